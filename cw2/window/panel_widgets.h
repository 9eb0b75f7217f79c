// What the parts of the panel are made of.
#pragma once

#include <string>

namespace cw2 {

void text(const std::string& words);
/// Words of less weight; they are wrapped.
void dim_text(const std::string& words);
/// Puts `name` at the left; what follows has the rest of the row.
void label(const char* name);
/// A row of a table of readings.
void reading(const char* name, const std::string& value);
/// A headline that opens and closes what is under it. True while that is open.
bool section(const char* name, bool open = true);
/// A window of fixed width, as high as it must be, but never higher than the picture; ImGui::End()
/// ends it. Lengths in pixels.
void begin_window(const char* name, float left, float width, float scale);

}  // namespace cw2
