#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "base/file.h"
#include "image/image_file.h"
#include "shade/color.glsl.h"
#include "unit/base/temp_folder.h"
#include "unit/image/image_util.h"
#include "unit/image/webp_avif_files.h"

namespace candela {
namespace {

using test::animated_webp;
using test::avif;
using test::Bytes;
using test::kHeight;
using test::kWidth;
using test::picture;
using test::Pixels;
using test::webp;

void expect_picture(const Bytes& bytes, const Pixels& expected, int tolerance, bool has_alpha) {
  const ImageHeader header = read_image_header(bytes, "t");
  EXPECT_EQ(header.size, ivec2(kWidth, kHeight));
  EXPECT_EQ(header.bits, 8);
  EXPECT_EQ(header.has_alpha, has_alpha);
  EXPECT_TRUE(header.facts.empty());
  const TextureImage image = decode_texture(bytes, "t");
  ASSERT_EQ(ivec2(image.width, image.height), ivec2(kWidth, kHeight));
  EXPECT_EQ(image.has_alpha, has_alpha);
  ASSERT_EQ(image.pixels.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    // Of what is transparent the colour is nobody's business.
    if (i % 4 != 3 && expected[i / 4 * 4 + 3] == 0) continue;
    ASSERT_NEAR(image.pixels[i], expected[i], tolerance) << i;
  }
}

std::vector<std::pair<std::string, Bytes>> samples() {
  return {{"lossless WebP", webp(picture(true), true)},
          {"lossy WebP", webp(picture(true), false)},
          {"animated WebP", animated_webp({picture(true), picture(false)})},
          {"AVIF", avif({picture(true)})},
          {"AVIF of 10 bits", avif({picture(true)}, {.depth = 10})}};
}

TEST(unit_image_webp, pictures_decode_with_straight_alpha) {
  for (const bool has_alpha : {false, true}) {
    expect_picture(webp(picture(has_alpha), true), picture(has_alpha), 0, has_alpha);
  }
  // Chroma has half the picture's resolution: but for its edges it is right.
  const TextureImage lossy = decode_texture(webp(picture(true), false), "t");
  EXPECT_NEAR(lossy.pixels[0], 30, 8);
  EXPECT_NEAR(lossy.pixels[std::size_t{4} * (kWidth - 1)], 220, 8);
  EXPECT_EQ(lossy.pixels[std::size_t{4} * kWidth * (kHeight - 1) + 3], 100);
}

TEST(unit_image_webp, an_animation_shows_its_first_frame_and_says_so) {
  Pixels second = picture(true);
  std::reverse(second.begin(), second.end());
  const Bytes bytes = animated_webp({picture(true), second, picture(true)});
  const ImageHeader header = read_image_header(bytes, "t");
  ASSERT_EQ(header.facts.size(), 1u);
  EXPECT_EQ(header.facts[0].name, "animation");
  EXPECT_EQ(header.facts[0].value, "3 frames");
  EXPECT_TRUE(header.facts[0].is_odd);
  const TextureImage image = decode_texture(bytes, "t");
  EXPECT_TRUE(image.has_alpha);
  EXPECT_EQ(Pixels(image.pixels.begin(), image.pixels.begin() + 4), (Pixels{30, 40, 128, 255}));
  EXPECT_EQ(image.pixels[4 * kWidth * (kHeight - 1) + 3], 100);
}

TEST(unit_image_avif, pictures_decode_with_straight_alpha) {
  for (const bool has_alpha : {false, true}) {
    expect_picture(avif({picture(has_alpha)}), picture(has_alpha), 1, has_alpha);
  }
  // Premultiplied in the file: what is stored is divided by alpha again.
  Pixels multiplied = picture(true);
  for (std::size_t i = 0; i < multiplied.size(); ++i) {
    if (i % 4 != 3) multiplied[i] = static_cast<std::uint8_t>(multiplied[i] * multiplied[i / 4 * 4 + 3] / 255);
  }
  const TextureImage image = decode_texture(avif({picture(true)}, {.is_premultiplied = true}), "t");
  EXPECT_NEAR(image.pixels[4 * kWidth * (kHeight - 1) + 1], 200, 3);
}

TEST(unit_image_avif, ten_and_twelve_bits_become_sixteen) {
  for (const std::uint32_t depth : {10u, 12u}) {
    const Bytes bytes = avif({picture(true)}, {.depth = depth});
    EXPECT_EQ(read_image_header(bytes, "t").bits, 16);
    const TextureImage image = decode_texture(bytes, "t");
    ASSERT_EQ(image.bits, 16);
    std::array<std::uint16_t, 4> texel{};
    std::memcpy(texel.data(), image.pixels.data(), sizeof texel);
    EXPECT_NEAR(texel[0] / 65535.0, 30 / 255.0, 1e-3);
    EXPECT_NEAR(texel[1] / 65535.0, 40 / 255.0, 1e-3);
    EXPECT_EQ(texel[3], 65535);
  }
}

TEST(unit_image_avif, is_turned_and_mirrored_as_its_file_says) {
  // Where the red and green corners of the stored picture come to lie; the box turns counter-clockwise.
  const auto corner = [](const TextureImage& image, bool right, bool low) {
    const int x = right ? image.width - 1 : 0, y = low ? image.height - 1 : 0;
    const std::uint8_t* p = &image.pixels[static_cast<std::size_t>(4 * (y * image.width + x))];
    return std::pair(p[0] > 128, p[1] > 128);  // it was at the right, it was low
  };
  using Corner = std::pair<bool, bool>;
  TextureImage image = decode_texture(avif({picture(false)}, {.transforms = AVIF_TRANSFORM_IROT, .quarters = 1}), "t");
  EXPECT_EQ(ivec2(image.width, image.height), ivec2(kHeight, kWidth));
  EXPECT_EQ(read_image_size(avif({picture(false)}, {.transforms = AVIF_TRANSFORM_IROT, .quarters = 1}), "t"),
            ivec2(kHeight, kWidth));
  EXPECT_EQ(corner(image, false, false), Corner(true, false));
  EXPECT_EQ(corner(image, false, true), Corner(false, false));
  image = decode_texture(avif({picture(false)}, {.transforms = AVIF_TRANSFORM_IROT, .quarters = 3}), "t");
  EXPECT_EQ(corner(image, false, false), Corner(false, true));
  EXPECT_EQ(corner(image, true, false), Corner(false, false));
  image = decode_texture(avif({picture(false)}, {.transforms = AVIF_TRANSFORM_IROT, .quarters = 2}), "t");
  EXPECT_EQ(corner(image, false, false), Corner(true, true));
  image = decode_texture(avif({picture(false)}, {.transforms = AVIF_TRANSFORM_IMIR, .mirror = 1}), "t");
  EXPECT_EQ(corner(image, false, false), Corner(true, false));
  image = decode_texture(avif({picture(false)}, {.transforms = AVIF_TRANSFORM_IMIR, .mirror = 0}), "t");
  EXPECT_EQ(corner(image, false, false), Corner(false, true));
  // Turned first, then mirrored.
  image = decode_texture(
      avif({picture(false)}, {.transforms = AVIF_TRANSFORM_IROT | AVIF_TRANSFORM_IMIR, .quarters = 1, .mirror = 0}),
      "t");
  EXPECT_EQ(corner(image, false, false), Corner(false, false));
  EXPECT_EQ(corner(image, true, false), Corner(false, true));
}

TEST(unit_image_avif, what_is_not_followed_is_said) {
  const auto names = [](const Bytes& bytes) {
    std::string text;
    for (const ImageFact& fact : read_image_header(bytes, "t").facts) text += fact.name + '|';
    return text;
  };
  EXPECT_EQ(names(avif({picture(false)}, {.transfer = AVIF_TRANSFER_CHARACTERISTICS_SMPTE2084})), "transfer function|");
  EXPECT_EQ(names(avif({picture(false)}, {.primaries = AVIF_COLOR_PRIMARIES_BT2020})), "colour primaries|");
  EXPECT_EQ(names(avif({picture(false), picture(true)})), "animation|");
}

TEST(unit_image_webp_avif, every_cut_is_an_error) {
  for (const auto& [name, bytes] : samples()) {
    for (std::size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / 60) {
      const std::span<const std::byte> part(bytes.data(), size);
      // An animation cut behind its first frame has that.
      if (name == "animated WebP" && size > bytes.size() / 2) continue;
      EXPECT_THROW(decode_texture(part, "t"), Error) << name << ' ' << size << " of " << bytes.size();
    }
  }
}

TEST(unit_image_webp_avif, changed_bytes_are_pixels_or_an_error) {
  std::mt19937 random(7);
  for (const auto& [name, bytes] : samples()) {
    for (int i = 0; i < 150; ++i) {
      Bytes changed = bytes;
      for (int k = 0; k < 3; ++k) changed[random() % changed.size()] = static_cast<std::byte>(random());
      try {
        const TextureImage image = decode_texture(changed, "t");
        EXPECT_EQ(image.pixels.size(), static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) *
                                           static_cast<std::size_t>(image.bits / 2));
      } catch (const Error&) {
      }
    }
  }
}

TEST(unit_image_webp_avif, a_size_that_is_too_large_is_refused_from_the_header) {
  // VP8X: the canvas less one, 24 bits each, at byte 24 (RFC 9649 §2.7.1).
  Bytes bytes = animated_webp({picture(true), picture(false)});
  for (const std::size_t at : {24u, 25u, 27u, 28u}) bytes[at] = std::byte{0xFF};
  EXPECT_THROW(read_image_size(bytes, "t"), Error);
  EXPECT_THROW(decode_texture(bytes, "t"), Error);
  // `ispe`: version and flags, then width and height (ISO/IEC 23008-12 §6.5.3).
  bytes = avif({picture(false)});
  const std::string name = "ispe";
  for (auto at = bytes.begin(); at != bytes.end(); ++at) {
    at = std::search(at, bytes.end(), name.begin(), name.end(),
                     [](std::byte b, char c) { return b == static_cast<std::byte>(c); });
    if (at == bytes.end()) break;
    at[8] = at[12] = std::byte{0x7F};
  }
  EXPECT_THROW(read_image_size(bytes, "t"), Error);
}

TEST(unit_image_webp_avif, a_picture_file_is_linear_light_and_premultiplied) {
  const test::TempFolder folder;
  const float expected = shade::srgb_decode_channel(200 / 255.0f) * 100 / 255.0f;
  for (const auto& [name, bytes] :
       {std::pair<std::string, Bytes>{"a.png", webp(picture(true), true)}, {"b.png", avif({picture(true)})}}) {
    write_file(folder / name, bytes);  // told by its content
    const ImageFile file = read_image_file({folder / name, {}});
    EXPECT_TRUE(is_display_format(file.format));
    ASSERT_EQ(file.image.channels, 4);
    EXPECT_NEAR(file.image.rgb(0, kHeight - 1).y, expected, 0.01f);
  }
}

}  // namespace
}  // namespace candela
