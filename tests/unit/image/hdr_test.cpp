#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/file.h"
#include "image/codec.h"
#include "image/image_file.h"
#include "image/primaries.h"
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
  EXPECT_EQ(corner("+X 2 -Y 2"), 1.0f);
  EXPECT_EQ(corner("-X 2 -Y 2"), 4.0f);
  EXPECT_EQ(corner("+X 2 +Y 2"), 2.0f);
  EXPECT_EQ(corner("-X 2 +Y 2"), 8.0f);
  for (const char* resolution : {"+X 2 -X 2", "-Y 2 +Y 2", "+Z 2 -Y 2", "*X 2 -Y 2"})
    EXPECT_THROW(corner(resolution), Error) << resolution;
}

TEST(unit_image_hdr, columns_are_set_upright_packed_or_not) {
  const test::TempFolder folder;
  for (const int height : {3, 9}) {  // of a scanline: 9 pixels are packed
    const Image upright = test::random_image(12, height, 3);
    Image lying(height, 12, 3);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < 12; ++x) lying.set_rgb(y, x, upright.rgb(x, y));
    write_hdr(folder / "lying.hdr", lying);
    Bytes bytes = read_file(folder / "lying.hdr");
    const Bytes from = test::bytes_of("-Y 12 +X " + std::to_string(height));
    const Bytes to = test::bytes_of("+X 12 -Y " + std::to_string(height));
    const auto at = std::search(bytes.begin(), bytes.end(), from.begin(), from.end());
    std::copy(to.begin(), to.end(), at);
    const Image back = read_bytes(folder, bytes);
    ASSERT_EQ(back.width, 12);
    ASSERT_EQ(back.height, height);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < 12; ++x) expect_rgbe_close(back.rgb(x, y), upright.rgb(x, y));
  }
}

const std::vector<int> kPixel{128, 64, 32, 129};  // 1, 0.5, 0.25

ImageFile read_lines(const test::TempFolder& folder, const std::string& lines, const std::vector<int>& pixel = kPixel) {
  write_file(folder / "in.hdr", hdr_file("#?RADIANCE\n" + lines + "\n-Y 1 +X 1\n", pixel));
  return read_image_file({folder / "in.hdr", {}});
}

/// Without a name where there is none.
ImageFact fact_named(const ImageFile& file, const std::string& name) {
  for (const ImageFact& fact : file.facts)
    if (fact.name == name) return fact;
  return {};
}

TEST(unit_image_hdr, corrections_multiply_and_are_divided_out) {
  const test::TempFolder folder;
  const ImageFile file = read_lines(folder, "COLORCORR= 2.0 1.0 0.5\nEXPOSURE=2\nCOLORCORR= 2 2 2\nEXPOSURE=+4\n");
  EXPECT_EQ(file.image.rgb(0, 0), vec3(1.0f / 32.0f, 0.5f / 16.0f, 0.25f / 8.0f));
  ASSERT_FALSE(fact_named(file, "COLORCORR").name.empty());
  EXPECT_EQ(fact_named(file, "COLORCORR").value, "2.0 1.0 0.5");
  EXPECT_EQ(fact_named(file, "COLORCORR").done, "divided out");
  // What a program put before it, and what it quotes of its own input, is indented and does not count.
  EXPECT_EQ(read_lines(folder, "\tEXPOSURE=7\n\tCOLORCORR=7 7 7\n").image.rgb(0, 0), vec3(1.0f, 0.5f, 0.25f));
  for (const char* line : {"COLORCORR=1 2\n", "COLORCORR=1 0 1\n", "COLORCORR=1 -2 1\n", "COLORCORR=a b c\n",
                           "COLORCORR=nan 1 1\n", "COLORCORR=\n", "EXPOSURE=1e-30\nEXPOSURE=1e-30\n", "EXPOSURE=inf\n",
                           "EXPOSURE=-2\nEXPOSURE=-2\n", "COLORCORR=1 -2 1\nCOLORCORR=1 -2 1\n"})
    EXPECT_THROW(read_lines(folder, line), Error) << line;
}

TEST(unit_image_hdr, primaries_become_rec709_and_eight_zeros_are_none) {
  const test::TempFolder folder;
  const std::string p3 = "PRIMARIES= 0.68 0.32 0.265 0.69 0.15 0.06 0.3127 0.329\n";
  const vec3 expected =
      *rec709_from_rgb({{0.68, 0.32}, {0.265, 0.69}, {0.15, 0.06}, {0.3127, 0.329}}) * vec3(1.0f, 0.5f, 0.25f);
  const ImageFile file = read_lines(folder, p3);
  EXPECT_NEAR(glm::distance(file.image.rgb(0, 0), expected), 0.0f, 1e-6f);
  EXPECT_GT(file.image.rgb(0, 0).x, 1.05f);
  EXPECT_EQ(fact_named(file, "PRIMARIES").done, "converted to Rec.709");
  // Radiance's own: white of equal energy stays grey.
  const ImageFile own =
      read_lines(folder, "PRIMARIES= 0.64 0.33 0.29 0.6 0.15 0.06 0.3333 0.3333\n", {128, 128, 128, 129});
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(own.image.rgb(0, 0)[c], 1.0f, 2e-3f);
  // The last line counts, and what is no colour space leaves pixels as they are, with a word.
  EXPECT_EQ(read_lines(folder, p3 + "PRIMARIES= 0 0 0 0 0 0 0 0\n").image.rgb(0, 0), vec3(1.0f, 0.5f, 0.25f));
  EXPECT_FALSE(fact_named(read_lines(folder, "PRIMARIES= 0 0 0 0 0 0 0 0\n"), "PRIMARIES").is_odd);
  for (const char* line : {"PRIMARIES= 0.68 0.32 0.265 0.69 0.15 0.06 0.3127\n", "PRIMARIES=\n", "PRIMARIES= a\n",
                           "PRIMARIES= 0.68 0.32 0.265 0.69 0.15 0.06 0.3127 0.329 1\n",
                           "PRIMARIES= 0.68 0.32 0.265 0.69 0.15 0.06 0.3127 0\n",
                           "PRIMARIES= 0.3 0.3 0.3 0.3 0.3 0.3 0.3 0.3\n", "PRIMARIES= 1e30 1 1 1e30 0 0 0.3 0.3\n"}) {
    const ImageFile bad = read_lines(folder, line);
    EXPECT_EQ(bad.image.rgb(0, 0), vec3(1.0f, 0.5f, 0.25f)) << line;
    EXPECT_TRUE(fact_named(bad, "PRIMARIES").is_odd) << line;
  }
}

TEST(unit_image_hdr, xyz_is_measured_light_over_179) {
  const test::TempFolder folder;
  // White of Rec.709 in XYZ (0.9505, 1, 1.089) times 179, as 8 bits hold it: exponent 136 + 8 - 8 keeps the numbers.
  const ImageFile file = read_lines(folder, "FORMAT=32-bit_rle_xyze\n", {170, 179, 195, 136});
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(file.image.rgb(0, 0)[c], 1.0f, 0.01f);
  EXPECT_FALSE(fact_named(file, "FORMAT").name.empty());
  const ImageFile exposed = read_lines(folder, "FORMAT=32-bit_rle_xyze\nEXPOSURE=5.586592e-03\n", {122, 128, 139, 129});
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(exposed.image.rgb(0, 0)[c], 1.0f, 0.02f);
  // A pure X is no colour that Rec.709 has: not negative.
  const vec3 x = read_lines(folder, "FORMAT=32-bit_rle_xyze\n", {200, 20, 20, 136}).image.rgb(0, 0);
  EXPECT_GE(std::min({x.x, x.y, x.z}), 0.0f);
  EXPECT_NEAR(luminance(x), 20.0f / 179.0f, 1e-3f);
  EXPECT_TRUE(fact_named(read_lines(folder, "FORMAT=32-bit_rle_rgbe\n"), "FORMAT").name.empty()) << "nothing to say";
  EXPECT_THROW(read_lines(folder, "FORMAT=Radiance_spectra\n"), Error);
}

TEST(unit_image_hdr, a_gamma_is_told_and_not_followed) {
  const test::TempFolder folder;
  const ImageFile file = read_lines(folder, "GAMMA=2.2\nVIEW= -vta -vh 180\n");
  EXPECT_EQ(file.image.rgb(0, 0), vec3(1.0f, 0.5f, 0.25f));
  EXPECT_TRUE(fact_named(file, "GAMMA").is_odd);
  EXPECT_FALSE(fact_named(file, "VIEW").is_odd);
  EXPECT_FALSE(fact_named(read_lines(folder, "GAMMA=1.0\n"), "GAMMA").is_odd);
  EXPECT_TRUE(fact_named(read_lines(folder, "GAMMA=much\n"), "GAMMA").is_odd);
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
  EXPECT_THROW(read_bytes(folder, hdr_file("#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\n", {1, 2, 3, 4})), Error);
}

}  // namespace
}  // namespace candela
