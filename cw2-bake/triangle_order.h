// The order of a chunk's triangles that suits the caches of vertices on GPUs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace bake {

/// Orders triangles so that their vertices are used again while a cache of the last kCacheSize
/// still holds them (after Sander, Nehab and Barczak 2007): all triangles around one vertex, then
/// those around one of the vertices just used. Reused from chunk to chunk by one thread.
class TriangleOrder {
 public:
    static constexpr std::uint32_t kCacheSize = 16;

    /// The triangles over vertices 0 .. vertex_count - 1 in their best order: their numbers, valid
    /// until the next call. At most 65,536 corners.
    std::span<const std::uint16_t> order(std::span<const std::uint16_t> indices,
                                         std::size_t vertex_count);

 private:
    void list_triangles(std::span<const std::uint16_t> indices, std::size_t vertex_count);
    void emit_around(std::uint16_t vertex, std::span<const std::uint16_t> indices);
    std::uint16_t next_vertex(std::size_t vertex_count);

    static constexpr std::uint16_t kNone = 0xFFFF;

    std::vector<std::uint16_t> first_;      // by vertex, where its triangles start in triangles_
    std::vector<std::uint16_t> triangles_;  // by vertex
    std::vector<std::uint16_t> left_;       // by vertex, its triangles that are not ordered yet
    std::vector<std::uint32_t> entered_;    // by vertex, when it entered the cache
    std::vector<bool> done_;                // by triangle
    std::vector<std::uint16_t> recent_;     // vertices used, the last one last
    std::vector<std::uint16_t> candidates_;
    std::vector<std::uint16_t> result_;
    std::uint32_t time_ = 0;  // counts what enters the cache
    std::uint16_t scan_ = 0;  // all vertices before it are done
};

}  // namespace bake
