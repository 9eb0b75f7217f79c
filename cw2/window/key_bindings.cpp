#include "cw2/window/key_bindings.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <array>
#include <string_view>
#include <utility>
#include <vector>

namespace cw2 {

const int kLightKey = GLFW_KEY_L;

namespace {

struct Binding {
    int key;  ///< 0: `character` is what counts
    int modifiers;
    Command command;
    unsigned int character = 0;
};

bool take(std::string_view& text, std::string_view what) {
    if (!text.starts_with(what)) return false;
    text.remove_prefix(what.size());
    return true;
}

/// The key of a name in the table of controls; 0 for a character that is no key's name.
int key_named(std::string_view name) {
    constexpr std::array<std::pair<std::string_view, int>, 6> kNames{
        {{"Tab", GLFW_KEY_TAB},
         {"Space", GLFW_KEY_SPACE},
         {"Escape", GLFW_KEY_ESCAPE},
         {"Home", GLFW_KEY_HOME},
         {"Page up", GLFW_KEY_PAGE_UP},
         {"Page down", GLFW_KEY_PAGE_DOWN}}};
    for (const auto& [known, key] : kNames) {
        if (name == known) return key;
    }
    if (name.size() == 1 && name[0] >= 'A' && name[0] <= 'Z') return GLFW_KEY_A + (name[0] - 'A');
    if (name.size() == 1) return 0;
    int number = 0;
    for (const char digit : name.substr(1)) number = 10 * number + (digit - '0');
    return GLFW_KEY_F1 + number - 1;
}

/// Adds what one of a control's keys does.
void add(std::string_view key, CommandKind kind, std::vector<Binding>& bindings) {
    int modifiers = 0;
    if (take(key, "Ctrl+")) modifiers |= GLFW_MOD_CONTROL;
    if (take(key, "Shift+")) modifiers |= GLFW_MOD_SHIFT;
    if (key == "1 to 9") {
        const View first = modifiers & GLFW_MOD_SHIFT ? 9 : 0;
        for (View i = 0; i < 9 && first + i < interop::kViewCount; ++i) {
            bindings.push_back({GLFW_KEY_1 + static_cast<int>(i), modifiers, {kind, first + i}});
        }
        return;
    }
    const std::string_view name = key.substr(0, key.find(" in the panel"));
    bindings.push_back({.key = key_named(name), .modifiers = modifiers, .command = {kind}});
    if (bindings.back().key == 0) bindings.back().character = static_cast<unsigned char>(name[0]);
}

std::vector<Binding> all_bindings() {
    std::vector<Binding> bindings;
    for (const Control& control : kControls) {
        if (!control.command) continue;
        std::string_view rest = control.input;
        while (!rest.empty()) {
            const std::string_view key = rest.substr(0, rest.find(", "));
            add(key, *control.command, bindings);
            rest.remove_prefix(key.size());
            take(rest, ", ");
        }
    }
    return bindings;
}

const std::vector<Binding>& bindings() {
    static const std::vector<Binding> kBindings = all_bindings();
    return kBindings;
}

}  // namespace

std::optional<Command> command_of(int key, int modifiers) {
    constexpr int kOurs = GLFW_MOD_SHIFT | GLFW_MOD_CONTROL | GLFW_MOD_ALT | GLFW_MOD_SUPER;
    for (const int held : {modifiers & kOurs, modifiers & kOurs & ~GLFW_MOD_SHIFT}) {
        for (const Binding& binding : bindings()) {
            if (binding.key == key && binding.modifiers == held) return binding.command;
        }
    }
    return std::nullopt;
}

std::optional<Command> command_of_character(unsigned int character) {
    for (const Binding& binding : bindings()) {
        if (binding.key == 0 && binding.character == character) return binding.command;
    }
    return std::nullopt;
}

}  // namespace cw2
