// The order of a chunk's triangles that suits the caches of vertices on GPUs.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "mesh-format/layout.h"

namespace bake {

/// Orders triangles so that their vertices are used again while a cache of the last kCacheSize
/// still holds them (after Sander, Nehab and Barczak 2007): all triangles around one vertex, then
/// those around one of the vertices just used. Around a vertex each triangle goes on from the edge
/// that the one before ends with, as long as one does: so a compressed file has little to say of
/// it. Reused from chunk to chunk by one thread.
class TriangleOrder {
 public:
    static constexpr std::uint32_t kCacheSize = 16;

    /// The triangles over vertices 0 .. vertex_count - 1, at most kMaxChunkTriangles and three
    /// vertices for each, in their best order: their numbers, valid until the next call.
    std::span<const std::uint16_t> order(std::span<const std::uint16_t> indices,
                                         std::size_t vertex_count);

 private:
    void list_triangles(std::span<const std::uint16_t> indices, std::size_t vertex_count);
    void emit_around(std::uint16_t vertex, std::span<const std::uint16_t> indices);
    std::size_t gather_fan(std::uint16_t vertex, std::span<const std::uint16_t> indices);
    std::uint16_t next_vertex(std::size_t vertex_count);

    static constexpr std::uint16_t kNone = 0xFFFF;
    static constexpr std::size_t kMaxTriangles = mesh_format::kMaxChunkTriangles;
    static constexpr std::size_t kMaxCorners = 3 * kMaxTriangles;

    template <std::size_t kSize>
    using Numbers = std::array<std::uint16_t, kSize>;

    /// A triangle around a vertex, and the two vertices that follow that one.
    struct Blade {
        std::uint16_t triangle, first, last;
        bool goes_on;  // from another one's last vertex
    };

    Numbers<kMaxCorners + 1> first_;        // by vertex, where its triangles start in triangles_
    Numbers<kMaxCorners> triangles_;        // by vertex
    Numbers<kMaxCorners> left_;             // by vertex, its triangles that are not ordered yet
    Numbers<kMaxCorners> entered_;          // by vertex, when it entered the cache
    std::array<bool, kMaxTriangles> done_;  // by triangle
    // Around a vertex, those that were not done; at each corner that the vertex is.
    std::array<Blade, kMaxCorners> fan_;
    Numbers<kMaxCorners> blades_;      // by vertex, which of the fan starts with it, if one does
    Numbers<kMaxCorners + 1> recent_;  // vertices used, the last one last
    std::size_t recent_count_ = 0;
    std::size_t candidates_ = 0;  // where in recent_ those start that were used just now
    Numbers<kMaxTriangles> result_;
    std::size_t result_count_ = 0;
    std::uint32_t time_ = 0;  // counts what enters the cache
    std::uint16_t scan_ = 0;  // all vertices before it are done
};

}  // namespace bake
