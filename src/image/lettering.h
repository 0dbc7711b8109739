#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "image/develop.h"

/// Words on a picture, in one typeface of two sizes that the build draws (DejaVu Sans): Latin, Greek and Cyrillic
/// letters; what it has not is a box. The same text gives the same pixels wherever the program runs.
namespace candela {

enum class LetterSize { text, title };
/// Pixels from one line to the next.
int line_height(LetterSize size);
/// Pixels that a line of UTF-8 is wide.
int text_width(std::string_view line, LetterSize size);
/// What of a line fits into `width` pixels: all of it, or its beginning and an ellipsis.
std::string fitted(std::string_view line, int width, LetterSize size);
/// `text` as lines of at most `width` pixels, broken between words where they fit.
std::vector<std::string> wrapped(std::string_view text, int width, LetterSize size);

/// A display colour, 8 bits.
struct Ink {
  std::uint8_t r = 0, g = 0, b = 0;
};
/// Writes a line with its left upper corner at (x, y); what lies outside of the picture is cut off.
void draw_text(DisplayImage& image, int x, int y, std::string_view line, Ink ink, LetterSize size = LetterSize::text);

}  // namespace candela
