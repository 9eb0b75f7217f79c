// The panel under a mouse that does anything: what it makes of the options is always valid, and
// there is nothing that it cannot change.
#include <gtest/gtest.h>
#include <imgui.h>

#include <random>
#include <set>
#include <sstream>
#include <string>

#include "cw2/options/frame_of.h"
#include "cw2/window/panel.h"
#include "tests/support/temporary_folder.h"

namespace {

using namespace cw2;

constexpr Bounds kBounds{{1.0f, 2.0f, 3.0f}, 4.0f};

class Panel : public testing::Test {
 protected:
    Panel() {
        ImGui::CreateContext();
        ImGuiIO& io = ImGui::GetIO();
        io.IniFilename = nullptr;
        io.DisplaySize = {1100.0f, 840.0f};
        io.DeltaTime = 1.0f / 60.0f;
        unsigned char* pixels = nullptr;
        int width = 0, height = 0;
        io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
        state_.options.scene = "scene.cw2mesh";
        state_.options.samples = 1;
        state_.options.camera_position = glm::vec3(5.0f);
        state_.options.camera_target = kBounds.center;
        state_.options.vertical_fov = kVerticalFov;
        state_.options.light_position = glm::vec3(2.0f, 9.0f, 1.0f);
        state_.options.light_color = glm::vec3(1.0f);
    }
    ~Panel() override { ImGui::DestroyContext(); }

    std::vector<Command> frame() {
        ImGui::NewFrame();
        std::vector<Command> commands = draw_panel(facts_, state_);
        ImGui::Render();
        return commands;
    }

    PanelFacts facts_{.device = "a device",
                      .bounds = kBounds,
                      .extent = {1000, 800},
                      .triangles = 1234567,
                      .scene_bytes = 1u << 24,
                      .image_bytes = 1u << 22,
                      .message = "",
                      .message_is_error = false,
                      .scale = 1.0f};
    PanelState state_{{}, false};
};

/// The names of what differs.
void note_changes(const PanelState& before, const PanelState& after, std::set<std::string>& names) {
    const Options &a = before.options, &b = after.options;
    const auto note = [&](const char* name, bool differs) {
        if (differs) names.insert(name);
    };
    note("view", a.view != b.view);
    note("split", a.split.has_value() != b.split.has_value());
    note("sides", a.split && b.split && *a.split != *b.split);
    note("divider", a.divider != b.divider);
    note("exposure", a.exposure != b.exposure);
    note("false colours", a.false_color.has_value() != b.false_color.has_value());
    note("range", a.false_color && b.false_color && *a.false_color != *b.false_color);
    note("samples", a.samples != b.samples);
    note("fov", a.vertical_fov != b.vertical_fov);
    note("light", a.light_position != b.light_position);
    note("light colour", a.light_color != b.light_color);
    note("ambient", a.ambient != b.ambient);
    note("background", a.background != b.background);
    note("time", a.time != b.time);
    note("orbit", before.light_moves != after.light_moves);
    note("roughness", a.roughness != b.roughness);
    note("metalness", a.metalness != b.metalness);
    note("normal strength", a.normal_strength != b.normal_strength);
    note("normal maps", a.normal_map != b.normal_map);
    note("alpha masks", a.alpha_mask != b.alpha_mask);
    note("two-sided", a.two_sided != b.two_sided);
    note("orbit's axis", a.orbit_axis != b.orbit_axis);
}

/// What a config file makes of the options.
Options saved_and_read(const TemporaryFolder& folder, const Options& options) {
    const std::string path = folder / "panel.toml";
    write_config(path, options);
    const char* const arguments[] = {"cw2", "--config", path.c_str()};
    return parse_options(3, arguments).value();
}

TEST_F(Panel, NoClickOrDragMakesAnythingThatCannotBeSavedAndDrawn) {
    const TemporaryFolder folder;
    std::mt19937 random(3);
    std::set<std::string> changed;
    std::set<CommandKind> commanded;
    ImGuiIO& io = ImGui::GetIO();
    // The title bar is left alone: what is closed or moved away cannot be clicked.
    io.ConfigWindowsMoveFromTitleBarOnly = true;
    int held = 0;
    for (int i = 0; i < 60000; ++i) {
        const PanelState before = state_;
        io.MouseDown[0] = held > 0;
        if (held-- > 0) {
            if (held % 2 == 0 && random() % 2 == 0) {
                io.MousePos.x += static_cast<float>(random() % 61) - 30.0f;
            }
        } else if (held < -1) {
            // A frame lies between arriving somewhere and pressing there. Half the time that is the
            // column of the check boxes, which are small.
            io.MousePos = {
                static_cast<float>(random() % 2 == 0 ? 92 + random() % 24 : 10 + random() % 300),
                static_cast<float>(32 + random() % 760)};
            held = static_cast<int>(1 + random() % 6);
            io.MouseDown[0] = false;
        }
        for (const Command& command : frame()) commanded.insert(command.kind);
        note_changes(before, state_, changed);
        if (state_.options == before.options) continue;
        ASSERT_NO_THROW(frame_settings(state_.options, kBounds, 1.5f));
        if (i % 10 == 0) {
            ASSERT_TRUE(saved_and_read(folder, state_.options) == state_.options);
        }
    }
    const std::set<std::string> all{
        "view",        "split",       "sides",     "divider",     "exposure",     "false colours",
        "range",       "samples",     "fov",       "light",       "light colour", "ambient",
        "background",  "time",        "orbit",     "roughness",   "metalness",    "normal strength",
        "normal maps", "alpha masks", "two-sided", "orbit's axis"};
    EXPECT_EQ(changed, all);
    for (const CommandKind kind :
         {CommandKind::save_settings, CommandKind::save_picture, CommandKind::reload_shaders,
          CommandKind::copy_camera, CommandKind::reset, CommandKind::open, CommandKind::frame_scene,
          CommandKind::toggle_help}) {
        EXPECT_TRUE(commanded.contains(kind)) << static_cast<int>(kind);
    }
}

TEST_F(Panel, WithoutTheMouseItChangesNothing) {
    const PanelState before = state_;
    for (int i = 0; i < 10; ++i) EXPECT_TRUE(frame().empty());
    EXPECT_TRUE(state_.options == before.options);
    EXPECT_EQ(state_.light_moves, before.light_moves);
}

TEST(CameraFlags, AreReadAsTheSameCameraAndLight) {
    Options options;
    options.camera_position = glm::vec3(-0.1f, 1.0f / 3.0f, -1e-7f);
    options.camera_target = glm::vec3(12345.678f, -2.0f, 3.0f);
    options.vertical_fov = 33.3f;
    options.light_position = glm::vec3(-7.7f, 1e-3f, 0.3f);
    options.time = 0.1;
    std::vector<std::string> words{"cw2", "scene.cw2mesh"};
    std::istringstream flags(camera_flags(options));
    for (std::string word; flags >> word;) words.push_back(word);
    std::vector<const char*> arguments;
    for (const std::string& word : words) arguments.push_back(word.c_str());
    const Options read =
        parse_options(static_cast<int>(arguments.size()), arguments.data()).value();
    EXPECT_EQ(read.camera_position, options.camera_position);
    EXPECT_EQ(read.camera_target, options.camera_target);
    EXPECT_EQ(read.vertical_fov, options.vertical_fov);
    EXPECT_EQ(read.light_position, options.light_position);
    EXPECT_EQ(read.time, options.time);
}

}  // namespace
