#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace candela::foreign {

/// The number of `count` bytes, at most four, at a place that the text has.
inline std::uint32_t little_endian(std::string_view text, std::size_t at, std::size_t count = 4) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i) {
    value |= std::uint32_t{static_cast<unsigned char>(text[at + i])} << (8 * i);
  }
  return value;
}

}  // namespace candela::foreign
