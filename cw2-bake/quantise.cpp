#include "cw2-bake/quantise.h"

#include <meshoptimizer.h>
#include <tbb/parallel_for.h>

#include <algorithm>
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

struct Box {
    glm::vec3 low{std::numeric_limits<float>::infinity()};
    glm::vec3 high{-std::numeric_limits<float>::infinity()};

    void add(const glm::vec3& point) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }
};

Box box_of(std::span<const glm::vec3> positions) {
    Box box;
    for (const glm::vec3& position : positions) box.add(position);
    return box;
}

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

double position_step(std::span<const Box> boxes) {
    double range = 0.0;
    for (const Box& box : boxes) {
        for (int axis = 0; axis < 3; ++axis) {
            range = std::max(range, double{box.high[axis]} - double{box.low[axis]});
        }
    }
    return smallest_step(range, [&](double step) {
        return std::all_of(boxes.begin(), boxes.end(), [step](const Box& box) {
            return fits(box.low.x, box.high.x, step) && fits(box.low.y, box.high.y, step) &&
                   fits(box.low.z, box.high.z, step);
        });
    });
}

/// The errors of one mesh, and sums for means over all.
struct Errors {
    double position = 0.0;
    double frame_sum = 0.0;
    double frame_max = 0.0;
    double uv_texels = 0.0;
};

/// Packs one mesh into its part of the vertex section.
class MeshPacker {
 public:
    MeshPacker(const FramedMesh& mesh, const UvBudget& budget, double step, MeshRecord& record)
        : mesh_(mesh), step_(step), texels_(budget.texels), record_(record) {
        if (record.position_form == PositionForm::quantised) choose_position_origin();
        choose_uv_lattice(budget);
    }

    /// Writes all vertices to `out`, and the decoded bounds into the record.
    Errors pack(std::byte* out) {
        const auto layout =
            mesh_format::vertex_layout(record_.position_form, record_.frame_form, record_.uv_form);
        Errors errors;
        Box decoded_box;
        for (std::size_t i = 0; i < mesh_.positions.size(); ++i, out += layout.stride) {
            const glm::vec3 decoded = pack_position(mesh_.positions[i], out);
            decoded_box.add(decoded);
            errors.position =
                std::max(errors.position,
                         glm::distance(glm::dvec3(decoded), glm::dvec3(mesh_.positions[i])));
            const double angle = pack_frame(i, out + layout.frame_offset);
            errors.frame_sum += angle;
            errors.frame_max = std::max(errors.frame_max, angle);
            errors.uv_texels =
                std::max(errors.uv_texels, pack_uv(mesh_.uvs[i], out + layout.uv_offset));
        }
        for (int axis = 0; axis < 3; ++axis) {
            record_.bounds_min[axis] = decoded_box.low[axis];
            record_.bounds_max[axis] = decoded_box.high[axis];
        }
        return errors;
    }

 private:
    void choose_position_origin() {
        const Box box = box_of(mesh_.positions);
        for (int axis = 0; axis < 3; ++axis) {
            record_.origin[axis] =
                static_cast<std::int32_t>(std::round(double{box.low[axis]} / step_));
        }
    }

    void choose_uv_lattice(const UvBudget& budget) {
        glm::dvec2 low(std::numeric_limits<double>::infinity());
        glm::dvec2 high = -low;
        for (const glm::vec2& uv : mesh_.uvs) {
            low = glm::min(low, glm::dvec2(uv));
            high = glm::max(high, glm::dvec2(uv));
        }
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

    /// Returns the decoded position, by the arithmetic of shaders/mesh.vert.
    glm::vec3 pack_position(const glm::vec3& position, std::byte* out) const {
        if (record_.position_form == PositionForm::f32) {
            std::memcpy(out, &position, sizeof position);
            return position;
        }
        glm::vec3 decoded;
        for (int axis = 0; axis < 3; ++axis) {
            const auto lattice =
                static_cast<std::int32_t>(std::round(double{position[axis]} / step_));
            const auto word = static_cast<std::uint16_t>(lattice - record_.origin[axis]);
            std::memcpy(out + 2 * axis, &word, sizeof word);
            decoded[axis] = static_cast<float>(lattice) * static_cast<float>(step_);
        }
        return decoded;
    }

    /// Returns the angle between the true and the decoded frame, degrees.
    double pack_frame(std::size_t i, std::byte* out) const {
        const glm::vec3& n = mesh_.normals[i];
        const glm::vec4& t = mesh_.tangents[i];
        const TangentFrame frame{{t.x, t.y, t.z}, {n.x, n.y, n.z}, t.w};
        mesh_format::pack_frame(record_.frame_form, frame, out);
        // A tangent need not be orthogonal to its normal yet; in f32 it is made so and no more.
        std::byte exact[mesh_format::frame_bytes(FrameForm::f32)];
        mesh_format::pack_frame(FrameForm::f32, frame, exact);
        return mesh_format::frame_angle(mesh_format::unpack_frame(FrameForm::f32, exact),
                                        mesh_format::unpack_frame(record_.frame_form, out));
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
            const double lattice =
                std::clamp(std::round((shifted - origin) / step), 0.0, kLatticeSpan);
            const auto word = static_cast<std::uint16_t>(lattice);
            std::memcpy(out + 2 * axis, &word, sizeof word);
            error = std::max(error, std::abs(origin + lattice * step - shifted) * texels_);
        }
        return error;
    }

    const FramedMesh& mesh_;
    double step_;
    double texels_;
    glm::dvec2 uv_shift_{0.0};
    MeshRecord& record_;
};

/// Fills in the mesh's part of the chunk section. `position_error` is how far a decoded position
/// may lie from its source.
void bound_chunks(const ChunkedMesh& chunked, double position_error,
                  std::span<mesh_format::ChunkRecord> records) {
    const FramedMesh& mesh = chunked.mesh;
    for (std::size_t i = 0; i < chunked.chunks.size(); ++i) {
        const Chunk& chunk = chunked.chunks[i];
        const meshopt_Bounds bounds = meshopt_computeClusterBounds(
            mesh.indices.data() + chunk.first_index, chunk.index_count, &mesh.positions.front().x,
            mesh.positions.size(), sizeof(glm::vec3));
        mesh_format::ChunkRecord& record = records[i];
        record.first_index = chunk.first_index;
        record.index_count = chunk.index_count;
        for (int axis = 0; axis < 3; ++axis) {
            record.center[axis] = bounds.center[axis];
            record.cone_axis[axis] = bounds.cone_axis[axis];
        }
        record.radius = bounds.radius + static_cast<float>(position_error);
        record.cone_cutoff = bounds.cone_cutoff;
    }
}

/// Where the parts of each mesh lie in the sections.
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

/// Fills in what follows from all meshes together.
void finish_scene(PackedGeometry& geometry, std::span<const ChunkedMesh> meshes,
                  std::span<const Errors> errors) {
    Box box;
    for (const MeshRecord& record : geometry.meshes) {
        box.add({record.bounds_min[0], record.bounds_min[1], record.bounds_min[2]});
        box.add({record.bounds_max[0], record.bounds_max[1], record.bounds_max[2]});
    }
    const glm::dvec3 center = 0.5 * (glm::dvec3(box.low) + glm::dvec3(box.high));
    double square_radius = 0.0;
    double vertices = 0.0;
    Errors all;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        for (const glm::vec3& position : meshes[i].mesh.positions) {
            const glm::dvec3 arm = glm::dvec3(position) - center;
            square_radius = std::max(square_radius, glm::dot(arm, arm));
        }
        vertices += static_cast<double>(meshes[i].mesh.positions.size());
        all.position = std::max(all.position, errors[i].position);
        all.frame_sum += errors[i].frame_sum;
        all.frame_max = std::max(all.frame_max, errors[i].frame_max);
        all.uv_texels = std::max(all.uv_texels, errors[i].uv_texels);
    }
    for (int axis = 0; axis < 3; ++axis) {
        geometry.scene.bounds_min[axis] = box.low[axis];
        geometry.scene.bounds_max[axis] = box.high[axis];
    }
    // The error is added so that the decoded vertices, too, lie within.
    geometry.scene.radius = static_cast<float>(std::sqrt(square_radius) + all.position);
    geometry.scene.vertex_bytes = geometry.vertices.size();
    geometry.scene.index_count = geometry.indices.size();
    geometry.scene.position_error = static_cast<float>(all.position);
    geometry.scene.frame_error_mean = static_cast<float>(all.frame_sum / vertices);
    geometry.scene.frame_error_max = static_cast<float>(all.frame_max);
    geometry.scene.uv_error = static_cast<float>(all.uv_texels);
}

}  // namespace

PackedGeometry quantise(std::span<const ChunkedMesh> meshes, std::span<const UvBudget> materials,
                        const QuantiseSettings& settings) {
    PackedGeometry geometry;
    double step = 0.0;
    if (settings.position_form == PositionForm::quantised) {
        std::vector<Box> boxes;
        for (const ChunkedMesh& chunked : meshes) boxes.push_back(box_of(chunked.mesh.positions));
        step = position_step(boxes);
    }
    geometry.scene.position_step = static_cast<float>(step);

    std::vector<MeshPacker> packers;
    geometry.meshes.resize(meshes.size());
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        MeshRecord& record = geometry.meshes[i];
        record.material = meshes[i].mesh.material;
        record.position_form = settings.position_form;
        record.frame_form = settings.frame_form;
        record.uv_form =
            settings.position_form == PositionForm::f32 ? UvForm::f32 : UvForm::quantised;
        record.vertex_count = static_cast<std::uint32_t>(meshes[i].mesh.positions.size());
        record.index_count = static_cast<std::uint32_t>(meshes[i].mesh.indices.size());
        packers.emplace_back(meshes[i].mesh, materials[meshes[i].mesh.material], step, record);
    }
    geometry.vertices.resize(lay_out(meshes, geometry.meshes));
    geometry.chunks.resize(geometry.meshes.back().first_chunk + geometry.meshes.back().chunk_count);
    geometry.indices.reserve(geometry.meshes.back().first_index +
                             geometry.meshes.back().index_count);
    for (const ChunkedMesh& chunked : meshes) {
        geometry.indices.insert(geometry.indices.end(), chunked.mesh.indices.begin(),
                                chunked.mesh.indices.end());
    }
    std::vector<Errors> errors(meshes.size());
    tbb::parallel_for(std::size_t{0}, meshes.size(), [&](std::size_t i) {
        errors[i] = packers[i].pack(geometry.vertices.data() + geometry.meshes[i].vertex_offset);
        bound_chunks(meshes[i], errors[i].position,
                     std::span(geometry.chunks).subspan(geometry.meshes[i].first_chunk));
    });
    finish_scene(geometry, meshes, errors);
    return geometry;
}

}  // namespace bake
