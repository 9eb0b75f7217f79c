// What the parts of the panel are made of.
#pragma once

#include <array>
#include <string>

#include "cw2/options/options.h"

namespace cw2 {

void text(const std::string& words);
/// Words of less weight; they are wrapped.
void dim_text(const std::string& words);
/// Puts `name` at the left; what follows has the rest of the row.
void label(const char* name);
/// A row of a table of readings; its value is cut where the window ends, and whole in a tip.
void reading(const char* name, const std::string& value);
/// The same with three values, one below the other from row to row.
void readings(const char* name, const std::array<std::string, 3>& values);
/// The rest of the row: a slider over the range, and at its right the number, which can be edited.
void slider(const char* id, float& value, const Range<float>& range, const char* format);
/// A headline that opens and closes what is under it. True while that is open.
bool section(const char* name, bool open = true);

/// Of the picture.
enum class Edge { left, right };

/// Whether a window at each edge leaves enough of the picture to be seen.
bool readings_are_apart(float scale);
/// A window of fixed width at an edge, as high as it must be, but never higher than the picture;
/// ImGui::End() ends it. Lengths are multiplied by `scale`.
void begin_window(const char* name, Edge edge, float scale);

}  // namespace cw2
