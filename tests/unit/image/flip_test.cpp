#include "image/flip.h"

#include <gtest/gtest.h>

#include <cmath>

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

/// A colour of the linear opponent space: achromatic, red to green, blue to yellow.
vec3 opponent(vec3 o) {
  const glm::mat3 xyz_from_rgb(vec3(0.4124564f, 0.2126729f, 0.0193339f), vec3(0.3575761f, 0.7151522f, 0.1191920f),
                               vec3(0.1804375f, 0.0721750f, 0.9503041f));
  const float y = (o.x + 16.0f) / 116.0f;
  return glm::inverse(xyz_from_rgb) * (vec3(y + o.y / 500.0f, y, y - o.z / 200.0f) * (xyz_from_rgb * vec3(1.0f)));
}

TEST(unit_image_flip, gratings_fade_with_their_frequency_as_the_eye_sees_them) {
  // Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images", table 1: each channel of a grating of
  // f cycles per degree is left with the share S(f).
  struct Case {
    vec3 amplitude;
    int period;  // pixels
    double (*share)(double);
  };
  const Case cases[] = {{{3.0f, 0, 0}, 4, [](double f) { return std::exp(-0.0047 * f * f); }},
                        {{0, 15.0f, 0}, 6, [](double f) { return std::exp(-0.0053 * f * f); }},
                        {{0, 0, 20.0f}, 16, [](double f) {
                           return (34.1 * std::exp(-0.04 * f * f) + 13.5 * std::exp(-0.025 * f * f)) / 47.6;
                         }}};
  constexpr double kPixelsPerDegree = 67.0;
  const vec3 gray(7.2f, 0, 0);
  for (const Case& c : cases) {
    Image grating = flat(vec3(0.0f), 64);
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const float wave = std::cos(6.2831853f * static_cast<float>(x) / static_cast<float>(c.period));
        grating.set_rgb(x, y, opponent(gray + c.amplitude * wave));
      }
    }
    const auto left = static_cast<float>(c.share(kPixelsPerDegree / c.period));
    const Image even = flat(opponent(gray), 64);
    const double expected = flip_mean(even, flat(opponent(gray + c.amplitude * left), 64));
    const int crest = 32 / c.period * c.period;
    EXPECT_NEAR(static_cast<double>(flip(even, grating, kPixelsPerDegree).at(crest, 32)[0]) / expected, 1.0, 0.05)
        << "period " << c.period;
  }
}

TEST(unit_image_flip, a_slope_where_there_was_none_counts_more_than_its_colour) {
  // At its middle the slope has the colour of the plain picture, an edge everywhere and points nowhere.
  Image slope = flat(vec3(0.0f), 65);
  for (int y = 0; y < 65; ++y) {
    for (int x = 0; x < 65; ++x) slope.set_rgb(x, y, vec3(0.4f + 0.004f * static_cast<float>(x - 32)));
  }
  const Image even = flat(vec3(0.35f), 65);
  EXPECT_GT(static_cast<double>(flip(even, slope).at(32, 32)[0]), 1.1 * flip_mean(even, flat(vec3(0.4f), 65)));
}

TEST(unit_image_flip, pictures_of_different_size_cannot_be_compared) {
  EXPECT_THROW(flip(flat(vec3(0.0f), 8), flat(vec3(0.0f), 9)), Error);
}

}  // namespace
}  // namespace candela
