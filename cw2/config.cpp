#include "cw2/config.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "mesh-format/io.h"

namespace cw2 {

namespace {

bool is_bare(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_';
}

void append_utf8(std::string& text, std::uint32_t code) {
    if (code < 0x80) {
        text += static_cast<char>(code);
        return;
    }
    const int continuations = code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
    constexpr unsigned kLead[] = {0, 0xC0, 0xE0, 0xF0};
    text += static_cast<char>(kLead[continuations] | code >> (6 * continuations));
    for (int i = continuations - 1; i >= 0; --i) {
        text += static_cast<char>(0x80 | ((code >> (6 * i)) & 0x3F));
    }
}

class Reader {
 public:
    Reader(std::string name, std::string_view text) : name_(std::move(name)), rest_(text) {}

    std::vector<ConfigEntry> entries() {
        std::vector<ConfigEntry> entries;
        for (skip_blank_lines(); !rest_.empty(); skip_blank_lines()) {
            ConfigEntry entry = next_entry();
            const auto has_its_key = [&](const ConfigEntry& other) {
                return other.key == entry.key;
            };
            if (std::any_of(entries.begin(), entries.end(), has_its_key)) {
                fail(fmt::format("'{}' is there a second time", entry.key));
            }
            entries.push_back(std::move(entry));
            skip_spaces();
            skip_comment();
            if (!rest_.empty() && rest_.front() != '\n') fail("the line goes on after its value");
        }
        return entries;
    }

 private:
    [[noreturn]] void fail(const std::string& what) const {
        throw UsageError(fmt::format("{}:{}: {}", name_, line_, what));
    }

    char take() {
        const char c = rest_.front();
        rest_.remove_prefix(1);
        if (c == '\n') ++line_;
        return c;
    }
    bool take_if(char c) {
        if (rest_.empty() || rest_.front() != c) return false;
        take();
        return true;
    }
    void skip_spaces() {
        while (take_if(' ') || take_if('\t') || take_if('\r')) {
        }
    }
    void skip_comment() {
        if (!rest_.starts_with('#')) return;
        while (!rest_.empty() && rest_.front() != '\n') take();
    }
    void skip_blank_lines() {
        do {
            skip_spaces();
            skip_comment();
        } while (take_if('\n'));
    }
    std::string take_bare(std::string_view more) {
        std::string text;
        while (!rest_.empty() &&
               (is_bare(rest_.front()) || more.find(rest_.front()) != std::string_view::npos)) {
            text += take();
        }
        return text;
    }

    ConfigEntry next_entry() {
        if (rest_.front() == '[') fail("tables have no meaning here");
        ConfigEntry entry{take_bare(""), {}, line_};
        if (entry.key.empty()) fail("a key is expected, the name of an option without its dashes");
        skip_spaces();
        if (!take_if('=')) fail(fmt::format("'=' is expected after '{}'", entry.key));
        skip_spaces();
        entry.value = take_if('[') ? array_of(entry.key) : value_of(entry.key);
        return entry;
    }

    std::string array_of(const std::string& key) {
        std::string joined;
        for (bool is_first = true;; is_first = false) {
            skip_blank_lines();
            if (take_if(']')) return joined;
            if (!is_first) joined += ',';
            joined += value_of(key);
            skip_blank_lines();
            if (!take_if(',') && !rest_.starts_with(']')) fail(key + ": the array does not end");
        }
    }

    std::string value_of(const std::string& key) {
        if (take_if('"')) return basic_string(key);
        if (take_if('\'')) return literal_string(key);
        const std::string text = take_bare("+.");
        const bool is_number = text.find_first_of("0123456789") != std::string::npos &&
                               text.find_first_not_of("0123456789+-.eE_") == std::string::npos;
        if (!is_number && text != "true" && text != "false") {
            fail(fmt::format("{}: a number, true, false, a \"string\" or an [array] is expected",
                             key));
        }
        return text;
    }

    char take_in_string(const std::string& key) {
        if (rest_.empty() || rest_.front() == '\n') fail(key + ": the string does not end");
        return take();
    }

    std::string literal_string(const std::string& key) {
        std::string text;
        while (!take_if('\'')) text += take_in_string(key);
        return text;
    }

    std::string basic_string(const std::string& key) {
        std::string text;
        while (!take_if('"')) {
            const char c = take_in_string(key);
            if (c != '\\') {
                text += c;
                continue;
            }
            const char escape = take_in_string(key);
            constexpr std::string_view kEscapes = "btnfr\"\\", kMeanings = "\b\t\n\f\r\"\\";
            if (const auto at = kEscapes.find(escape); at != std::string_view::npos) {
                text += kMeanings[at];
            } else if (escape == 'u' || escape == 'U') {
                append_utf8(text, code_point(key, escape == 'u' ? 4 : 8));
            } else {
                fail(fmt::format("{}: '\\{}' is no escape", key, escape));
            }
        }
        return text;
    }

    std::uint32_t code_point(const std::string& key, int digits) {
        std::uint32_t code = 0;
        for (int i = 0; i < digits; ++i) {
            constexpr std::string_view kDigits = "0123456789abcdef0123456789ABCDEF";
            const auto digit = kDigits.find(take_in_string(key));
            if (digit == std::string_view::npos) {
                fail(fmt::format("{}: {} hexadecimal digits are expected", key, digits));
            }
            code = code << 4 | static_cast<std::uint32_t>(digit % 16);
        }
        if (code > 0x10FFFF || (code >= 0xD800 && code < 0xE000)) {
            fail(fmt::format("{}: U+{:X} is no character", key, code));
        }
        return code;
    }

    std::string name_;
    std::string_view rest_;
    int line_ = 1;
};

}  // namespace

std::vector<ConfigEntry> read_config(const std::filesystem::path& path) {
    const mesh_format::MappedFile file(path);
    const std::span<const std::byte> bytes = file.bytes();
    return Reader(path.string(), {reinterpret_cast<const char*>(bytes.data()), bytes.size()})
        .entries();
}

std::string toml_string(std::string_view text) {
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') {
            quoted += '\\';
            quoted += c;
        } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
            quoted += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
        } else {
            quoted += c;
        }
    }
    return quoted + '"';
}

}  // namespace cw2
