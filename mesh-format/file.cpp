#include "mesh-format/file.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

namespace mesh_format {

namespace {

template <typename T>
std::span<const std::byte> as_bytes(const T* data, std::size_t count) {
    return std::as_bytes(std::span<const T>(data, count));
}

/// What goes wrong in a file, told with the file's name and the place in it.
class Checker {
 public:
    explicit Checker(std::string_view name) : name_(name) {}

    [[noreturn]] void fail(const std::string& what) const {
        throw FileError(std::string(name_) + ": " + what);
    }
    void require(bool condition, const char* what) const {
        if (!condition) fail(what);
    }
    /// As above, for record `index` of the table `table`.
    void require(bool condition, const char* table, std::size_t index, const char* what) const {
        if (!condition) fail(std::string(table) + ' ' + std::to_string(index) + ": " + what);
    }

 private:
    std::string_view name_;
};

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

/// Whether [offset, offset + size) lies in [0, end), without overflow.
bool in_range(std::uint64_t offset, std::uint64_t size, std::uint64_t end) {
    return offset <= end && size <= end - offset;
}

bool in_unit_interval(float value) {
    return value >= 0.0f && value <= 1.0f;
}

bool positive_power_of_two(float value) {
    int exponent = 0;
    return std::isfinite(value) && value > 0.0f && std::frexp(value, &exponent) == 0.5f;
}

void check_scene(const Checker& check, const SceneRecord& scene) {
    check.require(ordered(scene.bounds_min, scene.bounds_max),
                  "the scene's bounding box is invalid");
    check.require(std::isfinite(scene.radius) && scene.radius >= 0.0f,
                  "the scene's radius is invalid");
    check.require(scene.position_step == 0.0f || positive_power_of_two(scene.position_step),
                  "the scene's position step is no power of two");
}

std::uint64_t vertex_bytes(const MeshRecord& mesh) {
    const VertexLayout layout = vertex_layout(mesh.position_form, mesh.frame_form, mesh.uv_form);
    return std::uint64_t{mesh.vertex_count} * layout.stride;
}

void check_mesh(const Checker& check, const Document& document, std::size_t i) {
    const MeshRecord& mesh = document.meshes[i];
    const auto require = [&](bool condition, const char* what) {
        check.require(condition, "mesh", i, what);
    };
    require(mesh.material < document.materials.size(), "its material does not exist");
    require(mesh.position_form <= PositionForm::f32 && mesh.frame_form <= FrameForm::f32 &&
                mesh.uv_form <= UvForm::f32,
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
    require(mesh.position_form == PositionForm::f32 || document.scene.position_step > 0.0f,
            "the scene's position step is missing");
    require(all_finite(mesh.uv_origin) && all_finite(mesh.uv_step), "its UV range is not finite");
    require(ordered(mesh.bounds_min, mesh.bounds_max), "its bounding box is invalid");
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
    require(all_finite(material.base_color), "its base colour is not finite");
    require(in_unit_interval(material.roughness) && in_unit_interval(material.metalness) &&
                in_unit_interval(material.alpha_cutoff),
            "a factor lies outside [0, 1]");
    require((material.flags & ~std::uint32_t{kAlphaMask | kCullBack}) == 0, "unknown flags");
    for (const std::uint32_t texture :
         {material.base_color_texture, material.roughness_texture, material.metalness_texture,
          material.normal_texture, material.alpha_mask_texture}) {
        require(texture == kNoTexture || texture < document.textures.size(),
                "a texture does not exist");
    }
}

void check_texture(const Checker& check, const Document& document, std::size_t i) {
    const TextureRecord& texture = document.textures[i];
    const auto require = [&](bool condition, const char* what) {
        check.require(condition, "texture", i, what);
    };
    require(valid_text(document, texture.name), "its name lies outside the strings");
    require(texture.format <= TextureFormat::bc5_unorm, "unknown format");
    require((texture.flags & ~std::uint32_t{kClampToEdge}) == 0, "unknown flags");
    require(texture.width > 0 && texture.width <= kMaxTextureSize && texture.height > 0 &&
                texture.height <= kMaxTextureSize,
            "its size is out of range");
    require(texture.mip_count == full_mip_count(texture.width, texture.height),
            "its mip count does not fit its size");
    require(texture.psnr >= 0.0f && texture.psnr <= kExactPsnr, "its PSNR is out of range");
    require(texture.size == mip_chain_bytes(texture.format, texture.width, texture.height) &&
                texture.offset % kMipAlignment == 0 &&
                in_range(texture.offset, texture.size, document.texels.size()),
            "its texels lie outside the texel section");
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

std::uint64_t header_checksum(Header header) {
    header.checksum = 0;
    return checksum(as_bytes(&header, 1));
}

/// The header, once it is known to be one of ours, whole and unaltered.
Header checked_header(const Checker& check, std::span<const std::byte> bytes) {
    check.require(!bytes.empty(), "the file is empty");
    const std::size_t magic_bytes = std::min(bytes.size(), kMagic.size());
    check.require(std::memcmp(bytes.data(), kMagic.data(), magic_bytes) == 0,
                  "is no .cw2mesh file; bake one with cw2-bake");
    check.require(bytes.size() >= sizeof(Header), "is truncated: the header is incomplete");
    Header header;
    std::memcpy(&header, bytes.data(), sizeof header);
    if (header.version != kVersion) {
        check.fail("has format version " + std::to_string(header.version) +
                   ", this program reads " + std::to_string(kVersion) + "; bake again");
    }
    check.require(header.header_size == sizeof(Header), "the header's size is wrong");
    check.require(header.checksum == header_checksum(header), "is altered: wrong header checksum");
    if (bytes.size() < header.file_size) {
        check.fail("is truncated: " + std::to_string(bytes.size()) + " of " +
                   std::to_string(header.file_size) + " bytes");
    }
    check.require(bytes.size() == header.file_size, "is altered: bytes after its end");
    return header;
}

constexpr std::array<const char*, kSectionCount> kSectionNames{
    "scene",    "meshes",  "chunks", "materials",        "textures",       "strings",
    "vertices", "indices", "texels", "encoded vertices", "encoded indices"};
static_assert(kSectionNames.back() != nullptr);

constexpr std::uint64_t align_section(std::uint64_t offset) {
    return (offset + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment;
}

/// The sections follow each other, and nothing but zeros lies between them.
void check_sections(const Checker& check, std::span<const std::byte> bytes, const Header& header) {
    std::uint64_t end = sizeof(Header);
    for (std::size_t k = 0; k < kSectionCount; ++k) {
        const Section& section = header.sections[k];
        if (section.offset != align_section(end) ||
            !in_range(section.offset, section.size, bytes.size())) {
            check.fail(std::string("section ") + kSectionNames[k] + " is not where it belongs");
        }
        for (const std::byte padding : bytes.subspan(end, section.offset - end)) {
            check.require(padding == std::byte{0}, "is altered: a byte between two sections");
        }
        end = section.offset + section.size;
    }
    check.require(end == bytes.size(), "is altered: bytes after the last section");
}

/// The sections of a file whose header and their places have been checked.
class SectionReader {
 public:
    SectionReader(const Checker& check, std::span<const std::byte> bytes, const Header& header)
        : check_(check), bytes_(bytes), header_(header) {}

    std::span<const std::byte> bytes(SectionKind kind) const {
        const auto k = static_cast<std::size_t>(kind);
        const Section& section = header_.sections[k];
        const auto contents = bytes_.subspan(section.offset, section.size);
        if (checksum(contents) != section.checksum) {
            check_.fail(std::string("is altered: wrong checksum of section ") + kSectionNames[k]);
        }
        return contents;
    }

    template <typename Record>
    std::span<const Record> records(SectionKind kind) const {
        const auto contents = bytes(kind);
        if (contents.size() % sizeof(Record) != 0) {
            check_.fail(std::string("section ") + kSectionNames[static_cast<std::size_t>(kind)] +
                        " ends within a record");
        }
        // Aligned: sections start at multiples of 64 from a base that is a multiple of 16.
        return {reinterpret_cast<const Record*>(contents.data()), contents.size() / sizeof(Record)};
    }

 private:
    const Checker& check_;
    std::span<const std::byte> bytes_;
    const Header& header_;
};

}  // namespace

std::uint64_t checksum(std::span<const std::byte> bytes) {
    constexpr std::uint64_t kMultiplier = 0x9E37'79B9'7F4A'7C15;
    const auto fold = [](std::uint64_t lane, std::uint64_t word) {
        return std::rotl((lane ^ word) * kMultiplier, 29);
    };
    std::uint64_t lanes[4] = {0, 1, 2, 3};
    const std::size_t block_bytes = bytes.size() / 32 * 32;
    for (std::size_t at = 0; at < block_bytes; at += 32) {
        std::uint64_t words[4];
        std::memcpy(words, bytes.data() + at, sizeof words);
        for (int i = 0; i < 4; ++i) lanes[i] = fold(lanes[i], words[i]);
    }
    const std::size_t rest = bytes.size() - block_bytes;
    if (rest > 0) {
        std::uint64_t words[4] = {};
        std::memcpy(words, bytes.data() + block_bytes, rest);
        for (std::size_t i = 0; i < (rest + 7) / 8; ++i) lanes[i] = fold(lanes[i], words[i]);
    }
    std::uint64_t result = bytes.size();
    for (const std::uint64_t lane : lanes) result = fold(result, lane);
    return result;
}

void check(const Document& document, std::string_view name) {
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
        if (!document.is_encoded()) check_indices(checker, document, i);
    }
    for (std::size_t i = 0; i < document.materials.size(); ++i) {
        check_material(checker, document, i);
    }
    for (std::size_t i = 0; i < document.textures.size(); ++i) check_texture(checker, document, i);
}

Document parse(std::span<const std::byte> bytes, std::string_view name) {
    assert(reinterpret_cast<std::uintptr_t>(bytes.data()) % 16 == 0);
    const Checker checker(name);
    const Header header = checked_header(checker, bytes);
    check_sections(checker, bytes, header);
    const SectionReader sections(checker, bytes, header);

    const auto scenes = sections.records<SceneRecord>(SectionKind::scene);
    checker.require(scenes.size() == 1, "section scene does not hold one record");
    Document document;
    document.scene = scenes.front();
    document.meshes = sections.records<MeshRecord>(SectionKind::meshes);
    document.chunks = sections.records<ChunkRecord>(SectionKind::chunks);
    document.materials = sections.records<MaterialRecord>(SectionKind::materials);
    document.textures = sections.records<TextureRecord>(SectionKind::textures);
    const auto strings = sections.bytes(SectionKind::strings);
    document.strings = {reinterpret_cast<const char*>(strings.data()), strings.size()};
    document.vertices = sections.bytes(SectionKind::vertices);
    document.indices = sections.records<std::uint16_t>(SectionKind::indices);
    document.texels = sections.bytes(SectionKind::texels);
    document.encoded_vertices = sections.bytes(SectionKind::encoded_vertices);
    document.encoded_indices = sections.bytes(SectionKind::encoded_indices);
    check(document, name);
    return document;
}

std::uint64_t write(const Document& document, const std::filesystem::path& path) {
    check(document, path.string());

    const std::array<std::span<const std::byte>, kSectionCount> contents{
        as_bytes(&document.scene, 1),
        std::as_bytes(document.meshes),
        std::as_bytes(document.chunks),
        std::as_bytes(document.materials),
        std::as_bytes(document.textures),
        as_bytes(document.strings.data(), document.strings.size()),
        document.vertices,
        std::as_bytes(document.indices),
        document.texels,
        document.encoded_vertices,
        document.encoded_indices,
    };
    Header header{};
    header.magic = kMagic;
    header.version = kVersion;
    header.header_size = sizeof(Header);
    std::uint64_t end = sizeof(Header);
    for (std::size_t k = 0; k < kSectionCount; ++k) {
        const std::uint64_t offset = align_section(end);
        header.sections[k] = {offset, contents[k].size(), checksum(contents[k])};
        end = offset + contents[k].size();
    }
    header.file_size = end;
    header.checksum = header_checksum(header);

    OutputFile file(path);
    file.write(as_bytes(&header, 1));
    std::uint64_t position = sizeof(Header);
    for (std::size_t k = 0; k < kSectionCount; ++k) {
        static constexpr std::byte kPadding[kSectionAlignment] = {};
        file.write(std::span(kPadding).first(header.sections[k].offset - position));
        file.write(contents[k]);
        position = header.sections[k].offset + contents[k].size();
    }
    file.commit();
    return header.file_size;
}

}  // namespace mesh_format
