#include "cw2/options/config.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>

#include "common/io.h"

namespace cw2 {

namespace {

/// The value as the command line would have it; nothing for what no option takes.
std::optional<std::string> text_of(const toml::node& node) {
    if (const auto* text = node.as_string()) return text->get();
    if (const auto* integer = node.as_integer()) return fmt::format("{}", integer->get());
    if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
    if (const auto* boolean = node.as_boolean()) return fmt::format("{}", boolean->get());
    const auto* array = node.as_array();
    if (array == nullptr) return std::nullopt;
    std::string joined;
    for (const toml::node& element : *array) {
        const std::optional<std::string> text = text_of(element);
        if (!text) return std::nullopt;
        if (&element != &array->front()) joined += ',';
        joined += *text;
    }
    return joined;
}

}  // namespace

std::vector<ConfigEntry> read_config(const std::filesystem::path& path) {
    const std::vector<std::byte> bytes = common::read_file(path);
    const auto fail = [&](const toml::source_region& place, std::string_view what) {
        throw UsageError(fmt::format("{}:{}: {}", path.string(), place.begin.line, what));
    };
    std::vector<ConfigEntry> entries;
    try {
        const toml::table table = toml::parse(
            std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
        for (const auto& [key, node] : table) {
            const std::optional<std::string> text = text_of(node);
            if (!text) {
                fail(
                    key.source(),
                    fmt::format("{}: a number, true, false, a \"string\" or an [array] is expected",
                                key.str()));
            }
            entries.push_back(
                {std::string(key.str()), *text, static_cast<int>(key.source().begin.line)});
        }
    } catch (const toml::parse_error& error) {
        fail(error.source(), error.description());
    }
    std::ranges::sort(entries, {}, &ConfigEntry::line);
    return entries;
}

}  // namespace cw2
