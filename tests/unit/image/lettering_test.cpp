#include "image/lettering.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace candela {
namespace {

DisplayImage paper(int width, int height) {
  DisplayImage image;
  image.width = width;
  image.height = height;
  image.rgba.assign(static_cast<std::size_t>(width * height) * 4, 255);
  return image;
}

/// How much of the paper is covered, in texels.
double ink(const DisplayImage& image) {
  double sum = 0.0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) sum += (255 - image.rgba[i]) / 255.0;
  return sum;
}

double ink_of(std::string_view text) {
  DisplayImage image = paper(400, 40);
  draw_text(image, 4, 4, text, {});
  return ink(image);
}

TEST(unit_image_lettering, every_letter_leaves_ink_and_a_blank_none) {
  for (char c = '!'; c <= '~'; ++c) EXPECT_GT(ink_of(std::string(1, c)), 1.0) << c;
  for (const char* text : {"ä", "λ", "Ж", "×", "…"}) {
    EXPECT_GT(ink_of(text), 1.0) << text;
    EXPECT_NE(ink_of(text), ink_of("□")) << text;
  }
  EXPECT_EQ(ink_of(" "), 0.0);
  EXPECT_NEAR(ink_of("ab"), ink_of("a") + ink_of("b"), 1e-6);
}

TEST(unit_image_lettering, what_is_no_letter_is_a_box) {
  for (const char* text : {"模", "\x01", "\xff", "\xc3", "\xe2\x80"}) {
    const std::size_t boxes = std::string(text) == "\xe2\x80" ? 2 : 1;
    EXPECT_NEAR(ink_of(text), static_cast<double>(boxes) * ink_of("□"), 1e-6) << text;
  }
}

TEST(unit_image_lettering, ink_stays_within_the_width_and_the_picture) {
  const std::string_view line = "Quickly, 1.89 × 1.80 m";
  const int width = text_width(line, LetterSize::text);
  DisplayImage image = paper(width + 20, 30);
  draw_text(image, 10, 4, line, {});
  for (int y = 0; y < image.height; ++y) {
    for (const int x : {5, width + 15}) EXPECT_EQ(image.rgba[static_cast<std::size_t>(4 * (y * image.width + x))], 255);
  }
  EXPECT_GT(text_width(line, LetterSize::title), width);
  draw_text(image, -5, -7, line, {});
  draw_text(image, image.width - 3, image.height - 3, line, {});
  draw_text(image, 1000000, -1000000, line, {});
}

TEST(unit_image_lettering, lines_fit_and_lose_no_word_that_has_room) {
  const std::string text = "base colour of luminance 0.95 where it is no metal";
  const int width = text_width("base colour of lumin", LetterSize::text);
  std::string joined;
  for (const std::string& line : wrapped(text, width, LetterSize::text)) {
    EXPECT_LE(text_width(line, LetterSize::text), width);
    joined += (joined.empty() ? "" : " ") + line;
  }
  EXPECT_EQ(joined, text);
  EXPECT_TRUE(wrapped("", width, LetterSize::text).empty());
  EXPECT_EQ(fitted("short", width, LetterSize::text), "short");
  const std::string cut = fitted(std::string(200, 'm'), width, LetterSize::text);
  EXPECT_LE(text_width(cut, LetterSize::text), width);
  EXPECT_TRUE(cut.ends_with("…"));
}

}  // namespace
}  // namespace candela
