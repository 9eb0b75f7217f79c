#include "packaging/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>

namespace packaging {

namespace {

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts(1);
    for (const char c : text) {
        if (c == separator) {
            parts.emplace_back();
        } else {
            parts.back() += c;
        }
    }
    return parts;
}

/// A word that is meant as it is written; what stands for something is in capitals, or a range.
bool is_literal(const std::string& word) {
    return !word.empty() && std::ranges::none_of(word, [](unsigned char c) {
        return std::isupper(c) || c == '.' || c == ',';
    });
}

Option describe(const CLI::Option& option) {
    Option result;
    for (const std::string& name : option.get_snames()) result.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) result.names.push_back("--" + name);
    result.description = option.get_description();
    if (option.get_items_expected_max() == 0) return result;
    result.form = option.get_type_name();
    for (const std::string& part : split(result.form, '|')) {
        if (part.starts_with("FILE")) {
            result.is_file = true;
        } else if (is_literal(part)) {
            result.choices.push_back(part);
        }
    }
    return result;
}

}  // namespace

CommandLine describe(const CLI::App& app) {
    CommandLine line{app.get_name(), app.get_description(), app.get_footer(), {}};
    for (const CLI::Option* option : app.get_options()) {
        line.options.push_back(describe(*option));
        Option& described = line.options.back();
        if (option->get_positional()) {
            described.form = option->get_name(true);
            described.names.clear();
            described.is_file = true;
        } else {
            const std::string list = "--list-" + described.names.back().substr(2) + "s";
            if (app.get_option_no_throw(list)) described.list_option = list;
        }
    }
    return line;
}

}  // namespace packaging
