// What there is to say of a program's command line, whatever the form it is said in.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace packaging {

struct Option {
    std::vector<std::string> names;  ///< with their dashes, the short ones first; none: positional
    std::string form;                ///< of its value; empty: it takes none
    std::string description;
    std::vector<std::string> choices;  ///< the words that its value may be, if it is one of some
    bool is_file = false;              ///< its value is the path of a file
    /// The option that prints its possible values at the start of lines; may be empty.
    std::string list_option;
};

struct CommandLine {
    std::string program;
    std::string description;
    std::string footer;
    std::vector<Option> options;  ///< in the order of --help
};

/// What CLI11 knows, and what the forms of values tell: "a|b" are choices, "FILE.png" is a file;
/// and the values of --NAME are what --list-NAMEs prints.
CommandLine describe(const CLI::App& app);

/// The page of section 1, in roff's macros `man`; `manual` is the text of the sections that follow
/// the options, in the same.
std::string man_page(const CommandLine& line, std::string_view version, std::string_view manual);

std::string bash_completion(const CommandLine& line);
std::string fish_completion(const CommandLine& line);
std::string zsh_completion(const CommandLine& line);

}  // namespace packaging
