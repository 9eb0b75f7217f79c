#include "cw2/window/title.h"

#include <fmt/format.h>

#include <utility>

#include "cw2/render/view.h"

namespace cw2 {

namespace {

/// How often the time is written anew.
constexpr std::chrono::milliseconds kPause{250};

}  // namespace

void Title::set_scene(const std::string& name, const std::string& place) {
    scene_ = place.empty() ? name : fmt::format("{} ({})", name, place);
}

void Title::set_error(std::string error) {
    error_ = std::move(error);
}

void Title::update(const FrameSettings& settings, std::optional<double> milliseconds) {
    std::string words = fmt::format("{} - {}", scene_, kViews[settings.view].name);
    if (settings.split) words += fmt::format(" | {}", kViews[settings.split->right.view].name);
    if (!error_.empty()) words = error_ + " - " + words;
    const auto now = std::chrono::steady_clock::now();
    if (words == words_ && now - written_ < kPause) return;
    window_.set_title(milliseconds ? fmt::format("{} - {:.1f} ms", words, *milliseconds) : words);
    words_ = std::move(words);
    written_ = now;
}

}  // namespace cw2
