#include "image/flip.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "math/hash.h"

namespace candela {
namespace {

Image flat(vec3 color, int size = 24) {
  Image image(size, size, 3);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) image.set_rgb(x, y, color);
  }
  return image;
}

Image noisy(float amount) {
  Image image = flat(vec3(0.3f), 48);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] += amount * (unit_float(hash_combine(7, static_cast<std::uint32_t>(i))) - 0.5f);
  }
  return image;
}

Image edge_at(int column) {
  Image image = flat(vec3(0.0f), 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = column; x < 64; ++x) image.set_rgb(x, y, vec3(1.0f));
  }
  return image;
}

TEST(unit_image_flip, a_picture_does_not_differ_from_itself) { EXPECT_EQ(flip_mean(noisy(0.4f), noisy(0.4f)), 0.0); }

TEST(unit_image_flip, plain_colours_differ_as_the_formula_says) {
  // Nothing to filter: HyAB of the two in Hunt-adjusted CIELAB, worked out by hand. Green to blue is the scale's end.
  EXPECT_NEAR(flip_mean(flat({0, 1, 0}), flat({0, 0, 1})), 1.0, 1e-6);
  // Black to white: 100^0.7 = 25.1 on a scale to 203^0.7 = 41.3, beyond the knee: 0.95 + 0.05 (25.1 - 16.5) / 24.8.
  EXPECT_NEAR(flip_mean(flat(vec3(0.0f)), flat(vec3(1.0f))), 0.9674, 1e-3);
}

TEST(unit_image_flip, order_does_not_matter_and_more_is_more) {
  const Image a = noisy(0.0f);
  EXPECT_NEAR(flip_mean(a, noisy(0.2f)), flip_mean(noisy(0.2f), a), 1e-9);
  double last = 0.0;
  for (const float amount : {0.02f, 0.1f, 0.3f, 0.6f}) {
    const double now = flip_mean(a, noisy(amount));
    EXPECT_GT(now, last) << amount;
    last = now;
  }
}

TEST(unit_image_flip, it_is_where_the_pictures_differ) {
  const Image error = flip(edge_at(32), edge_at(34));
  EXPECT_GT(error.at(32, 20)[0], 0.5f);
  EXPECT_LT(error.at(4, 20)[0], 1e-3f);
  EXPECT_LT(error.at(60, 20)[0], 1e-3f);
}

TEST(unit_image_flip, noise_that_the_eye_blurs_counts_less) {
  EXPECT_LT(flip(noisy(0.0f), noisy(0.3f), 120.0).pixels[1000], flip(noisy(0.0f), noisy(0.3f), 30.0).pixels[1000]);
}

TEST(unit_image_flip, pictures_of_different_size_cannot_be_compared) {
  EXPECT_THROW(flip(flat(vec3(0.0f), 8), flat(vec3(0.0f), 9)), Error);
}

}  // namespace
}  // namespace candela
