#include "cw2-bake/quantise.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "mesh-format/tangent_frame.h"

namespace bake {

namespace {

using mesh_format::FrameForm;
using mesh_format::MeshRecord;
using mesh_format::PositionForm;
using mesh_format::TangentFrame;
using mesh_format::UvForm;

/// Points of a 16-bit lattice along one side, less one.
constexpr double kLatticeSpan = 65'535.0;
/// Lattice coordinates below this are exact as floats.
constexpr double kExactIntegers = 16'777'216.0;

/// Whether [low, high] has a place on the lattice of this step.
bool fits(double low, double high, double step) {
    const double first = std::round(low / step);
    const double last = std::round(high / step);
    return last - first <= kLatticeSpan && first > -kExactIntegers &&
           first + kLatticeSpan < kExactIntegers;
}

/// The smallest power of two on whose lattice all ranges fit, but no finer than floats resolve.
template <typename Fits>
double smallest_step(double coarsest_range, Fits all_fit) {
    constexpr int kFinestExponent = -100;
    int exponent = kFinestExponent;
    if (coarsest_range > 0.0) {
        exponent = std::max(exponent, std::ilogb(coarsest_range / kLatticeSpan));
    }
    while (!all_fit(std::ldexp(1.0, exponent))) ++exponent;
    return std::ldexp(1.0, exponent);
}

double position_step(std::span<const ChunkedMesh> meshes) {
    double range = 0.0;
    for (const ChunkedMesh& mesh : meshes) {
        const auto& box = mesh.positions;
        for (int axis = 0; axis < 3; ++axis) {
            range = std::max(range, double{box.high[axis]} - double{box.low[axis]});
        }
    }
    return smallest_step(range, [&](double step) {
        return std::ranges::all_of(meshes, [step](const ChunkedMesh& mesh) {
            const auto& box = mesh.positions;
            return fits(box.low.x, box.high.x, step) && fits(box.low.y, box.high.y, step) &&
                   fits(box.low.z, box.high.z, step);
        });
    });
}

/// The errors of some vertices, and sums for means over all.
struct Errors {
    double square_position = 0.0;
    double frame_sum = 0.0;
    double frame_max = 0.0;
    double uv_texels = 0.0;

    void add(const Errors& other) {
        square_position = std::max(square_position, other.square_position);
        frame_sum += other.frame_sum;
        frame_max = std::max(frame_max, other.frame_max);
        uv_texels = std::max(uv_texels, other.uv_texels);
    }
};

/// Rounds to the nearest whole number, halves up; much faster than std::round.
std::int32_t nearest(double x) {
    const auto below = static_cast<std::int32_t>(x);
    const double rest = x - below;
    return below + (rest >= 0.5) - (rest < -0.5);
}

/// Packs the vertices of one mesh.
class MeshPacker {
 public:
    MeshPacker(const FramedScene& scene, const ChunkedMesh& mesh, const UvBudget& budget,
               double step, MeshRecord& record)
        : scene_(scene),
          mesh_(mesh),
          step_(step),
          inverse_step_(1.0 / step),
          texels_(budget.texels),
          record_(record) {
        if (record.position_form == PositionForm::quantised) choose_position_origin();
        choose_uv_lattice(budget);
        set_bounds();
    }

    /// Writes vertices begin .. end - 1 of the mesh to `out`.
    Errors pack(std::size_t begin, std::size_t end, std::byte* out) const {
        Errors errors;
        for (; begin < end; begin += kBatch) {
            const std::size_t count = std::min(kBatch, end - begin);
            // The next batch lies all over the memory: starts to fetch it.
            const std::size_t behind = std::min(begin + count + kBatch, mesh_.vertices.size());
            for (std::size_t v = begin + count; v < behind; ++v)
                __builtin_prefetch(&scene_.framed.vertices[mesh_.vertices[v]]);
            errors.add(pack_batch(std::span(mesh_.vertices).subspan(begin, count), out));
        }
        return errors;
    }

 private:
    /// Moves `out` behind what it writes.
    Errors pack_batch(std::span<const std::uint32_t> vertices, std::byte*& out) const {
        const auto layout =
            mesh_format::vertex_layout(record_.position_form, record_.frame_form, record_.uv_form);
        std::array<TangentFrame, kBatch> frames;
        std::array<double, kBatch> degrees;
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            const glm::vec3& n = scene_.normal(vertices[i]);
            const glm::vec4& t = scene_.framed.vertices[vertices[i]].tangent;
            frames[i] = {{t.x, t.y, t.z}, {n.x, n.y, n.z}, t.w};
        }
        mesh_format::pack_frames(record_.frame_form, std::span(frames).first(vertices.size()),
                                 out + layout.frame_offset, layout.stride, degrees.data());
        Errors errors;
        for (std::size_t i = 0; i < vertices.size(); ++i, out += layout.stride) {
            errors.add({.square_position = pack_position(scene_.position(vertices[i]), out),
                        .frame_sum = degrees[i],
                        .frame_max = degrees[i],
                        .uv_texels = pack_uv(scene_.uv(vertices[i]), out + layout.uv_offset)});
        }
        return errors;
    }

    void choose_position_origin() {
        for (int axis = 0; axis < 3; ++axis)
            record_.origin[axis] = lattice(mesh_.positions.low, axis);
    }

    std::int32_t lattice(const glm::vec3& position, int axis) const {
        return nearest(double{position[axis]} * inverse_step_);
    }

    /// By the arithmetic of shaders/mesh.vert.
    float decoded(std::int32_t lattice) const {
        return static_cast<float>(lattice) * static_cast<float>(step_);
    }

    /// Of the decoded positions: rounding keeps their order.
    void set_bounds() {
        const bool exact = record_.position_form == PositionForm::f32;
        const auto& [low, high] = mesh_.positions;
        for (int axis = 0; axis < 3; ++axis) {
            record_.bounds_min[axis] = exact ? low[axis] : decoded(lattice(low, axis));
            record_.bounds_max[axis] = exact ? high[axis] : decoded(lattice(high, axis));
        }
    }

    void choose_uv_lattice(const UvBudget& budget) {
        const glm::dvec2 low(mesh_.uvs.low);
        const glm::dvec2 high(mesh_.uvs.high);
        if (budget.shiftable) uv_shift_ = glm::floor(low);
        for (int axis = 0; axis < 2; ++axis) {
            const double first = low[axis] - uv_shift_[axis];
            const double last = high[axis] - uv_shift_[axis];
            const double step = smallest_step(
                last - first, [&](double candidate) { return fits(first, last, candidate); });
            record_.uv_step[axis] = static_cast<float>(step);
            record_.uv_origin[axis] = static_cast<float>(std::round(first / step) * step);
            if (step > budget.largest_step()) record_.uv_form = UvForm::f32;
        }
        if (record_.uv_form == UvForm::f32) {
            uv_shift_ = glm::dvec2(0.0);
            for (int axis = 0; axis < 2; ++axis) {
                record_.uv_origin[axis] = 0.0f;
                record_.uv_step[axis] = 1.0f;
            }
        }
    }

    /// Returns the square distance to the decoded position.
    double pack_position(const glm::vec3& position, std::byte* out) const {
        if (record_.position_form == PositionForm::f32) {
            std::memcpy(out, &position, sizeof position);
            return 0.0;
        }
        double square = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
            const std::int32_t point = lattice(position, axis);
            const auto word = static_cast<std::uint16_t>(point - record_.origin[axis]);
            std::memcpy(out + 2 * axis, &word, sizeof word);
            const double error = double{decoded(point)} - position[axis];
            square += error * error;
        }
        return square;
    }

    /// Returns the error in texels.
    double pack_uv(const glm::vec2& uv, std::byte* out) const {
        if (record_.uv_form == UvForm::f32) {
            std::memcpy(out, &uv, sizeof uv);
            return 0.0;
        }
        double error = 0.0;
        for (int axis = 0; axis < 2; ++axis) {
            const double shifted = double{uv[axis]} - uv_shift_[axis];
            const double origin = record_.uv_origin[axis];
            const double step = record_.uv_step[axis];
            const double point = std::clamp((shifted - origin) / step, 0.0, kLatticeSpan);
            const auto word = static_cast<std::uint16_t>(nearest(point));
            std::memcpy(out + 2 * axis, &word, sizeof word);
            error = std::max(error, std::abs(origin + word * step - shifted) * texels_);
        }
        return error;
    }

    static constexpr std::size_t kBatch = 64;

    const FramedScene& scene_;
    const ChunkedMesh& mesh_;
    double step_;
    double inverse_step_;  // exact: the step is a power of two
    double texels_;
    glm::dvec2 uv_shift_{0.0};
    MeshRecord& record_;
};

/// Where the parts of each mesh lie in the sections. Returns the bytes of all vertices.
std::size_t lay_out(std::span<const ChunkedMesh> meshes, std::vector<MeshRecord>& records) {
    std::size_t vertex_bytes = 0;
    std::uint64_t index_count = 0;
    std::uint32_t chunk_count = 0;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        MeshRecord& record = records[i];
        record.first_chunk = chunk_count;
        record.chunk_count = static_cast<std::uint32_t>(meshes[i].chunks.size());
        chunk_count += record.chunk_count;
        record.vertex_offset = vertex_bytes;
        record.first_index = index_count;
        const auto stride =
            mesh_format::vertex_layout(record.position_form, record.frame_form, record.uv_form)
                .stride;
        vertex_bytes += (std::size_t{record.vertex_count} * stride + 3) / 4 * 4;
        index_count += record.index_count;
    }
    return vertex_bytes;
}

/// Vertices of one mesh that one task packs.
struct PackBlock {
    std::size_t mesh, begin, end;
    Errors errors{};
    double square_radius = 0.0;  ///< the largest square distance from the scene's centre
};

std::vector<PackBlock> make_blocks(std::span<const ChunkedMesh> meshes) {
    constexpr std::size_t kVerticesPerBlock = 4096;
    std::vector<PackBlock> blocks;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        const std::size_t count = meshes[i].vertices.size();
        for (std::size_t begin = 0; begin < count; begin += kVerticesPerBlock)
            blocks.push_back({i, begin, std::min(begin + kVerticesPerBlock, count)});
    }
    return blocks;
}

double largest_square_distance(const FramedScene& scene, std::span<const std::uint32_t> vertices,
                               const glm::dvec3& center) {
    double largest = 0.0;
    for (const std::uint32_t vertex : vertices) {
        const glm::dvec3 arm = glm::dvec3(scene.position(vertex)) - center;
        largest = std::max(largest, glm::dot(arm, arm));
    }
    return largest;
}

/// Appends the mesh's part of the section of chunks. `position_error` is how far a
/// decoded position may lie from its source.
void append_chunks(const ChunkedMesh& mesh, double position_error, PackedGeometry& geometry) {
    for (mesh_format::ChunkRecord chunk : mesh.chunks) {
        chunk.radius += static_cast<float>(position_error);
        geometry.chunks.push_back(chunk);
    }
}

Box<glm::vec3> decoded_box(std::span<const MeshRecord> records) {
    Box<glm::vec3> box;
    for (const MeshRecord& record : records) {
        box.add(glm::vec3(record.bounds_min[0], record.bounds_min[1], record.bounds_min[2]));
        box.add(glm::vec3(record.bounds_max[0], record.bounds_max[1], record.bounds_max[2]));
    }
    return box;
}

/// Fills in what follows from all meshes together.
void finish_scene(PackedGeometry& geometry, const Box<glm::vec3>& box,
                  std::span<const PackBlock> blocks) {
    Errors all;
    double square_radius = 0.0;
    double vertices = 0.0;
    for (const PackBlock& block : blocks) {
        all.add(block.errors);
        square_radius = std::max(square_radius, block.square_radius);
        vertices += static_cast<double>(block.end - block.begin);
    }
    for (int axis = 0; axis < 3; ++axis) {
        geometry.scene.bounds_min[axis] = box.low[axis];
        geometry.scene.bounds_max[axis] = box.high[axis];
    }
    // The error is added so that the decoded vertices, too, lie within.
    const double position_error = std::sqrt(all.square_position);
    geometry.scene.radius = static_cast<float>(std::sqrt(square_radius) + position_error);
    geometry.scene.vertex_bytes = geometry.vertices.size();
    geometry.scene.index_count = geometry.indices.size();
    geometry.scene.position_error = static_cast<float>(position_error);
    geometry.scene.frame_error_mean = static_cast<float>(all.frame_sum / vertices);
    geometry.scene.frame_error_max = static_cast<float>(all.frame_max);
    geometry.scene.uv_error = static_cast<float>(all.uv_texels);
}

}  // namespace

PackedGeometry quantise(const FramedScene& scene, const ChunkedScene& chunked,
                        std::span<const UvBudget> materials, const QuantiseSettings& settings) {
    const std::span<const ChunkedMesh> meshes = chunked.meshes;
    PackedGeometry geometry;
    geometry.indices = chunked.indices;
    const bool exact = settings.position_form == PositionForm::f32;
    const double step = exact ? 0.0 : position_step(meshes);
    geometry.scene.position_step = static_cast<float>(step);

    std::vector<MeshPacker> packers;
    geometry.meshes.resize(meshes.size());
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        MeshRecord& record = geometry.meshes[i];
        record.material = meshes[i].material;
        record.position_form = settings.position_form;
        record.frame_form = settings.frame_form;
        record.uv_form = exact ? UvForm::f32 : UvForm::quantised;
        record.vertex_count = static_cast<std::uint32_t>(meshes[i].vertices.size());
        record.index_count = static_cast<std::uint32_t>(meshes[i].indices.size());
        packers.emplace_back(scene, meshes[i], materials[meshes[i].material], step, record);
    }
    geometry.vertices.resize(lay_out(meshes, geometry.meshes));

    const Box<glm::vec3> box = decoded_box(geometry.meshes);
    const glm::dvec3 center = 0.5 * (glm::dvec3(box.low) + glm::dvec3(box.high));
    std::vector<PackBlock> blocks = make_blocks(meshes);
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t i) {
        PackBlock& block = blocks[i];
        const MeshRecord& record = geometry.meshes[block.mesh];
        const auto stride =
            mesh_format::vertex_layout(record.position_form, record.frame_form, record.uv_form)
                .stride;
        block.errors = packers[block.mesh].pack(
            block.begin, block.end,
            geometry.vertices.data() + record.vertex_offset + block.begin * stride);
        block.square_radius = largest_square_distance(
            scene,
            std::span(meshes[block.mesh].vertices).subspan(block.begin, block.end - block.begin),
            center);
    });
    finish_scene(geometry, box, blocks);
    for (const ChunkedMesh& mesh : meshes)
        append_chunks(mesh, geometry.scene.position_error, geometry);
    return geometry;
}

}  // namespace bake
