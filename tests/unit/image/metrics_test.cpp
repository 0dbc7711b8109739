#include "image/metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "unit/image/image_util.h"

namespace candela {
namespace {

Image flat(int width, int height, vec3 color, int channels = 3) {
  Image image(width, height, channels);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.set_rgb(x, y, color);
  return image;
}

TEST(unit_image_metrics, equal_pictures_differ_by_nothing) {
  const Image a = test::random_image(20, 10, 3);
  EXPECT_EQ(mse(a, a), 0.0);
  EXPECT_EQ(rel_mse(a, a), 0.0);
  EXPECT_EQ(rel_mse_trimmed(a, a), 0.0);
  EXPECT_EQ(max_abs_difference(a, a), 0.0);
}

TEST(unit_image_metrics, a_flat_difference_has_the_error_computed_by_hand) {
  const Image a = flat(5, 4, vec3(1.5f, 2.0f, 0.0f)), b = flat(5, 4, vec3(1.0f, 2.0f, 0.25f));
  EXPECT_DOUBLE_EQ(mse(a, b), (0.25 + 0.0625) / 3.0);
  EXPECT_DOUBLE_EQ(rel_mse(a, b), (0.25 / 1.01 + 0.0625 / 0.0725) / 3.0);
  EXPECT_DOUBLE_EQ(rel_mse_trimmed(a, b), rel_mse(a, b));
  EXPECT_DOUBLE_EQ(max_abs_difference(a, b), 0.5);
  EXPECT_EQ(image_mean(b), dvec3(1.0, 2.0, 0.25));
}

TEST(unit_image_metrics, relative_error_divides_by_the_reference) {
  const Image a = flat(2, 2, vec3(3.0f)), b = flat(2, 2, vec3(1.0f));
  EXPECT_DOUBLE_EQ(rel_mse(a, b), 4.0 / 1.01);
  EXPECT_DOUBLE_EQ(rel_mse(b, a), 4.0 / 9.01);
}

TEST(unit_image_metrics, trimming_leaves_out_one_pixel_of_a_thousand) {
  const Image b = flat(50, 40, vec3(1.0f));  // 2000 pixels: two are left out
  Image a = flat(50, 40, vec3(1.1f));
  const double clean = rel_mse(a, b);
  a.set_rgb(3, 3, vec3(1000.0f)), a.set_rgb(30, 20, vec3(0.0f, 500.0f, 0.0f));
  EXPECT_GT(rel_mse(a, b), 100.0 * clean);
  EXPECT_NEAR(rel_mse_trimmed(a, b), clean, 1e-12);
  a.set_rgb(40, 20, vec3(1000.0f));
  EXPECT_GT(rel_mse_trimmed(a, b), 100.0 * clean);
}

TEST(unit_image_metrics, a_nan_is_never_hidden) {
  const Image b = flat(50, 40, vec3(1.0f));
  Image a = b;
  a.set_rgb(7, 7, vec3(1.0f, std::nanf(""), 1.0f));
  EXPECT_TRUE(std::isnan(mse(a, b)));
  EXPECT_TRUE(std::isnan(rel_mse(a, b)));
  EXPECT_TRUE(std::isnan(rel_mse_trimmed(a, b)));
  EXPECT_TRUE(std::isnan(max_abs_difference(a, b)));
}

TEST(unit_image_metrics, alpha_is_not_compared_and_grey_repeats) {
  const Image color = flat(3, 3, vec3(0.5f)), with_alpha = flat(3, 3, vec3(0.5f), 4);
  Image grey(3, 3, 1);
  std::fill(grey.pixels.begin(), grey.pixels.end(), 0.5f);
  EXPECT_EQ(mse(color, with_alpha), 0.0);
  EXPECT_EQ(mse(grey, color), 0.0);
}

TEST(unit_image_metrics, pictures_of_different_size_are_an_error) {
  EXPECT_THROW(mse(Image(2, 3, 3), Image(3, 2, 3)), Error);
  EXPECT_THROW(rel_mse(Image(), Image()), Error);
}

}  // namespace
}  // namespace candela
