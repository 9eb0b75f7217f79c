// A small document for the tests of the file format, written and forged.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "mesh-format/file.h"

namespace small_scene {

using namespace mesh_format;

using Bytes = std::vector<std::byte>;  // its memory starts at a multiple of 16

/// A document that owns what it holds: a quantised mesh, one of floats, a masked material, a
/// texture of one texel and one of 5 x 3.
struct SmallScene {
    SceneRecord scene{};
    std::vector<MeshRecord> meshes;
    std::vector<ChunkRecord> chunks;
    std::vector<MaterialRecord> materials;
    std::vector<TextureRecord> textures;
    std::vector<SourceRecord> sources;
    std::string strings = "stoneleafmask.png";
    Bytes vertices;
    std::vector<std::uint16_t> indices{0, 1, 2, 2, 1, 3, 0, 1, 2};
    Bytes texels;
    Bytes encoded_vertices, encoded_indices;

    SmallScene() {
        add_mesh({.material = 1, .vertex_count = 4, .index_count = 6});
        add_mesh({.material = 0,
                  .forms = {PositionForm::f32, FrameForm::f32, UvForm::f32, ColorForm::rgba8},
                  .vertex_count = 3,
                  .index_count = 3});
        materials.push_back({.name = {0, 5},
                             .base_color = {0.5f, 0.25f, 1.0f},
                             .roughness = 1.0f,
                             .opacity = 1.0f,
                             .textures = per_map(kNoTexture)});
        materials.push_back(materials.front());
        materials.back().name = {5, 4};
        materials.back().flags = kAlphaMask;
        materials.back().alpha_cutoff = 0.5f;
        materials.back().textures[MapUse::alpha_mask] = 1;
        add_texture(TextureFormat::rgba8_srgb, 1, 1);
        add_texture(TextureFormat::r8_unorm, 5, 3);
        sources.push_back({.key = {1, 2}, .texture = 0, .alpha_mask = 1});
        sources.push_back({.key = {3, 4},
                           .texture = kNoTexture,
                           .alpha_mask = kNoTexture,
                           .flags = kHoldsFactor});
        scene.vertex_bytes = vertices.size();
        scene.index_count = indices.size();
        scene.position_step = 0.25f;
        scene.radius = 2.0f;
        std::fill(std::begin(scene.bounds_max), std::end(scene.bounds_max), 1.0f);
    }

    Document document() const {
        return {.scene = scene,
                .meshes = meshes,
                .chunks = chunks,
                .materials = materials,
                .textures = textures,
                .sources = sources,
                .strings = strings,
                .vertices = vertices,
                .indices = indices,
                .texels = texels,
                .encoded_vertices = encoded_vertices,
                .encoded_indices = encoded_indices};
    }

    std::vector<std::span<const std::byte>> payloads() const {
        std::vector<std::span<const std::byte>> parts;
        for (const TextureRecord& texture : textures) parts.push_back(document().payload(texture));
        return parts;
    }

    /// Moves the geometry to the sections of a compressed file. What the parts hold matters only to
    /// those who decode them.
    void encode() {
        const auto parts = [](std::size_t bytes) {
            Bytes section(8 + 2 * bytes, std::byte{7});
            const auto size = static_cast<std::uint32_t>(bytes);
            std::memcpy(section.data(), &size, 4);
            std::memcpy(section.data() + 4, &size, 4);
            return section;
        };
        vertices.clear();
        indices.clear();
        encoded_vertices = parts(9);
        encoded_indices = parts(5);
    }

 private:
    void add_mesh(MeshRecord mesh) {
        mesh.vertex_offset = vertices.size();
        mesh.first_index =
            meshes.empty() ? 0 : meshes.back().first_index + meshes.back().index_count;
        mesh.first_chunk = static_cast<std::uint32_t>(chunks.size());
        mesh.chunk_count = mesh.index_count / 3;
        mesh.uv_step[0] = mesh.uv_step[1] = 0.5f;
        mesh.origin[2] = -3;
        for (std::uint32_t i = 0; i < mesh.chunk_count; ++i) {
            chunks.push_back({.first_index = 3 * i, .index_count = 3, .radius = 1.0f});
        }
        const std::uint32_t stride = vertex_layout(mesh.forms).stride;
        for (std::uint32_t i = 0; i < mesh.vertex_count * stride; ++i) {
            vertices.push_back(static_cast<std::byte>(i));
        }
        meshes.push_back(mesh);
    }
    void add_texture(TextureFormat format, std::uint32_t width, std::uint32_t height) {
        textures.push_back({.name = {9, 8},
                            .format = format,
                            .width = width,
                            .height = height,
                            .mip_count = full_mip_count(width, height),
                            .offset = texels.size(),
                            .size = mip_chain_bytes(format, width, height)});
        texels.resize(texels.size() + textures.back().size,
                      static_cast<std::byte>(200 + textures.size()));
        textures.back().checksum = checksum(document().payload(textures.back()));
    }
};

inline Bytes written(const Document& document,
                     std::span<const std::span<const std::byte>> payloads) {
    Bytes bytes;
    const std::uint64_t size =
        write(document, payloads, "the file", [&](std::span<const std::byte> part) {
            bytes.insert(bytes.end(), part.begin(), part.end());
        });
    EXPECT_EQ(size, bytes.size());
    return bytes;
}

inline Bytes written(const SmallScene& scene) {
    return written(scene.document(), scene.payloads());
}

/// What parse() complains about, or an empty text.
inline std::string complaint(const Bytes& bytes) {
    try {
        parse(bytes, "the file");
        return {};
    } catch (const FormatError& error) {
        return error.what();
    }
}

/// Bytes of a file whose checksums follow what is changed in it.
class Forgery {
 public:
    explicit Forgery(const SmallScene& scene = {}) : bytes_(written(scene)) {}

    Header& header() { return *reinterpret_cast<Header*>(bytes_.data()); }
    Section& section(SectionKind kind) { return header().sections[static_cast<std::size_t>(kind)]; }
    template <typename Record>
    Record& record(SectionKind kind, std::size_t index = 0) {
        return reinterpret_cast<Record*>(bytes_.data() + section(kind).offset)[index];
    }
    SceneRecord& scene() { return record<SceneRecord>(SectionKind::scene); }
    MeshRecord& mesh(std::size_t i) { return record<MeshRecord>(SectionKind::meshes, i); }
    /// Float `k` of a vertex of a mesh that holds only floats.
    float& vertex_float(std::size_t of_mesh, std::size_t vertex, std::size_t k) {
        const MeshRecord& floats = mesh(of_mesh);
        const std::uint32_t stride = vertex_layout(floats.forms).stride;
        return record<float>(SectionKind::vertices,
                             (floats.vertex_offset + vertex * stride) / sizeof(float) + k);
    }
    ChunkRecord& chunk(std::size_t i) { return record<ChunkRecord>(SectionKind::chunks, i); }
    MaterialRecord& material(std::size_t i) {
        return record<MaterialRecord>(SectionKind::materials, i);
    }
    TextureRecord& texture(std::size_t i) {
        return record<TextureRecord>(SectionKind::textures, i);
    }

    SourceRecord& source(std::size_t i) { return record<SourceRecord>(SectionKind::sources, i); }

    const Bytes& sealed() {
        for (Section& section : header().sections) {
            if (section.offset > bytes_.size() || section.size > bytes_.size() - section.offset) {
                continue;
            }
            section.checksum = checksum(std::span(bytes_).subspan(section.offset, section.size));
        }
        section(SectionKind::texels).checksum = 0;
        header().checksum = 0;
        header().checksum = checksum(std::span(bytes_).first(sizeof(Header)));
        return bytes_;
    }

 private:
    Bytes bytes_;
};

}  // namespace small_scene
