// The byte layout of a .cw2mesh file: everything that is written to disk is declared here, once.
//
// A file is a Header followed by its sections in their order, each aligned to kSectionAlignment and
// zero-padded up to it. All numbers are little-endian. Section k of the header's table has
// SectionKind k:
//
//   scene      one SceneRecord
//   meshes     MeshRecord[]
//   chunks     ChunkRecord[], the chunks of all meshes, mesh after mesh
//   materials  MaterialRecord[]
//   textures   TextureRecord[]
//   sources    SourceRecord[]
//   strings    UTF-8 bytes that StringRef points into, no terminators
//   vertices   packed vertices of all meshes, mesh after mesh
//   indices    uint16[], triangle lists; an index counts from its mesh's first vertex
//   texels     the payloads of all textures, texture after texture; TextureRecord has the checksum
//              of each, the section's own is 0
//   encoded vertices, encoded indices
//              in a compressed file, what becomes the sections vertices and indices, which are
//              then empty: uint32[], the stored size of each mesh's part, then those parts, each
//              Zstandard frames. The indices' hold an index stream, see TriangleStart, the
//              vertices' a vertex stream, see FrameModel
#pragma once

#include <array>
#include <bit>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace mesh_format {

static_assert(std::endian::native == std::endian::little, "files are little-endian");

inline constexpr std::array<char, 8> kMagic{'C', 'W', '2', 'M', 'E', 'S', 'H', '\0'};
inline constexpr std::uint32_t kVersion = 9;
inline constexpr std::uint64_t kSectionAlignment = 64;
/// A mesh's vertices are addressed by 16-bit indices.
inline constexpr std::uint32_t kMaxMeshVertices = 65'536;
/// The largest number of triangles in a chunk.
inline constexpr std::uint32_t kMaxChunkTriangles = 512;
inline constexpr std::uint32_t kNoTexture = 0xFFFF'FFFF;

enum class SectionKind : std::uint32_t {
    scene,
    meshes,
    chunks,
    materials,
    textures,
    sources,
    strings,
    vertices,
    indices,
    texels,
    encoded_vertices,
    encoded_indices,
    count
};
inline constexpr std::size_t kSectionCount = static_cast<std::size_t>(SectionKind::count);

struct Section {
    std::uint64_t offset;    ///< bytes from the start of the file, a multiple of kSectionAlignment
    std::uint64_t size;      ///< bytes, without padding
    std::uint64_t checksum;  ///< checksum() of the section's bytes, see file.h; of texels 0
};

struct Header {
    std::array<char, 8> magic;
    std::uint32_t version;
    std::uint32_t header_size;  ///< sizeof(Header)
    std::uint64_t file_size;    ///< bytes, the header included
    std::uint64_t checksum;     ///< checksum() of the header with this field 0
    std::array<Section, kSectionCount> sections;
};

/// Bytes [offset, offset + length) of the strings section.
struct StringRef {
    std::uint32_t offset;
    std::uint32_t length;
};

/// How a vertex holds its position.
enum class PositionForm : std::uint8_t {
    quantised,  ///< 3 x uint16 on the scene's lattice: step * (mesh.origin + q), exact in float
    f32,        ///< 3 x float
};

/// How a vertex holds its tangent frame; see tangent_frame.h.
enum class FrameForm : std::uint8_t {
    quat48,  ///< 3 x uint16
    quat32,  ///< 2 x uint16
    half3,   ///< 3 x IEEE half, the handedness in bit 14 of the first
    f32,     ///< 4 x float, the handedness in the sign of w
};

/// A mesh's triangles in a compressed file are a code for each, one byte: kTriangleStart times a
/// TriangleStart, and flags, TriangleEnd. Then come the low bytes of all numbers, and their high
/// ones: a number is a vertex by its difference d to the vertex that the number before stood for
/// (at first 0), modulo 2^16, as 2 d, or as -2 d - 1 if d is negative.
///
/// A triangle goes from its pivot to its second and its third vertex. Triangles have a border, and
/// vertices come one after the other: a new one that no number says is the next. index_stream.cpp
/// says what the border becomes.
enum TriangleStart : std::uint32_t {
    kGoesOn,  ///< the pivot is that of the triangle before, the second vertex its third
    // 1 to 28: the pivot is the vertex that came so many before in the list of those seen (all
    // third vertices, and second ones but with kGoesOn), the second vertex as with kPivotNumber.
    kPivotNumber = 29,  ///< a number is the pivot; the border comes to it from the second vertex
    kNextTwo,           ///< the next two vertices are pivot and second vertex
    kTwoNumbers,        ///< two numbers are
};

/// What a triangle's third vertex is; the next one without any of these.
enum TriangleEnd : std::uint32_t {
    kClosesPivot = 1,   ///< the border's edge from the pivot goes there
    kClosesSecond = 2,  ///< the border's edge to the second vertex comes from there
    kThirdNumber = 4,   ///< a number
    kTriangleStart = 8,
};

/// A mesh's vertices in a compressed file are three bytes, a FrameModel, SurfaceModel::normal_shift
/// and tangent_shift, and planes of one byte a vertex. The vertex's parts follow each other:
/// position, UV, colour, frame. A part of k numbers of n bytes each has k n planes: the lowest byte
/// of the first number, of the second, ..., then the next bytes. A number stands for how much the
/// vertex's differs from an expected one, d modulo 256^n: as 2 d, or as -2 d - 1 if d is negative.
/// Expected is a + b - c, the numbers of the three Neighbours in index_stream.h; 0 for vertex 0.
/// The bits of a float count as a number once the first, or in negative floats all of them, are
/// inverted.
///
/// A frame of quat32 is one number of four bytes. By how much it differs is said by seven planes:
/// of a number of one byte, the top, and of three of two bytes, the digits; see CodeDigits in
/// frame_differences.h.
enum class FrameModel : std::uint8_t {
    neighbours,  ///< frames are expected as other parts are
    /// As expect_quat48() and expect_quat32() of sum_surfaces() say; where positions and UVs are
    /// quantised.
    surface,
    surface_without_uvs,  ///< the same: SurfaceModel::has_uvs
    surface_by_angle,     ///< SurfaceModel::by_angle
    surface_by_angle_without_uvs,
    count
};

/// How a vertex holds its texture coordinate; v = 0 is the top row of the image.
enum class UvForm : std::uint8_t {
    quantised,  ///< 2 x uint16: mesh.uv_origin + mesh.uv_step * q
    f32,        ///< 2 x float
};

/// How a vertex holds its colour, which multiplies the base colour.
enum class ColorForm : std::uint8_t {
    none,   ///< not at all: white
    rgba8,  ///< 4 x uint8: red, green and blue sRGB-encoded, alpha linear
};

/// How the vertices of a mesh hold what they hold; vertex_layout() says where.
struct VertexForms {
    PositionForm position;
    FrameForm frame;
    UvForm uv;
    ColorForm color;
    auto operator<=>(const VertexForms&) const = default;
};

/// All positions in the file, those of camera and light included, are relative to `origin`.
struct SceneRecord {
    double origin[3];            ///< in the source's coordinates, scene units
    std::uint64_t vertex_bytes;  ///< size of the section vertices, decoded
    std::uint64_t index_count;   ///< of the section indices, decoded
    float bounds_min[3];         ///< bounding box of all positions as decoded, scene units
    float bounds_max[3];
    float radius;          ///< largest distance of a vertex from the box's centre, scene units
    float position_step;   ///< lattice step, a power of two, scene units; 0 if no mesh is quantised
    float position_error;  ///< largest distance between a source and its decoded position
    float frame_error_mean;  ///< angle of the rotation between true and decoded frame, degrees
    float frame_error_max;
    float
        uv_error;  ///< largest UV error, in texels of the mesh's largest texture (of 1024 if none)
    std::uint32_t flags;       ///< SceneFlags
    float camera_position[3];  ///< where a viewer starts, scene units; 0 without kHasCamera
    float camera_target[3];    ///< another point
    float camera_fov;          ///< vertical, radians, in (0, pi)
    float light_position[3];   ///< where the light starts, scene units; 0 without kHasLight
    float light_color[3];      ///< linear, without falloff
};

enum SceneFlags : std::uint32_t {
    kHasCamera = 1,
    kHasLight = 2,
};

struct MeshRecord {
    std::uint32_t material;
    VertexForms forms;
    std::uint32_t vertex_count;
    std::uint32_t index_count;    ///< a multiple of 3
    std::uint64_t vertex_offset;  ///< bytes into the vertices section, a multiple of 4
    std::uint64_t first_index;    ///< uint16 units into the indices section
    std::int32_t origin[3];       ///< lattice units; |origin + q| < 2^24
    float uv_origin[2];
    float uv_step[2];     ///< powers of two
    float bounds_min[3];  ///< of the decoded positions, scene units
    float bounds_max[3];
    std::uint32_t first_chunk;
    std::uint32_t chunk_count;  ///< they follow each other and hold all the mesh's indices
    std::uint32_t reserved2;    ///< 0
};

/// Triangles of a mesh that lie close together: what is culled and drawn as one.
struct ChunkRecord {
    std::uint32_t first_index;  ///< counted from the mesh's first, a multiple of 3
    std::uint32_t index_count;  ///< a positive multiple of 3, at most 3 kMaxChunkTriangles
    float center[3];            ///< of a sphere around the decoded positions, scene units
    float radius;
    /// A camera at c sees only back faces if
    /// dot(center - c, cone_axis) >= cone_cutoff * length(center - c) + radius.
    float cone_axis[3];
    float cone_cutoff;  ///< 1 where normals spread too far for a cone
};

enum MaterialFlags : std::uint32_t {
    kAlphaMask = 1,        ///< drawn by the alpha-mask pipeline
    kCullBack = 2,         ///< back faces are not drawn; from OBJ: never set
    kFlipBackNormals = 4,  ///< normals of back faces are turned to the viewer; from OBJ: never set
    kUnlit = 8,            ///< shows its base colour whatever the light
    kBlend = 16,           ///< the source blends it, by MaterialRecord::opacity; drawn opaque
};

/// What a material's textures are for.
enum class MapUse : std::uint32_t {
    base_color,
    roughness,
    metalness,
    normal,
    alpha_mask,
    emission,
    count
};
inline constexpr std::size_t kMapUseCount = static_cast<std::size_t>(MapUse::count);

/// One T for each use.
template <typename T>
struct PerMap {
    T values[kMapUseCount];

    constexpr T& operator[](MapUse use) { return values[static_cast<std::size_t>(use)]; }
    constexpr const T& operator[](MapUse use) const {
        return values[static_cast<std::size_t>(use)];
    }
    bool operator==(const PerMap&) const = default;
};

/// `value` for every use.
template <typename T>
constexpr PerMap<T> per_map(const T& value) {
    PerMap<T> result{};
    for (T& each : result.values) each = value;
    return result;
}

/// Factors multiply their texture's sample; an absent texture counts as 1 (normal: (0, 0, 1)).
struct MaterialRecord {
    StringRef name;
    float base_color[3];  ///< linear, [0, 1]
    float roughness;      ///< [0, 1], the alpha of the Blinn-Phong distribution
    float metalness;      ///< [0, 1]
    float alpha_cutoff;   ///< a fragment whose mask is below this is discarded
    float normal_scale;   ///< multiplies x and y of what the normal texture holds
    /// Linear, not negative: what is emitted, over the light that leaves white paper facing a
    /// light of colour 1.
    float emission[3];
    float opacity;        ///< [0, 1]; below 1 only with kBlend
    std::uint32_t flags;  ///< MaterialFlags
    /// Indices into the textures section, or kNoTexture; kMaps has the formats that fit.
    PerMap<std::uint32_t> textures;
};

/// The blocks are those of the Khronos Data Format Specification 1.3, 4 x 4 texels each; of BC7
/// those of mode 1 with one of the first kBc7Partitions partitions. A normal
/// map holds 0.5 n + 0.5 of x and y alone, and z = sqrt(max(0, 1 - x^2 - y^2)).
enum class TextureFormat : std::uint32_t {
    r8_unorm,
    rg8_unorm,
    rgba8_srgb,
    bc1_srgb,   ///< opaque red, green and blue
    bc4_unorm,  ///< red
    bc5_unorm,  ///< red and green
    bc7_srgb,   ///< opaque red, green and blue
};
inline constexpr std::uint32_t kBc7Partitions = 16;

/// What is the same for all textures of one use.
struct MapInfo {
    const char* name;         ///< for people
    TextureFormat plain;      ///< the format of its textures
    TextureFormat in_blocks;  ///< the same, in blocks; colours may be in bc7_srgb, too
};
inline constexpr PerMap<MapInfo> kMaps{{
    {"base colour", TextureFormat::rgba8_srgb, TextureFormat::bc1_srgb},
    {"roughness", TextureFormat::r8_unorm, TextureFormat::bc4_unorm},
    {"metalness", TextureFormat::r8_unorm, TextureFormat::bc4_unorm},
    {"normal", TextureFormat::rg8_unorm, TextureFormat::bc5_unorm},
    {"alpha mask", TextureFormat::r8_unorm, TextureFormat::bc4_unorm},
    {"emission", TextureFormat::rgba8_srgb, TextureFormat::bc1_srgb},
}};

enum TextureFlags : std::uint32_t {
    kClampToEdge = 1,  ///< otherwise repeat
    /// Beside the other, of an alpha mask that hides all along its edges: it is 0 beyond them. The
    /// edges of small levels have means of what is inside, which would go on without end.
    kHiddenBeyond = 2,
    kCompressed = 4,  ///< the payload is stored as kPartBytes says
};

/// A texture's payload is its complete mip chain, largest level first, each level's rows (of texels
/// or of blocks) tightly packed from the top, each level starting at a multiple of kMipAlignment
/// from the first. Blocks that reach over the right or lower edge hold anything there.
///
/// A compressed one is stored as uint32[], the stored size of each part, then those parts, each a
/// Zstandard frame of the next kPartBytes of the payload, the last one of what is left. A part
/// takes the kLargestRatio-th part of what it holds at least: after a frame that is shorter goes a
/// skippable one, of zeros.
struct TextureRecord {
    StringRef name;
    TextureFormat format;
    std::uint32_t flags;  ///< TextureFlags
    std::uint32_t width;  ///< texels of level 0
    std::uint32_t height;
    std::uint32_t mip_count;  ///< full_mip_count(width, height)
    /// Of level 0 in blocks against the texels that it stands for, dB, at most kExactPsnr; also
    /// where it was too low, so that the texture stayed as it was. 0 where blocks were not tried.
    float psnr;
    std::uint64_t offset;    ///< bytes into the texels section, where the payload before it ends
    std::uint64_t size;      ///< mip_chain_bytes(format, width, height); compressed, less
    std::uint64_t checksum;  ///< checksum() of the payload as it is stored
};

enum SourceFlags : std::uint32_t {
    kHoldsFactor = 1,  ///< the texture is multiplied with its material's factor already
};

/// What a map of a material became, for the next bake of the same scene: where an equal key comes
/// up again, these textures, or that there are none, are what it would make.
struct SourceRecord {
    /// A hash of the images' bytes and of all that the textures depend on beside them, the baker's
    /// code included.
    std::uint64_t key[2];
    std::uint32_t texture;     ///< index into the textures section, or kNoTexture
    std::uint32_t alpha_mask;  ///< the same
    std::uint32_t flags;       ///< SourceFlags
    std::uint32_t reserved;    ///< 0
};

inline constexpr std::uint64_t kPartBytes = 128 << 10;
/// What is compressed has at most so many times the bytes that are stored of it (of geometry, with
/// its chunks), so that a small file cannot claim all memory. The geometry of a flat grid may
/// shrink to next to nothing; its chunks are the 200th part of it.
inline constexpr std::uint64_t kLargestRatio = 1000;
inline constexpr std::uint64_t kMipAlignment = 16;
inline constexpr float kExactPsnr = 100.0f;
inline constexpr std::uint32_t kMaxTextureSize = 16'384;

static_assert(sizeof(Section) == 24 && sizeof(Header) == 32 + 24 * kSectionCount);
static_assert(sizeof(SceneRecord) == 144 && sizeof(MeshRecord) == 96);
static_assert(sizeof(ChunkRecord) == 40);
static_assert(sizeof(MaterialRecord) == 80 && sizeof(TextureRecord) == 56);
static_assert(sizeof(SourceRecord) == 32);
static_assert(std::is_trivially_copyable_v<Header> && std::is_trivially_copyable_v<MeshRecord>);

constexpr std::uint32_t position_bytes(PositionForm form) {
    return form == PositionForm::quantised ? 6 : 12;
}
constexpr std::uint32_t frame_bytes(FrameForm form) {
    return form == FrameForm::f32 ? 16 : form == FrameForm::quat32 ? 4 : 6;
}
constexpr std::uint32_t uv_bytes(UvForm form) {
    return form == UvForm::quantised ? 4 : 8;
}
constexpr std::uint32_t color_bytes(ColorForm form) {
    return form == ColorForm::none ? 0 : 4;
}

/// Where a vertex's parts lie, in bytes. Position, frame, UV and colour follow each other; a part
/// of 32-bit components starts at a multiple of 4.
struct VertexLayout {
    std::uint32_t frame_offset;  ///< the position is at 0
    std::uint32_t uv_offset;
    std::uint32_t color_offset;
    std::uint32_t stride;  ///< 16 in the default forms
    bool has_gaps;         ///< some bytes belong to no part; they are 0
};

constexpr VertexLayout vertex_layout(const VertexForms& forms) {
    const auto align = [](std::uint32_t offset, bool wide) {
        return wide ? (offset + 3) / 4 * 4 : offset;
    };
    const bool wide_frame = forms.frame == FrameForm::f32;
    const bool wide_uv = forms.uv == UvForm::f32;
    const bool wide = forms.position == PositionForm::f32 || wide_frame || wide_uv;
    VertexLayout layout{};
    layout.frame_offset = align(position_bytes(forms.position), wide_frame);
    layout.uv_offset = align(layout.frame_offset + frame_bytes(forms.frame), wide_uv);
    layout.color_offset = layout.uv_offset + uv_bytes(forms.uv);
    layout.stride = align(layout.color_offset + color_bytes(forms.color), wide);
    layout.has_gaps = layout.stride != position_bytes(forms.position) + frame_bytes(forms.frame) +
                                           uv_bytes(forms.uv) + color_bytes(forms.color);
    return layout;
}
static_assert(vertex_layout({PositionForm::quantised, FrameForm::quat48, UvForm::quantised,
                             ColorForm::none})
                  .stride == 16);

/// Texels along each side of a block; formats without blocks count as blocks of one texel.
constexpr std::uint32_t block_extent(TextureFormat format) {
    return format >= TextureFormat::bc1_srgb ? 4 : 1;
}

constexpr std::uint32_t block_bytes(TextureFormat format) {
    switch (format) {
        case TextureFormat::r8_unorm:
            return 1;
        case TextureFormat::rg8_unorm:
            return 2;
        case TextureFormat::rgba8_srgb:
            return 4;
        case TextureFormat::bc1_srgb:
        case TextureFormat::bc4_unorm:
            return 8;
        case TextureFormat::bc5_unorm:
        case TextureFormat::bc7_srgb:
            return 16;
    }
    return 0;
}

/// Blocks that it takes to hold `extent` texels along a side.
constexpr std::uint32_t block_count(TextureFormat format, std::uint32_t extent) {
    return (extent + block_extent(format) - 1) / block_extent(format);
}

constexpr std::uint32_t full_mip_count(std::uint32_t width, std::uint32_t height) {
    return static_cast<std::uint32_t>(std::bit_width(width > height ? width : height));
}

/// Extent of a mip level along one side whose level 0 has `extent` texels.
constexpr std::uint32_t mip_extent(std::uint32_t extent, std::uint32_t level) {
    return extent >> level > 0 ? extent >> level : 1;
}

/// Bytes of one level, padding to kMipAlignment included.
constexpr std::uint64_t mip_bytes(TextureFormat format, std::uint32_t width, std::uint32_t height,
                                  std::uint32_t level) {
    const std::uint64_t bytes = std::uint64_t{block_count(format, mip_extent(width, level))} *
                                block_count(format, mip_extent(height, level)) *
                                block_bytes(format);
    return (bytes + kMipAlignment - 1) / kMipAlignment * kMipAlignment;
}

/// Bytes of the complete chain.
constexpr std::uint64_t mip_chain_bytes(TextureFormat format, std::uint32_t width,
                                        std::uint32_t height) {
    std::uint64_t sum = 0;
    for (std::uint32_t level = 0; level < full_mip_count(width, height); ++level) {
        sum += mip_bytes(format, width, height, level);
    }
    return sum;
}
static_assert(mip_chain_bytes(TextureFormat::r8_unorm, 5, 3) == 16 + 16 + 16);
static_assert(mip_chain_bytes(TextureFormat::bc1_srgb, 9, 5) == 3 * 2 * 8 + 16 + 16 + 16);
static_assert(mip_chain_bytes(TextureFormat::bc5_unorm, 8, 4) == 2 * 16 + 16 + 16 + 16);

}  // namespace mesh_format
