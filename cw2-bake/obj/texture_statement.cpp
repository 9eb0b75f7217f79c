#include "cw2-bake/obj/texture_statement.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <span>
#include <vector>

#include "cw2-bake/base/text_lines.h"
#include "cw2-bake/obj/decimal.h"

namespace bake {
namespace {

/// How many words follow an option, and those that change nothing.
struct Option {
    std::string_view name;
    std::size_t min_words;
    std::size_t max_words;  ///< beyond min_words only what reads as a number
    std::array<std::string_view, 3> neutral;
};
constexpr std::array kOptions{
    Option{"-blendu", 1, 1, {"on"}},
    Option{"-blendv", 1, 1, {"on"}},
    Option{"-bm", 1, 1, {}},
    Option{"-boost", 1, 1, {"0"}},
    Option{"-cc", 1, 1, {"off"}},
    Option{"-clamp", 1, 1, {}},
    Option{"-imfchan", 1, 1, {}},
    Option{"-mm", 2, 2, {"0", "1"}},
    Option{"-o", 1, 3, {}},
    Option{"-s", 1, 3, {}},
    Option{"-t", 1, 3, {"0", "0", "0"}},
    Option{"-texres", 1, 1, {}},
    Option{"-type", 1, 1, {}},
};

using Words = std::span<const std::string_view>;

bool is_neutral(const Option& option, Words words) {
    for (std::size_t i = 0; i < words.size(); ++i) {
        const auto value = as_number(words[i]);
        const std::string_view neutral = option.neutral[i];
        if (words[i] != neutral && !(value && value == as_number(neutral))) return false;
    }
    return true;
}

bool is_finite(std::optional<float> value) {
    return value && std::isfinite(*value);
}

/// False if a number is none.
bool read_numbers(Words words, std::span<float> values) {
    for (std::size_t i = 0; i < std::min(words.size(), values.size()); ++i) {
        const auto value = as_number(words[i]);
        if (!is_finite(value)) return false;
        values[i] = *value;
    }
    return true;
}

/// The third number is of no use to an image.
bool read_vector(Words words, glm::vec2& vector) {
    std::array values{vector.x, vector.y};
    if (!read_numbers(words, values)) return false;
    vector = {values[0], values[1]};
    return true;
}

/// False if the option is not honoured.
bool apply(const Option& option, Words words, TextureStatement& statement) {
    if (option.name == "-bm") return read_numbers(words, {&statement.bump_scale, 1});
    if (option.name == "-s") return read_vector(words, statement.transform.scale);
    if (option.name == "-o") return read_vector(words, statement.transform.offset);
    if (option.name == "-clamp") {
        statement.map.clamp = lower_case(words[0]) == "on";
        return true;
    }
    if (option.name == "-imfchan") {
        constexpr std::string_view kLetters = "rgbml";
        constexpr std::array kChannels{Channel::r, Channel::g, Channel::b, Channel::alpha,
                                       Channel::luminance};
        const std::size_t i = words[0].size() == 1 ? kLetters.find(words[0][0]) : kLetters.npos;
        if (i == kLetters.npos) return false;
        statement.map.channel = kChannels[i];
        return true;
    }
    return is_neutral(option, words);
}

}  // namespace

std::optional<float> as_number(std::string_view word) {
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
    float value = 0;
    const char* end = word.data() + word.size();
    if (read_decimal(word.data(), end, value) != end) return std::nullopt;
    return value + 0.0f;
}

std::string lower_case(std::string_view text) {
    std::string result(text);
    std::ranges::transform(result, result.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return result;
}

std::optional<TextureStatement> parse_texture(
    std::string_view words, const std::filesystem::path& folder, FileFinder& finder,
    const std::function<void(const std::string& option)>& left_out) {
    TextureStatement statement;
    words = trimmed(words);
    while (words.starts_with('-')) {
        std::string_view after = words;
        const std::string name = lower_case(take_word(after));
        const auto known = std::ranges::find(kOptions, name, &Option::name);
        if (known == kOptions.end()) break;
        std::vector<std::string_view> values;
        while (values.size() < known->max_words && !after.empty()) {
            std::string_view behind = after;
            const std::string_view word = take_word(behind);
            const bool is_path = behind.empty() || !as_number(word);
            if (values.size() >= known->min_words && is_path) break;
            values.push_back(word);
            after = behind;
        }
        words = after;
        if (values.size() < known->min_words) break;
        if (!apply(*known, values, statement)) {
            left_out(name == "-imfchan" ? fmt::format("-imfchan {}", values[0]) : name);
        }
    }
    words = without_quotes(words);
    if (words.empty()) return std::nullopt;
    const std::vector<std::string> readings = readings_of(words);
    const FoundFile found = finder.find(folder, readings);
    statement.map.file = found.file;
    statement.is_outside = found.is_outside;
    if (!found.note.empty()) {
        statement.map.note =
            fmt::format("{}: no such file; {}", (folder / readings[0]).string(), found.note);
    }
    return statement;
}

}  // namespace bake
