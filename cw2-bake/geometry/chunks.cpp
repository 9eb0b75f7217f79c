#include "cw2-bake/geometry/chunks.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <numeric>

#include "cw2-bake/base/raw_vector.h"
#include "cw2-bake/geometry/chunk_bounds.h"
#include "cw2-bake/geometry/chunk_split.h"
#include "cw2-bake/geometry/coarse_split.h"
#include "cw2-bake/geometry/triangle_order.h"

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

/// A finished chunk, before it has its place in a mesh: first_index counts from the material's, and
/// its indices are those of `vertices`.
struct FinishedChunk {
    ChunkRecord record;
    Box<glm::vec3> positions;
    UvBox uvs;
    std::vector<std::uint32_t> vertices;  ///< in the order of their first use
};

/// Makes chunks of the parts that a material's triangles are cut into; used by one thread.
class ChunkMaker {
 public:
    explicit ChunkMaker(const FramedScene& scene)
        : scene_(scene), local_(scene.framed.vertices.size(), kNotLocal) {}

    /// Halves `triangles` by UV as long as they exceed the limit. The chunks that result go to
    /// `chunks`, their indices to `out`, where the first is index `first_index`.
    void make(std::span<CentredTriangle> triangles, const UvLimit& limit, std::uint32_t first_index,
              std::span<std::uint16_t> out, std::vector<FinishedChunk>& chunks) {
        gather(triangles);
        if (triangles.size() == 1 || !limit.exceeded_by(uvs_)) {
            FinishedChunk& chunk = chunks.emplace_back();
            chunk.record = bound_chunk(box_, std::span(positions_).first(vertex_count_), indices());
            chunk.record.first_index = first_index;
            chunk.record.index_count = static_cast<std::uint32_t>(index_count_);
            chunk.positions = box_;
            chunk.uvs = uvs_;
            chunk.vertices = order(out);
            return;
        }
        sort_by_uv(triangles, uvs_.high.x - uvs_.low.x >= uvs_.high.y - uvs_.low.y ? 0 : 1);
        const std::size_t half = triangles.size() / 2;
        make(triangles.first(half), limit, first_index, out.first(3 * half), chunks);
        make(triangles.subspan(half), limit, first_index + static_cast<std::uint32_t>(3 * half),
             out.subspan(3 * half), chunks);
    }

 private:
    std::span<const std::uint32_t> corners_of(const CentredTriangle& triangle) const {
        return std::span(scene_.framed.indices).subspan(3 * std::size_t{triangle.index}, 3);
    }

    std::span<const std::uint16_t> indices() const {
        return std::span(indices_).first(index_count_);
    }

    /// In loops of one kind of access each, so that many wait for the memory at once.
    void gather(std::span<const CentredTriangle> triangles) {
        index_count_ = 3 * triangles.size();
        std::array<std::uint32_t, kMaxCorners> corners;
        for (std::size_t i = 0; i < triangles.size(); ++i)
            std::ranges::copy(corners_of(triangles[i]), &corners[3 * i]);
        std::uint32_t count = 0;
        for (std::size_t i = 0; i < index_count_; ++i) {
            // Without a branch on whether it is new: then kNotLocal, which is larger, is its place.
            const std::uint32_t known = local_[corners[i]];
            const std::uint32_t local = known < count ? known : count;
            local_[corners[i]] = indices_[i] = static_cast<std::uint16_t>(local);
            vertices_[count] = corners[i];
            count += local == count;
            __builtin_prefetch(&scene_.framed.vertices[corners[i]]);
        }
        vertex_count_ = count;
        std::array<std::uint32_t, kMaxCorners> uvs;
        for (std::size_t i = 0; i < count; ++i) {
            const Corner& corner = scene_.framed.vertices[vertices_[i]].corner;
            corners[i] = corner.position;
            uvs[i] = corner.uv;
            local_[vertices_[i]] = kNotLocal;
        }
        Box<glm::vec3> box;
        for (std::size_t i = 0; i < count; ++i) {
            positions_[i] = scene_.source.positions[corners[i]];
            box.add(positions_[i]);
        }
        box_ = box;
        UvBox uv_box;
        for (std::size_t i = 0; i < count; ++i) {
            const glm::vec2& uv = scene_.source.uvs[uvs[i]];
            uv_box.add({uv.x, 1.0f - uv.y});
        }
        uvs_ = uv_box;
    }

    /// Writes the gathered triangles in their best order. Returns the vertices in the order of
    /// their first use there, which the indices mean.
    std::vector<std::uint32_t> order(std::span<std::uint16_t> out) {
        std::array<std::uint16_t, kMaxCorners> place;
        std::fill_n(place.begin(), vertex_count_, kNotLocal);
        std::array<std::uint32_t, kMaxCorners + 1> used;
        std::uint32_t count = 0;
        std::size_t next = 0;
        for (const std::uint16_t triangle : order_.order(indices(), vertex_count_)) {
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const std::uint16_t local = indices_[3 * std::size_t{triangle} + corner];
                const std::uint32_t known = place[local];
                const std::uint32_t index = known < count ? known : count;
                out[next++] = place[local] = static_cast<std::uint16_t>(index);
                used[count] = vertices_[local];
                count += index == count;
            }
        }
        return {used.begin(), used.begin() + count};
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

    static constexpr std::uint16_t kNotLocal = 0xFFFF;
    static constexpr std::size_t kMaxCorners = 3 * mesh_format::kMaxChunkTriangles;

    const FramedScene& scene_;
    TriangleOrder order_;
    std::vector<std::uint16_t> local_;  // vertex -> gathered vertex
    // What was gathered; behind the last vertex there is room for one that is not new.
    std::array<std::uint32_t, kMaxCorners + 1> vertices_;  // gathered vertex -> vertex
    std::array<glm::vec3, kMaxCorners> positions_;         // of gathered vertices
    std::array<std::uint16_t, kMaxCorners> indices_;       // of gathered vertices
    std::size_t vertex_count_ = 0;
    std::size_t index_count_ = 0;
    Box<glm::vec3> box_;
    UvBox uvs_;
};

/// Gathers the chunks of one material into meshes.
class Assembler {
 public:
    /// `placed` holds kNone for the vertices of the material, and will again.
    Assembler(std::uint32_t material, UvLimit limit, std::span<std::uint32_t> placed)
        : material_(material), limit_(limit), placed_(placed) {}

    /// Replaces the chunk's vertices by what the mesh calls them.
    void add(FinishedChunk& chunk) {
        UvBox merged = box_;
        merged.add(chunk.uvs);
        // A chunk too wide by itself shares a mesh with others of that kind only.
        const bool uvs_fit = limit_.exceeded_by(merged) == limit_.exceeded_by(chunk.uvs) &&
                             limit_.exceeded_by(merged) == limit_.exceeded_by(box_);
        if (meshes_.empty() || !uvs_fit || !has_room(chunk.vertices)) start_mesh();
        box_.add(chunk.uvs);
        ChunkedMesh& mesh = meshes_.back();
        mesh.positions.add(chunk.positions);
        mesh.chunks.push_back(chunk.record);
        mesh.chunks.back().first_index = index_count_;
        index_count_ += chunk.record.index_count;
        for (std::uint32_t& vertex : chunk.vertices) {
            std::uint32_t& place = placed_[vertex];
            if (place == kNone) {
                place = static_cast<std::uint32_t>(mesh.vertices.size());
                mesh.vertices.push_back(vertex);
            }
            vertex = place;
        }
    }

    /// The meshes, over the material's indices.
    std::vector<ChunkedMesh> take(std::span<std::uint16_t> indices) {
        finish_mesh();
        for (ChunkedMesh& mesh : meshes_) {
            const ChunkRecord& last = mesh.chunks.back();
            mesh.indices = indices.first(last.first_index + last.index_count);
            indices = indices.subspan(mesh.indices.size());
        }
        return std::move(meshes_);
    }

 private:
    bool has_room(std::span<const std::uint32_t> vertices) const {
        // Every vertex may be a new one; only near the limit is it worth to count.
        const std::size_t room = mesh_format::kMaxMeshVertices - meshes_.back().vertices.size();
        const auto is_new = [this](std::uint32_t vertex) { return placed_[vertex] == kNone; };
        return vertices.size() <= room ||
               static_cast<std::size_t>(std::ranges::count_if(vertices, is_new)) <= room;
    }

    void start_mesh() {
        if (!meshes_.empty()) finish_mesh();
        box_ = {};
        index_count_ = 0;
        meshes_.emplace_back().material = material_;
    }

    void finish_mesh() {
        ChunkedMesh& mesh = meshes_.back();
        mesh.uvs = box_;
        for (const std::uint32_t vertex : mesh.vertices) placed_[vertex] = kNone;
    }

    std::uint32_t material_;
    UvLimit limit_;
    UvBox box_;                        // of the last mesh
    std::uint32_t index_count_ = 0;    // of the last mesh
    std::span<std::uint32_t> placed_;  // vertex -> vertex of the last mesh
    std::vector<ChunkedMesh> meshes_;
};

/// The chunks that a part of a material's triangles is cut into; `out` is for their indices, and
/// `first_index` counts those of the material that come before.
std::vector<FinishedChunk> chunks_of(const FramedScene& scene, std::span<const std::uint32_t> part,
                                     const UvLimit& limit, std::uint32_t first_index,
                                     std::span<std::uint16_t> out,
                                     tbb::enumerable_thread_specific<ChunkMaker>& makers) {
    RawVector<CentredTriangle> triangles(part.size());
    RawVector<CentredTriangle> spare(part.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, part.size(), 1 << 13),
                      [&](const auto& block) {
                          for (std::size_t i = block.begin(); i < block.end(); ++i)
                              triangles[i] = {scene.centroid(part[i]), part[i]};
                      });
    std::vector<std::vector<FinishedChunk>> pieces(part_count(part.size()));
    split(std::span(triangles), std::span(spare),
          [&](std::size_t piece, std::span<CentredTriangle> members, std::size_t begin) {
              makers.local().make(members, limit,
                                  first_index + static_cast<std::uint32_t>(3 * begin),
                                  out.subspan(3 * begin, 3 * members.size()), pieces[piece]);
          });
    std::vector<FinishedChunk> chunks;
    for (auto& piece : pieces) std::move(piece.begin(), piece.end(), std::back_inserter(chunks));
    return chunks;
}

/// The meshes of one material, of the chunks of its parts; `indices` are those of its triangles.
std::vector<ChunkedMesh> assemble(std::uint32_t material, const UvLimit& limit,
                                  std::span<std::vector<FinishedChunk>> parts,
                                  std::span<std::uint16_t> indices,
                                  std::span<std::uint32_t> placed) {
    Assembler assembler(material, limit, placed);
    for (auto& part : parts)
        for (FinishedChunk& chunk : part) assembler.add(chunk);
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
        for (const FinishedChunk& chunk : parts[part])
            for (std::uint16_t& index :
                 indices.subspan(chunk.record.first_index, chunk.record.index_count))
                index = static_cast<std::uint16_t>(chunk.vertices[index]);
        parts[part] = {};
    });
    return assembler.take(indices);
}

/// Calls visit(i) for each, the largest first, so that no thread is left alone with one.
template <typename Size, typename Visit>
void largest_first(std::size_t count, const Size& size, const Visit& visit) {
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater(), size);
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const auto& range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) visit(order[i]);
        },
        tbb::simple_partitioner());
}

/// The parts of one material.
struct MaterialParts {
    std::size_t begin, end;
    std::size_t first, size;  ///< triangles
};

std::vector<MaterialParts> by_material(std::span<const CoarseParts::Part> parts) {
    std::vector<MaterialParts> materials;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (i == 0 || parts[i].material != parts[i - 1].material)
            materials.push_back({i, i, parts[i].first, 0});
        materials.back().end = i + 1;
        materials.back().size += parts[i].size;
    }
    return materials;
}

}  // namespace

ChunkedScene make_chunks(const FramedScene& scene, std::span<const UvBudget> budgets,
                         const Advance& advance) {
    ChunkedScene chunked;
    CoarseParts coarse = split_coarsely(scene);
    const auto& parts = coarse.parts;
    const std::vector<MaterialParts> materials = by_material(parts);
    std::vector<std::size_t> first_of_material(scene.source.materials.size());
    for (const MaterialParts& material : materials)
        first_of_material[parts[material.begin].material] = material.first;
    chunked.indices.resize(scene.framed.indices.size());
    const auto indices_of = [&](std::size_t first, std::size_t size) {
        return std::span(chunked.indices).subspan(3 * first, 3 * size);
    };

    std::vector<std::vector<FinishedChunk>> finished(parts.size());
    {
        tbb::enumerable_thread_specific<ChunkMaker> makers([&] { return ChunkMaker(scene); });
        largest_first(
            parts.size(), [&](std::size_t i) { return parts[i].size; },
            [&](std::size_t i) {
                const CoarseParts::Part& part = parts[i];
                const std::size_t before = part.first - first_of_material[part.material];
                finished[i] =
                    chunks_of(scene, coarse.triangles_of(part), UvLimit(budgets[part.material]),
                              static_cast<std::uint32_t>(3 * before),
                              indices_of(part.first, part.size), makers);
                advance(static_cast<double>(part.size) /
                        static_cast<double>(scene.source.triangle_material.size()));
            });
    }
    RawVector<std::uint32_t>().swap(coarse.triangles);

    // One for all: no vertex belongs to two materials.
    std::vector<std::uint32_t> placed(scene.framed.vertices.size(), kNone);
    std::vector<std::vector<ChunkedMesh>> pieces(materials.size());
    largest_first(
        materials.size(), [&](std::size_t i) { return materials[i].size; },
        [&](std::size_t i) {
            const MaterialParts& own = materials[i];
            const std::uint32_t material = parts[own.begin].material;
            pieces[i] = assemble(material, UvLimit(budgets[material]),
                                 std::span(finished).subspan(own.begin, own.end - own.begin),
                                 indices_of(own.first, own.size), placed);
        });
    for (auto& part : pieces)
        std::move(part.begin(), part.end(), std::back_inserter(chunked.meshes));
    return chunked;
}

}  // namespace bake
