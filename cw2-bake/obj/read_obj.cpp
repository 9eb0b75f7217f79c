#include "cw2-bake/obj/read_obj.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <system_error>
#include <unordered_map>
#include <utility>

#include "common/file_kind.h"
#include "common/io.h"
#include "cw2-bake/base/file_finder.h"
#include "cw2-bake/base/text_lines.h"
#include "cw2-bake/geometry/origin.h"
#include "cw2-bake/obj/assembly.h"
#include "cw2-bake/obj/read_mtl.h"
#include "cw2-bake/obj/triangulate.h"
#include "cw2-bake/obj/vertex_colors.h"

namespace bake {
namespace {

common::MappedFile map_file(const std::filesystem::path& path) {
    try {
        return common::MappedFile(path);
    } catch (const common::FileError& error) {
        throw BakeError(error.what());
    }
}

/// The fans of all polygons become proper triangulations.
void triangulate_polygons(const std::vector<ObjPolygon>& polygons, SourceScene& scene) {
    struct Scratch {
        Triangulator triangulator;
        std::vector<Corner> corners;
        std::vector<glm::vec3> positions;
    };
    tbb::enumerable_thread_specific<Scratch> scratches;
    const auto triangulate = [&](const ObjPolygon& polygon) {
        Scratch& scratch = scratches.local();
        Corner* fan = scene.corners.data() + std::size_t{polygon.first_triangle} * 3;
        scratch.corners.assign(fan, fan + 2);
        for (std::uint32_t i = 0; i < polygon.corner_count - 2; ++i) {
            scratch.corners.push_back(fan[3 * i + 2]);
        }
        scratch.positions.clear();
        for (const Corner& corner : scratch.corners) {
            scratch.positions.push_back(scene.positions[corner.position]);
        }
        for (const auto& triangle : scratch.triangulator.triangulate(scratch.positions)) {
            for (const std::uint32_t i : triangle) *fan++ = scratch.corners[i];
        }
    };
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, polygons.size()), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) triangulate(polygons[i]);
    });
}

/// Says which triangles are smoothed if some corner has no normal.
void prepare_missing_normals(const std::vector<ObjSmoothingUse>& uses, SourceScene& scene) {
    const auto lacks_normal = [](const Corner& corner) { return corner.normal == kAbsent; };
    std::erase_if(scene.without_normals, [&](const TriangleRange& range) {
        return std::ranges::none_of(
            std::span(scene.corners).subspan(3 * range.begin, 3 * (range.end - range.begin)),
            lacks_normal);
    });
    if (scene.without_normals.empty()) return;
    std::uint32_t group = 0;
    for (const ObjSmoothingUse& use : uses) {
        scene.smoothing_group.extend(use.first_triangle, group);
        group = use.group;
    }
    scene.smoothing_group.extend(scene.triangle_material.size(), group);
}

/// Gives corners of materials that transform their UVs new ones.
void transform_uvs(const std::vector<MtlMaterial>& materials, const std::string& name,
                   const Warn& warn, SourceScene& scene) {
    const auto transforms = [](const MtlMaterial& material) {
        return material.transform != MtlTransform{};
    };
    if (std::ranges::none_of(materials, transforms)) return;
    std::unordered_map<std::uint64_t, std::uint32_t> made;  // by material and index
    std::size_t too_large = 0;
    const auto transformed = [&](const MtlTransform& transform, std::uint32_t index) {
        const glm::dvec2 exact = glm::dvec2{transform.scale} * glm::dvec2{scene.uvs[index]} +
                                 glm::dvec2{transform.offset};
        const glm::vec2 uv = glm::vec2{exact} + 0.0f;  // no -0
        if (std::isfinite(uv.x) && std::isfinite(uv.y)) return uv;
        ++too_large;
        return glm::vec2{0.0f};
    };
    RunVector::Iterator triangle = scene.triangle_material.begin();
    for (std::size_t i = 0; i < scene.corners.size(); ++i) {
        if (i > 0 && i % 3 == 0) ++triangle;
        const std::uint32_t material = *triangle;
        const MtlTransform& transform = materials[material].transform;
        std::uint32_t& index = scene.corners[i].uv;
        if (index == kAbsent || transform == MtlTransform{}) continue;
        const auto [entry, is_new] = made.try_emplace(std::uint64_t{material} << 32 | index,
                                                      static_cast<std::uint32_t>(scene.uvs.size()));
        if (is_new) scene.uvs.push_back(transformed(transform, index));
        index = entry->second;
    }
    if (too_large > 0) {
        warn(
            fmt::format("{}: -s or -o take texture coordinates out of the range of floats; 0 is "
                        "used ({} in all)",
                        name, too_large));
    }
}

/// The MTL files of an OBJ, and what of them its materials name.
class Libraries {
 public:
    /// Adds the files that it reads to `files`.
    Libraries(const std::filesystem::path& obj, std::string_view text, const Warn& warn,
              const std::filesystem::path& root, std::vector<std::filesystem::path>& files)
        : obj_(obj), lines_(text, true), warn_(warn), files_(files), finder_(root) {}

    /// `offsets` are those of ObjContents::material_offsets.
    void read(const std::vector<ObjStatement>& statements,
              const std::vector<std::optional<std::size_t>>& offsets,
              std::vector<MtlMaterial>& materials);
    void warn_of_unknown(const std::vector<MtlMaterial>& materials,
                         const std::vector<std::optional<std::size_t>>& offsets);

 private:
    std::vector<std::string> names(const ObjStatement& statement);
    void find(const ObjStatement& statement);
    void find_beside();
    void read_library(const std::filesystem::path& path, const std::string& place,
                      std::vector<MtlMaterial>& materials);
    std::string place(std::size_t offset) {
        return fmt::format("{}:{}", obj_.string(), lines_.at(offset));
    }

    const std::filesystem::path& obj_;
    LineCounter lines_;
    const Warn& warn_;
    std::vector<std::filesystem::path>& files_;
    FileFinder finder_;
    struct Library {
        std::string name;
        FoundFile found;
        std::string place;
    };
    std::vector<Library> libraries_;  // each name once
    std::set<std::string> names_;
    std::set<std::filesystem::path> found_;
    std::unordered_map<std::string_view, std::size_t> unknown_;  // by name, index of material
    bool some_missing_ = false;
};

/// The names in a statement, in quotes or apart by blanks; or, with `in_blanks`, such that blanks
/// belong to a name up to its .mtl.
std::vector<std::string> split_names(std::string_view rest, bool in_blanks) {
    std::vector<std::string> names;
    bool open = false;  // the last name has no .mtl yet
    while (!(rest = trimmed(rest)).empty()) {
        const std::size_t quote = rest.front() == '"' ? rest.find('"', 1) : rest.npos;
        std::string word;
        if (quote != rest.npos) {
            word = rest.substr(1, quote - 1);
            rest.remove_prefix(quote + 1);
            open = false;
        } else {
            word = take_word(rest);
        }
        if (open) {
            names.back() += ' ' + word;
        } else {
            names.push_back(word);
        }
        open = in_blanks && quote == rest.npos &&
               common::lower_extension(std::filesystem::path(word)) != ".mtl";
    }
    return names;
}

/// The files a statement names: one, with blanks in its name, or several; whichever is there.
std::vector<std::string> Libraries::names(const ObjStatement& statement) {
    if (statement.words.empty()) return {};
    const std::vector<std::string> ways[] = {{std::string(without_quotes(statement.words))},
                                             split_names(statement.words, true),
                                             split_names(statement.words, false)};
    const auto folder = obj_.parent_path();
    const auto is_there = [&](const std::string& name) {
        const FoundFile found = finder_.find(folder, readings_of(name));
        return found.exists && found.note.empty();
    };
    for (const auto& way : ways)
        if (std::ranges::any_of(way, is_there)) return way;
    const auto is_alike = [&](const std::string& name) {
        return finder_.find(folder, readings_of(name)).exists;
    };
    for (const auto& way : ways)
        if (std::ranges::any_of(way, is_alike)) return way;
    return ways[1];
}

void Libraries::find(const ObjStatement& statement) {
    for (const std::string& name : names(statement)) {
        if (!names_.insert(name).second) continue;
        FoundFile found = finder_.find(obj_.parent_path(), readings_of(name));
        // By another name it is no other file, and would only be read once more.
        std::error_code error;
        const auto file = std::filesystem::canonical(found.file, error);
        if (found.exists && !error && !found_.insert(file).second) continue;
        libraries_.push_back({name, std::move(found), place(statement.offset)});
    }
}

/// Where no library is there, one with the name of the OBJ is as good as those it names.
void Libraries::find_beside() {
    const auto is_there = [](const Library& library) { return library.found.exists; };
    if (unknown_.empty() || std::ranges::any_of(libraries_, is_there)) return;
    FoundFile own = finder_.find(obj_.parent_path(), {{obj_.stem().string() + ".mtl"}});
    if (!own.exists) return;
    own.note = own.file.string() + " is taken";
    const std::string stated_in = libraries_.empty() ? obj_.string() : libraries_.front().place;
    libraries_.assign(1, {names_.empty() ? "" : libraries_.front().name, own, stated_in});
}

void Libraries::read_library(const std::filesystem::path& path, const std::string& stated_in,
                             std::vector<MtlMaterial>& materials) {
    const auto wanted = [&](std::string_view material) { return unknown_.contains(material); };
    files_.push_back(path);
    try {
        for (MtlMaterial& material : read_mtl(path, wanted, finder_, warn_)) {
            const auto entry = unknown_.find(material.source.name);
            MtlMaterial& named = materials[entry->second];
            unknown_.erase(entry);
            named = std::move(material);
        }
    } catch (const common::FileError& error) {
        some_missing_ = true;
        warn_(fmt::format("{}: {}", stated_in, error.what()));
    }
}

void Libraries::read(const std::vector<ObjStatement>& statements,
                     const std::vector<std::optional<std::size_t>>& offsets,
                     std::vector<MtlMaterial>& materials) {
    for (std::size_t i = 0; i < materials.size(); ++i) {
        if (offsets[i]) unknown_.emplace(materials[i].source.name, i);
    }
    for (const ObjStatement& statement : statements) find(statement);
    find_beside();
    for (const auto& [name, found, stated_in] : libraries_) {
        const std::string note = found.note.empty() ? "" : "; " + found.note;
        if (!found.exists || !note.empty())
            warn_(fmt::format("{}: no material library{}{}", stated_in,
                              name.empty() ? " is named" : ' ' + in_quotes(name), note));
        if (found.exists) {
            read_library(found.file, stated_in, materials);
        } else {
            some_missing_ = true;
            if (!found.is_outside) files_.push_back(found.file);
        }
    }
}

/// The warning of a missing library covers the materials that may be in it. A `usemtl` without a
/// name, or with "(null)", as Blender's first exporter says that a face has none, asks for nothing
/// but what such a `newmtl` holds, if there is one.
void Libraries::warn_of_unknown(const std::vector<MtlMaterial>& materials,
                                const std::vector<std::optional<std::size_t>>& offsets) {
    if (some_missing_) return;
    for (std::size_t i = 0; i < materials.size(); ++i) {
        const std::string& material = materials[i].source.name;
        if (material.empty() || material == "(null)" || !unknown_.contains(material)) continue;
        warn_(fmt::format("{}: no material library defines {}; a default is used",
                          place(offsets[i].value()), in_quotes(material)));
    }
}

}  // namespace

SourceScene read_obj(const std::filesystem::path& path, const Warn& warn, std::size_t chunk_bytes,
                     const std::filesystem::path& root, const Advance& advance) {
    const common::MappedFile file = map_file(path);
    const std::string name = path.string();
    const std::string_view text = without_padding(
        without_bom({reinterpret_cast<const char*>(file.bytes().data()), file.bytes().size()}));
    constexpr std::size_t kProbeBytes = 4096;
    if (text.substr(0, kProbeBytes).find('\0') != text.npos) {
        throw BakeError(name + ": is no OBJ: it holds binary data");
    }

    ObjContents contents = parse_obj(text, name, chunk_bytes, glm::dvec3(0.0), advance);
    for (int i = 0; i < kMostOrigins; ++i) {
        const auto origin = distant_origin(contents.scene.positions, contents.scene.corners);
        if (!origin) break;
        contents = parse_obj(text, name, chunk_bytes, contents.scene.origin + *origin);
    }
    SourceScene& scene = contents.scene;
    if (scene.corners.empty()) throw BakeError(name + ": has no faces");
    for (const ObjError& warning : contents.warnings)
        warn(fmt::format("{}:{}: {}", name, contents.lines.at(warning.offset), warning.what));
    triangulate_polygons(contents.polygons, scene);
    prepare_missing_normals(contents.smoothing_uses, scene);

    scene.files.push_back(path);
    Libraries libraries(path, text, warn, root, scene.files);
    std::vector<MtlMaterial> materials;
    for (const std::string& material : contents.material_names) {
        materials.push_back({.source = {.name = material}});
    }
    libraries.read(contents.libraries, contents.material_offsets, materials);
    libraries.warn_of_unknown(materials, contents.material_offsets);
    transform_uvs(materials, name, warn, scene);
    color_corners(contents.colors, materials, scene);
    for (MtlMaterial& material : materials) {
        if (material.source.name.empty()) material.source.name = "default";
        scene.materials.push_back(std::move(material.source));
    }
    file.require_unchanged();
    return std::move(scene);
}

}  // namespace bake
