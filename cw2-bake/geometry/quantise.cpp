#include "cw2-bake/geometry/quantise.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>

#include "cw2-bake/geometry/vertex_lanes.h"
#include "mesh-format/tangent_frame.h"

namespace bake {

namespace {

using mesh_format::ColorForm;
using mesh_format::FrameForm;
using mesh_format::MeshRecord;
using mesh_format::PositionForm;
using mesh_format::TangentFrame;
using mesh_format::UvForm;

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

/// The errors and the extent of some vertices, and sums for means over all.
struct Errors {
    double square_position = 0.0;
    double frame_sum = 0.0;
    double frame_max = 0.0;
    double uv_texels = 0.0;
    double square_radius = 0.0;  ///< the largest square distance from the scene's centre

    void add(const Errors& other) {
        square_position = std::max(square_position, other.square_position);
        frame_sum += other.frame_sum;
        frame_max = std::max(frame_max, other.frame_max);
        uv_texels = std::max(uv_texels, other.uv_texels);
        square_radius = std::max(square_radius, other.square_radius);
    }
};

mesh_format::VertexLayout layout_of(const MeshRecord& record) {
    return mesh_format::vertex_layout(record.forms);
}

/// Packs the vertices of one mesh.
class MeshPacker {
 public:
    MeshPacker(const FramedScene& scene, const ChunkedMesh& mesh, const UvBudget& budget,
               double step, MeshRecord& record)
        : scene_(scene), mesh_(mesh), step_(step), texels_(budget.texels), record_(record) {
        if (record.forms.position == PositionForm::quantised) choose_position_origin();
        choose_uv_lattice(budget);
        if (is_colored()) record.forms.color = ColorForm::rgba8;
        set_bounds();
        layout_ = layout_of(record);
    }

    /// Writes vertices begin .. end - 1 of the mesh to `out`. `center` is the scene's.
    Errors pack(std::size_t begin, std::size_t end, const glm::dvec3& center,
                std::byte* out) const {
        Errors errors;
        Values values;
        for (; begin < end; begin += kBatch) {
            const std::size_t count = std::min(kBatch, end - begin);
            // The next batch lies all over the memory: starts to fetch it.
            const std::size_t behind = std::min(begin + count + kBatch, mesh_.vertices.size());
            for (std::size_t v = begin + count; v < behind; ++v)
                __builtin_prefetch(&scene_.framed.vertices[mesh_.vertices[v]]);
            gather(std::span(mesh_.vertices).subspan(begin, count), values);
            errors.add(pack_batch(values, count, out));
            if (record_.forms.color != ColorForm::none)
                pack_colors(std::span(mesh_.vertices).subspan(begin, count),
                            out + layout_.color_offset);
            errors.add({.square_radius = largest_square_distance(values.position, center)});
            out += count * layout_.stride;
        }
        return errors;
    }

 private:
    /// Of a batch of vertices; those that it is short of repeat the first.
    struct Values {
        std::array<Batch<float>, 3> position;
        std::array<Batch<float>, 2> uv;
        Batch<TangentFrame> frame;
    };

    void gather(std::span<const std::uint32_t> vertices, Values& values) const {
        for (std::size_t i = 0; i < kBatch; ++i) {
            const std::uint32_t vertex = vertices[i < vertices.size() ? i : 0];
            const glm::vec3& position = scene_.position(vertex);
            for (int axis = 0; axis < 3; ++axis) values.position[axis][i] = position[axis];
            const glm::vec2 uv = scene_.uv(vertex);
            for (int axis = 0; axis < 2; ++axis) values.uv[axis][i] = uv[axis];
            const glm::vec3& n = scene_.normal(vertex);
            const glm::vec4& t = scene_.framed.vertices[vertex].tangent;
            values.frame[i] = {{t.x, t.y, t.z}, {n.x, n.y, n.z}, t.w};
        }
    }

    Errors pack_batch(const Values& values, std::size_t count, std::byte* out) const {
        if (layout_.has_gaps) std::fill_n(out, count * layout_.stride, std::byte{0});
        Errors errors = pack_frames(values, count, out + layout_.frame_offset);
        errors.square_position = pack_positions(values, count, out);
        errors.uv_texels = pack_uvs(values, count, out + layout_.uv_offset);
        return errors;
    }

    /// Whether any vertex is not white.
    bool is_colored() const {
        constexpr std::uint32_t kWhite = 0xFFFF'FFFF;
        const RawVector<std::uint32_t>& colors = scene_.framed.colors;
        return !colors.empty() && std::ranges::any_of(mesh_.vertices, [&](std::uint32_t vertex) {
            return colors[vertex] != kWhite;
        });
    }

    void pack_colors(std::span<const std::uint32_t> vertices, std::byte* out) const {
        for (const std::uint32_t vertex : vertices) {
            std::memcpy(out, &scene_.framed.colors[vertex], sizeof(std::uint32_t));
            out += layout_.stride;
        }
    }

    Errors pack_frames(const Values& values, std::size_t count, std::byte* out) const {
        Batch<double> degrees;
        mesh_format::pack_frames(record_.forms.frame, std::span(values.frame).first(count), out,
                                 layout_.stride, degrees.data());
        Errors errors;
        for (std::size_t i = 0; i < count; ++i) {
            errors.frame_sum += degrees[i];
            errors.frame_max = std::max(errors.frame_max, degrees[i]);
        }
        return errors;
    }

    void choose_position_origin() {
        for (int axis = 0; axis < 3; ++axis) {
            record_.origin[axis] = lattice(mesh_.positions.low, axis);
            position_axes_[axis] = {0.0, record_.origin[axis] * step_, step_};
        }
    }

    /// The nearest point, halves up.
    std::int32_t lattice(const glm::vec3& position, int axis) const {
        return static_cast<std::int32_t>(std::floor(position[axis] / step_ + 0.5));
    }

    /// By the arithmetic of shaders/mesh.vert.
    float decoded(std::int32_t lattice) const {
        return static_cast<float>(lattice) * static_cast<float>(step_);
    }

    /// Of the decoded positions: rounding keeps their order.
    void set_bounds() {
        const bool exact = record_.forms.position == PositionForm::f32;
        const auto& [low, high] = mesh_.positions;
        for (int axis = 0; axis < 3; ++axis) {
            record_.bounds_min[axis] = exact ? low[axis] : decoded(lattice(low, axis));
            record_.bounds_max[axis] = exact ? high[axis] : decoded(lattice(high, axis));
        }
    }

    void choose_uv_lattice(const UvBudget& budget) {
        const glm::dvec2 low(mesh_.uvs.low);
        const glm::dvec2 high(mesh_.uvs.high);
        const glm::dvec2 shift = budget.shiftable ? glm::floor(low) : glm::dvec2(0.0);
        for (int axis = 0; axis < 2; ++axis) {
            const double first = low[axis] - shift[axis];
            const double last = high[axis] - shift[axis];
            const double step = smallest_step(
                last - first, [&](double candidate) { return fits(first, last, candidate); });
            record_.uv_step[axis] = static_cast<float>(step);
            record_.uv_origin[axis] = static_cast<float>(std::round(first / step) * step);
            uv_axes_[axis] = {shift[axis], record_.uv_origin[axis], step};
            if (step > budget.largest_step()) record_.forms.uv = UvForm::f32;
        }
        if (record_.forms.uv == UvForm::f32) {
            for (int axis = 0; axis < 2; ++axis) {
                record_.uv_origin[axis] = 0.0f;
                record_.uv_step[axis] = 1.0f;
            }
        }
    }

    /// Returns the largest square distance to a decoded position.
    double pack_positions(const Values& values, std::size_t count, std::byte* out) const {
        if (record_.forms.position == PositionForm::f32) {
            store(values.position, count, out);
            return 0.0;
        }
        std::array<Batch<std::uint16_t>, 3> points;
        std::array<Batch<double>, 3> errors;
        for (std::size_t axis = 0; axis < 3; ++axis)
            to_lattice(values.position[axis], position_axes_[axis], points[axis], errors[axis]);
        store(points, count, out);
        return largest_square(errors);
    }

    /// Returns the largest error in texels.
    double pack_uvs(const Values& values, std::size_t count, std::byte* out) const {
        if (record_.forms.uv == UvForm::f32) {
            store(values.uv, count, out);
            return 0.0;
        }
        std::array<Batch<std::uint16_t>, 2> points;
        double largest = 0.0;
        for (std::size_t axis = 0; axis < 2; ++axis) {
            Batch<double> errors;
            to_lattice(values.uv[axis], uv_axes_[axis], points[axis], errors);
            largest = std::max(largest, largest_magnitude(errors));
        }
        store(points, count, out);
        return largest * texels_;
    }

    /// Writes each vertex's components one behind the other.
    template <typename Component, std::size_t kAxes>
    void store(const std::array<Batch<Component>, kAxes>& components, std::size_t count,
               std::byte* out) const {
        for (std::size_t i = 0; i < count; ++i, out += layout_.stride) {
            std::array<Component, kAxes> vertex;
            for (std::size_t axis = 0; axis < kAxes; ++axis) vertex[axis] = components[axis][i];
            std::memcpy(out, &vertex, sizeof vertex);
        }
    }

    const FramedScene& scene_;
    const ChunkedMesh& mesh_;
    double step_;
    double texels_;
    MeshRecord& record_;
    std::array<AxisLattice, 3> position_axes_{};
    std::array<AxisLattice, 2> uv_axes_{};
    mesh_format::VertexLayout layout_;
};

std::size_t vertex_bytes_of(const MeshRecord& record) {
    return std::size_t{record.vertex_count} * layout_of(record).stride;
}

/// A mesh's vertices start at a multiple of 4 bytes.
std::size_t padded(std::size_t bytes) {
    return (bytes + 3) / 4 * 4;
}

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
        vertex_bytes += padded(vertex_bytes_of(record));
        index_count += record.index_count;
    }
    return vertex_bytes;
}

/// Vertices of one mesh that one task packs.
struct PackBlock {
    std::size_t mesh, begin, end;
    Errors errors{};
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
    double vertices = 0.0;
    for (const PackBlock& block : blocks) {
        all.add(block.errors);
        vertices += static_cast<double>(block.end - block.begin);
    }
    for (int axis = 0; axis < 3; ++axis) {
        geometry.scene.bounds_min[axis] = box.low[axis];
        geometry.scene.bounds_max[axis] = box.high[axis];
    }
    // The error is added so that the decoded vertices, too, lie within.
    const double position_error = std::sqrt(all.square_position);
    geometry.scene.radius = static_cast<float>(std::sqrt(all.square_radius) + position_error);
    geometry.scene.vertex_bytes = geometry.vertices.size();
    geometry.scene.index_count = geometry.indices.size();
    geometry.scene.position_error = static_cast<float>(position_error);
    geometry.scene.frame_error_mean = static_cast<float>(all.frame_sum / vertices);
    geometry.scene.frame_error_max = static_cast<float>(all.frame_max);
    geometry.scene.uv_error = static_cast<float>(all.uv_texels);
}

}  // namespace

PackedGeometry quantise(const FramedScene& scene, const ChunkedScene& chunked,
                        std::span<const UvBudget> materials, const QuantiseSettings& settings,
                        const Advance& advance) {
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
        record.forms.position = settings.position_form;
        record.forms.frame = settings.frame_form;
        record.forms.uv = exact ? UvForm::f32 : UvForm::quantised;
        record.vertex_count = static_cast<std::uint32_t>(meshes[i].vertices.size());
        record.index_count = static_cast<std::uint32_t>(meshes[i].indices.size());
        packers.emplace_back(scene, meshes[i], materials[meshes[i].material], step, record);
    }
    geometry.vertices.resize(lay_out(meshes, geometry.meshes));
    for (const MeshRecord& record : geometry.meshes) {
        const std::size_t bytes = vertex_bytes_of(record);
        std::fill_n(geometry.vertices.data() + record.vertex_offset + bytes, padded(bytes) - bytes,
                    std::byte{0});
    }

    const Box<glm::vec3> box = decoded_box(geometry.meshes);
    const glm::dvec3 center = 0.5 * (glm::dvec3(box.low) + glm::dvec3(box.high));
    std::vector<PackBlock> blocks = make_blocks(meshes);
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t i) {
        PackBlock& block = blocks[i];
        const MeshRecord& record = geometry.meshes[block.mesh];
        block.errors = packers[block.mesh].pack(block.begin, block.end, center,
                                                geometry.vertices.data() + record.vertex_offset +
                                                    block.begin * layout_of(record).stride);
        advance(1.0 / static_cast<double>(blocks.size()));
    });
    finish_scene(geometry, box, blocks);
    for (const ChunkedMesh& mesh : meshes)
        append_chunks(mesh, geometry.scene.position_error, geometry);
    return geometry;
}

}  // namespace bake
