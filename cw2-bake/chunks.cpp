#include "cw2-bake/chunks.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>

#include "cw2-bake/chunk_bounds.h"
#include "cw2-bake/chunk_split.h"
#include "cw2-bake/raw_vector.h"
#include "cw2-bake/triangle_order.h"

namespace bake {

namespace {

using mesh_format::ChunkRecord;

constexpr std::uint32_t kNone = 0xFFFF'FFFF;
// Steps of a 16-bit lattice, less one for where its ends are rounded to.
constexpr double kLatticeSpan = 65'534.0;

using UvBox = Box<glm::vec2>;

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

/// A finished chunk, before it has its place in a mesh: first_index counts from the material's.
struct FinishedChunk {
    ChunkRecord record;
    UvBox uvs;
    Box<glm::vec3> positions{};
};

/// Makes chunks of the parts that a material's triangles are cut into; used by one thread.
class ChunkMaker {
 public:
    explicit ChunkMaker(const FramedScene& scene)
        : scene_(scene), local_(scene.framed.vertices.size(), kNone) {}

    /// Halves `triangles` by UV as long as they exceed the limit. The chunks that result go to
    /// `chunks`, their vertices to `out`, where the first is index `first_index`.
    void make(std::span<CentredTriangle> triangles, const UvLimit& limit, std::uint32_t first_index,
              std::span<std::uint32_t> out, std::vector<FinishedChunk>& chunks) {
        gather(triangles);
        UvBox uvs;
        for (const std::uint32_t vertex : vertices_) uvs.add(scene_.uv(vertex));
        if (triangles.size() == 1 || !limit.exceeded_by(uvs)) {
            order(out);
            chunks.push_back(finished(first_index, uvs));
            return;
        }
        sort_by_uv(triangles, uvs.high.x - uvs.low.x >= uvs.high.y - uvs.low.y ? 0 : 1);
        const std::size_t half = triangles.size() / 2;
        make(triangles.first(half), limit, first_index, out.first(3 * half), chunks);
        make(triangles.subspan(half), limit, first_index + static_cast<std::uint32_t>(3 * half),
             out.subspan(3 * half), chunks);
    }

 private:
    std::span<const std::uint32_t> corners_of(const CentredTriangle& triangle) const {
        return std::span(scene_.framed.indices).subspan(3 * std::size_t{triangle.index}, 3);
    }

    void gather(std::span<const CentredTriangle> triangles) {
        vertices_.clear();
        positions_.clear();
        indices_.clear();
        for (const CentredTriangle& triangle : triangles) {
            for (const std::uint32_t vertex : corners_of(triangle)) {
                if (local_[vertex] == kNone) {
                    local_[vertex] = static_cast<std::uint32_t>(vertices_.size());
                    vertices_.push_back(vertex);
                    positions_.push_back(scene_.position(vertex));
                }
                indices_.push_back(static_cast<std::uint16_t>(local_[vertex]));
            }
        }
        for (const std::uint32_t vertex : vertices_) local_[vertex] = kNone;
    }

    /// Writes the gathered triangles in their best order.
    void order(std::span<std::uint32_t> out) {
        std::size_t next = 0;
        for (const std::uint16_t triangle : order_.order(indices_, vertices_.size())) {
            for (std::size_t corner = 0; corner < 3; ++corner)
                out[next++] = vertices_[indices_[3 * std::size_t{triangle} + corner]];
        }
    }

    FinishedChunk finished(std::uint32_t first_index, const UvBox& uvs) const {
        FinishedChunk chunk{.record = bound_chunk(positions_, indices_), .uvs = uvs};
        chunk.record.first_index = first_index;
        chunk.record.index_count = static_cast<std::uint32_t>(indices_.size());
        for (const glm::vec3& position : positions_) chunk.positions.add(position);
        return chunk;
    }

    void sort_by_uv(std::span<CentredTriangle> triangles, int axis) const {
        const auto key = [&](const CentredTriangle& triangle) {
            const auto corners = corners_of(triangle);
            return std::pair(std::max({scene_.uv(corners[0])[axis], scene_.uv(corners[1])[axis],
                                       scene_.uv(corners[2])[axis]}),
                             triangle.index);
        };
        std::ranges::sort(triangles, {}, key);
    }

    const FramedScene& scene_;
    TriangleOrder order_;
    std::vector<std::uint32_t> local_;     // vertex -> chunk vertex
    std::vector<std::uint32_t> vertices_;  // chunk vertex -> vertex
    std::vector<glm::vec3> positions_;     // of chunk vertices
    std::vector<std::uint16_t> indices_;   // of chunk vertices
};

/// Gathers the chunks of one material into meshes.
class Assembler {
 public:
    Assembler(std::uint32_t material, UvLimit limit, std::vector<std::uint32_t>& placed)
        : material_(material), limit_(limit), placed_(placed) {}

    void add(const FinishedChunk& chunk, std::span<const std::uint32_t> vertices) {
        UvBox merged = box_;
        merged.add(chunk.uvs);
        // A chunk too wide by itself shares a mesh with others of that kind only.
        const bool uvs_fit = limit_.exceeded_by(merged) == limit_.exceeded_by(chunk.uvs) &&
                             limit_.exceeded_by(merged) == limit_.exceeded_by(box_);
        if (meshes_.empty() || !uvs_fit || !has_room(vertices)) start_mesh();
        box_.add(chunk.uvs);
        ChunkedMesh& mesh = meshes_.back();
        mesh.positions.add(chunk.positions);
        mesh.chunks.push_back(chunk.record);
        mesh.chunks.back().first_index = static_cast<std::uint32_t>(mesh.indices.size());
        for (const std::uint32_t vertex : vertices) {
            if (placed_[vertex] == kNone) {
                placed_[vertex] = static_cast<std::uint32_t>(mesh.vertices.size());
                mesh.vertices.push_back(vertex);
            }
            mesh.indices.push_back(static_cast<std::uint16_t>(placed_[vertex]));
        }
    }

    std::vector<ChunkedMesh> take() {
        finish_mesh();
        return std::move(meshes_);
    }

 private:
    bool has_room(std::span<const std::uint32_t> vertices) const {
        // Every index may name a new vertex; only near the limit is it worth to count.
        const std::size_t room = mesh_format::kMaxMeshVertices - meshes_.back().vertices.size();
        if (vertices.size() <= room) return true;
        std::vector<std::uint32_t> fresh;
        std::copy_if(vertices.begin(), vertices.end(), std::back_inserter(fresh),
                     [this](std::uint32_t vertex) { return placed_[vertex] == kNone; });
        std::sort(fresh.begin(), fresh.end());
        const auto end = std::unique(fresh.begin(), fresh.end());
        return static_cast<std::size_t>(end - fresh.begin()) <= room;
    }

    void start_mesh() {
        if (!meshes_.empty()) finish_mesh();
        box_ = {};
        meshes_.emplace_back().material = material_;
    }

    void finish_mesh() {
        ChunkedMesh& mesh = meshes_.back();
        mesh.uvs = box_;
        for (const std::uint32_t vertex : mesh.vertices) placed_[vertex] = kNone;
    }

    std::uint32_t material_;
    UvLimit limit_;
    UvBox box_;                           // of the last mesh
    std::vector<std::uint32_t>& placed_;  // vertex -> vertex of the last mesh
    std::vector<ChunkedMesh> meshes_;
};

/// The triangles by material, each material's in the source's order.
struct TrianglesByMaterial {
    std::vector<std::size_t> first;  ///< by material, and the end of the last
    RawVector<CentredTriangle> triangles;
};

TrianglesByMaterial sort_by_material(const FramedScene& framed) {
    const SourceScene& scene = framed.source;
    TrianglesByMaterial result;
    result.first.assign(scene.materials.size() + 1, 0);
    for (const std::uint32_t material : scene.triangle_material) ++result.first[material + 1];
    for (std::size_t m = 0; m < scene.materials.size(); ++m) result.first[m + 1] += result.first[m];
    result.triangles.resize(scene.triangle_material.size());
    std::vector<std::size_t> next = result.first;
    for (std::uint32_t t = 0; t < scene.triangle_material.size(); ++t)
        result.triangles[next[scene.triangle_material[t]]++].index = t;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, result.triangles.size(), 1 << 13),
                      [&](const auto& block) {
                          for (std::size_t i = block.begin(); i < block.end(); ++i) {
                              CentredTriangle& triangle = result.triangles[i];
                              const std::uint32_t* corners =
                                  &framed.framed.indices[3 * std::size_t{triangle.index}];
                              // Scaled so that no sum of finite positions overflows.
                              triangle.centroid = 0.25f * framed.position(corners[0]) +
                                                  0.25f * framed.position(corners[1]) +
                                                  0.25f * framed.position(corners[2]);
                          }
                      });
    return result;
}

}  // namespace

std::vector<ChunkedMesh> make_chunks(const FramedScene& scene, std::span<const UvBudget> budgets) {
    TrianglesByMaterial sorted = sort_by_material(scene);
    tbb::enumerable_thread_specific<ChunkMaker> makers([&] { return ChunkMaker(scene); });
    tbb::enumerable_thread_specific<std::vector<std::uint32_t>> placed(scene.framed.vertices.size(),
                                                                       kNone);

    const auto chunks_of = [&](std::uint32_t material) {
        const std::size_t first = sorted.first[material];
        const auto triangles =
            std::span(sorted.triangles).subspan(first, sorted.first[material + 1] - first);
        const UvLimit limit(budgets[material]);
        RawVector<std::uint32_t> vertices(3 * triangles.size());
        std::vector<std::vector<FinishedChunk>> parts(part_count(triangles.size()));
        RawVector<CentredTriangle> spare(triangles.size());
        split(triangles, spare,
              [&](std::size_t part, std::span<CentredTriangle> members, std::size_t begin) {
                  makers.local().make(members, limit, static_cast<std::uint32_t>(3 * begin),
                                      std::span(vertices).subspan(3 * begin, 3 * members.size()),
                                      parts[part]);
              });
        Assembler assembler(material, limit, placed.local());
        for (const auto& part : parts) {
            for (const FinishedChunk& chunk : part)
                assembler.add(chunk, std::span(vertices).subspan(chunk.record.first_index,
                                                                 chunk.record.index_count));
        }
        return assembler.take();
    };

    // The largest first, so that no thread is left alone with one.
    std::vector<std::uint32_t> materials;
    for (std::uint32_t m = 0; m < scene.source.materials.size(); ++m)
        if (sorted.first[m] < sorted.first[m + 1]) materials.push_back(m);
    std::ranges::stable_sort(materials, std::greater(), [&](std::uint32_t m) {
        return sorted.first[m + 1] - sorted.first[m];
    });
    std::vector<std::vector<ChunkedMesh>> pieces(scene.source.materials.size());
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, materials.size(), 1),
        [&](const auto& range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i)
                pieces[materials[i]] = chunks_of(materials[i]);
        },
        tbb::simple_partitioner());
    std::vector<ChunkedMesh> meshes;
    for (auto& part : pieces) std::move(part.begin(), part.end(), std::back_inserter(meshes));
    return meshes;
}

}  // namespace bake
