#include "cw2-bake/obj/read_mtl.h"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <set>

#include "common/io.h"
#include "cw2-bake/base/text_lines.h"

namespace bake {
namespace {

using mesh_format::MapUse;

/// An option of a texture statement: how many words follow it, and the number that changes nothing.
struct Option {
    std::string_view name;
    int min_words;
    int max_words;  ///< beyond min_words only what reads as a number
    std::string_view neutral;
};
constexpr std::array kOptions{
    Option{"-blendu", 1, 1, "on"}, Option{"-blendv", 1, 1, "on"}, Option{"-bm", 1, 1, "1"},
    Option{"-boost", 1, 1, ""},    Option{"-cc", 1, 1, "off"},    Option{"-clamp", 1, 1, ""},
    Option{"-imfchan", 1, 1, ""},  Option{"-mm", 2, 2, ""},       Option{"-o", 1, 3, "0"},
    Option{"-s", 1, 3, "1"},       Option{"-t", 1, 3, "0"},       Option{"-texres", 1, 1, ""},
    Option{"-type", 1, 1, ""},
};

std::optional<float> as_number(std::string_view word) {
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
    float value = 0;
    const char* end = word.data() + word.size();
    const auto result = fast_float::from_chars(word.data(), end, value);
    if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
    return value + 0.0f;
}

bool is_neutral(const Option& option, std::string_view word) {
    if (word == option.neutral) return true;
    const auto value = as_number(word);
    return value && value == as_number(option.neutral);
}

std::string lower(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return result;
}

/// What one material states.
struct Statements {
    std::string name;
    std::optional<glm::vec3> kd;
    std::optional<float> pr, ns, pm, d, tr;
    std::optional<TextureMap> map_kd, map_pr, map_pm, map_d, norm;
    std::optional<BumpMap> bump;
    std::string transparency_place;
};

class MtlReader {
 public:
    MtlReader(const std::filesystem::path& path, std::string_view text, const Warn& warn)
        : path_(path), text_(text), warn_(warn) {}

    std::vector<SourceMaterial> read(const std::function<bool(std::string_view)>& wanted);

 private:
    void statement(std::string_view keyword, std::string_view words);
    glm::vec3 color(std::string_view words);
    float number(std::string_view& words);
    float unit(std::string_view words, std::string_view keyword);
    float in_unit(float value, std::string_view keyword);
    std::optional<TextureMap> texture(std::string_view words, float* bump_scale);
    void option(const Option& option, std::span<const std::string_view> words, TextureMap& map,
                float* bump_scale);
    void leave_out(std::string_view option);
    SourceMaterial finish(const Statements& material);
    void warn_at_end() const;
    std::string place() const { return fmt::format("{}:{}", path_.string(), line_); }

    const std::filesystem::path& path_;
    std::string_view text_;
    const Warn& warn_;
    std::size_t line_ = 1;  // of the statement at hand
    Statements material_;
    std::set<std::string, std::less<>> left_out_options_;
    std::string left_out_place_;
    std::string transparent_name_, transparent_place_;
    int transparent_count_ = 0;
};

float MtlReader::number(std::string_view& words) {
    const std::string_view word = take_word(words);
    const auto value = as_number(word);
    if (word.empty()) throw BakeError(place() + ": a number is missing");
    if (!value) throw BakeError(fmt::format("{}: {} is not a number", place(), in_quotes(word)));
    if (!std::isfinite(*value)) {
        throw BakeError(fmt::format("{}: {} is not a finite number", place(), in_quotes(word)));
    }
    return *value;
}

float MtlReader::in_unit(float value, std::string_view keyword) {
    if (value >= 0 && value <= 1) return value;
    const float clamped = std::clamp(value, 0.0f, 1.0f);
    warn_(fmt::format("{}: {} {} is outside 0 to 1; {} is used", place(), keyword, value, clamped));
    return clamped;
}

float MtlReader::unit(std::string_view words, std::string_view keyword) {
    return in_unit(number(words), keyword);
}

glm::vec3 MtlReader::color(std::string_view words) {
    glm::vec3 value{number(words)};
    if (!words.empty() && !words.starts_with('#')) {
        value.y = number(words);
        value.z = number(words);
    }
    for (int i = 0; i < 3; ++i) value[i] = in_unit(value[i], "Kd");
    return value;
}

void MtlReader::leave_out(std::string_view option) {
    if (left_out_options_.empty()) left_out_place_ = place();
    left_out_options_.emplace(option);
}

void MtlReader::option(const Option& option, std::span<const std::string_view> words,
                       TextureMap& map, float* bump_scale) {
    if (option.name == "-bm" && bump_scale) {
        std::string_view word = words[0];
        *bump_scale = number(word);
    } else if (option.name == "-clamp") {
        map.clamp = words[0] == "on";
    } else if (option.name == "-imfchan") {
        constexpr std::string_view kLetters = "rgbml";
        constexpr std::array kChannels{Channel::r, Channel::g, Channel::b, Channel::alpha,
                                       Channel::luminance};
        const std::size_t i = words[0].size() == 1 ? kLetters.find(words[0][0]) : kLetters.npos;
        if (i == kLetters.npos) return leave_out(fmt::format("-imfchan {}", words[0]));
        map.channel = kChannels[i];
    } else if (!std::all_of(words.begin(), words.end(),
                            [&](std::string_view word) { return is_neutral(option, word); })) {
        leave_out(option.name);
    }
}

/// Options, then the path: the rest of the line. `bump_scale` is null where -bm means nothing.
std::optional<TextureMap> MtlReader::texture(std::string_view words, float* bump_scale) {
    TextureMap map;
    map.stated_in = place();
    words = trimmed(words);
    while (words.starts_with('-')) {
        std::string_view after = words;
        const std::string name = lower(take_word(after));
        const auto known = std::find_if(kOptions.begin(), kOptions.end(),
                                        [&](const Option& option) { return option.name == name; });
        if (known == kOptions.end()) break;
        std::vector<std::string_view> values;
        for (int i = 0; i < known->max_words && !after.empty(); ++i) {
            std::string_view behind = after;
            const std::string_view word = take_word(behind);
            const bool path = behind.empty() || !as_number(word);
            if (i >= known->min_words && path) break;
            values.push_back(word);
            after = behind;
        }
        words = after;
        if (static_cast<int>(values.size()) < known->min_words) break;
        option(*known, values, map, bump_scale);
    }
    if (words.size() > 2 && words.front() == '"' && words.back() == '"') {
        words = trimmed(words.substr(1, words.size() - 2));
    }
    if (words.empty()) {
        warn_(place() + ": no image is named");
        return std::nullopt;
    }
    std::string name(words);
    std::replace(name.begin(), name.end(), '\\', '/');
    map.file = path_.parent_path() / name;
    return map;
}

void MtlReader::statement(std::string_view keyword, std::string_view words) {
    const std::string key = lower(keyword);
    if (key == "kd") {
        if (words.starts_with("spectral") || words.starts_with("xyz")) {
            return warn_(fmt::format("{}: only RGB colours are read; Kd is left out", place()));
        }
        material_.kd = color(words);
    } else if (key == "pr") {
        material_.pr = unit(words, "Pr");
    } else if (key == "pm") {
        material_.pm = unit(words, "Pm");
    } else if (key == "ns") {
        material_.ns = std::max(number(words), 0.0f);
    } else if (key == "d" || key == "tr") {
        std::string_view rest = words;
        if (take_word(rest) == "-halo") words = rest;
        (key == "d" ? material_.d : material_.tr) = number(words);
        material_.transparency_place = place();
    } else if (key == "map_kd") {
        material_.map_kd = texture(words, nullptr);
    } else if (key == "map_pr") {
        material_.map_pr = texture(words, nullptr);
    } else if (key == "map_pm") {
        material_.map_pm = texture(words, nullptr);
    } else if (key == "map_d") {
        material_.map_d = texture(words, nullptr);
    } else if (key == "norm") {
        material_.norm = texture(words, nullptr);
    } else if (key == "map_bump" || key == "bump") {
        float scale = 1;
        const auto map = texture(words, &scale);
        if (map) material_.bump = BumpMap{*map, scale};
    }
}

SourceMaterial MtlReader::finish(const Statements& stated) {
    SourceMaterial material;
    material.name = stated.name;
    material.maps[MapUse::base_color] = stated.map_kd;
    material.maps[MapUse::roughness] = stated.map_pr;
    material.maps[MapUse::metalness] = stated.map_pm;
    material.maps[MapUse::normal] = stated.norm;
    material.maps[MapUse::alpha_mask] = stated.map_d;
    material.bump_map = stated.bump;

    if (stated.map_kd) {
        const bool black = stated.kd == glm::vec3{0.0f};
        material.base_color = stated.kd && !black ? *stated.kd : glm::vec3{1.0f};
    } else if (stated.kd) {
        material.base_color = *stated.kd;
    }
    if (stated.pr) {
        material.roughness = *stated.pr;
    } else if (stated.ns && !stated.map_pr) {
        material.roughness = std::pow(2.0f / (*stated.ns + 2.0f), 0.25f);
    }
    material.metalness = stated.pm.value_or(stated.map_pm ? 1.0f : 0.0f);

    // Some exporters state Tr upside down; where d is stated too, d is the one to believe.
    const float opacity = stated.d ? *stated.d : 1.0f - stated.tr.value_or(0.0f);
    if (opacity < 1 && !stated.map_d && transparent_count_++ == 0) {
        transparent_name_ = stated.name;
        transparent_place_ = stated.transparency_place;
    }
    return material;
}

void MtlReader::warn_at_end() const {
    if (transparent_count_ > 0) {
        const std::string others =
            transparent_count_ > 1 ? fmt::format(" and {} more", transparent_count_ - 1) : "";
        warn_(fmt::format("{}: material {}{} should be see-through but will be opaque",
                          transparent_place_, in_quotes(transparent_name_), others));
    }
    if (!left_out_options_.empty()) {
        warn_(fmt::format("{}: texture options that have no effect here: {}", left_out_place_,
                          fmt::join(left_out_options_, ", ")));
    }
}

std::vector<SourceMaterial> MtlReader::read(const std::function<bool(std::string_view)>& wanted) {
    std::vector<SourceMaterial> materials;
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

std::vector<SourceMaterial> read_mtl(const std::filesystem::path& path,
                                     const std::function<bool(std::string_view)>& wanted,
                                     const Warn& warn) {
    const common::MappedFile file(path);
    const std::string_view text =
        without_bom({reinterpret_cast<const char*>(file.bytes().data()), file.bytes().size()});
    return MtlReader(path, text, warn).read(wanted);
}

}  // namespace bake
