#pragma once

#include <string_view>

namespace candela::viewer {

/// DejaVu Sans, as the build found it.
std::string_view gui_font_file();

/// Gives ImGui that typeface, so many pixels high.
void add_font(float pixels);

}  // namespace candela::viewer
