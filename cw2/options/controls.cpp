#include "cw2/options/controls.h"

#include <fmt/format.h>

namespace cw2 {

std::string controls_text() {
    std::string text = "In the window:\n";
    for (const Control& control : kControls) {
        text += fmt::format("  {:<30}{}\n", control.input, control.does);
    }
    return text;
}

std::string controls_markdown() {
    std::string text;
    for (const Control& control : kControls) {
        text += fmt::format("| {} | {} |\n", control.input, control.does);
    }
    return text;
}

}  // namespace cw2
