#include "io/texture_budget.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "base/error.h"
#include "image/develop.h"
#include "image/image_file.h"
#include "unit/io/gltf_builder.h"

namespace candela::io::test {
namespace {

constexpr std::uint64_t kTexelBytes = 4;

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<TextureExtent> squares(std::initializer_list<int> sides) {
  std::vector<TextureExtent> images;
  for (const int side : sides) images.push_back({.size = ivec2(side)});
  return images;
}

std::uint64_t kept(const std::vector<TextureExtent>& images, const TexturePlan& plan, bool counts_levels) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < images.size(); ++i) sum += texture_bytes(images[i], plan.levels[i], counts_levels);
  return sum;
}

TEST(unit_io_texture_budget, the_largest_lose_levels_first_until_all_fit) {
  const auto images = squares({64, 256, 128, 256});
  const std::uint64_t all = kTexelBytes * (64 * 64 + 2 * 256 * 256 + 128 * 128);
  EXPECT_THAT(plan_textures(images, {all}, 2).levels, ElementsAre(0, 0, 0, 0));
  EXPECT_THAT(plan_textures(images, {all}, 2).told, "");
  EXPECT_THAT(plan_textures(images, {all - 1}, 2).levels, ElementsAre(0, 1, 0, 0));
  // 64² + three times 128², and half of one of them less.
  EXPECT_THAT(plan_textures(images, {kTexelBytes * (64 * 64 + 3 * 128 * 128)}, 2).levels, ElementsAre(0, 1, 0, 1));
  EXPECT_THAT(plan_textures(images, {kTexelBytes * (64 * 64 + 2 * 128 * 128 + 100 * 100)}, 2).levels,
              ElementsAre(0, 2, 0, 1));
}

TEST(unit_io_texture_budget, whatever_the_budget_all_fit_and_no_level_goes_without_need) {
  const std::vector<TextureExtent> images = {
      {.size = {300, 20}}, {.size = {64, 64}, .bits = 16}, {.size = {7, 900}, .copies = 2}, {.size = {1, 1}}};
  for (const bool counts_levels : {false, true}) {
    for (std::uint64_t budget = 60; budget < 200'000; budget += budget / 3) {
      const TexturePlan plan = plan_textures(images, {budget, counts_levels}, 2);
      EXPECT_LE(kept(images, plan, counts_levels), budget);
      EXPECT_EQ(plan.levels, plan_textures(images, {budget, counts_levels}, 64).levels);
      EXPECT_EQ(plan.told.empty(), std::all_of(plan.levels.begin(), plan.levels.end(), [](int l) { return l == 0; }));
    }
  }
  EXPECT_THROW(plan_textures(images, {10}, 2), Error);
}

TEST(unit_io_texture_budget, smaller_levels_count_a_third) {
  const TextureExtent image{.size = {256, 256}};
  EXPECT_EQ(texture_bytes(image, 0, false), 4u * 256 * 256);
  EXPECT_EQ(texture_bytes(image, 2, false), 4u * 64 * 64);
  EXPECT_EQ(texture_bytes(image, 0, true), 4u * (4 * 256 * 256 - 1) / 3);
}

TEST(unit_io_texture_budget, what_is_decoded_at_a_time_fits_beside_what_is_kept) {
  const std::vector<TextureExtent> images(40, {.size = {512, 512}});
  constexpr std::uint64_t kFull = kTexelBytes * 512 * 512;
  for (const std::uint64_t budget : {40 * kFull, 10 * kFull, 4 * kFull, kFull}) {
    for (const int threads : {1, 2, 8}) {
      const TexturePlan plan = plan_textures(images, {budget}, threads);
      std::uint64_t sum = 0;
      std::vector<std::size_t> decoded;
      for (const std::vector<std::size_t>& batch : plan.batches) {
        for (const std::size_t i : batch) sum += texture_bytes(images[i], plan.levels[i], false);
        decoded.insert(decoded.end(), batch.begin(), batch.end());
        const auto most = std::min<std::uint64_t>(batch.size(), static_cast<std::uint64_t>(threads));
        EXPECT_LE(sum + most * kFull, std::max(budget, sum + kFull));
      }
      std::vector<std::size_t> all(images.size());
      std::iota(all.begin(), all.end(), std::size_t{0});
      EXPECT_EQ(decoded, all);
    }
  }
}

TEST(unit_io_texture_budget, what_is_there_already_counts_and_stays) {
  std::vector<TextureExtent> images = squares({64, 64});
  images[0].is_here = true;
  const TexturePlan plan = plan_textures(images, {kTexelBytes * (64 * 64 + 32 * 32)}, 1);
  EXPECT_THAT(plan.levels, ElementsAre(0, 1));
  EXPECT_THAT(plan.batches, ElementsAre(ElementsAre(1)));
}

/// A triangle that wears two images of 32² and 16² texels, the first as colour, the second as a normal map.
Builder textured() {
  Builder b = with_material(
      {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}, {"normalTexture", {{"index", 1}}}});
  for (const int side : {32, 16}) {
    TextureImage image{side, side, 8, false, {}};
    for (int i = 0; i < side * side; ++i) {
      const auto bright = static_cast<std::uint8_t>(i % 2 == 0 ? 255 : 0);
      image.pixels.insert(image.pixels.end(), {bright, static_cast<std::uint8_t>(i), 128, 255});
    }
    b.root["images"].push_back({{"bufferView", b.view(encode_png(image))}, {"mimeType", "image/png"}});
    b.root["textures"].push_back({{"source", b.root["images"].size() - 1}});
  }
  return b;
}

TEST(unit_io_texture_budget, a_file_is_read_as_it_is_where_the_budget_is_ample) {
  const Loaded all = load(textured());
  const Loaded ample = load(textured(), {.texture_memory = kTexelBytes * (32 * 32 + 16 * 16)});
  ASSERT_EQ(ample.scene.images.size(), 2u);
  EXPECT_THAT(ample.warnings, IsEmpty());
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(ample.scene.images[i]->pixels, all.scene.images[i]->pixels);
}

TEST(unit_io_texture_budget, a_file_is_made_to_fit_and_says_so_once) {
  const Loaded loaded = load(textured(), {.texture_memory = kTexelBytes * (8 * 8 + 8 * 8)});
  ASSERT_EQ(loaded.scene.images.size(), 2u);
  EXPECT_EQ(loaded.scene.images[0]->width, 8);
  EXPECT_EQ(loaded.scene.images[1]->width, 8);
  ASSERT_EQ(loaded.warnings.size(), 1u);
  EXPECT_THAT(loaded.warnings[0].text(),
              HasSubstr("1 loses one level, 1 loses 2 levels; at worst 32 x 32 texels become 8 x 8"));
  // Black and white side by side are half of the light, not half of the code.
  EXPECT_EQ(loaded.scene.images[0]->pixels[0], 188);
  const Loaded all = load(textured());
  EXPECT_EQ(loaded.scene.images[1]->pixels, reduced(*all.scene.images[1], 1, TexelKind::normal).pixels);
}

TEST(unit_io_texture_budget, with_smaller_levels_less_fits) {
  const LoadOptions options{.texture_memory = kTexelBytes * (32 * 32 + 16 * 16), .counts_texture_levels = true};
  const Loaded loaded = load(textured(), options);
  EXPECT_EQ(loaded.scene.images[0]->width, 16);
  EXPECT_EQ(loaded.warnings.size(), 1u);
}

TEST(unit_io_texture_budget, less_than_a_texel_each_is_an_error) {
  try {
    load(textured(), {.texture_memory = 7});
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("2 images have no room in"));
  }
}

}  // namespace
}  // namespace candela::io::test
