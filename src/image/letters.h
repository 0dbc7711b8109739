#pragma once

#include <cstdint>
#include <span>

// What make_letters.cpp draws during the build.
namespace candela {

/// A letter: `width` × `height` bytes of coverage from `offset` on, its left upper corner at (left, top) from the left
/// upper corner of its line; the next letter begins `advance` further right.
struct Letter {
  std::uint32_t code;  ///< of Unicode
  std::int16_t left, top, width, height, advance;
  std::uint32_t offset;
};
struct Letters {
  int line_height;
  std::span<const Letter> letters;  ///< sorted by code
  const unsigned char* coverage;
};
extern const Letters kTextLetters;
extern const Letters kTitleLetters;

}  // namespace candela
