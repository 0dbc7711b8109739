#include "image/reduced.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>

#include "math/hash.h"
#include "shade/color.glsl.h"

namespace candela {
namespace {

/// Texels by chance, `words` to a texel as wide as `bits`.
TextureImage noise(int width, int height, int bits) {
  TextureImage image{width, height, bits, true, {}};
  image.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4 *
                      static_cast<std::size_t>(bits / 8));
  std::uint32_t seed = 1;
  for (std::uint8_t& byte : image.pixels) byte = static_cast<std::uint8_t>((seed = hash_combine(seed, 7u)) >> 24);
  return image;
}

float code_at(const TextureImage& image, std::size_t texel, std::size_t channel) {
  const std::size_t at = texel * 4 + channel;
  if (image.bits == 8) return static_cast<float>(image.pixels[at]) / 255.0f;
  std::uint16_t word = 0;
  std::memcpy(&word, image.pixels.data() + at * 2, sizeof word);
  return static_cast<float>(word) / 65535.0f;
}

std::size_t texels(const TextureImage& image) {
  return static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
}

/// Of a channel: of the light where it is a colour's.
double mean(const TextureImage& image, std::size_t channel, bool is_color) {
  double sum = 0.0;
  for (std::size_t i = 0; i < texels(image); ++i) {
    const float code = code_at(image, i, channel);
    sum += static_cast<double>(is_color && channel < 3 ? shade::srgb_decode_channel(code) : code);
  }
  return sum / static_cast<double>(texels(image));
}

TEST(unit_image_reduced, the_mean_of_light_and_of_numbers_is_kept_at_every_level_and_size) {
  constexpr double kHalfCode = 0.5 / 255.0;
  for (const ivec2 size : {ivec2(64, 64), ivec2(37, 22), ivec2(1, 19), ivec2(130, 3)}) {
    for (const int bits : {8, 16}) {
      const TextureImage image = noise(size.x, size.y, bits);
      for (const int level : {0, 1, 2, 4, 9}) {
        for (const TexelKind kind : {TexelKind::color, TexelKind::data}) {
          const bool is_color = kind == TexelKind::color;
          const TextureImage small = reduced(image, level, kind);
          EXPECT_EQ(small.width, std::max(size.x >> level, 1));
          EXPECT_EQ(small.height, std::max(size.y >> level, 1));
          EXPECT_EQ(small.bits, bits);
          for (std::size_t c = 0; c < 4; ++c) {
            // Half a code of sRGB is at most 2.3 halves of light.
            EXPECT_NEAR(mean(small, c, is_color), mean(image, c, is_color), 2.3 * kHalfCode / (bits == 16 ? 257 : 1))
                << size.x << " x " << size.y << ", level " << level << ", channel " << c;
          }
        }
      }
    }
  }
}

TEST(unit_image_reduced, a_mean_of_codes_is_not_a_mean_of_light) {
  // What the law above is worth: the wrong kind misses by far more than it allows.
  const TextureImage image = noise(64, 64, 8);
  EXPECT_GT(std::fabs(mean(reduced(image, 3, TexelKind::data), 0, true) - mean(image, 0, true)), 0.05);
}

TEST(unit_image_reduced, each_texel_is_the_mean_of_what_it_covers) {
  // Half of three texels, rounded down, is one.
  TextureImage image{3, 1, 8, false, {0, 0, 0, 255, 60, 60, 60, 255, 240, 240, 240, 255}};
  const TextureImage one = reduced(image, 1, TexelKind::data);
  ASSERT_EQ(one.width, 1);
  EXPECT_EQ(one.pixels, (std::vector<std::uint8_t>{100, 100, 100, 255}));
  image.width = 2, image.pixels.resize(8);
  const float light = 0.5f * shade::srgb_decode_channel(60.0f / 255.0f);
  const auto code = static_cast<std::uint8_t>(std::lround(255.0f * shade::srgb_encode_channel(light)));
  EXPECT_EQ(reduced(image, 1, TexelKind::color).pixels, (std::vector<std::uint8_t>{code, code, code, 255}));
}

TEST(unit_image_reduced, level_0_is_the_image_itself) {
  for (const int bits : {8, 16}) {
    const TextureImage image = noise(13, 9, bits);
    for (const TexelKind kind : {TexelKind::color, TexelKind::data}) {
      EXPECT_EQ(reduced(image, 0, kind).pixels, image.pixels);
    }
  }
}

TEST(unit_image_reduced, normals_stay_of_unit_length) {
  // Two that lean to opposite sides by 60 degrees: the mean of the codes would be half as long.
  const auto code = [](float v) { return static_cast<std::uint8_t>(std::lround(255.0f * (0.5f * v + 0.5f))); };
  const float lean = std::sqrt(0.75f);
  const TextureImage image{
      2, 1, 8, false, {code(lean), code(0), code(0.5f), 255, code(-lean), code(0), code(0.5f), 255}};
  const TextureImage small = reduced(image, 1, TexelKind::normal);
  EXPECT_NEAR(small.pixels[0], 128, 1);
  EXPECT_NEAR(small.pixels[1], 128, 1);
  EXPECT_EQ(small.pixels[2], 255);
}

}  // namespace
}  // namespace candela
