#include "viewer/gui_font.h"

#include <imgui.h>

#include <array>

namespace candela::viewer {

void add_font(float pixels) {
  // What people name files, materials and findings with: Latin, Greek, Cyrillic, punctuation, arrows, mathematics.
  static constexpr std::array<ImWchar, 15> kRanges = {0x20,   0x17f,  0x370,  0x45f,  0x2010, 0x2027, 0x2070, 0x209c,
                                                      0x2190, 0x2193, 0x2200, 0x2265, 0x25a0, 0x25cf, 0};
  const std::string_view file = gui_font_file();
  ImFontConfig config;
  config.FontDataOwnedByAtlas = false;
  config.OversampleH = config.OversampleV = 1;
  config.PixelSnapH = true;
  // It is only read: ImGui's pointer would be const, were it not freed in other cases.
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast)
  ImGui::GetIO().Fonts->AddFontFromMemoryTTF(const_cast<char*>(file.data()), static_cast<int>(file.size()), pixels,
                                             &config, kRanges.data());
}

}  // namespace candela::viewer
