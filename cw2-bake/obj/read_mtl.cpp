#include "cw2-bake/obj/read_mtl.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "common/io.h"
#include "cw2-bake/base/file_finder.h"
#include "cw2-bake/base/text_lines.h"
#include "cw2-bake/obj/texture_statement.h"

namespace bake {
namespace {

using mesh_format::MapUse;

/// What one material states.
struct Statements {
    std::string name;
    std::optional<glm::vec3> kd, ke;
    std::optional<float> pr, ns, pm, d, tr;
    std::optional<TextureStatement> map_kd, map_pr, map_pm, map_d, map_ke, norm, bump, map_ka;
    /// Roughness, metalness and occlusion in one image, where there is no map of its own.
    std::optional<TextureStatement> rma, orm;
    std::string transparency_place;
    /// What is not read and not neutral, by its key, with its place and what a note says.
    struct LeftOut {
        std::string key, place, kind, word;
    };
    std::vector<LeftOut> left_out;  // each key once
    std::unordered_set<std::string> left_out_keys;

    void leave_out(const std::string& key, const std::string& place, const std::string& kind) {
        if (left_out_keys.insert(key).second) left_out.push_back({key, place, kind});
    }
};

/// What is warned of once, whatever the number of materials.
class Notes {
 public:
    /// `word` is told of the first that is noted.
    void add(const std::string& kind, std::string_view place, std::string_view word,
             std::size_t material);
    void tell(const Warn& warn) const;

 private:
    struct Note {
        std::string kind, place, word;
        std::size_t material;  // the last
        std::size_t materials;
    };
    std::vector<Note> notes_;
    std::unordered_map<std::string, std::size_t> by_kind_;
};

void Notes::add(const std::string& kind, std::string_view place, std::string_view word,
                std::size_t material) {
    const auto [same, fresh] = by_kind_.try_emplace(kind, notes_.size());
    if (fresh) {
        notes_.push_back({kind, std::string(place), std::string(word), material, 1});
    } else if (Note& note = notes_[same->second]; note.material != material) {
        note.material = material;
        ++note.materials;
    }
}

void Notes::tell(const Warn& warn) const {
    for (const Note& note : notes_) {
        warn(fmt::format("{}: {}{} ({} material{})", note.place, note.kind,
                         note.word.empty() ? "" : ", the first " + note.word, note.materials,
                         note.materials == 1 ? "" : "s"));
    }
}

class MtlReader {
 public:
    MtlReader(const std::filesystem::path& path, std::string_view text, FileFinder& finder,
              const Warn& warn)
        : path_(path), text_(text), warn_(warn), finder_(finder) {}

    std::vector<MtlMaterial> read(const std::function<bool(std::string_view)>& wanted);

 private:
    void statement(std::string_view keyword, std::string_view words);
    bool number_statement(const std::string& key, std::string_view words);
    bool map_statement(const std::string& key, std::string_view words);
    void other_statement(const std::string& key, std::string_view keyword, std::string_view words);
    void note(const std::string& kind, std::string_view word = {}) {
        notes_.add(kind, place(), word, material_count_);
    }
    std::optional<float> number(std::string_view& words, std::string_view keyword);
    std::optional<glm::vec3> color(std::string_view words, std::string_view keyword);
    std::optional<float> unit(std::string_view words, std::string_view keyword);
    float in_unit(float value, std::string_view keyword);
    std::optional<TextureStatement> texture(std::string_view words);
    void take_maps(const Statements& stated, SourceMaterial& material) const;
    MtlTransform transform(const Statements& stated);
    void note_left_out(const Statements& stated);
    void warn_at_end() const;
    MtlMaterial finish(const Statements& stated);
    std::string place() const { return fmt::format("{}:{}", path_.string(), line_); }

    const std::filesystem::path& path_;
    std::string_view text_;
    const Warn& warn_;
    FileFinder& finder_;
    std::size_t line_ = 1;  // of the statement at hand
    std::size_t material_count_ = 0;
    Statements material_;
    Notes notes_;
    std::string transparent_name_, transparent_place_;
    int transparent_count_ = 0;
};

/// None if there is none that is finite, with a note.
std::optional<float> MtlReader::number(std::string_view& words, std::string_view keyword) {
    const std::string_view word = take_word(words);
    if (word.empty() || word.starts_with('#')) {
        note(fmt::format("{} lacks a number and is left out", keyword));
        return std::nullopt;
    }
    const auto value = as_number(word);
    if (value && std::isfinite(*value)) return value;
    note(fmt::format("{} holds no finite number and is left out", keyword), in_quotes(word));
    return std::nullopt;
}

float MtlReader::in_unit(float value, std::string_view keyword) {
    if (value >= 0 && value <= 1) return value;
    const float clamped = std::clamp(value, 0.0f, 1.0f);
    warn_(fmt::format("{}: {} {} is outside 0 to 1; {} is used", place(), keyword, value, clamped));
    return clamped;
}

std::optional<float> MtlReader::unit(std::string_view words, std::string_view keyword) {
    const auto value = number(words, keyword);
    return value ? std::optional(in_unit(*value, keyword)) : std::nullopt;
}

/// Three numbers, or one for all.
std::optional<glm::vec3> MtlReader::color(std::string_view words, std::string_view keyword) {
    if (words.starts_with("spectral") || words.starts_with("xyz")) {
        note(fmt::format("only RGB colours are read; {} is left out", keyword));
        return std::nullopt;
    }
    const auto red = number(words, keyword);
    if (!red) return std::nullopt;
    if (words.empty() || words.starts_with('#')) return glm::vec3{*red};
    const auto green = number(words, keyword);
    if (!green) return std::nullopt;
    const auto blue = number(words, keyword);
    if (!blue) return std::nullopt;
    return glm::vec3{*red, *green, *blue};
}

std::optional<TextureStatement> MtlReader::texture(std::string_view words) {
    auto result =
        parse_texture(words, path_.parent_path(), finder_, [&](const std::string& option) {
            note(fmt::format("the texture option {} is not supported and left out", option));
        });
    if (!result) {
        warn_(place() + ": no image is named");
    } else if (result->is_outside) {
        warn_(fmt::format("{}: {}: is outside the scene's folder", place(),
                          result->map.file.string()));
        result.reset();
    } else {
        result->map.stated_in = place();
    }
    return result;
}

bool MtlReader::number_statement(const std::string& key, std::string_view words) {
    if (key == "kd") {
        material_.kd = color(words, "Kd");
        for (int i = 0; material_.kd && i < 3; ++i) {
            (*material_.kd)[i] = in_unit((*material_.kd)[i], "Kd");
        }
    } else if (key == "ke") {
        material_.ke = color(words, "Ke");
        for (int i = 0; material_.ke && i < 3; ++i) {
            float& value = (*material_.ke)[i];
            if (value < 0) note("Ke is negative; 0 is used");
            value = std::max(value, 0.0f);
        }
    } else if (key == "pr") {
        material_.pr = unit(words, "Pr");
    } else if (key == "pm") {
        material_.pm = unit(words, "Pm");
    } else if (key == "ns") {
        material_.ns = number(words, "Ns");
        if (material_.ns) material_.ns = std::max(*material_.ns, 0.0f);
    } else if (key == "d" || key == "tr") {
        std::string_view rest = words;
        if (take_word(rest) == "-halo") words = rest;
        (key == "d" ? material_.d : material_.tr) = number(words, key == "d" ? "d" : "Tr");
        material_.transparency_place = place();
    } else {
        return false;
    }
    return true;
}

bool MtlReader::map_statement(const std::string& key, std::string_view words) {
    using Member = std::optional<TextureStatement> Statements::*;
    static const std::array<std::pair<std::string_view, Member>, 13> kMaps{{
        {"map_kd", &Statements::map_kd},
        {"map_pr", &Statements::map_pr},
        {"map_pm", &Statements::map_pm},
        {"map_d", &Statements::map_d},
        {"map_ke", &Statements::map_ke},
        {"map_emissive", &Statements::map_ke},
        {"norm", &Statements::norm},
        {"map_kn", &Statements::norm},
        {"map_bump", &Statements::bump},
        {"bump", &Statements::bump},
        {"map_rma", &Statements::rma},
        {"map_orm", &Statements::orm},
        {"map_ka", &Statements::map_ka},
    }};
    const auto map = std::ranges::find(kMaps, key, &std::pair<std::string_view, Member>::first);
    if (map == kMaps.end()) return false;
    if (key == "map_ka" && words.empty()) return true;
    material_.*(map->second) = texture(words);
    if (key == "map_rma" || key == "map_orm")
        note("the ambient occlusion of map_RMA or map_ORM is left out");
    return true;
}

/// Whether these words of a statement that is not read change nothing.
bool is_neutral(std::string_view key, std::string_view words) {
    std::string_view rest = words;
    const std::string_view first = take_word(rest);
    std::vector<std::optional<float>> numbers;
    while (!words.empty() && !words.starts_with('#'))
        numbers.push_back(as_number(take_word(words)));
    const auto all = [&](float value) {
        return std::ranges::all_of(numbers, [=](auto number) { return number == value; });
    };
    // Filters nothing, or all, of what a transparent surface lets through.
    if (key == "tf") return all(1) || all(0);
    if (key == "map_aat" && lower_case(first) == "on") return true;  // as ever
    if (key == "sharpness") return all(60);
    return all(0);
}

/// Ka, Ks, Ni and illum 0 to 2 are of the older shading model, and every exporter writes them.
void MtlReader::other_statement(const std::string& key, std::string_view keyword,
                                std::string_view words) {
    if (key == "ka" || key == "ks" || key == "ni" || key.empty() || key.starts_with('#')) return;
    if (key == "illum") {
        const auto model = as_number(take_word(words));
        if (model == 4.0f || model == 9.0f) {
            material_.leave_out("glass", place(),
                                "illum 4 or 9, glass, is not supported and left out");
        } else if (model && (*model < 0 || *model > 2)) {
            material_.left_out.push_back(
                {*model == 3.0f ? "reflection" : "illum", place(),
                 "illum 3 to 10, reflections and refraction, are not supported and left out",
                 fmt::format("{}", *model)});
        }
        return;
    }
    if (!is_neutral(key, words)) {
        const std::string kind =
            fmt::format("{} is not supported and left out", in_quotes(keyword));
        material_.leave_out(key, place(), kind);
    }
}

void MtlReader::statement(std::string_view keyword, std::string_view words) {
    const std::string key = lower_case(keyword);
    if (!number_statement(key, words) && !map_statement(key, words)) {
        other_statement(key, keyword, words);
    }
}

/// The images of a material share its UVs.
MtlTransform MtlReader::transform(const Statements& stated) {
    const auto& normal = stated.norm ? stated.norm : stated.bump;
    const TextureStatement* first = nullptr;
    for (const auto* map : {&stated.map_kd, &normal, &stated.map_pr, &stated.map_pm, &stated.rma,
                            &stated.orm, &stated.map_d, &stated.map_ke}) {
        if (!*map) continue;
        if (!first) {
            first = &**map;
        } else if ((*map)->transform != first->transform) {
            notes_.add(
                "textures of a material differ in -s or -o; all take those of its base "
                "colour, or of the first that it has",
                (*map)->map.stated_in, "", material_count_);
        }
    }
    return first ? first->transform : MtlTransform{};
}

void MtlReader::take_maps(const Statements& stated, SourceMaterial& material) const {
    const auto map_of = [](const std::optional<TextureStatement>& statement) {
        return statement ? std::optional(statement->map) : std::nullopt;
    };
    const auto channel_of = [](const std::optional<TextureStatement>& statement, Channel channel) {
        TextureMap map = statement->map;
        map.channel = channel;
        return map;
    };
    material.maps[MapUse::base_color] = map_of(stated.map_kd);
    material.maps[MapUse::roughness] = map_of(stated.map_pr);
    material.maps[MapUse::metalness] = map_of(stated.map_pm);
    if (const auto& packed = stated.rma ? stated.rma : stated.orm) {
        const bool rma = stated.rma.has_value();
        if (!stated.map_pr)
            material.maps[MapUse::roughness] = channel_of(packed, rma ? Channel::r : Channel::g);
        if (!stated.map_pm)
            material.maps[MapUse::metalness] = channel_of(packed, rma ? Channel::g : Channel::b);
    }
    material.maps[MapUse::normal] = map_of(stated.norm);
    if (stated.norm) material.normal_scale = stated.norm->bump_scale;
    if (stated.bump) material.bump_map = BumpMap{stated.bump->map, stated.bump->bump_scale};
    material.maps[MapUse::alpha_mask] = map_of(stated.map_d);
    material.maps[MapUse::emission] = map_of(stated.map_ke);
}

void MtlReader::note_left_out(const Statements& stated) {
    const auto has = [&](const char* key) { return stated.left_out_keys.contains(key); };
    const bool opaque = stated.d.value_or(1.0f) >= 1 && stated.tr.value_or(0.0f) <= 0 &&
                        !stated.map_d && !has("tf");
    const bool metal = stated.pm.value_or(0.0f) > 0 || stated.map_pm || stated.rma || stated.orm;
    for (const Statements::LeftOut& left : stated.left_out) {
        // Blender states it of every metal.
        if (left.key == "reflection" && metal) continue;
        // Maya states glass of everything.
        if (left.key == "glass" && opaque) continue;
        // Blender states a coat's roughness without a coat, too.
        if ((left.key == "pcr" && !has("pc")) || (left.key == "anisor" && !has("aniso"))) continue;
        notes_.add(left.kind, left.place, left.word, material_count_);
    }
    // 3ds Max states the colour's image a second time.
    const auto& ambient = stated.map_ka;
    if (ambient && !(stated.map_kd && stated.map_kd->map.file == ambient->map.file)) {
        notes_.add("'map_Ka' is not supported and left out", ambient->map.stated_in, "",
                   material_count_);
    }
}

/// Of a colour: what is stated, but 1 beside a map where that is black or nothing.
glm::vec3 factor(const std::optional<glm::vec3>& stated, bool has_map, const glm::vec3& otherwise) {
    const glm::vec3 black{0.0f};
    return has_map && stated.value_or(black) == black ? glm::vec3{1.0f}
                                                      : stated.value_or(otherwise);
}

MtlMaterial MtlReader::finish(const Statements& stated) {
    MtlMaterial result;
    SourceMaterial& material = result.source;
    material.name = stated.name;
    take_maps(stated, material);
    note_left_out(stated);
    result.transform = transform(stated);
    result.states_color = stated.kd || stated.map_kd;

    material.base_color = factor(stated.kd, stated.map_kd.has_value(), material.base_color);
    material.emission = factor(stated.ke, stated.map_ke.has_value(), material.emission);
    if (stated.pr) {
        material.roughness = *stated.pr;
    } else if (stated.ns && !material.maps[MapUse::roughness]) {
        material.roughness = std::pow(2.0f / (*stated.ns + 2.0f), 0.25f);
    }
    material.metalness = stated.pm.value_or(material.maps[MapUse::metalness] ? 1.0f : 0.0f);

    // Some exporters state Tr upside down; where d is stated too, d is the one to believe. Nobody
    // means what cannot be seen: MeshLab's Tr of 1 is opaque.
    const float tr = stated.tr.value_or(0.0f);
    const float opacity = stated.d ? *stated.d : tr < 1 ? 1.0f - tr : 1.0f;
    if (opacity < 1 && !stated.map_d) {
        material.blend = true;
        material.opacity = std::clamp(opacity, 0.0f, 1.0f);
        if (transparent_count_++ == 0) {
            transparent_name_ = stated.name;
            transparent_place_ = stated.transparency_place;
        }
    }
    ++material_count_;
    return result;
}

void MtlReader::warn_at_end() const {
    if (transparent_count_ > 0) {
        const std::string others =
            transparent_count_ > 1 ? fmt::format(" and {} more", transparent_count_ - 1) : "";
        warn_(fmt::format("{}: material {}{} should be see-through but will be opaque",
                          transparent_place_, in_quotes(transparent_name_), others));
    }
    notes_.tell(warn_);
}

std::vector<MtlMaterial> MtlReader::read(const std::function<bool(std::string_view)>& wanted) {
    std::vector<MtlMaterial> materials;
    std::set<std::string, std::less<>> seen;
    bool inside = false;
    for (std::string_view rest = text_; !rest.empty();) {
        std::size_t length = 0;
        const std::string line = take_statement(rest, length);
        std::string_view words = line;
        const std::string_view keyword = take_word(words);
        if (keyword == "newmtl") {
            if (inside) materials.push_back(finish(material_));
            inside = wanted(words) && seen.emplace(words).second;
            material_ = Statements{};
            material_.name = words;
        } else if (inside) {
            statement(keyword, words);
        }
        line_ += line_number(rest, length) - 1;
        rest.remove_prefix(length);
    }
    if (inside) materials.push_back(finish(material_));
    warn_at_end();
    return materials;
}

}  // namespace

std::vector<MtlMaterial> read_mtl(const std::filesystem::path& path,
                                  const std::function<bool(std::string_view)>& wanted,
                                  FileFinder& finder, const Warn& warn) {
    const std::vector<std::byte> bytes = common::read_file(path);
    const std::string_view text =
        without_padding(without_bom({reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
    return MtlReader(path, text, finder, warn).read(wanted);
}

}  // namespace bake
