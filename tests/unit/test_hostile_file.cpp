// Files whose checksums are right and whose contents are hostile.
#include <gtest/gtest.h>

#include <limits>

#include "small_scene.h"

namespace {

using namespace small_scene;

TEST(HostileFile, AnotherVersionIsRefusedWithTheWordsToBakeAgain) {
    Forgery forgery;
    ++forgery.header().version;
    EXPECT_NE(complaint(forgery.sealed()).find("bake again"), std::string::npos);
}

TEST(HostileFile, UnchangedForgeriesAreTaken) {
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
    {"half_a_source", [](Forgery& f) { f.section(SectionKind::sources).size -= 16; }},
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
    {"position_form", [](Forgery& f) { f.mesh(0).forms.position = static_cast<PositionForm>(2); }},
    {"frame_form", [](Forgery& f) { f.mesh(0).forms.frame = static_cast<FrameForm>(4); }},
    {"uv_form", [](Forgery& f) { f.mesh(0).forms.uv = static_cast<UvForm>(255); }},
    {"color_form", [](Forgery& f) { f.mesh(0).forms.color = static_cast<ColorForm>(2); }},
    {"scene_origin", [](Forgery& f) { f.scene().origin[2] = kNan; }},
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
    {"position", [](Forgery& f) { f.vertex_float(1, 1, 2) = kNan; }},
    {"frame", [](Forgery& f) { f.vertex_float(1, 2, 6) = -kInfinity; }},
    {"uv", [](Forgery& f) { f.vertex_float(1, 0, 8) = kInfinity; }},
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
    {"base_color", [](Forgery& f) { f.material(0).base_color[1] = 1.5f; }},
    {"base_color_nan", [](Forgery& f) { f.material(0).base_color[2] = kNan; }},
    {"roughness", [](Forgery& f) { f.material(0).roughness = 1.5f; }},
    {"roughness_nan", [](Forgery& f) { f.material(0).roughness = kNan; }},
    {"metalness", [](Forgery& f) { f.material(0).metalness = -0.5f; }},
    {"cutoff", [](Forgery& f) { f.material(1).alpha_cutoff = kInfinity; }},
    {"emission_negative", [](Forgery& f) { f.material(0).emission[1] = -1.0f; }},
    {"emission_infinite", [](Forgery& f) { f.material(0).emission[2] = kInfinity; }},
    {"opacity", [](Forgery& f) { f.material(0).opacity = 2.0f; }},
    {"opacity_of_no_blend", [](Forgery& f) { f.material(0).opacity = 0.5f; }},
    {"emission_texture", [](Forgery& f) { f.material(0).textures[MapUse::emission] = 1; }},
    {"flags", [](Forgery& f) { f.material(1).flags = 0x8000'0000; }},
    {"base_color_texture", [](Forgery& f) { f.material(0).textures[MapUse::base_color] = 2; }},
    {"roughness_texture", [](Forgery& f) { f.material(0).textures[MapUse::roughness] = 2; }},
    {"metalness_texture", [](Forgery& f) { f.material(0).textures[MapUse::metalness] = 2; }},
    {"normal_texture", [](Forgery& f) { f.material(0).textures[MapUse::normal] = 2; }},
    {"alpha_mask_texture",
     [](Forgery& f) { f.material(1).textures[MapUse::alpha_mask] = 0xFFFF'FFFE; }},
    {"base_color_format", [](Forgery& f) { f.material(0).textures[MapUse::base_color] = 1; }},
    {"roughness_format", [](Forgery& f) { f.material(0).textures[MapUse::roughness] = 0; }},
    {"metalness_format", [](Forgery& f) { f.material(0).textures[MapUse::metalness] = 0; }},
    {"normal_format", [](Forgery& f) { f.material(0).textures[MapUse::normal] = 1; }},
    {"alpha_mask_format", [](Forgery& f) { f.material(1).textures[MapUse::alpha_mask] = 0; }},
    {"texture_name", [](Forgery& f) { f.texture(0).name.length = 9; }},
    {"format", [](Forgery& f) { f.texture(0).format = static_cast<TextureFormat>(99); }},
    {"texture_flags", [](Forgery& f) { f.texture(0).flags = 4; }},
    {"hidden_beyond", [](Forgery& f) { f.texture(0).flags = mesh_format::kHiddenBeyond; }},
    {"no_width", [](Forgery& f) { f.texture(0).width = 0; }},
    {"width", [](Forgery& f) { f.texture(0).width = 1 << 30; }},
    {"height", [](Forgery& f) { f.texture(1).height = 4; }},
    {"mip_count", [](Forgery& f) { f.texture(1).mip_count = 2; }},
    {"mip_count_huge", [](Forgery& f) { f.texture(1).mip_count = 0xFFFF'FFFF; }},
    {"texture_size", [](Forgery& f) { f.texture(1).size -= 16; }},
    {"texture_checksum", [](Forgery& f) { ++f.texture(1).checksum; }},
    {"texture_is_that_before_it", [](Forgery& f) { f.texture(1) = f.texture(0); }},
    {"source_texture", [](Forgery& f) { f.source(0).texture = 2; }},
    {"source_alpha_mask", [](Forgery& f) { f.source(1).alpha_mask = 0xFFFF'FFFE; }},
    {"source_flags", [](Forgery& f) { f.source(1).flags = 2; }},
    {"source_reserved", [](Forgery& f) { f.source(0).reserved = 1; }},
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

TEST(HostileFile, HostileHeadersAreRefusedInSpiteOfTheirChecksum) {
    expect_refused(kHostileHeaders);
}

TEST(HostileFile, HostileGeometryIsRefusedInSpiteOfItsChecksum) {
    expect_refused(kHostileGeometry);
}

TEST(HostileFile, HostileMaterialsAreRefusedInSpiteOfTheirChecksum) {
    expect_refused(kHostileMaterials);
}

/// No more memory is taken than the stored bytes make plausible.
TEST(HostileFile, TexelsOfHardlyAnyBytesAreRefused) {
    const auto complaint_of = [](std::uint64_t size) -> std::string {
        SmallScene scene;
        TextureRecord& texture = scene.textures[1];
        texture.width = texture.height = 1024;
        texture.mip_count = full_mip_count(1024, 1024);
        texture.flags = kCompressed;
        texture.size = size;
        scene.texels.resize(texture.offset + size);
        try {
            check(scene.document(), "the file");
            return {};
        } catch (const FormatError& error) {
            return error.what();
        }
    };
    const std::uint64_t least = mip_chain_bytes(TextureFormat::r8_unorm, 1024, 1024) / 1000 + 1;
    EXPECT_EQ(complaint_of(least), "");
    for (const std::uint64_t size : {least - 1, std::uint64_t{15}, std::uint64_t{0}})
        EXPECT_EQ(complaint_of(size),
                  "the file: texture 1: its compressed texels are implausibly few");
}

TEST(HostileFile, EncodedPartsMustFillTheirSections) {
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

TEST(HostileFile, DocumentsOfImpossibleShapeAreRefused) {
    const auto expect_refused = [](const SmallScene& scene) {
        EXPECT_THROW(check(scene.document(), "the file"), FormatError);
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

}  // namespace
