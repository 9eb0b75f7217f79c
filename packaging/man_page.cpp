#include "packaging/command_line.h"

namespace packaging {

namespace {

/// Text as roff prints it: a hyphen is one to copy, nothing at the start of a line is a request.
std::string roff(std::string_view text) {
    std::string result;
    bool at_start = true;
    for (const char c : text) {
        if (at_start && (c == '.' || c == '\'')) result += "\\&";
        at_start = c == '\n';
        if (c == '\\') {
            result += "\\e";
        } else if (c == '-') {
            result += "\\-";
        } else {
            result += c;
        }
    }
    return result;
}

}  // namespace

std::string man_page(const CommandLine& line, std::string_view version, std::string_view manual) {
    std::string title;
    for (const char c : line.program) title += static_cast<char>(std::toupper(c));
    const std::size_t end_of_phrase = line.description.find_first_of(":;");
    std::string phrase = line.description.substr(0, end_of_phrase);
    while (phrase.ends_with('.')) phrase.pop_back();
    phrase.front() = static_cast<char>(std::tolower(phrase.front()));

    std::string page = ".TH " + title + " 1 \"\" \"" + line.program + ' ' + std::string(version) +
                       "\" \"User Commands\"\n";
    page += ".SH NAME\n" + roff(line.program) + " \\- " + roff(phrase) + '\n';
    page += ".SH SYNOPSIS\n.B " + roff(line.program) + "\n[\\fIOPTION\\fR]...";
    for (const Option& option : line.options) {
        if (option.names.empty()) page += " \\fI" + roff(option.form) + "\\fR";
    }
    page += "\n.SH DESCRIPTION\n" + roff(line.description) + "\n.SH OPTIONS\n";
    for (const Option& option : line.options) {
        page += ".TP\n";
        for (const std::string& name : option.names) {
            page += (name == option.names.front() ? "\\fB" : ", \\fB") + roff(name) + "\\fR";
        }
        if (!option.form.empty()) {
            page += (option.names.empty() ? "\\fI" : " \\fI") + roff(option.form) + "\\fR";
        }
        page += '\n' + roff(option.description) + '\n';
    }
    if (!line.footer.empty()) {
        page += ".SH KEYS AND MOUSE\n.nf\n" + roff(line.footer) + "\n.fi\n";
    }
    return page + std::string(manual);
}

}  // namespace packaging
