// What check() asks of a document.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "mesh-format/checker.h"

namespace mesh_format {

namespace {

template <std::size_t N>
bool all_finite(const float (&values)[N]) {
    for (const float value : values) {
        if (!std::isfinite(value)) return false;
    }
    return true;
}

template <std::size_t N>
bool ordered(const float (&low)[N], const float (&high)[N]) {
    for (std::size_t i = 0; i < N; ++i) {
        if (!(low[i] <= high[i])) return false;
    }
    return all_finite(low) && all_finite(high);
}

bool in_unit_interval(float value) {
    return value >= 0.0f && value <= 1.0f;
}

bool positive_power_of_two(float value) {
    int exponent = 0;
    return std::isfinite(value) && value > 0.0f && std::frexp(value, &exponent) == 0.5f;
}

void check_scene(const Checker& check, const SceneRecord& scene) {
    check.require(std::ranges::all_of(scene.origin, [](double x) { return std::isfinite(x); }),
                  "the scene's origin is not finite");
    check.require(ordered(scene.bounds_min, scene.bounds_max),
                  "the scene's bounding box is invalid");
    check.require(std::isfinite(scene.radius) && scene.radius >= 0.0f,
                  "the scene's radius is invalid");
    check.require(scene.position_step == 0.0f || positive_power_of_two(scene.position_step),
                  "the scene's position step is no power of two");
    check.require((scene.flags & ~std::uint32_t{kHasCamera | kHasLight}) == 0,
                  "the scene has unknown flags");
    check.require(all_finite(scene.camera_position) && all_finite(scene.camera_target),
                  "the scene's camera is not finite");
    if (scene.flags & kHasCamera) {
        check.require(scene.camera_fov > 0.0f && scene.camera_fov < std::numbers::pi_v<float> &&
                          !std::ranges::equal(scene.camera_position, scene.camera_target),
                      "the scene's camera sees nothing");
    }
    check.require(all_finite(scene.light_position) && all_finite(scene.light_color),
                  "the scene's light is not finite");
}

std::uint64_t vertex_bytes(const MeshRecord& mesh) {
    const VertexLayout layout = vertex_layout(mesh.forms);
    return std::uint64_t{mesh.vertex_count} * layout.stride;
}

void check_mesh(const Checker& check, const Document& document, std::size_t i) {
    const MeshRecord& mesh = document.meshes[i];
    const auto require = [&](bool condition, const char* what) {
        check.require(condition, "mesh", i, what);
    };
    require(mesh.material < document.materials.size(), "its material does not exist");
    require(mesh.forms.position <= PositionForm::f32 && mesh.forms.frame <= FrameForm::f32 &&
                mesh.forms.uv <= UvForm::f32 && mesh.forms.color <= ColorForm::rgba8,
            "unknown vertex form");
    require(mesh.vertex_count > 0 && mesh.vertex_count <= kMaxMeshVertices,
            "vertex count out of range");
    require(mesh.index_count > 0 && mesh.index_count % 3 == 0, "index count is no multiple of 3");
    require(mesh.vertex_offset % 4 == 0 &&
                in_range(mesh.vertex_offset, vertex_bytes(mesh), document.scene.vertex_bytes),
            "its vertices lie outside the vertex section");
    require(in_range(mesh.first_index, mesh.index_count, document.scene.index_count),
            "its indices lie outside the index section");
    for (const std::int32_t origin : mesh.origin) {
        require(origin > -(1 << 24) && origin < (1 << 24) - 65'535, "its origin is out of range");
    }
    require(mesh.forms.position == PositionForm::f32 || document.scene.position_step > 0.0f,
            "the scene's position step is missing");
    require(all_finite(mesh.uv_origin) && all_finite(mesh.uv_step), "its UV range is not finite");
    require(ordered(mesh.bounds_min, mesh.bounds_max), "its bounding box is invalid");
}

/// Whether `count` floats are finite at `offset` in each of the mesh's vertices.
bool floats_finite(const Document& document, const MeshRecord& mesh, std::uint32_t offset,
                   std::uint32_t count) {
    const std::uint32_t stride = vertex_layout(mesh.forms).stride;
    const std::byte* vertex = document.vertices.data() + mesh.vertex_offset + offset;
    constexpr std::uint32_t kExponent = 0x7F80'0000;  // all ones in an infinity and in a NaN
    bool finite = true;
    for (std::uint32_t i = 0; i < mesh.vertex_count; ++i, vertex += stride) {
        for (std::uint32_t k = 0; k < count; ++k) {
            std::uint32_t bits = 0;
            std::memcpy(&bits, vertex + k * sizeof bits, sizeof bits);
            finite &= (bits & kExponent) != kExponent;
        }
    }
    return finite;
}

void check_vertices(const Checker& check, const Document& document, std::size_t i) {
    const MeshRecord& mesh = document.meshes[i];
    const VertexLayout layout = vertex_layout(mesh.forms);
    const auto require = [&](bool is_f32, std::uint32_t offset, std::uint32_t count,
                             const char* what) {
        check.require(!is_f32 || floats_finite(document, mesh, offset, count), "mesh", i, what);
    };
    require(mesh.forms.position == PositionForm::f32, 0, 3, "a position is not finite");
    require(mesh.forms.frame == FrameForm::f32, layout.frame_offset, 4, "a frame is not finite");
    require(mesh.forms.uv == UvForm::f32, layout.uv_offset, 2, "a UV is not finite");
}

void check_indices(const Checker& check, const Document& document, std::size_t i) {
    const MeshRecord& mesh = document.meshes[i];
    std::uint16_t largest = 0;
    for (const std::uint16_t index : document.indices.subspan(mesh.first_index, mesh.index_count)) {
        largest = std::max(largest, index);
    }
    check.require(largest < mesh.vertex_count, "mesh", i, "an index is out of range");
}

/// The mesh's chunks: one after the other they hold all its indices.
void check_chunks(const Checker& check, const Document& document, std::size_t i) {
    const MeshRecord& mesh = document.meshes[i];
    check.require(in_range(mesh.first_chunk, mesh.chunk_count, document.chunks.size()), "mesh", i,
                  "its chunks lie outside the chunk section");
    std::uint64_t next_index = 0;
    for (const ChunkRecord& chunk : document.chunks.subspan(mesh.first_chunk, mesh.chunk_count)) {
        check.require(chunk.first_index == next_index && chunk.index_count > 0 &&
                          chunk.index_count % 3 == 0 && chunk.index_count <= 3 * kMaxChunkTriangles,
                      "mesh", i, "its chunks do not follow each other");
        check.require(all_finite(chunk.center) && std::isfinite(chunk.radius) &&
                          all_finite(chunk.cone_axis) && std::isfinite(chunk.cone_cutoff),
                      "mesh", i, "a chunk's bounds are not finite");
        next_index += chunk.index_count;
    }
    check.require(next_index == mesh.index_count, "mesh", i,
                  "its chunks do not hold all its indices");
}

bool valid_text(const Document& document, StringRef ref) {
    return in_range(ref.offset, ref.length, document.strings.size());
}

void check_material(const Checker& check, const Document& document, std::size_t i) {
    const MaterialRecord& material = document.materials[i];
    const auto require = [&](bool condition, const char* what) {
        check.require(condition, "material", i, what);
    };
    require(valid_text(document, material.name), "its name lies outside the strings");
    require(std::ranges::all_of(material.base_color, in_unit_interval) &&
                in_unit_interval(material.roughness) && in_unit_interval(material.metalness) &&
                in_unit_interval(material.alpha_cutoff),
            "a factor lies outside [0, 1]");
    require(std::isfinite(material.normal_scale), "its normal scale is not finite");
    require(std::ranges::all_of(material.emission,
                                [](float e) { return e >= 0.0f && std::isfinite(e); }),
            "its emission is negative or not finite");
    require(in_unit_interval(material.opacity) &&
                (material.opacity == 1.0f || (material.flags & kBlend) != 0),
            "its opacity is invalid");
    require((material.flags &
             ~std::uint32_t{kAlphaMask | kCullBack | kFlipBackNormals | kUnlit | kBlend}) == 0,
            "unknown flags");
    const auto require_texture = [&](std::uint32_t texture, TextureFormat plain,
                                     TextureFormat blocks) {
        if (texture == kNoTexture) return;
        require(texture < document.textures.size(), "a texture does not exist");
        const TextureFormat format = document.textures[texture].format;
        require(format == plain || format == blocks ||
                    (format == TextureFormat::bc7_srgb && blocks == TextureFormat::bc1_srgb),
                "a texture's format does not fit its use");
    };
    for (std::size_t use = 0; use < kMapUseCount; ++use) {
        require_texture(material.textures.values[use], kMaps.values[use].plain,
                        kMaps.values[use].in_blocks);
    }
}

void check_texture(const Checker& check, const Document& document, std::size_t i) {
    const TextureRecord& texture = document.textures[i];
    const auto require = [&](bool condition, const char* what) {
        check.require(condition, "texture", i, what);
    };
    require(valid_text(document, texture.name), "its name lies outside the strings");
    require(texture.format <= TextureFormat::bc7_srgb, "unknown format");
    constexpr std::uint32_t kBorders = kClampToEdge | kHiddenBeyond;
    require((texture.flags & ~(kBorders | kCompressed)) == 0, "unknown flags");
    require((texture.flags & kBorders) != kHiddenBeyond,
            "hides what is beyond it, but does not clamp");
    require(texture.width > 0 && texture.width <= kMaxTextureSize && texture.height > 0 &&
                texture.height <= kMaxTextureSize,
            "its size is out of range");
    require(texture.mip_count == full_mip_count(texture.width, texture.height),
            "its mip count does not fit its size");
    require(texture.psnr >= 0.0f && texture.psnr <= kExactPsnr, "its PSNR is out of range");
    const std::uint64_t whole = mip_chain_bytes(texture.format, texture.width, texture.height);
    require(texture.flags & kCompressed ? texture.size < whole : texture.size == whole,
            "its texels do not fit its size");
    require(texture.size * kLargestRatio >= whole, "its compressed texels are implausibly few");
}

void check_source(const Checker& check, const Document& document, std::size_t i) {
    const SourceRecord& source = document.sources[i];
    for (const std::uint32_t texture : {source.texture, source.alpha_mask}) {
        check.require(texture == kNoTexture || texture < document.textures.size(), "source", i,
                      "a texture does not exist");
    }
    check.require((source.flags & ~std::uint32_t{kHoldsFactor}) == 0 && source.reserved == 0,
                  "source", i, "unknown flags");
}

/// An encoded section starts with the size of each mesh's part.
void check_encoded(const Checker& check, const Document& document,
                   std::span<const std::byte> encoded, const char* what) {
    std::uint64_t end = document.meshes.size() * sizeof(std::uint32_t);
    check.require(end <= encoded.size(), what);
    for (std::size_t i = 0; i < document.meshes.size(); ++i) {
        std::uint32_t size = 0;
        std::memcpy(&size, encoded.data() + i * sizeof size, sizeof size);
        end += size;
    }
    check.require(end == encoded.size(), what);
}

void check_geometry_sizes(const Checker& check, const Document& document) {
    if (document.is_encoded()) {
        check.require(document.vertices.empty() && document.indices.empty(),
                      "holds geometry both encoded and decoded");
        check_encoded(check, document, document.encoded_vertices,
                      "the encoded vertices do not fit the meshes");
        check_encoded(check, document, document.encoded_indices,
                      "the encoded indices do not fit the meshes");
    } else {
        check.require(document.encoded_indices.empty(), "holds encoded indices alone");
        check.require(document.vertices.size() == document.scene.vertex_bytes &&
                          document.indices.size() == document.scene.index_count,
                      "the scene's sizes do not fit its sections");
    }
}

}  // namespace

void check(const Document& document, std::uint64_t texel_bytes, std::string_view name) {
    const Checker checker(name);
    check_scene(checker, document.scene);
    checker.require(!document.meshes.empty(), "holds no mesh");
    check_geometry_sizes(checker, document);
    std::uint64_t vertex_end = 0;
    std::uint64_t index_end = 0;
    for (std::size_t i = 0; i < document.meshes.size(); ++i) {
        check_mesh(checker, document, i);
        const MeshRecord& mesh = document.meshes[i];
        checker.require(mesh.vertex_offset >= vertex_end && mesh.first_index >= index_end, "mesh",
                        i, "it overlaps the mesh before it");
        vertex_end = mesh.vertex_offset + vertex_bytes(mesh);
        index_end = mesh.first_index + mesh.index_count;
        check_chunks(checker, document, i);
        if (document.is_encoded()) continue;
        check_indices(checker, document, i);
        check_vertices(checker, document, i);
    }
    for (std::size_t i = 0; i < document.materials.size(); ++i) {
        check_material(checker, document, i);
    }
    std::uint64_t payload_end = 0;
    for (std::size_t i = 0; i < document.textures.size(); ++i) {
        check_texture(checker, document, i);
        checker.require(document.textures[i].offset == payload_end, "texture", i,
                        "its texels do not follow those before it");
        payload_end += document.textures[i].size;
    }
    checker.require(payload_end == texel_bytes, "the texel section does not fit the textures");
    for (std::size_t i = 0; i < document.sources.size(); ++i) check_source(checker, document, i);
}

void check(const Document& document, std::string_view name) {
    check(document, document.texels.size(), name);
}

void check_decoded(const Document& document, std::string_view name) {
    const Checker checker(name);
    check_geometry_sizes(checker, document);
    for (std::size_t i = 0; i < document.meshes.size(); ++i) check_vertices(checker, document, i);
}

}  // namespace mesh_format
