// The file format: what is written comes back, and nothing else is taken for a file.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "mesh-format/file.h"
#include "tests/support/temporary_folder.h"

namespace {

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
    std::string strings = "stoneleafmask.png";
    Bytes vertices;
    std::vector<std::uint16_t> indices{0, 1, 2, 2, 1, 3, 0, 1, 2};
    Bytes texels;
    Bytes encoded_vertices, encoded_indices;

    SmallScene() {
        add_mesh({.material = 1, .vertex_count = 4, .index_count = 6});
        add_mesh({.material = 0,
                  .position_form = PositionForm::f32,
                  .frame_form = FrameForm::f32,
                  .uv_form = UvForm::f32,
                  .vertex_count = 3,
                  .index_count = 3});
        materials.push_back({.name = {0, 5},
                             .base_color = {0.5f, 0.25f, 1.0f},
                             .roughness = 1.0f,
                             .base_color_texture = kNoTexture,
                             .roughness_texture = kNoTexture,
                             .metalness_texture = kNoTexture,
                             .normal_texture = kNoTexture,
                             .alpha_mask_texture = kNoTexture});
        materials.push_back(materials.front());
        materials.back().name = {5, 4};
        materials.back().flags = kAlphaMask;
        materials.back().alpha_cutoff = 0.5f;
        materials.back().alpha_mask_texture = 1;
        add_texture(TextureFormat::rgba8_srgb, 1, 1);
        add_texture(TextureFormat::r8_unorm, 5, 3);
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
                .strings = strings,
                .vertices = vertices,
                .indices = indices,
                .texels = texels,
                .encoded_vertices = encoded_vertices,
                .encoded_indices = encoded_indices};
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
        const std::uint32_t stride =
            vertex_layout(mesh.position_form, mesh.frame_form, mesh.uv_form).stride;
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
        texels.resize(texels.size() + textures.back().size, std::byte{200});
    }
};

Bytes bytes_of(const std::filesystem::path& path) {
    const MappedFile file(path);
    return {file.bytes().begin(), file.bytes().end()};
}

Bytes written(const SmallScene& scene) {
    const TemporaryFolder folder;
    const std::uint64_t size = write(scene.document(), folder / "scene");
    EXPECT_EQ(size, std::filesystem::file_size(folder / "scene"));
    return bytes_of(folder / "scene");
}

/// What parse() complains about, or an empty text.
std::string complaint(const Bytes& bytes) {
    try {
        parse(bytes, "the file");
        return {};
    } catch (const FileError& error) {
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
    ChunkRecord& chunk(std::size_t i) { return record<ChunkRecord>(SectionKind::chunks, i); }
    MaterialRecord& material(std::size_t i) {
        return record<MaterialRecord>(SectionKind::materials, i);
    }
    TextureRecord& texture(std::size_t i) {
        return record<TextureRecord>(SectionKind::textures, i);
    }

    const Bytes& sealed() {
        for (Section& section : header().sections) {
            if (section.offset > bytes_.size() || section.size > bytes_.size() - section.offset) {
                continue;
            }
            section.checksum = checksum(std::span(bytes_).subspan(section.offset, section.size));
        }
        header().checksum = 0;
        header().checksum = checksum(std::span(bytes_).first(sizeof(Header)));
        return bytes_;
    }

 private:
    Bytes bytes_;
};

template <typename T>
void expect_equal(std::span<const T> a, std::span<const T> b) {
    ASSERT_EQ(a.size(), b.size());
    EXPECT_TRUE(a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

void expect_equal(const Document& a, const Document& b) {
    EXPECT_EQ(std::memcmp(&a.scene, &b.scene, sizeof a.scene), 0);
    expect_equal(a.meshes, b.meshes);
    expect_equal(a.chunks, b.chunks);
    expect_equal(a.materials, b.materials);
    expect_equal(a.textures, b.textures);
    EXPECT_EQ(a.strings, b.strings);
    expect_equal(a.vertices, b.vertices);
    expect_equal(a.indices, b.indices);
    expect_equal(a.texels, b.texels);
    expect_equal(a.encoded_vertices, b.encoded_vertices);
    expect_equal(a.encoded_indices, b.encoded_indices);
}

TEST(File, WhatIsWrittenComesBack) {
    for (const bool encoded : {false, true}) {
        SmallScene scene;
        if (encoded) scene.encode();
        const Bytes bytes = written(scene);
        const Document document = parse(bytes, "the file");
        expect_equal(document, scene.document());
        EXPECT_EQ(document.is_encoded(), encoded);
        EXPECT_EQ(document.text(document.materials[1].name), "leaf");

        const TemporaryFolder folder;
        write(document, folder / "again");
        EXPECT_EQ(bytes_of(folder / "again"), bytes);
    }
}

TEST(File, EveryTruncationIsRefused) {
    for (const bool encoded : {false, true}) {
        SmallScene scene;
        if (encoded) scene.encode();
        const Bytes whole = written(scene);
        for (std::size_t size = 0; size < whole.size(); ++size) {
            // A vector of its own, so that reading beyond the end is found.
            const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
            EXPECT_TRUE(complaint(part).starts_with("the file: ")) << size << " bytes";
        }
    }
}

TEST(File, BytesAfterTheEndAreRefused) {
    Bytes bytes = written({});
    bytes.push_back(std::byte{0});
    EXPECT_NE(complaint(bytes), "");
}

TEST(File, EveryAlteredByteIsRefused) {
    for (const bool encoded : {false, true}) {
        SmallScene scene;
        if (encoded) scene.encode();
        Bytes bytes = written(scene);
        for (std::size_t at = 0; at < bytes.size(); ++at) {
            for (const unsigned change : {0x01u, 0x80u, 0xFFu}) {
                bytes[at] ^= static_cast<std::byte>(change);
                EXPECT_TRUE(complaint(bytes).starts_with("the file: ")) << at;
                bytes[at] ^= static_cast<std::byte>(change);
            }
        }
    }
}

TEST(File, AnotherVersionIsRefusedWithTheWordsToBakeAgain) {
    Forgery forgery;
    ++forgery.header().version;
    EXPECT_NE(complaint(forgery.sealed()).find("bake again"), std::string::npos);
}

TEST(File, UnchangedForgeriesAreTaken) {
    EXPECT_EQ(complaint(Forgery().sealed()), "");
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::uint64_t kHuge = ~std::uint64_t{0};

struct Hostile {
    const char* name;
    void (*change)(Forgery&);
};

const Hostile kHostileHeaders[] = {
    {"magic", [](Forgery& f) { f.header().magic[3] = 'X'; }},
    {"header_size", [](Forgery& f) { f.header().header_size += 8; }},
    {"file_size_larger", [](Forgery& f) { f.header().file_size = kHuge; }},
    {"file_size_smaller", [](Forgery& f) { f.header().file_size -= 1; }},
    {"section_beyond_the_end",
     [](Forgery& f) { f.section(SectionKind::texels).offset += 1 << 20; }},
    {"section_offset_overflows",
     [](Forgery& f) { f.section(SectionKind::vertices).offset = kHuge - 63; }},
    {"section_size_overflows", [](Forgery& f) { f.section(SectionKind::vertices).size = kHuge; }},
    {"sections_overlap",
     [](Forgery& f) {
         f.section(SectionKind::encoded_indices) = f.section(SectionKind::encoded_vertices);
         f.section(SectionKind::encoded_vertices) = f.section(SectionKind::vertices);
     }},
    {"section_not_aligned", [](Forgery& f) { f.section(SectionKind::strings).offset += 4; }},
    {"no_scene", [](Forgery& f) { f.section(SectionKind::scene).size = 0; }},
    {"half_a_scene", [](Forgery& f) { f.section(SectionKind::scene).size /= 2; }},
    {"no_mesh", [](Forgery& f) { f.section(SectionKind::meshes).size = 0; }},
    {"half_a_mesh", [](Forgery& f) { f.section(SectionKind::meshes).size -= 4; }},
    {"one_mesh_of_two", [](Forgery& f) { f.section(SectionKind::vertices).size -= 4; }},
    {"no_material", [](Forgery& f) { f.section(SectionKind::materials).size = 0; }},
    {"no_texture", [](Forgery& f) { f.section(SectionKind::textures).size = 0; }},
    {"no_string", [](Forgery& f) { f.section(SectionKind::strings).size = 0; }},
    {"half_an_index", [](Forgery& f) { f.section(SectionKind::indices).size -= 1; }},
    {"an_index_less", [](Forgery& f) { f.section(SectionKind::indices).size -= 2; }},
    {"no_texel", [](Forgery& f) { f.section(SectionKind::texels).size = 0; }},
    {"a_chunk_less",
     [](Forgery& f) { f.section(SectionKind::chunks).size -= sizeof(ChunkRecord); }},
};

const Hostile kHostileGeometry[] = {
    {"bounds_nan", [](Forgery& f) { f.scene().bounds_min[1] = kNan; }},
    {"bounds_infinite", [](Forgery& f) { f.scene().bounds_max[1] = kInfinity; }},
    {"bounds_inside_out", [](Forgery& f) { f.scene().bounds_min[1] = 2.0f; }},
    {"radius_negative", [](Forgery& f) { f.scene().radius = -1.0f; }},
    {"radius_nan", [](Forgery& f) { f.scene().radius = kNan; }},
    {"step_no_power_of_two", [](Forgery& f) { f.scene().position_step = 0.3f; }},
    {"step_missing", [](Forgery& f) { f.scene().position_step = 0.0f; }},
    {"step_negative", [](Forgery& f) { f.scene().position_step = -0.5f; }},
    {"vertex_bytes", [](Forgery& f) { f.scene().vertex_bytes = kHuge; }},
    {"index_count", [](Forgery& f) { f.scene().index_count += 3; }},
    {"material", [](Forgery& f) { f.mesh(1).material = 2; }},
    {"position_form", [](Forgery& f) { f.mesh(0).position_form = static_cast<PositionForm>(2); }},
    {"frame_form", [](Forgery& f) { f.mesh(0).frame_form = static_cast<FrameForm>(4); }},
    {"uv_form", [](Forgery& f) { f.mesh(0).uv_form = static_cast<UvForm>(255); }},
    {"no_vertex", [](Forgery& f) { f.mesh(0).vertex_count = 0; }},
    {"vertices", [](Forgery& f) { f.mesh(1).vertex_count = 4; }},
    {"vertices_of_the_next", [](Forgery& f) { f.mesh(0).vertex_count = 5; }},
    {"too_many_vertices", [](Forgery& f) { f.mesh(0).vertex_count = 0xFFFF'FFFF; }},
    {"vertex_offset", [](Forgery& f) { f.mesh(1).vertex_offset += 4; }},
    {"vertex_offset_overflows", [](Forgery& f) { f.mesh(1).vertex_offset = kHuge - 3; }},
    {"vertex_offset_not_aligned", [](Forgery& f) { f.mesh(0).vertex_offset = 2; }},
    {"no_indices", [](Forgery& f) { f.mesh(0).index_count = 0; }},
    {"index_count_not_of_3", [](Forgery& f) { f.mesh(0).index_count = 5; }},
    {"index_count_too_large", [](Forgery& f) { f.mesh(1).index_count = 6; }},
    {"first_index", [](Forgery& f) { f.mesh(1).first_index = 7; }},
    {"first_index_overflows", [](Forgery& f) { f.mesh(1).first_index = kHuge; }},
    {"overlapping_indices", [](Forgery& f) { f.mesh(1).first_index = 3; }},
    {"origin", [](Forgery& f) { f.mesh(0).origin[0] = 1 << 24; }},
    {"origin_smallest",
     [](Forgery& f) { f.mesh(0).origin[1] = std::numeric_limits<std::int32_t>::min(); }},
    {"uv_origin", [](Forgery& f) { f.mesh(0).uv_origin[1] = kNan; }},
    {"uv_step", [](Forgery& f) { f.mesh(1).uv_step[0] = kInfinity; }},
    {"mesh_bounds", [](Forgery& f) { f.mesh(1).bounds_max[2] = kNan; }},
    {"first_chunk", [](Forgery& f) { f.mesh(1).first_chunk = 3; }},
    {"chunk_count", [](Forgery& f) { f.mesh(0).chunk_count = 0xFFFF'FFFF; }},
    {"no_chunk", [](Forgery& f) { f.mesh(0).chunk_count = 0; }},
    {"chunk_elsewhere", [](Forgery& f) { f.chunk(1).first_index = 0; }},
    {"chunk_too_long", [](Forgery& f) { f.chunk(2).index_count = 6; }},
    {"chunk_empty", [](Forgery& f) { f.chunk(0).index_count = 0; }},
    {"chunk_center", [](Forgery& f) { f.chunk(0).center[1] = kNan; }},
    {"chunk_radius", [](Forgery& f) { f.chunk(0).radius = kInfinity; }},
    {"chunk_cone", [](Forgery& f) { f.chunk(0).cone_axis[0] = kNan; }},
    {"chunk_cutoff", [](Forgery& f) { f.chunk(0).cone_cutoff = kNan; }},
    {"index", [](Forgery& f) { f.record<std::uint16_t>(SectionKind::indices, 5) = 4; }},
    {"largest_index",
     [](Forgery& f) { f.record<std::uint16_t>(SectionKind::indices, 8) = 0xFFFF; }},
};

const Hostile kHostileMaterials[] = {
    {"name",
     [](Forgery& f) {
         f.material(0).name = {10, 8};
     }},
    {"name_overflows",
     [](Forgery& f) {
         f.material(0).name = {0xFFFF'FFFF, 0xFFFF'FFFF};
     }},
    {"base_color", [](Forgery& f) { f.material(0).base_color[2] = kNan; }},
    {"roughness", [](Forgery& f) { f.material(0).roughness = 1.5f; }},
    {"roughness_nan", [](Forgery& f) { f.material(0).roughness = kNan; }},
    {"metalness", [](Forgery& f) { f.material(0).metalness = -0.5f; }},
    {"cutoff", [](Forgery& f) { f.material(1).alpha_cutoff = kInfinity; }},
    {"flags", [](Forgery& f) { f.material(1).flags = 0x8000'0000; }},
    {"base_color_texture", [](Forgery& f) { f.material(0).base_color_texture = 2; }},
    {"roughness_texture", [](Forgery& f) { f.material(0).roughness_texture = 2; }},
    {"metalness_texture", [](Forgery& f) { f.material(0).metalness_texture = 2; }},
    {"normal_texture", [](Forgery& f) { f.material(0).normal_texture = 2; }},
    {"alpha_mask_texture", [](Forgery& f) { f.material(1).alpha_mask_texture = 0xFFFF'FFFE; }},
    {"texture_name", [](Forgery& f) { f.texture(0).name.length = 9; }},
    {"format", [](Forgery& f) { f.texture(0).format = static_cast<TextureFormat>(99); }},
    {"texture_flags", [](Forgery& f) { f.texture(0).flags = 2; }},
    {"no_width", [](Forgery& f) { f.texture(0).width = 0; }},
    {"width", [](Forgery& f) { f.texture(0).width = 1 << 30; }},
    {"height", [](Forgery& f) { f.texture(1).height = 4; }},
    {"mip_count", [](Forgery& f) { f.texture(1).mip_count = 2; }},
    {"mip_count_huge", [](Forgery& f) { f.texture(1).mip_count = 0xFFFF'FFFF; }},
    {"texture_size", [](Forgery& f) { f.texture(1).size -= 16; }},
    {"texture_offset", [](Forgery& f) { f.texture(1).offset += 16; }},
    {"texture_offset_not_aligned", [](Forgery& f) { f.texture(0).offset = 8; }},
    {"texture_offset_overflows", [](Forgery& f) { f.texture(1).offset = kHuge - 15; }},
};

void expect_refused(std::span<const Hostile> table) {
    for (const Hostile& hostile : table) {
        SCOPED_TRACE(hostile.name);
        Forgery forgery;
        hostile.change(forgery);
        EXPECT_TRUE(complaint(forgery.sealed()).starts_with("the file: "));
    }
}

TEST(File, HostileHeadersAreRefusedInSpiteOfTheirChecksum) {
    expect_refused(kHostileHeaders);
}

TEST(File, HostileGeometryIsRefusedInSpiteOfItsChecksum) {
    expect_refused(kHostileGeometry);
}

TEST(File, HostileMaterialsAreRefusedInSpiteOfTheirChecksum) {
    expect_refused(kHostileMaterials);
}

TEST(File, EncodedPartsMustFillTheirSections) {
    SmallScene scene;
    scene.encode();
    for (const SectionKind kind : {SectionKind::encoded_vertices, SectionKind::encoded_indices}) {
        for (const std::uint32_t size : {0u, 4u, 0xFFFF'FFFFu}) {
            Forgery forgery(scene);
            forgery.record<std::uint32_t>(kind, 1) = size;
            EXPECT_NE(complaint(forgery.sealed()), "");
        }
        Forgery forgery(scene);
        forgery.section(kind).size = 3;
        EXPECT_NE(complaint(forgery.sealed()), "");
    }
}

TEST(File, DocumentsOfImpossibleShapeAreRefused) {
    const auto expect_refused = [](const SmallScene& scene) {
        EXPECT_THROW(check(scene.document(), "the file"), FileError);
    };
    SmallScene many_vertices;
    many_vertices.meshes[1].vertex_count = kMaxMeshVertices + 1;
    many_vertices.vertices.resize(4'000'000);
    many_vertices.scene.vertex_bytes = 4'000'000;
    expect_refused(many_vertices);

    SmallScene without_triangles;
    without_triangles.meshes[1].index_count = 0;
    without_triangles.meshes[1].chunk_count = 0;
    expect_refused(without_triangles);

    SmallScene encoded;
    encoded.encode();
    check(encoded.document(), "the file");
    SmallScene both;
    both.encoded_vertices = encoded.encoded_vertices;
    both.encoded_indices = encoded.encoded_indices;
    expect_refused(both);
    SmallScene encoded_indices_alone;
    encoded_indices_alone.encoded_indices = encoded.encoded_indices;
    expect_refused(encoded_indices_alone);
}

TEST(File, WritingAnInvalidDocumentLeavesTheTargetAsItWas) {
    const TemporaryFolder folder;
    std::ofstream(folder / "scene") << "what was there";
    SmallScene scene;
    scene.indices[2] = 4;
    EXPECT_THROW(write(scene.document(), folder / "scene"), FileError);
    EXPECT_EQ(std::filesystem::file_size(folder / "scene"), 14u);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(File, ChecksumTellsLengthsAndPlacesApart) {
    const Bytes zeros(100);
    for (std::size_t size = 0; size < zeros.size(); ++size) {
        Bytes bytes(size);
        const std::uint64_t sum = checksum(bytes);
        EXPECT_NE(sum, checksum(std::span(zeros).first(size + 1)));
        for (std::size_t at = 0; at < size; ++at) {
            bytes[at] = std::byte{1};
            EXPECT_NE(checksum(bytes), sum);
            bytes[at] = std::byte{0};
        }
    }
}

}  // namespace
