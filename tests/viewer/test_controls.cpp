// The table of keys: every key in it does what it says, and the documents say the same.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "cw2/options/controls.h"
#include "cw2/window/key_bindings.h"

namespace {

using cw2::command_of;
using cw2::CommandKind;

std::optional<CommandKind> kind_of(int key, int modifiers = 0) {
    const std::optional<cw2::Command> command = command_of(key, modifiers);
    return command ? std::optional(command->kind) : std::nullopt;
}

TEST(Controls, TheReferenceHasTheTable) {
    std::ifstream file(CW2_SOURCE_DIR "/docs/cw2.md");
    const std::string page{std::istreambuf_iterator<char>(file), {}};
    EXPECT_NE(
        page.find("| key or mouse | does |\n| --- | --- |\n" + cw2::controls_markdown() + "\n"),
        std::string::npos)
        << "docs/cw2.md should have:\n"
        << cw2::controls_markdown();
}

TEST(Controls, EveryCommandOfTheTableHasItsKeys) {
    std::set<CommandKind> with_key;
    for (int key = GLFW_KEY_SPACE; key <= GLFW_KEY_LAST; ++key) {
        for (const int modifiers : {0, GLFW_MOD_SHIFT, GLFW_MOD_CONTROL}) {
            if (const auto kind = kind_of(key, modifiers)) with_key.insert(*kind);
        }
    }
    for (const cw2::Control& control : cw2::kControls) {
        if (!control.command) continue;
        EXPECT_TRUE(with_key.contains(*control.command)) << control.input;
    }
}

TEST(Controls, KeysAreReadFromTheirNames) {
    EXPECT_EQ(kind_of(GLFW_KEY_TAB), CommandKind::toggle_panel);
    EXPECT_EQ(kind_of(GLFW_KEY_F12), CommandKind::save_picture);
    EXPECT_EQ(kind_of(GLFW_KEY_F12, GLFW_MOD_SHIFT), CommandKind::save_window);
    EXPECT_EQ(kind_of(GLFW_KEY_HOME), CommandKind::frame_scene);
    EXPECT_EQ(kind_of(GLFW_KEY_F), CommandKind::frame_scene);
    EXPECT_EQ(kind_of(GLFW_KEY_F, GLFW_MOD_SHIFT), CommandKind::frame_material);
    EXPECT_EQ(kind_of(GLFW_KEY_PAGE_DOWN), CommandKind::next_file);
    EXPECT_EQ(kind_of(GLFW_KEY_R, GLFW_MOD_CONTROL), CommandKind::reload_shaders);
    EXPECT_EQ(kind_of(GLFW_KEY_R), CommandKind::reset);
    // Without a meaning of its own Shift changes nothing; Ctrl and Alt do.
    EXPECT_EQ(kind_of(GLFW_KEY_N, GLFW_MOD_SHIFT), CommandKind::toggle_normal_map);
    EXPECT_EQ(kind_of(GLFW_KEY_N, GLFW_MOD_SHIFT | GLFW_MOD_CAPS_LOCK),
              CommandKind::toggle_normal_map);
    EXPECT_EQ(kind_of(GLFW_KEY_N, GLFW_MOD_CONTROL), std::nullopt);
    EXPECT_EQ(kind_of(GLFW_KEY_N, GLFW_MOD_ALT), std::nullopt);
    EXPECT_EQ(kind_of(GLFW_KEY_W), std::nullopt);
    EXPECT_EQ(cw2::command_of_character('?')->kind, CommandKind::toggle_help);
    EXPECT_FALSE(cw2::command_of_character('h'));
}

TEST(Controls, DigitsAreViews) {
    EXPECT_EQ(command_of(GLFW_KEY_1, 0)->view, 0u);
    EXPECT_EQ(command_of(GLFW_KEY_9, 0)->view, 8u);
    EXPECT_EQ(command_of(GLFW_KEY_1, GLFW_MOD_SHIFT)->view, 9u);
    EXPECT_EQ(command_of(GLFW_KEY_7, GLFW_MOD_SHIFT)->view, 15u);
    EXPECT_FALSE(command_of(GLFW_KEY_2, GLFW_MOD_CONTROL));
}

}  // namespace
