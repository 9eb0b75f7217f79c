#include <fmt/format.h>

#include <map>

#include "packaging/command_line.h"

namespace packaging {

namespace {

/// `text` with a backslash before each of `special`.
std::string escaped(std::string_view text, std::string_view special) {
    std::string result;
    for (const char c : text) {
        if (special.find(c) != special.npos) result += '\\';
        result += c;
    }
    return result;
}

/// Between apostrophes, in any shell.
std::string in_apostrophes(std::string_view text) {
    std::string result = "'";
    for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + '\'';
}

/// A command that prints the values that an option may have.
std::string list_command(const CommandLine& line, const Option& option) {
    return fmt::format("{} {} 2>/dev/null", line.program, option.list_option);
}

std::string header(const CommandLine& line) {
    return fmt::format("# Completes {}; made from its options.\n", line.program);
}

/// What bash does for the value of the option.
std::string bash_reply(const CommandLine& line, const Option& option) {
    std::string text;
    std::string values = fmt::format("{}", fmt::join(option.choices, " "));
    if (!option.list_option.empty())
        values = fmt::format("$({} | sed 's|[: ].*||')", list_command(line, option));
    if (!values.empty())
        text += fmt::format("            COMPREPLY=($(compgen -W \"{}\" -- \"$word\"))\n", values);
    // With no reply bash goes on to the names of files.
    if (!option.is_file) text += "            compopt +o default\n";
    return text + "            return ;;\n";
}

constexpr std::string_view kBash = R"({header}_{program}() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}}
    if [[ $word == "=" ]]; then
        word=
    elif [[ $previous == "=" ]]; then
        previous=${{COMP_WORDS[COMP_CWORD - 2]}}
    fi
    case $previous in
{cases}    esac
    if [[ $word == -* ]]; then
        COMPREPLY=($(compgen -W "{names}" -- "$word"))
    fi
}}
complete -o default -F _{program} {program}
)";

std::string zsh_action(const CommandLine& line, const Option& option) {
    if (!option.list_option.empty())
        return fmt::format("{{compadd -- $({} | sed 's|[: ].*||')}}", list_command(line, option));
    if (!option.choices.empty()) return fmt::format("({})", fmt::join(option.choices, " "));
    return option.is_file ? "_files" : "";
}

}  // namespace

std::string bash_completion(const CommandLine& line) {
    std::vector<std::string> names;
    std::map<std::string, std::vector<std::string>> replies;  // and the options that have them
    for (const Option& option : line.options) {
        names.insert(names.end(), option.names.begin(), option.names.end());
        if (option.form.empty()) continue;
        auto& same = replies[bash_reply(line, option)];
        same.insert(same.end(), option.names.begin(), option.names.end());
    }
    std::string cases;
    for (const auto& [reply, of] : replies) {
        if (!of.empty()) cases += fmt::format("        {})\n{}", fmt::join(of, "|"), reply);
    }
    return fmt::format(kBash, fmt::arg("header", header(line)), fmt::arg("program", line.program),
                       fmt::arg("cases", cases), fmt::arg("names", fmt::join(names, " ")));
}

std::string fish_completion(const CommandLine& line) {
    std::string text = header(line);
    for (const Option& option : line.options) {
        if (option.names.empty()) continue;
        text += fmt::format("complete -c {}", line.program);
        for (const std::string& name : option.names) {
            const bool is_long = name.starts_with("--");
            text += fmt::format(" -{} {}", is_long ? 'l' : 's', name.substr(is_long ? 2 : 1));
        }
        if (!option.form.empty()) text += option.is_file ? " -r -F" : " -x";
        std::string values = fmt::format("{}", fmt::join(option.choices, " "));
        if (!option.list_option.empty())
            values =
                fmt::format(R"(({} | string replace -r ':?\s+' \t))", list_command(line, option));
        if (!values.empty()) text += fmt::format(" -a {}", in_apostrophes(values));
        text += fmt::format(" -d {}\n", in_apostrophes(option.description));
    }
    return text;
}

std::string zsh_completion(const CommandLine& line) {
    std::string text = fmt::format("#compdef {}\n{}_arguments -s", line.program, header(line));
    for (const Option& option : line.options) {
        text += " \\\n    ";
        if (option.names.empty()) {
            text += in_apostrophes(fmt::format("*:{}:_files", option.form));
            continue;
        }
        if (option.names.size() > 1) {
            text += fmt::format("'({})'{{{}}}", fmt::join(option.names, " "),
                                fmt::join(option.names, ","));
        } else {
            text += option.names.front();
        }
        std::string rest = fmt::format("[{}]", escaped(option.description, "[]"));
        if (!option.form.empty())
            rest += fmt::format(":{}:{}", escaped(option.form, ":"), zsh_action(line, option));
        text += in_apostrophes(rest);
    }
    return text + '\n';
}

}  // namespace packaging
