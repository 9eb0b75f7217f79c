#include "cw2-bake/geometry/plain_tangents.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <span>
#include <vector>

#include "cw2-bake/geometry/fan.h"
#include "cw2-bake/geometry/tangent_directions.h"
#include "cw2-bake/geometry/tangent_topology.h"

namespace bake {
namespace {

/// Makes the fans of one block of faces after the other; used by one thread.
class FaceBlock {
 public:
    FaceBlock(const SourceScene& scene, FramedTriangles& triangles, std::span<std::uint8_t> left)
        : scene_(scene), triangles_(triangles), left_(left) {}

    /// Of the vertices of these faces, those from `first` to before `end` are in no earlier block.
    void make(std::size_t begin_face, std::size_t end_face, std::uint32_t first,
              std::uint32_t end) {
        first_ = first;
        fans_.clear();
        fans_.resize(end - first);
        for (Fan& fan : fans_) fan.clear();
        for (std::size_t face = begin_face; face < end_face; face += kLanes) {
            const std::size_t count = std::min(kLanes, end_face - face);
            spokes_.make(scene_, triangles_, face, count);
            for (std::size_t i = 0; i < count; ++i)
                if (!spokes_.is_degenerate(i)) add(face + i, i);
        }
        for (std::uint32_t i = 0; i < fans_.size(); ++i) {
            const auto tangent = fans_[i].tangent();
            if (tangent)
                triangles_.vertices[first + i].tangent = *tangent;
            else
                leave(first + i);
        }
    }

 private:
    void add(std::size_t face, std::size_t lane) {
        const std::uint32_t* const vertices = &triangles_.indices[3 * face];
        const std::uint32_t source = triangles_.sources.empty() ? 0 : triangles_.sources[face];
        for (std::size_t k = 0; k < 3; ++k) {
            if (vertices[k] < first_)
                leave(vertices[k]);
            else
                fans_[vertices[k] - first_].add(spokes_.at_corner(k), lane, vertices[(k + 1) % 3],
                                                vertices[(k + 2) % 3], source);
        }
    }

    /// Several blocks may have the same vertex.
    void leave(std::uint32_t vertex) {
        std::atomic_ref(left_[vertex]).store(1, std::memory_order_relaxed);
    }

    const SourceScene& scene_;
    FramedTriangles& triangles_;
    std::span<std::uint8_t> left_;
    std::uint32_t first_ = 0;
    RawVector<Fan> fans_;  // of vertices from first_ on
    FaceSpokes spokes_;
};

}  // namespace

bool may_be_plain(const SourceScene& scene) {
    return scene.tangents.empty() && scene.colors.empty();
}

RawVector<std::uint8_t> add_plain_tangents(const SourceScene& scene, FramedTriangles& triangles,
                                           const Advance& advance) {
    RawVector<std::uint8_t> left(triangles.vertices.size());
    std::ranges::fill(left, may_be_plain(scene) ? 0 : 1);
    if (!may_be_plain(scene)) {
        advance(1.0);
        return left;
    }

    // Few blocks, since what two of them share is left; but small ones, for the caches.
    const std::size_t threads =
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    const std::size_t faces = triangles.indices.size() / 3;
    constexpr std::size_t kLeast = 1 << 14, kMost = 1 << 15;
    const std::size_t block_faces = std::clamp(faces / (8 * threads), kLeast, kMost);
    const std::size_t blocks = (faces + block_faces - 1) / block_faces;
    const auto begin_of = [&](std::size_t block) { return std::min(block * block_faces, faces); };
    std::vector<std::uint32_t> end_vertex(blocks + 1);
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
        const std::size_t first = 3 * begin_of(block);
        const std::size_t count = 3 * begin_of(block + 1) - first;
        end_vertex[block + 1] = 1 + range_of(&triangles.indices[first], count).high;
    });
    for (std::size_t block = 0; block < blocks; ++block)
        end_vertex[block + 1] = std::max(end_vertex[block + 1], end_vertex[block]);
    tbb::enumerable_thread_specific<FaceBlock> makers(
        [&] { return FaceBlock(scene, triangles, left); });
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
        makers.local().make(begin_of(block), begin_of(block + 1), end_vertex[block],
                            end_vertex[block + 1]);
        advance(1.0 / static_cast<double>(blocks));
    });
    return left;
}

}  // namespace bake
