#include "cw2/render/touched_levels.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/gtc/type_precision.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/mat4x4.hpp>
#include <limits>

#include "cw2/render/visibility.h"

namespace cw2 {

namespace {

using mesh_format::ChunkRecord;
using mesh_format::Document;
using mesh_format::kNoTexture;
using mesh_format::MeshRecord;

constexpr float kNever = std::numeric_limits<float>::infinity();

/// A camera's picture. Positions are seen from it: x, y, and the distance along its direction.
struct Lens {
    glm::mat4 view;
    float focal;       ///< pixels
    glm::vec2 slopes;  ///< of the borders of the picture, a little beyond
    FrustumPlanes planes;

    Lens(const Camera& camera, const Bounds& bounds, VkExtent2D extent)
        : view(view_from_world(camera)) {
        focal = 0.5f * static_cast<float>(extent.height) / std::tan(0.5f * camera.vertical_fov);
        // Two pixels more: samples lie anywhere in a pixel, and derivatives are of pairs of them.
        slopes = (0.5f * glm::vec2(extent.width, extent.height) + 2.0f) / focal;
        planes = frustum_planes(
            clip_from_view(2.0f * std::atan(slopes.y), slopes.x / slopes.y, near_distance(bounds)));
        for (glm::vec4& plane : planes) plane.z = -plane.z;
    }
    glm::vec3 seen(const glm::vec3& position) const {
        const glm::vec4 p = view * glm::vec4(position, 1.0f);
        return {p.x, p.y, -p.z};
    }
    bool shows(const glm::vec3& center, float radius) const {
        return !is_outside(planes, seen(center), radius);
    }
};

/// The derivatives of a texture's coordinate over the picture, for a triangle with edges a and b on
/// the plane n . p = c, n = a x b: with k = u_b a - u_a b, at slopes (X, Y) and distance z, they
/// are (k.z Y - k.y) z^2 / c along X and (k.x - k.z X) z^2 / c along Y. This is the least of what
/// stands before z^2 / c, which is linear: it is least at a corner unless its sign changes.
class LeastDerivative {
 public:
    explicit LeastDerivative(const glm::vec3& k) : k_(k) {}

    void add(const glm::vec3& corner) {
        const float along[] = {k_.z * corner.y / corner.z - k_.y,
                               k_.x - k_.z * corner.x / corner.z};
        for (std::size_t i = 0; i < 2; ++i) {
            low_[i] = std::min(low_[i], along[i]);
            high_[i] = std::max(high_[i], along[i]);
        }
    }
    /// `around` is how far beyond the corners a sample may lie, in slope.
    float value(float around) const {
        float most = 0.0f;
        for (std::size_t i = 0; i < 2; ++i)
            most = std::max(
                {most, low_[i] - around * std::abs(k_.z), -high_[i] - around * std::abs(k_.z)});
        return most;
    }

 private:
    glm::vec3 k_;
    std::array<float, 2> low_{kNever, kNever};
    std::array<float, 2> high_{-kNever, -kNever};
};

/// The least that the UVs of a triangle, of which something is shown, can differ by from one pixel
/// to the next; nothing where it shows nothing.
float least_step(const Lens& lens, const std::array<glm::vec3, 3>& seen,
                 const std::array<glm::vec2, 3>& uv) {
    const CutTriangle shown = cut(seen, lens.planes);
    if (shown.count == 0) return kNever;
    const glm::vec3 a = seen[1] - seen[0], b = seen[2] - seen[0];
    const glm::vec2 ua = uv[1] - uv[0], ub = uv[2] - uv[0];
    const glm::vec3 normal = glm::cross(a, b);
    const float plane = std::abs(glm::dot(normal, seen[0]));
    if (!(plane > 0.0f)) return kNever;  // seen from its edge
    const glm::vec3 ku = ub.x * a - ua.x * b, kv = ub.y * a - ua.y * b;
    LeastDerivative u(ku), v(kv);
    float nearest = kNever;
    for (std::size_t i = 0; i < shown.count; ++i) {
        nearest = std::min(nearest, shown.corners[i].z);
        u.add(shown.corners[i]);
        v.add(shown.corners[i]);
    }
    // A pixel whose centre is outside may be one of the pair.
    const float around = 1.0f / lens.focal;
    nearest = 1.0f / (1.0f / nearest + around * (std::abs(normal.x) + std::abs(normal.y)) / plane);
    // A step of a pixel at distance z goes at least z / (focal sqrt(1 + slope^2)) along a surface.
    // The Frobenius norm of a product is at least that of one factor times the least singular value
    // of the other; the largest of four derivatives is at least half of it.
    const float by_distance =
        0.5f * nearest *
        std::sqrt((glm::dot(ku, ku) + glm::dot(kv, kv)) /
                  (glm::dot(normal, normal) * (1.0f + glm::dot(lens.slopes, lens.slopes))));
    const float by_corners = nearest * nearest / plane * std::max(u.value(around), v.value(around));
    return std::max(by_distance, by_corners) / lens.focal;
}

glm::vec2 uv_of(const Document& document, const MeshRecord& mesh, std::uint32_t vertex) {
    const mesh_format::VertexLayout layout = mesh_format::vertex_layout(mesh.forms);
    const std::byte* const bytes = document.vertices.data() + mesh.vertex_offset +
                                   std::size_t{vertex} * layout.stride + layout.uv_offset;
    if (mesh.forms.uv == mesh_format::UvForm::quantised) {
        glm::u16vec2 words;
        std::memcpy(&words, bytes, sizeof words);
        return glm::make_vec2(mesh.uv_step) * glm::vec2(words);
    }
    glm::vec2 uv;
    std::memcpy(&uv, bytes, sizeof uv);
    return uv;
}

/// A mesh, and where its vertices are among all.
struct Mesh {
    const MeshRecord* record;
    const glm::vec3* positions;
};

/// Triangles of a mesh.
struct Triangles {
    std::size_t mesh;
    std::span<const std::uint16_t> indices;
};

/// The least step of all that they show.
float least_step(const Document& document, const Mesh& mesh, std::span<const std::uint16_t> indices,
                 const Lens& lens) {
    float least = kNever;
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        std::array<glm::vec3, 3> seen;
        std::array<glm::vec2, 3> uvs;
        for (std::size_t k = 0; k < 3; ++k) {
            seen[k] = lens.seen(mesh.positions[indices[i + k]]);
            uvs[k] = uv_of(document, *mesh.record, indices[i + k]);
        }
        least = std::min(least, least_step(lens, seen, uvs));
    }
    return least;
}

std::vector<Triangles> triangles_of(std::span<const TriangleCulling::Shown> shown) {
    std::vector<Triangles> triangles;
    for (const TriangleCulling::Shown& frame : shown) {
        for (const DrawRange& range : frame.ranges)
            triangles.push_back(
                {range.draw, frame.indices.subspan(range.first_index, range.index_count)});
    }
    return triangles;
}

std::vector<Triangles> triangles_of(const Document& document, const Lens& lens) {
    std::vector<Triangles> triangles;
    for (std::size_t i = 0; i < document.meshes.size(); ++i) {
        const MeshRecord& mesh = document.meshes[i];
        for (const ChunkRecord& chunk :
             document.chunks.subspan(mesh.first_chunk, mesh.chunk_count)) {
            if (lens.shows(glm::make_vec3(chunk.center), chunk.radius))
                triangles.push_back(
                    {i, document.indices.subspan(mesh.first_index + chunk.first_index,
                                                 chunk.index_count)});
        }
    }
    return triangles;
}

bool is_textured(const mesh_format::MaterialRecord& material) {
    return std::ranges::any_of(material.textures.values,
                               [](std::uint32_t texture) { return texture != kNoTexture; });
}

/// Of every material that is textured.
std::vector<float> least_steps(const Document& document, const Bounds& bounds, const Lens& lens,
                               const std::vector<Triangles>& triangles) {
    std::vector<Mesh> meshes;
    const glm::vec3* positions = bounds.vertices.data();
    for (const MeshRecord& mesh : document.meshes) {
        meshes.push_back({&mesh, positions});
        positions += mesh.vertex_count;
    }
    std::vector<float> steps(triangles.size(), kNever);
    tbb::parallel_for(std::size_t{0}, triangles.size(), [&](std::size_t i) {
        const MeshRecord& mesh = document.meshes[triangles[i].mesh];
        if (is_textured(document.materials[mesh.material]))
            steps[i] = least_step(document, meshes[triangles[i].mesh], triangles[i].indices, lens);
    });
    std::vector<float> of_material(document.materials.size(), kNever);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        float& least = of_material[document.meshes[triangles[i].mesh].material];
        least = std::min(least, steps[i]);
    }
    return of_material;
}

/// How often `size` can be halved without a remainder.
std::uint32_t halvings(std::uint32_t size) {
    return static_cast<std::uint32_t>(std::countr_zero(size));
}

}  // namespace

std::vector<std::uint32_t> first_touched_levels(const Document& document, const Bounds& bounds,
                                                const Camera& camera,
                                                const PictureSampling& sampling,
                                                std::span<const TriangleCulling::Shown> shown) {
    const Lens lens(camera, bounds, sampling.extent);
    const std::vector<float> steps = least_steps(
        document, bounds, lens, shown.empty() ? triangles_of(document, lens) : triangles_of(shown));
    // Of each texture, in parts of it.
    std::vector<float> least(document.textures.size(), kNever);
    for (std::size_t i = 0; i < steps.size(); ++i) {
        for (const std::uint32_t texture : document.materials[i].textures.values) {
            if (texture != kNoTexture) least[texture] = std::min(least[texture], steps[i]);
        }
    }
    std::vector<std::uint32_t> first;
    for (std::size_t i = 0; i < document.textures.size(); ++i) {
        const mesh_format::TextureRecord& record = document.textures[i];
        // Devices approximate logarithms.
        constexpr float kSlack = 0.125f;
        const float level =
            std::log2(least[i] * static_cast<float>(std::min(record.width, record.height)) /
                      sampling.anisotropy) +
            sampling.lod_bias - kSlack;
        const std::uint32_t most = std::min({record.mip_count - std::min(record.mip_count, 2u),
                                             halvings(record.width), halvings(record.height)});
        // The bound is infinite where nothing is seen.
        const float clamped = std::clamp(level, 0.0f, static_cast<float>(most));
        first.push_back(static_cast<std::uint32_t>(clamped));
    }
    return first;
}

}  // namespace cw2
