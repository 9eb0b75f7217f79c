// What lies over the picture beside the panel. It knows only Dear ImGui; call between its NewFrame
// and Render.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

namespace cw2 {

/// A line at the lower edge, cut where the picture ends. Lengths are multiplied by `scale`.
void draw_line(const std::string& words, bool is_error, float scale);

/// All keys and what the mouse does, as large as the picture lets it.
void draw_help(float scale);

/// Asks for the path of a file. Tab completes what is typed so far; "~/" is the user's folder.
class PathField {
 public:
    void open();
    bool is_open() const { return open_; }
    /// Draws it where it is open; gives the path that was entered, and closes.
    std::optional<std::filesystem::path> draw(float scale);

 private:
    bool open_ = false;
    bool just_opened_ = false;
    std::array<char, 4096> text_{};
};

/// `text`, and as much more as all files agree on whose paths begin so.
std::string completed_path(const std::string& text);

}  // namespace cw2
