#include "cw2-bake/geometry/weld.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <cassert>

namespace bake {
namespace {

constexpr std::size_t kTrianglesPerBlock = 4096;

/// Numbers the vertices in the order of the corners that have them first.
class VertexMaker {
 public:
    VertexMaker(const SourceScene& scene, RawVector<FramedVertex>& vertices)
        : vertices_(vertices), head_(scene.positions.size(), kNone), overflow_(0) {
        // At most; what is left over is never touched.
        vertices_.resize(scene.corners.size());
        links_.resize(scene.corners.size());
    }

    /// The vertices of corners of one material.
    void number(std::span<const Corner> corners, std::uint32_t material, std::uint32_t* out) {
        FramedVertex* const vertices = vertices_.data();
        Link* const links = links_.data();
        std::uint32_t* const head = head_.data();
        for (const Corner& corner : corners) {
            int length = 0;
            std::uint32_t i = head[corner.position];
            for (; i != kNone; i = links[i].next) {
                const Corner& other = vertices[i].corner;
                const std::uint32_t difference = (other.normal ^ corner.normal) |
                                                 (other.uv ^ corner.uv) |
                                                 (links[i].material ^ material);
                if (difference == 0 || ++length == kMaxChain) break;
            }
            if (i == kNone) {
                i = count_++;
                links[i] = {head[corner.position], material};
                vertices[i].corner = corner;
                head[corner.position] = i;
            } else if (length == kMaxChain) {
                i = overflowing_vertex(corner, material);
            }
            *out++ = i;
        }
    }

    void finish() { vertices_.resize(count_); }

 private:
    static constexpr std::uint32_t kNone = 0xFFFF'FFFF;
    static constexpr int kMaxChain = 24;

    std::uint32_t overflowing_vertex(const Corner& corner, std::uint32_t material) {
        const auto is_equal = [&](std::uint32_t i) {
            const Corner& other = vertices_[i].corner;
            return other.position == corner.position && other.normal == corner.normal &&
                   other.uv == corner.uv && links_[i].material == material;
        };
        const std::uint32_t found = overflow_.find_or_insert(
            hash_of(corner.position, corner.normal, corner.uv, material), count_, is_equal);
        if (found != count_) return found;
        links_[count_].material = material;
        vertices_[count_].corner = corner;
        return count_++;
    }

    struct Link {
        std::uint32_t next;  ///< vertex at the same position
        std::uint32_t material;
    };

    RawVector<FramedVertex>& vertices_;
    RawVector<Link> links_;            // by vertex
    std::vector<std::uint32_t> head_;  // by position
    std::uint32_t count_ = 0;
    /// What exceeds kMaxChain at one position; nearly all have few.
    IndexSet overflow_;
};

void unify(std::span<Corner> corners, std::uint32_t Corner::*index, const FirstEqual& first) {
    if (first.all_differ()) return;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, corners.size(), 3 * kTrianglesPerBlock),
                      [&](const auto& block) {
                          for (std::size_t i = block.begin(); i < block.end(); ++i)
                              corners[i].*index = first[corners[i].*index];
                      });
}

}  // namespace

FramedTriangles weld(SourceScene& scene, const FirstEqual& positions, const Advance& advance) {
    const auto absent_uv = static_cast<std::uint32_t>(scene.uvs.size());
    scene.uvs.emplace_back(0.0f);
    // One attribute after the other: what tells which are equal takes memory while all corners are
    // still there.
    unify(scene.corners, &Corner::normal, FirstEqual(scene.normals));
    const FirstEqual uvs(scene.uvs);
    FramedTriangles result;
    result.indices.resize(scene.corners.size());
    VertexMaker maker(scene, result.vertices);

    struct Block {
        std::size_t begin, end;  ///< triangles
    };
    const std::size_t triangle_count = scene.corners.size() / 3;
    std::size_t next = 0;
    const auto take = [&](tbb::flow_control& flow) {
        if (next == triangle_count) flow.stop();
        const Block block{next, std::min(next + kTrianglesPerBlock, triangle_count)};
        next = block.end;
        return block;
    };
    const auto unify_rest = [&](const Block& block) {
        for (std::size_t i = 3 * block.begin; i < 3 * block.end; ++i) {
            Corner& corner = scene.corners[i];
            assert(corner.normal != kAbsent);
            corner.position = positions[corner.position];
            corner.uv = uvs[corner.uv != kAbsent ? corner.uv : absent_uv];
        }
        return block;
    };
    PageReleaser used(std::as_writable_bytes(std::span(scene.corners)));
    auto run = scene.triangle_material.runs().begin();
    const auto number = [&](const Block& block) {
        for (std::size_t begin = block.begin; begin < block.end;) {
            const std::size_t end = std::min(block.end, run->end);
            maker.number(std::span(scene.corners).subspan(3 * begin, 3 * (end - begin)),
                         run->number, &result.indices[3 * begin]);
            run += end == run->end;
            begin = end;
        }
        used.release(3 * block.end * sizeof(Corner));
        advance(static_cast<double>(block.end - block.begin) / static_cast<double>(triangle_count));
    };
    const std::size_t at_once =
        2 * tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    using tbb::filter_mode;
    tbb::parallel_pipeline(at_once,
                           tbb::make_filter<void, Block>(filter_mode::serial_in_order, take) &
                               tbb::make_filter<Block, Block>(filter_mode::parallel, unify_rest) &
                               tbb::make_filter<Block, void>(filter_mode::serial_in_order, number));
    maker.finish();
    std::vector<Corner>().swap(scene.corners);
    return result;
}

}  // namespace bake
