#include <gtest/gtest.h>
#include <turbojpeg.h>

#include <algorithm>
#include <cmath>

#include "base/file.h"
#include "image/develop.h"
#include "image/image_file.h"
#include "shade/color.glsl.h"
#include "unit/base/temp_folder.h"
#include "unit/image/image_util.h"

namespace candela {
namespace {

using test::Bytes;

constexpr int kWidth = 21, kHeight = 18;

/// Smooth, because JPEG is: channel c of a pixel.
int smooth(int x, int y, int c) { return 40 + 5 * x + 3 * (c == 1 ? kHeight - y : y) + 10 * c; }

Bytes encode(const std::vector<unsigned char>& pixels, TJPF format, int subsampling, int flags = 0) {
  tjhandle handle = tjInitCompress();
  unsigned char* data = nullptr;
  unsigned long size = 0;
  EXPECT_EQ(tjCompress2(handle, pixels.data(), kWidth, 0, kHeight, format, &data, &size, subsampling, 95, flags), 0);
  Bytes bytes(reinterpret_cast<std::byte*>(data), reinterpret_cast<std::byte*>(data) + size);
  tjFree(data);
  tjDestroy(handle);
  return bytes;
}

std::vector<unsigned char> rgb_pixels() {
  std::vector<unsigned char> pixels;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < 3; ++c) pixels.push_back(static_cast<unsigned char>(smooth(x, y, c)));
  return pixels;
}

void expect_smooth_picture(const Bytes& bytes, bool grey) {
  EXPECT_EQ(read_image_size(bytes, "t"), ivec2(kWidth, kHeight));
  const TextureImage image = decode_texture(bytes, "t");
  ASSERT_EQ(image.width, kWidth);
  ASSERT_EQ(image.height, kHeight);
  EXPECT_EQ(image.bits, 8);
  EXPECT_FALSE(image.has_alpha);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const std::uint8_t* p = &image.pixels[static_cast<std::size_t>(4 * (y * kWidth + x))];
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(p[c], smooth(x, y, grey ? 0 : c), 6) << x << ' ' << y << ' ' << c;
      ASSERT_EQ(p[3], 255);
    }
  }
}

TEST(unit_image_jpeg, every_sampling_decodes_baseline_and_progressive) {
  for (const int flags : {0, TJFLAG_PROGRESSIVE})
    for (const int subsampling : {TJSAMP_444, TJSAMP_422, TJSAMP_420})
      expect_smooth_picture(encode(rgb_pixels(), TJPF_RGB, subsampling, flags), false);
}

TEST(unit_image_jpeg, grey_repeats) {
  std::vector<unsigned char> grey;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) grey.push_back(static_cast<unsigned char>(smooth(x, y, 0)));
  expect_smooth_picture(encode(grey, TJPF_GRAY, TJSAMP_GRAY), true);
}

TEST(unit_image_jpeg, inks_become_light) {
  std::vector<unsigned char> inks;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < 4; ++c) inks.push_back(static_cast<unsigned char>(c == 3 ? 128 : smooth(x, y, c)));
  const TextureImage image = decode_texture(encode(inks, TJPF_CMYK, TJSAMP_444), "t");
  EXPECT_FALSE(image.has_alpha);
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const int x = i % kWidth, y = i / kWidth;
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(image.pixels[static_cast<std::size_t>(i * 4 + c)], smooth(x, y, c) * 128 / 255.0, 6);
    ASSERT_EQ(image.pixels[static_cast<std::size_t>(i * 4 + 3)], 255);
  }
}

TEST(unit_image_jpeg, damage_is_an_error_and_never_a_crash) {
  const auto decode = [](std::span<const std::byte> bytes) { decode_texture(bytes, "t"); };
  test::check_damage(decode, encode(rgb_pixels(), TJPF_RGB, TJSAMP_420));
  test::check_damage(decode, encode(rgb_pixels(), TJPF_RGB, TJSAMP_444, TJFLAG_PROGRESSIVE));
}

TEST(unit_image_jpeg, bytes_between_segments_do_no_harm) {
  Bytes bytes = encode(rgb_pixels(), TJPF_RGB, TJSAMP_444);
  bytes.insert(bytes.end() - 2, 5, std::byte{0});
  const std::size_t app0_end = 2 + 2 + 16;
  bytes.insert(bytes.begin() + app0_end, 3, std::byte{0});
  expect_smooth_picture(bytes, false);
}

TEST(unit_image_jpeg, sizes_that_cannot_be_are_refused_before_the_pixels_are_allocated) {
  Bytes bytes = encode(rgb_pixels(), TJPF_RGB, TJSAMP_444);
  std::size_t frame = 0;
  while (bytes[frame] != std::byte{0xff} || bytes[frame + 1] != std::byte{0xc0}) ++frame;
  const auto set_size = [&](unsigned width, unsigned height) {
    bytes[frame + 5] = static_cast<std::byte>(height >> 8), bytes[frame + 6] = static_cast<std::byte>(height & 255);
    bytes[frame + 7] = static_cast<std::byte>(width >> 8), bytes[frame + 8] = static_cast<std::byte>(width & 255);
  };
  set_size(16385, 8);
  EXPECT_FALSE(test::survives([](auto b) { read_image_size(b, "t"); }, bytes));
  set_size(16384, 16384);
  EXPECT_TRUE(test::survives([](auto b) { read_image_size(b, "t"); }, bytes));
  try {
    decode_texture(bytes, "big.jpg");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.message(), "damaged JPEG: the file is truncated");
    EXPECT_EQ(e.where(), "big.jpg");
  }
}

TEST(unit_image_jpeg, writing_composes_over_black_in_linear_light) {
  const test::TempFolder folder;
  DisplayImage image{16, 16, std::vector<std::uint8_t>(1024, 200)};
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 128;
  write_jpeg(folder / "a.jpg", image);
  const float half = shade::srgb_decode_channel(200.0f / 255.0f) * 128.0f / 255.0f;
  const int expected = static_cast<int>(std::lround(255.0f * shade::srgb_encode_channel(half)));
  EXPECT_NEAR(decode_texture(read_file(folder / "a.jpg"), "t").pixels[0], expected, 1);

  std::fill(image.rgba.begin(), image.rgba.end(), std::uint8_t{200});
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
  write_jpeg(folder / "a.jpg", image);
  EXPECT_NEAR(decode_texture(read_file(folder / "a.jpg"), "t").pixels[0], 200, 1);
}

TEST(unit_image_jpeg, colour_is_written_at_full_resolution) {
  const test::TempFolder folder;
  DisplayImage image = test::random_display(16, 16, true);
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {  // one-pixel columns of red and blue, equally bright
    const bool red = (i / 4) % 2 == 0;
    image.rgba[i] = red ? 200 : 0, image.rgba[i + 1] = red ? 0 : 40, image.rgba[i + 2] = red ? 0 : 255;
  }
  write_jpeg(folder / "a.jpg", image);
  const TextureImage back = decode_texture(read_file(folder / "a.jpg"), "t");
  for (std::size_t i = 0; i < image.rgba.size(); ++i) ASSERT_NEAR(back.pixels[i], image.rgba[i], 40) << i;
}

}  // namespace
}  // namespace candela
