#include "cw2-bake/geometry/weld.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <bit>
#include <optional>
#include <span>
#include <utility>

#include "cw2-bake/geometry/spatial_order.h"

namespace bake {
namespace {

/// Numbers the vertices in the order of the corners that have them first.
class VertexMaker {
 public:
    /// A corner without a UV gets the scene's last. There will be `most` vertices at most; memory
    /// of those that are not made is never touched.
    VertexMaker(const SourceScene& scene, const FirstEqual& positions, std::size_t most)
        : scene_(scene),
          positions_(positions),
          absent_uv_(static_cast<std::uint32_t>(scene.uvs.size()) - 1),
          vertices_(most),
          head_(scene.positions.size(), kNone),
          overflow_(0) {}

    /// The vertices of corners of one material.
    void number(std::span<const Corner> corners, std::uint32_t material, std::uint32_t* out) {
        FramedVertex* const vertices = vertices_.data();
        std::uint32_t* const head = head_.data();
        for (Corner corner : corners) {
            corner.position = positions_[corner.position];
            corner.uv = corner.uv != kAbsent ? corner.uv : absent_uv_;
            int length = 0;
            std::uint32_t i = head[corner.position];
            for (; i != kNone; i = link_of(vertices[i]).next) {
                if ((link_of(vertices[i]).material == material &&
                     is_alike(vertices[i].corner, corner)) ||
                    ++length == kMaxChain)
                    break;
            }
            if (i == kNone) {
                i = count_++;
                vertices[i] = linked(corner, {head[corner.position], material});
                head[corner.position] = i;
            } else if (length == kMaxChain) {
                i = overflowing_vertex(corner, material);
            }
            *out++ = i;
        }
    }

    /// Starts to fetch what number() will ask for first.
    void prefetch(std::span<const Corner> corners) const {
        for (const Corner& corner : corners)
            __builtin_prefetch(&head_[positions_[corner.position]]);
    }

    /// The vertices of this one for those of `other`, by number; those that it lacks join it in
    /// their order: so it has in the end what it would have made of all corners of both.
    RawVector<std::uint32_t> take_over(const VertexMaker& other) {
        RawVector<std::uint32_t> result(other.count_);
        for (std::uint32_t v = 0; v < other.count_; ++v) {
            const FramedVertex& vertex = other.vertices_[v];
            number({&vertex.corner, 1}, link_of(vertex).material, &result[v]);
        }
        return result;
    }

    RawVector<FramedVertex> finish() && {
        vertices_.resize(count_);
        return std::move(vertices_);
    }

    /// The first vertex at the position of vertex v.
    static std::uint32_t first_there(const RawVector<FramedVertex>& vertices, std::uint32_t v) {
        while (link_of(vertices[v]).next != kNone) v = link_of(vertices[v]).next;
        return v;
    }

 private:
    static constexpr std::uint32_t kNone = 0xFFFF'FFFF;
    static constexpr int kMaxChain = 24;

    /// Whether corners at one position are equal in value. Nearly always their indices tell.
    bool is_alike(const Corner& a, const Corner& b) const {
        return (a.normal == b.normal || scene_.normals[a.normal] == scene_.normals[b.normal]) &&
               (a.uv == b.uv || scene_.uvs[a.uv] == scene_.uvs[b.uv]);
    }

    std::uint32_t overflowing_vertex(const Corner& corner, std::uint32_t material) {
        const auto is_equal = [&](std::uint32_t i) {
            const Corner& other = vertices_[i].corner;
            return other.position == corner.position &&
                   link_of(vertices_[i]).material == material && is_alike(other, corner);
        };
        const glm::vec3& normal = scene_.normals[corner.normal];
        const glm::vec2& uv = scene_.uvs[corner.uv];
        const std::uint32_t found = overflow_.find_or_insert(
            hash_of(corner.position, normal.x, normal.y, normal.z, uv.x, uv.y, material), count_,
            is_equal);
        if (found != count_) return found;
        vertices_[count_] = linked(corner, {head_[corner.position], material});
        return count_++;
    }

    struct Link {
        std::uint32_t next;  ///< vertex at the same position
        std::uint32_t material;
    };
    /// Lies in the place of the tangent, which is made later.
    static Link link_of(const FramedVertex& vertex) {
        return std::bit_cast<Link>(glm::vec2(vertex.tangent));
    }
    static FramedVertex linked(const Corner& corner, Link link) {
        return {corner, glm::vec4(std::bit_cast<glm::vec2>(link), 0.0f, 0.0f)};
    }

    const SourceScene& scene_;
    const FirstEqual& positions_;
    std::uint32_t absent_uv_;
    RawVector<FramedVertex> vertices_;
    std::vector<std::uint32_t> head_;  // by position
    std::uint32_t count_ = 0;
    /// What exceeds kMaxChain at one position; nearly all have few.
    IndexSet overflow_;
};

/// What the corners of some blocks of triangles take goes as soon as each block has been used.
class CornerReleaser {
 public:
    CornerReleaser(std::vector<Corner>& corners, std::size_t parts, std::size_t unit)
        : corners_(corners), unit_(unit), parts_(parts) {}

    /// The blocks of one part come in the order in which they lie.
    void release(const TriangleBlock& block) {
        std::optional<PageReleaser>& part = parts_[block.part].releaser;
        if (!part) {
            parts_[block.part].first = block.first;
            part.emplace(
                std::as_writable_bytes(std::span(corners_).subspan(3 * std::size_t{block.first})),
                unit_);
        }
        part->release(3 * std::size_t{block.first + block.size - parts_[block.part].first} *
                      sizeof(Corner));
    }

 private:
    struct Part {
        std::optional<PageReleaser> releaser;
        std::uint32_t first = 0;
    };
    std::vector<Corner>& corners_;
    std::size_t unit_;
    std::vector<Part> parts_;
};

std::size_t triangles_in(std::span<const TriangleBlock> blocks) {
    std::size_t sum = 0;
    for (const TriangleBlock& block : blocks) sum += block.size;
    return sum;
}

/// Welds the blocks of all of a scene's triangles, in their order.
class Welder {
 public:
    /// Where blocks are `scattered` each one's vertices are fetched before its turn comes.
    Welder(SourceScene& scene, const FirstEqual& positions, std::span<const TriangleBlock> blocks,
           std::size_t parts, bool scattered, const Advance& advance)
        : scene_(scene),
          positions_(positions),
          blocks_(blocks),
          parts_(parts),
          scattered_(scattered),
          advance_(advance) {}

    FramedTriangles weld() {
        scene_.uvs.emplace_back(0.0f);
        FramedTriangles result;
        result.indices.resize(scene_.corners.size());
        VertexMaker maker(scene_, positions_, scene_.corners.size());
        if (scattered_)
            number_halves(maker, result.indices);
        else
            number(blocks_, maker, result.indices);
        result.vertices = std::move(maker).finish();
        std::vector<Corner>().swap(scene_.corners);
        return result;
    }

 private:
    std::span<const Corner> corners_of(const TriangleBlock& block) const {
        return std::span(scene_.corners)
            .subspan(3 * std::size_t{block.first}, 3 * std::size_t{block.size});
    }

    void number(std::span<const TriangleBlock> blocks, VertexMaker& maker,
                std::span<std::uint32_t> out) {
        constexpr std::size_t kSmallUnit = 1 << 16;
        CornerReleaser used(scene_.corners, parts_, scattered_ ? kSmallUnit : kHugePage);
        for (std::size_t i = 0; i < blocks.size(); ++i) {
            if (scattered_ && i + 1 < blocks.size()) maker.prefetch(corners_of(blocks[i + 1]));
            const auto corners = corners_of(blocks[i]);
            maker.number(corners, blocks[i].material, out.data());
            out = out.subspan(corners.size());
            used.release(blocks[i]);
            advance_(static_cast<double>(corners.size()) /
                     static_cast<double>(scene_.corners.size()));
        }
    }

    /// On two threads, where there are two. That pays where what takes the time is the memory.
    void number_halves(VertexMaker& first, std::span<std::uint32_t> indices) {
        // The vertices of the second half are numbered again.
        const std::size_t cut = blocks_.size() - blocks_.size() * 9 / 20;
        const auto first_half = blocks_.first(cut);
        const auto second_half = blocks_.subspan(cut);
        const auto first_indices = indices.first(3 * triangles_in(first_half));
        const auto second_indices = indices.subspan(first_indices.size());
        VertexMaker second(scene_, positions_, second_indices.size());
        tbb::parallel_invoke([&] { number(first_half, first, first_indices); },
                             [&] { number(second_half, second, second_indices); });
        const RawVector<std::uint32_t> numbers = first.take_over(second);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, second_indices.size(), 1 << 14),
                          [&](const auto& range) {
                              for (std::size_t i = range.begin(); i < range.end(); ++i)
                                  second_indices[i] = numbers[second_indices[i]];
                          });
    }

    SourceScene& scene_;
    const FirstEqual& positions_;
    std::span<const TriangleBlock> blocks_;
    std::size_t parts_;
    bool scattered_;
    const Advance& advance_;
};

/// Whether consecutive vertices refer to what lies all over the memory, told by samples.
bool are_scattered(std::span<const FramedVertex> vertices, std::uint32_t Corner::*index) {
    constexpr std::size_t kWindows = 4;
    constexpr std::uint32_t kNear = 8;
    const std::size_t size = std::min<std::size_t>(vertices.size(), 1024);
    std::size_t places = 0;
    for (std::size_t window = 0; window < kWindows; ++window) {
        DistinctCount met;
        for (const FramedVertex& vertex :
             vertices.subspan((vertices.size() - size) / kWindows * window, size))
            met.add(vertex.corner.*index / kNear);
        places += met.count();
    }
    return 2 * places > kWindows * size;
}

/// Puts what vertices refer to by `index`, if it is scattered, into their order: vertex v refers to
/// element by_vertex(v) then. What few values many vertices share stays as it is.
template <typename Value, typename ByVertex>
void put_in_order(RawVector<FramedVertex>& vertices, std::vector<Value>& values,
                  std::uint32_t Corner::*index, const ByVertex& by_vertex) {
    const bool are_few = vertices.size() > values.size() + values.size() / 4;
    if (are_few || !are_scattered(vertices, index)) return;
    std::vector<Value> ordered(vertices.size());
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, vertices.size(), 1 << 13), [&](const auto& range) {
            for (auto v = static_cast<std::uint32_t>(range.begin()); v < range.end(); ++v) {
                ordered[v] = values[vertices[v].corner.*index];
                vertices[v].corner.*index = by_vertex(v);
            }
        });
    values = std::move(ordered);
}

void put_attributes_in_order(SourceScene& scene, RawVector<FramedVertex>& vertices) {
    const auto itself = [](std::uint32_t v) { return v; };
    const auto first_there = [&](std::uint32_t v) { return VertexMaker::first_there(vertices, v); };
    tbb::parallel_invoke(
        [&] { put_in_order(vertices, scene.positions, &Corner::position, first_there); },
        [&] { put_in_order(vertices, scene.normals, &Corner::normal, itself); },
        [&] { put_in_order(vertices, scene.uvs, &Corner::uv, itself); });
}

}  // namespace

FramedTriangles weld(SourceScene& scene, const FirstEqual& positions, const Advance& advance) {
    constexpr std::uint32_t kMostBlockTriangles = 4096;
    const std::vector<TriangleBlock> blocks =
        blocks_of(scene.triangle_material, kMostBlockTriangles);
    FramedTriangles result = Welder(scene, positions, blocks, 1, false, advance).weld();
    put_attributes_in_order(scene, result.vertices);
    return result;
}

FramedTriangles weld_in_space(SourceScene& scene, const FirstEqual& positions,
                              const Advance& advance) {
    const SpatialOrder order = sort_in_space(scene);
    FramedTriangles result =
        Welder(scene, positions, order.blocks, order.first_of_part.size(), true, advance).weld();
    scene.triangle_material = {};
    for (const TriangleBlock& block : order.blocks)
        scene.triangle_material.extend(scene.triangle_material.size() + block.size, block.material);
    tbb::parallel_invoke([&] { result.sources = order.sources(); },
                         [&] { put_attributes_in_order(scene, result.vertices); });
    return result;
}

}  // namespace bake
