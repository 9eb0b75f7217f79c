#include "cw2-bake/chunks.h"

#include <meshoptimizer.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <span>

#include "mesh-format/layout.h"

namespace bake {

namespace {

using mesh_format::kMaxChunkTriangles;

constexpr std::uint32_t kNone = 0xFFFF'FFFF;
// Steps of a 16-bit lattice, less one for where its ends are rounded to.
constexpr double kLatticeSpan = 65'534.0;
// Below this many triangles a task of its own costs more than it saves.
constexpr std::size_t kParallelSplit = 16'384;
// How much longer the vertex cache may work so that less is drawn over.
constexpr float kOverdrawThreshold = 1.05f;

struct Triangle {
    glm::vec3 centroid;  // times 3/4
    std::uint32_t index;
};

/// [first, last) of the triangles, once they are in chunk order.
struct Range {
    std::uint32_t first, last;
};

/// The number of chunks that `count` triangles are halved into.
std::size_t chunk_count(std::size_t count) {
    return count <= kMaxChunkTriangles ? 1
                                       : chunk_count(count / 2) + chunk_count(count - count / 2);
}

int longest_axis(std::span<const Triangle> triangles) {
    glm::vec3 low(std::numeric_limits<float>::infinity());
    glm::vec3 high = -low;
    for (const Triangle& triangle : triangles) {
        low = glm::min(low, triangle.centroid);
        high = glm::max(high, triangle.centroid);
    }
    const glm::vec3 extent = high - low;
    return extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
}

/// Orders `triangles`, which start at `first` of all, so that each chunk's follow each other, and
/// writes the chunks' ranges.
void split(std::span<Triangle> triangles, std::uint32_t first, std::span<Range> chunks) {
    if (chunks.size() == 1) {
        // Back to the source's order: it does not depend on how the halves were found.
        std::sort(triangles.begin(), triangles.end(),
                  [](const Triangle& a, const Triangle& b) { return a.index < b.index; });
        chunks.front() = {first, first + static_cast<std::uint32_t>(triangles.size())};
        return;
    }
    const int axis = longest_axis(triangles);
    const std::size_t half = triangles.size() / 2;
    std::nth_element(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(half),
                     triangles.end(), [axis](const Triangle& a, const Triangle& b) {
                         return a.centroid[axis] != b.centroid[axis]
                                    ? a.centroid[axis] < b.centroid[axis]
                                    : a.index < b.index;
                     });
    const std::size_t low_chunks = chunk_count(half);
    const auto low = [&] { split(triangles.first(half), first, chunks.first(low_chunks)); };
    const auto high = [&] {
        split(triangles.subspan(half), first + static_cast<std::uint32_t>(half),
              chunks.subspan(low_chunks));
    };
    if (triangles.size() >= kParallelSplit) {
        tbb::parallel_invoke(low, high);
    } else {
        low();
        high();
    }
}

struct UvBox {
    glm::vec2 low{std::numeric_limits<float>::infinity()};
    glm::vec2 high{-std::numeric_limits<float>::infinity()};

    void add(const glm::vec2& uv) {
        low = glm::min(low, uv);
        high = glm::max(high, uv);
    }
};

/// The range of UVs that 16 bits hold within a budget.
class UvLimit {
 public:
    explicit UvLimit(const UvBudget& budget)
        : range_(kLatticeSpan * std::exp2(std::floor(std::log2(budget.largest_step())))) {}

    bool exceeded_by(const UvBox& box) const {
        return box.high.x - box.low.x > range_ || box.high.y - box.low.y > range_;
    }

 private:
    double range_;
};

/// Halves `range` by UV as long as it exceeds the limit, and writes what results to `chunks`.
void split_by_uv(const FramedMesh& mesh, const UvLimit& limit, std::span<Triangle> triangles,
                 Range range, std::vector<Range>& chunks) {
    UvBox box;
    const auto part = triangles.subspan(range.first, range.last - range.first);
    for (const Triangle& triangle : part) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            box.add(mesh.uvs[mesh.indices[3 * std::size_t{triangle.index} + corner]]);
        }
    }
    if (part.size() == 1 || !limit.exceeded_by(box)) {
        chunks.push_back(range);
        return;
    }
    const int axis = box.high.x - box.low.x >= box.high.y - box.low.y ? 0 : 1;
    const auto uv_of = [&](const Triangle& triangle) {
        const auto corner = [&](std::size_t k) {
            return mesh.uvs[mesh.indices[3 * std::size_t{triangle.index} + k]][axis];
        };
        return std::max({corner(0), corner(1), corner(2)});
    };
    std::sort(part.begin(), part.end(), [&](const Triangle& a, const Triangle& b) {
        return std::pair(uv_of(a), a.index) < std::pair(uv_of(b), b.index);
    });
    const std::uint32_t half = range.first + static_cast<std::uint32_t>(part.size() / 2);
    split_by_uv(mesh, limit, triangles, {range.first, half}, chunks);
    split_by_uv(mesh, limit, triangles, {half, range.last}, chunks);
}

/// Orders the triangles of one chunk; reused from chunk to chunk by one thread.
class ChunkOptimiser {
 public:
    explicit ChunkOptimiser(const FramedMesh& mesh)
        : mesh_(mesh), local_(mesh.positions.size(), kNone) {}

    /// Writes the indices of `triangles` to `out` in their best order.
    void run(std::span<const Triangle> triangles, std::uint32_t* out) {
        vertices_.clear();
        positions_.clear();
        indices_.clear();
        for (const Triangle& triangle : triangles) {
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const std::uint32_t vertex =
                    mesh_.indices[3 * std::size_t{triangle.index} + corner];
                if (local_[vertex] == kNone) {
                    local_[vertex] = static_cast<std::uint32_t>(vertices_.size());
                    vertices_.push_back(vertex);
                    positions_.push_back(mesh_.positions[vertex]);
                }
                indices_.push_back(local_[vertex]);
            }
        }
        for (const std::uint32_t vertex : vertices_) local_[vertex] = kNone;

        ordered_.resize(indices_.size());
        meshopt_optimizeVertexCache(ordered_.data(), indices_.data(), indices_.size(),
                                    vertices_.size());
        meshopt_optimizeOverdraw(indices_.data(), ordered_.data(), indices_.size(),
                                 &positions_.front().x, positions_.size(), sizeof(glm::vec3),
                                 kOverdrawThreshold);
        for (std::size_t i = 0; i < indices_.size(); ++i) out[i] = vertices_[indices_[i]];
    }

 private:
    const FramedMesh& mesh_;
    std::vector<std::uint32_t> local_;     // mesh vertex -> chunk vertex
    std::vector<std::uint32_t> vertices_;  // chunk vertex -> mesh vertex
    std::vector<glm::vec3> positions_;
    std::vector<std::uint32_t> indices_, ordered_;
};

/// Gathers chunks into meshes.
class Assembler {
 public:
    Assembler(const FramedMesh& source, UvLimit limit)
        : source_(source), limit_(limit), placed_(source.positions.size(), kNone) {}

    void add(std::span<const std::uint32_t> indices) {
        UvBox box;
        for (const std::uint32_t vertex : indices) box.add(source_.uvs[vertex]);
        const UvBox merged{glm::min(box_.low, box.low), glm::max(box_.high, box.high)};
        // A chunk too wide by itself shares a mesh with others of that kind only.
        const bool uvs_fit = limit_.exceeded_by(merged) == limit_.exceeded_by(box) &&
                             limit_.exceeded_by(merged) == limit_.exceeded_by(box_);
        if (meshes_.empty() || !uvs_fit || !has_room(indices)) start_mesh();
        box_ = {glm::min(box_.low, box.low), glm::max(box_.high, box.high)};
        ChunkedMesh& piece = meshes_.back();
        FramedMesh& mesh = piece.mesh;
        piece.chunks.push_back({static_cast<std::uint32_t>(mesh.indices.size()),
                                static_cast<std::uint32_t>(indices.size())});
        for (const std::uint32_t vertex : indices) {
            if (placed_[vertex] == kNone) {
                placed_[vertex] = static_cast<std::uint32_t>(members_.size());
                members_.push_back(vertex);
                mesh.positions.push_back(source_.positions[vertex]);
                mesh.normals.push_back(source_.normals[vertex]);
                mesh.uvs.push_back(source_.uvs[vertex]);
                mesh.tangents.push_back(source_.tangents[vertex]);
            }
            mesh.indices.push_back(placed_[vertex]);
        }
    }

    std::vector<ChunkedMesh> take() { return std::move(meshes_); }

 private:
    bool has_room(std::span<const std::uint32_t> indices) const {
        // Every index may name a new vertex; only near the limit is it worth to count.
        const std::size_t room = mesh_format::kMaxMeshVertices - members_.size();
        if (indices.size() <= room) return true;
        std::vector<std::uint32_t> fresh;
        std::copy_if(indices.begin(), indices.end(), std::back_inserter(fresh),
                     [this](std::uint32_t vertex) { return placed_[vertex] == kNone; });
        std::sort(fresh.begin(), fresh.end());
        const auto end = std::unique(fresh.begin(), fresh.end());
        return static_cast<std::size_t>(end - fresh.begin()) <= room;
    }

    void start_mesh() {
        for (const std::uint32_t vertex : members_) placed_[vertex] = kNone;
        members_.clear();
        box_ = {};
        meshes_.emplace_back().mesh.material = source_.material;
    }

    const FramedMesh& source_;
    UvLimit limit_;
    UvBox box_;                           // of the last mesh
    std::vector<std::uint32_t> placed_;   // source vertex -> vertex of the last mesh
    std::vector<std::uint32_t> members_;  // vertex of the last mesh -> source vertex
    std::vector<ChunkedMesh> meshes_;
};

std::vector<Triangle> triangles_of(const FramedMesh& mesh) {
    std::vector<Triangle> triangles(mesh.indices.size() / 3);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        // Scaled so that no sum of finite positions overflows.
        triangles[i] = {0.25f * mesh.positions[mesh.indices[3 * i]] +
                            0.25f * mesh.positions[mesh.indices[3 * i + 1]] +
                            0.25f * mesh.positions[mesh.indices[3 * i + 2]],
                        static_cast<std::uint32_t>(i)};
    }
    return triangles;
}

}  // namespace

std::vector<ChunkedMesh> make_chunks(const FramedMesh& mesh, const UvBudget& budget) {
    std::vector<Triangle> triangles = triangles_of(mesh);
    std::vector<Range> near(chunk_count(triangles.size()));
    split(triangles, 0, near);
    const UvLimit limit(budget);
    std::vector<Range> ranges;
    for (const Range range : near) split_by_uv(mesh, limit, triangles, range, ranges);

    std::vector<std::uint32_t> indices(mesh.indices.size());
    tbb::enumerable_thread_specific<ChunkOptimiser> optimisers(
        [&] { return ChunkOptimiser(mesh); });
    tbb::parallel_for(std::size_t{0}, ranges.size(), [&](std::size_t i) {
        const Range range = ranges[i];
        optimisers.local().run(std::span(triangles).subspan(range.first, range.last - range.first),
                               indices.data() + 3 * std::size_t{range.first});
    });

    Assembler assembler(mesh, limit);
    for (const Range range : ranges) {
        assembler.add(std::span(indices).subspan(3 * std::size_t{range.first},
                                                 3 * std::size_t{range.last - range.first}));
    }
    return assembler.take();
}

}  // namespace bake
