#include "cw2-bake/bake.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <new>
#include <optional>
#include <thread>

#include "common/file_kind.h"
#include "cw2-bake/geometry/chunks.h"
#include "cw2-bake/geometry/compress.h"
#include "cw2-bake/geometry/normals.h"
#include "cw2-bake/geometry/quantise.h"
#include "cw2-bake/geometry/spatial_order.h"
#include "cw2-bake/geometry/tangents.h"
#include "cw2-bake/geometry/up_axis.h"
#include "cw2-bake/geometry/weld.h"
#include "cw2-bake/gltf/materials.h"
#include "cw2-bake/gltf/read_gltf.h"
#include "cw2-bake/gltf/write_gltf.h"
#include "cw2-bake/input_files.h"
#include "cw2-bake/obj/read_obj.h"
#include "cw2-bake/report.h"
#include "cw2-bake/stage_progress.h"
#include "cw2-bake/stats.h"
#include "cw2-bake/textures/textures.h"
#include "mesh-format/decode.h"
#include "mesh-format/file.h"

namespace bake {

namespace {

using mesh_format::kNoTexture;
using mesh_format::MapUse;
using mesh_format::MaterialRecord;
using mesh_format::StringRef;
using mesh_format::TextureRecord;

bool is_gltf(const std::filesystem::path& path) {
    return common::file_kind(path) == common::FileKind::gltf;
}

SourceScene read_scene(const Settings& settings, const Warn& warn, const Advance& advance) {
    const std::filesystem::path& path = settings.input;
    // Empty: files may be anywhere.
    std::filesystem::path root;
    if (settings.restricted) root = path.has_parent_path() ? path.parent_path() : ".";
    return is_gltf(path) ? read_gltf(path, warn, root)
                         : read_obj(path, warn, kObjChunkBytes, root, advance);
}

/// Throws BakeError if the box of the packed scene is beyond what floats hold, or its radius so
/// near that something at a few radii would be.
void check_extent(const mesh_format::SceneRecord& packed, const SourceScene& scene,
                  const std::filesystem::path& path) {
    constexpr float kLargestRadius = std::numeric_limits<float>::max() / 8.0f;
    bool finite = packed.radius <= kLargestRadius;
    for (int axis = 0; axis < 3; ++axis) {
        finite &= std::isfinite(packed.bounds_min[axis]) && std::isfinite(packed.bounds_max[axis]);
    }
    if (finite) return;
    glm::dvec3 low{scene.positions.front()}, high = low;
    for (const glm::dvec3 position : scene.positions) {
        low = glm::min(low, position);
        high = glm::max(high, position);
    }
    throw BakeError(fmt::format("{}: its extent, {:g}, is too near the largest float, {:g}",
                                path.string(), glm::length(high - low),
                                std::numeric_limits<float>::max()));
}

/// Warns where no triangle covers anything: its picture would be empty, and nobody know why.
void warn_of_no_area(const SourceScene& scene, const std::filesystem::path& path,
                     const Warn& warn) {
    const auto at = [&](std::size_t corner) {
        return glm::dvec3(scene.positions[scene.corners[corner].position]);
    };
    for (std::size_t i = 0; i + 2 < scene.corners.size(); i += 3) {
        const glm::dvec3 a = at(i + 1) - at(i);
        const glm::dvec3 b = at(i + 2) - at(i);
        // Whoever writes corners of a line as floats rounds them.
        constexpr double kFlat = 1e-6;
        if (glm::length(glm::cross(a, b)) > kFlat * glm::length(a) * glm::length(b)) return;
    }
    warn(path.string() + ": shows nothing: no triangle has an area");
}

TextureSet make_textures(const Settings& settings, const SourceScene& scene, const Warn& warn,
                         StageProgress& progress) {
    if (settings.textures == TextureMode::none) {
        return {.textures = {}, .materials = std::vector<MaterialTextures>(scene.materials.size())};
    }
    return bake_textures(scene.materials, {settings.textures, settings.compress}, settings.output,
                         warn,
                         [&](double done, std::string_view name) { progress.update(done, name); });
}

/// A line for the summary, unless nothing was.
std::string taken_over(const TextureSet& set) {
    const auto count = std::ranges::count_if(
        set.textures, [](const Texture& texture) { return !texture.earlier_payload.empty(); });
    return count == 0 ? ""
                      : fmt::format("  unchanged since the bake before: {} of {} textures\n", count,
                                    set.textures.size());
}

std::vector<UvBudget> uv_budgets(const TextureSet& textures) {
    std::vector<UvBudget> budgets;
    for (const MaterialTextures& material : textures.materials) {
        UvBudget budget;
        std::uint32_t longest = 0;
        for (const std::uint32_t index : material.textures.values) {
            if (index == kNoTexture) continue;
            const Texture& texture = textures.textures[index];
            longest = std::max({longest, texture.width, texture.height});
            budget.shiftable = budget.shiftable && texture.flags == 0;
        }
        if (longest > 0) budget.texels = longest;
        budgets.push_back(budget);
    }
    return budgets;
}

/// The tables of the file that do not hold geometry, and what they point into.
struct Tables {
    std::vector<MaterialRecord> materials;
    std::vector<TextureRecord> textures;
    std::vector<std::span<const std::byte>> payloads;  ///< of the textures
    std::string strings;

    StringRef add(std::string_view text) {
        const StringRef ref{static_cast<std::uint32_t>(strings.size()),
                            static_cast<std::uint32_t>(text.size())};
        strings += text;
        return ref;
    }
};

MaterialRecord material_record(const SourceMaterial& source, const MaterialTextures& textures,
                               StringRef name) {
    MaterialRecord record{};
    record.name = name;
    for (int channel = 0; channel < 3; ++channel) {
        record.base_color[channel] = source.base_color[channel];
        record.emission[channel] = source.emission[channel];
    }
    record.roughness = textures.roughness_holds_factor ? 1.0f : source.roughness;
    record.metalness = source.metalness;
    record.alpha_cutoff = source.alpha_cutoff;
    record.normal_scale = source.normal_scale;
    record.opacity = source.opacity;
    if (textures.textures[MapUse::alpha_mask] != kNoTexture)
        record.flags |= mesh_format::kAlphaMask;
    if (source.cull_back) record.flags |= mesh_format::kCullBack;
    if (source.flip_back_normals) record.flags |= mesh_format::kFlipBackNormals;
    if (source.unlit) record.flags |= mesh_format::kUnlit;
    if (source.blend) record.flags |= mesh_format::kBlend;
    record.textures = textures.textures;
    return record;
}

/// The payloads stay in `set`.
Tables make_tables(const std::vector<SourceMaterial>& materials, const TextureSet& set) {
    Tables tables;
    for (std::size_t i = 0; i < materials.size(); ++i) {
        const StringRef name = tables.add(materials[i].name);
        tables.materials.push_back(material_record(materials[i], set.materials[i], name));
    }
    std::uint64_t texel_bytes = 0;
    for (const Texture& texture : set.textures) {
        tables.textures.push_back(
            {.name = tables.add(texture.name),
             .format = texture.format,
             .flags = texture.flags,
             .width = texture.width,
             .height = texture.height,
             .mip_count = mesh_format::full_mip_count(texture.width, texture.height),
             .psnr = texture.psnr,
             .offset = texel_bytes,
             .size = texture.bytes().size(),
             .checksum = texture.checksum});
        tables.payloads.push_back(texture.bytes());
        texel_bytes += texture.bytes().size();
    }
    return tables;
}

/// Where the scene lies, and where the source wants it to be seen and lit from.
void add_start(const SourceScene& source, mesh_format::SceneRecord& record) {
    for (int axis = 0; axis < 3; ++axis) record.origin[axis] = source.origin[axis];
    const auto store = [](const glm::vec3& from, float(&to)[3]) {
        for (int axis = 0; axis < 3; ++axis) to[axis] = from[axis];
    };
    if (source.camera) {
        record.flags |= mesh_format::kHasCamera;
        store(source.camera->position, record.camera_position);
        store(source.camera->target, record.camera_target);
        record.camera_fov = source.camera->vertical_fov;
    }
    if (source.light) {
        record.flags |= mesh_format::kHasLight;
        store(source.light->position, record.light_position);
        store(source.light->color, record.light_color);
    }
}

/// Returns the file's size in bytes. Throws BakeError if it would show nothing: of triangles with
/// two equal corners readers of glTF make none.
std::uint64_t write_export(const mesh_format::Document& document,
                           std::span<const std::span<const std::byte>> payloads,
                           const Settings& settings, const Warn& warn) {
    const std::span<const std::uint16_t> indices = document.indices;
    bool shows = false;
    for (std::size_t i = 0; i < indices.size() && !shows; i += 3) {
        shows = indices[i] != indices[i + 1] && indices[i + 1] != indices[i + 2] &&
                indices[i + 2] != indices[i];
    }
    if (!shows) {
        throw BakeError(settings.input.string() +
                        ": shows no triangles: two corners of each are equal");
    }
    return write_gltf(document, payloads, settings.output, warn);
}

/// Returns the file's size in bytes.
std::uint64_t write_baked(const mesh_format::Document& document,
                          std::span<const std::span<const std::byte>> payloads,
                          const std::filesystem::path& path, const Advance& advance) {
    std::size_t most = document.vertices.size() + document.indices.size_bytes() +
                       document.encoded_vertices.size() + document.encoded_indices.size();
    for (const auto payload : payloads) most += payload.size();
    common::OutputFile file(path);
    const auto sink = [&](std::span<const std::byte> part) {
        constexpr std::size_t kPiece = 16 << 20;
        while (!part.empty()) {
            const auto piece = part.first(std::min(part.size(), kPiece));
            file.write(piece);
            advance(static_cast<double>(piece.size()) / static_cast<double>(most));
            part = part.subspan(piece.size());
        }
    };
    const std::uint64_t bytes = mesh_format::write(document, payloads, path.string(), sink);
    file.commit();
    return bytes;
}

void write_stats(const Settings& settings, const BakeStats& stats) {
    const std::string json = to_json(stats, std::filesystem::file_size(settings.input));
    common::write_file(*settings.stats, std::as_bytes(std::span(json)));
}

/// The geometry stays one scene from stage to stage, and no stage copies attributes: welding makes
/// vertices of equal corners, which name their attributes; chunks and meshes name vertices; packing
/// reads each vertex's values once and writes its final bytes. What a stage was made of goes as
/// soon as none of the later ones asks for it. Within a stage, tasks run over blocks of vertices,
/// or over halves of halves of a material's triangles, so that one large mesh fills all cores as
/// well as many small ones.
std::string run_stages(const Settings& settings, const Warn& warn_of, StageClock& clock) {
    const std::size_t threads = settings.threads > 0 ? static_cast<std::size_t>(settings.threads)
                                                     : std::thread::hardware_concurrency();
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    std::max<std::size_t>(threads, 1));

    require_writable(settings);
    StageProgress progress(!settings.quiet, clock);
    const Warn warn = [&](const std::string& warning) {
        progress.erase();
        warn_of(warning);
    };
    progress.begin("read");
    SourceScene scene = read_scene(settings, warn, progress.advance());
    const std::vector<std::filesystem::path> inputs = input_files(scene, settings);
    refuse_overwriting(settings, inputs);
    const std::string rule = settings.depfile ? depfile_text(settings.output, inputs) : "";
    warn_of_no_area(scene, settings.input, warn);
    progress.begin("textures");
    const TextureSet textures = make_textures(settings, scene, warn, progress);
    if (is_gltf(settings.input)) warn_of_blending(scene.materials, textures.materials, warn);
    const std::vector<UvBudget> budgets = uv_budgets(textures);
    progress.begin("normals");
    if (settings.z_up) turn_z_up(scene);
    std::optional<FirstEqual> positions(scene.positions);
    generate_normals(scene, *positions, progress.advance());
    progress.begin("weld");
    FramedTriangles framed = jumps_about(scene, *positions)
                                 ? weld_in_space(scene, *positions, progress.advance())
                                 : weld(scene, *positions, progress.advance());
    positions.reset();
    progress.begin("tangents");
    add_tangents(scene, framed, progress.advance());
    RawVector<std::uint32_t>().swap(framed.sources);
    progress.begin("chunks");
    const FramedScene framed_scene{scene, framed};
    const ChunkedScene chunked = make_chunks(framed_scene, budgets, progress.advance());
    RawVector<std::uint32_t>().swap(framed.indices);
    progress.begin("pack");
    PackedGeometry geometry =
        quantise(framed_scene, chunked, budgets, {settings.frame_form, settings.position_form},
                 progress.advance());
    check_extent(geometry.scene, scene, settings.input);
    add_start(scene, geometry.scene);
    const Tables tables = make_tables(scene.materials, textures);

    mesh_format::Document document{.scene = geometry.scene,
                                   .meshes = geometry.meshes,
                                   .chunks = geometry.chunks,
                                   .materials = tables.materials,
                                   .textures = tables.textures,
                                   .sources = textures.sources,
                                   .strings = tables.strings};
    EncodedGeometry encoded;
    if (settings.compress) {
        progress.begin("compress");
        encoded = compress(geometry, progress.advance());
        document.encoded_vertices = encoded.vertices;
        document.encoded_indices = encoded.indices;
    } else {
        document.vertices = geometry.vertices;
        document.indices = geometry.indices;
    }
    progress.begin("write");
    const bool exports = is_gltf(settings.output);
    const std::uint64_t bytes =
        exports ? write_export(document, tables.payloads, settings, warn)
                : write_baked(document, tables.payloads, settings.output, progress.advance());
    progress.begin("statistics");
    if (settings.depfile) write_depfile(*settings.depfile, rule);
    if (settings.stats)
        write_stats(settings,
                    {bytes, measure(framed_scene, chunked.meshes), geometry.scene, clock});
    if (exports)
        return fmt::format("{}\n{}", settings.output.string(), export_summary(document, bytes));
    return fmt::format("{}\n{}{}", settings.output.string(), summary(document, bytes),
                       taken_over(textures));
}

}  // namespace

std::string export_baked(const Settings& settings, const Warn& warn) {
    WarningFilter warnings(warn);
    if (!is_gltf(settings.output))
        throw BakeError(settings.input.string() + ": is baked already; -o FILE.glb exports it");
    refuse_overwriting(settings, {settings.input});
    require_writable(settings);
    const std::string rule =
        settings.depfile ? depfile_text(settings.output, {settings.input}) : "";
    const common::MappedFile file(settings.input);
    const std::string name = settings.input.string();
    mesh_format::Document document = mesh_format::parse(file.bytes(), name);
    const mesh_format::DecodedGeometry decoded =
        decode(document, name, [](std::size_t count, const auto& decode_mesh) {
            tbb::parallel_for(std::size_t{0}, count, decode_mesh);
        });
    std::vector<mesh_format::Payload> decoded_payloads(document.textures.size());
    tbb::parallel_for(std::size_t{0}, decoded_payloads.size(), [&](std::size_t i) {
        decoded_payloads[i] = decode_payload(document, i, name);
    });
    std::vector<std::span<const std::byte>> payloads;
    for (const mesh_format::Payload& payload : decoded_payloads) payloads.push_back(payload.bytes);
    const std::uint64_t bytes = write_export(document, payloads, settings, warnings.filtered());
    warnings.tell_rest();
    if (settings.depfile) write_depfile(*settings.depfile, rule);
    return fmt::format("{}\n{}", settings.output.string(), export_summary(document, bytes));
}

std::string bake(const Settings& settings, const Warn& warn) {
    StageClock clock;
    WarningFilter warnings(warn);
    try {
        std::string result = run_stages(settings, warnings.filtered(), clock);
        warnings.tell_rest();
        return result;
    } catch (const std::bad_alloc&) {
        throw BakeError(fmt::format("{}: there is not enough memory for the stage '{}'",
                                    settings.input.string(), clock.at_work()));
    }
}

}  // namespace bake
