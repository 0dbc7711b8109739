#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/file.h"
#include "image/codec.h"
#include "image/image_file.h"
#include "unit/base/temp_folder.h"
#include "unit/image/image_util.h"

// An independent reader, to check that our files mean to others what they mean to us.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#include <stb_image.h>

namespace candela {
namespace {

using test::Bytes;

/// Rounding to a shared exponent: half of the last of 8 mantissa bits, the largest channel's mantissa being at least
/// 128.
void expect_rgbe_close(vec3 back, vec3 original) {
  const float half_step = max_component(original) / 255.5f;
  for (int c = 0; c < 3; ++c) ASSERT_NEAR(back[c], original[c], half_step * 1.0001f);
}

Image read_bytes(const test::TempFolder& folder, const Bytes& bytes) {
  write_file(folder / "in.hdr", bytes);
  return read_image(folder / "in.hdr");
}

Bytes hdr_file(const std::string& header, const std::vector<int>& pixels) {
  Bytes bytes = test::bytes_of(header);
  for (const int v : pixels) bytes.push_back(static_cast<std::byte>(v));
  return bytes;
}

TEST(unit_image_hdr, a_round_trip_keeps_eight_bits_of_the_brightest_channel) {
  const test::TempFolder folder;
  for (const int width : {1, 7, 8, 9, 127, 128, 129, 300, 32768}) {  // narrow and very wide rows are not packed
    const Image image = test::random_image(width, 3, 3);
    write_hdr(folder / "a.hdr", image);
    const Image back = read_image(folder / "a.hdr");
    ASSERT_EQ(back.width, width);
    ASSERT_EQ(back.height, 3);
    ASSERT_EQ(back.channels, 3);
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < width; ++x) expect_rgbe_close(back.rgb(x, y), image.rgb(x, y));
  }
}

TEST(unit_image_hdr, rounding_has_no_bias) {
  const test::TempFolder folder;
  Image image(400, 100, 3);
  std::mt19937 random(1);
  for (float& v : image.pixels) v = std::uniform_real_distribution<float>(0.0f, 1.0f)(random);
  write_hdr(folder / "a.hdr", image);
  const Image back = read_image(folder / "a.hdr");
  double before = 0.0, after = 0.0;
  for (const float v : image.pixels) before += static_cast<double>(v);
  for (const float v : back.pixels) after += static_cast<double>(v);
  // 120 000 roundings of at most 0.4 % each average out; truncation would lose 0.2 %.
  EXPECT_NEAR(after / before, 1.0, 1e-4);
}

TEST(unit_image_hdr, another_reader_sees_the_same_picture) {
  const test::TempFolder folder;
  Image image = test::random_image(200, 40, 3);
  for (int x = 20; x < 180; ++x) image.set_rgb(x, 7, vec3(0.25f, 0.5f, 1.0f));  // a long run
  write_hdr(folder / "a.hdr", image);
  const Bytes bytes = read_file(folder / "a.hdr");
  int width = 0, height = 0, channels = 0;
  float* pixels = stbi_loadf_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()), static_cast<int>(bytes.size()),
                                         &width, &height, &channels, 3);
  ASSERT_NE(pixels, nullptr);
  const Image ours = read_image(folder / "a.hdr");
  ASSERT_EQ(width, 200);
  ASSERT_EQ(height, 40);
  for (std::size_t i = 0; i < ours.pixels.size(); ++i) ASSERT_EQ(ours.pixels[i], pixels[i]);
  stbi_image_free(pixels);
}

TEST(unit_image_hdr, runs_make_flat_pictures_small) {
  const test::TempFolder folder;
  Image image(1000, 100, 3);
  std::fill(image.pixels.begin(), image.pixels.end(), 0.7f);
  write_hdr(folder / "a.hdr", image);
  EXPECT_LT(read_file(folder / "a.hdr").size(), 100u * 80u);  // 4 components of 8 runs, 2 bytes each, and the mark
}

TEST(unit_image_hdr, extremes_stay_finite_and_alpha_is_dropped) {
  const test::TempFolder folder;
  Image image(8, 1, 4);
  const float inf = std::numeric_limits<float>::infinity();
  image.set_rgb(0, 0, vec3(-1.0f, 2.0f, -0.0f));
  image.set_rgb(1, 0, vec3(inf, 1.0f, 1.0f));
  image.set_rgb(2, 0, vec3(std::nanf(""), 1.0f, 0.5f));
  image.set_rgb(3, 0, vec3(3.4e38f));
  image.set_rgb(4, 0, vec3(1e-44f));
  image.set_rgb(5, 0, vec3(255.9f, 2.0f, 0.9f));  // rounds up into the next exponent
  write_hdr(folder / "a.hdr", image);
  const Image back = read_image(folder / "a.hdr");
  EXPECT_EQ(back.rgb(0, 0), vec3(0.0f, 2.0f, 0.0f));
  EXPECT_GT(back.rgb(1, 0).x, 1e38f);
  EXPECT_EQ(back.rgb(2, 0), vec3(0.0f, 1.0f, 0.5f));
  EXPECT_EQ(back.rgb(3, 0), vec3(255.0f * 0x1p119f));
  EXPECT_EQ(back.rgb(4, 0), vec3(0.0f));
  EXPECT_EQ(back.rgb(5, 0), vec3(256.0f, 2.0f, 0.0f));
}

TEST(unit_image_hdr, exposure_lines_are_divided_out) {
  const test::TempFolder folder;
  const std::vector<int> pixel{128, 64, 32, 129};
  const Image plain = read_bytes(folder, hdr_file("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n", pixel));
  EXPECT_EQ(plain.rgb(0, 0), vec3(1.0f, 0.5f, 0.25f));
  const Image exposed = read_bytes(folder, hdr_file("#?RADIANCE\nEXPOSURE=2\nEXPOSURE= 4.0\n\n-Y 1 +X 1\n", pixel));
  EXPECT_EQ(exposed.rgb(0, 0), vec3(0.125f, 0.0625f, 0.03125f));
}

TEST(unit_image_hdr, rows_and_columns_follow_the_resolution_line) {
  const test::TempFolder folder;
  const std::vector<int> pixels{128, 0, 0, 129, 128, 0, 0, 130, 128, 0, 0, 131, 128, 0, 0, 132};  // 1 2 / 4 8
  const auto corner = [&](const std::string& resolution) {
    return read_bytes(folder, hdr_file("#?RGBE\n\n" + resolution + "\n", pixels)).rgb(0, 0).x;
  };
  EXPECT_EQ(corner("-Y 2 +X 2"), 1.0f);
  EXPECT_EQ(corner("-Y 2 -X 2"), 2.0f);
  EXPECT_EQ(corner("+Y 2 +X 2"), 4.0f);
  EXPECT_EQ(corner("+Y 2 -X 2"), 8.0f);
  EXPECT_THROW(corner("+X 2 -Y 2"), Error);
}

TEST(unit_image_hdr, old_runs_repeat_the_pixel_before) {
  const test::TempFolder folder;
  // One pixel, repeated 3 + 1·256 times: a row of 260.
  const Image image =
      read_bytes(folder, hdr_file("#?RADIANCE\n\n-Y 1 +X 260\n", {128, 128, 128, 129, 1, 1, 1, 3, 1, 1, 1, 1}));
  for (int x = 0; x < 260; ++x) ASSERT_EQ(image.rgb(x, 0), vec3(1.0f));
  EXPECT_THROW(read_bytes(folder, hdr_file("#?RADIANCE\n\n-Y 1 +X 4\n", {1, 1, 1, 3, 9, 9, 9, 9})), Error);
  EXPECT_THROW(read_bytes(folder, hdr_file("#?RADIANCE\n\n-Y 1 +X 4\n", {9, 9, 9, 9, 1, 1, 1, 4})), Error);
}

TEST(unit_image_hdr, damage_is_an_error_and_never_a_crash) {
  const test::TempFolder folder;
  const auto decode = [](std::span<const std::byte> bytes) { codec::decode_hdr(bytes, "t"); };
  write_hdr(folder / "packed.hdr", test::random_image(12, 3, 3));
  test::check_damage(decode, read_file(folder / "packed.hdr"));
  write_hdr(folder / "plain.hdr", test::random_image(5, 3, 3));
  test::check_damage(decode, read_file(folder / "plain.hdr"));
}

TEST(unit_image_hdr, headers_that_cannot_be_are_refused) {
  const test::TempFolder folder;
  for (const char* resolution : {"-Y 32769 +X 1", "-Y 1 +X 32769", "-Y 30000 +X 30000", "-Y 0 +X 1", "-Y 1 +X -5",
                                 "-Y 10000 +X 10000", "-Y 1 +X 1 x", "nonsense", ""})
    EXPECT_THROW(read_bytes(folder, hdr_file(std::string("#?RADIANCE\n\n") + resolution + "\n", {1, 2, 3, 4})), Error)
        << resolution;
  EXPECT_THROW(read_bytes(folder, hdr_file("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n", {1, 2, 3, 4})), Error);
  EXPECT_THROW(read_bytes(folder, hdr_file("#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\n", {1, 2, 3, 4})), Error);
}

}  // namespace
}  // namespace candela
