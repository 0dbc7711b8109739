#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace candela::gl {

/// As errors of OpenGL and EGL are written: "0x0502".
inline std::string hex(unsigned number) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "0x%04x", number);
  return text.data();
}

}  // namespace candela::gl
