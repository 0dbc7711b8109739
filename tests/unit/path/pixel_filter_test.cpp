#include "path/pixel_filter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/quadrature.h"
#include "support/random.h"
#include "support/statistics.h"

namespace candela {
namespace {

using namespace test;
using path::PixelFilter;
using path::PixelFilterSampler;

struct Profile {
  PixelFilter filter;
  const char* name;
  std::function<double(double)> density;  ///< not normalised, over [-1, 1]
};

std::vector<Profile> profiles() {
  return {{PixelFilter::box, "box", [](double) { return 1.0; }},
          {PixelFilter::gaussian, "gaussian", [](double t) { return std::exp(-4.5 * t * t) - std::exp(-4.5); }},
          {PixelFilter::blackman_harris, "blackman-harris", [](double t) {
             const double x = M_PI * (t + 1.0);  // Harris' window runs over [0, 2π]
             return 0.35875 - 0.48829 * std::cos(x) + 0.14128 * std::cos(2.0 * x) - 0.01168 * std::cos(3.0 * x);
           }}};
}

double p_value(PixelFilter filter, float radius, const std::function<double(double)>& density) {
  constexpr int kBins = 64, kSamples = 100000;
  const PixelFilterSampler sampler(filter, radius);
  const double r = static_cast<double>(sampler.radius());
  std::vector<double> observed(kBins, 0.0), expected(kBins, 0.0);
  Pcg32 random(3);
  for (int i = 0; i < kSamples; ++i) {
    const vec2 p = sampler.sample(random.next_vec2());
    for (const float x : {p.x, p.y}) {
      const int bin = static_cast<int>(std::floor((static_cast<double>(x) / r + 1.0) * 0.5 * kBins));
      EXPECT_TRUE(bin >= 0 && bin <= kBins) << x;
      observed[static_cast<std::size_t>(std::min(bin, kBins - 1))] += 1.0;
    }
  }
  const double total = integrate(density, -1.0, 1.0);
  for (int i = 0; i < kBins; ++i) {
    expected[static_cast<std::size_t>(i)] =
        2.0 * kSamples * integrate(density, 2.0 * i / kBins - 1.0, 2.0 * (i + 1) / kBins - 1.0) / total;
  }
  return chi_square_test(observed, expected).p_value;
}

TEST(unit_path_pixel_filter, samples_have_the_density_of_the_profile) {
  for (const Profile& p : profiles()) {
    EXPECT_GT(p_value(p.filter, 0.0f, p.density), sidak_threshold(6)) << p.name;
    EXPECT_GT(p_value(p.filter, 2.3f, p.density), sidak_threshold(6)) << p.name;
  }
}

TEST(unit_path_pixel_filter, profiles_are_told_apart) {
  for (const Profile& a : profiles()) {
    for (const Profile& b : profiles()) {
      if (a.filter == b.filter) continue;
      EXPECT_LT(p_value(a.filter, 0.0f, b.density), 1e-6) << a.name << " for " << b.name;
    }
  }
}

TEST(unit_path_pixel_filter, second_moment_is_the_profiles) {
  for (const Profile& p : profiles()) {
    const PixelFilterSampler sampler(p.filter, 1.0f);
    double mean = 0.0, square = 0.0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      const double x = static_cast<double>(sampler.sample(vec2((static_cast<float>(i) + 0.5f) / kSteps, 0.5f)).x);
      mean += x / kSteps;
      square += x * x / kSteps;
    }
    const double expected =
        integrate([&](double t) { return t * t * p.density(t); }, -1.0, 1.0) / integrate(p.density, -1.0, 1.0);
    EXPECT_NEAR(mean, 0.0, 1e-4) << p.name;
    EXPECT_NEAR(square, expected, 3e-4) << p.name;
  }
}

TEST(unit_path_pixel_filter, radius_is_the_settings_or_the_filters_own) {
  EXPECT_FLOAT_EQ(PixelFilterSampler(PixelFilter::box, 0.0f).radius(), 0.5f);
  EXPECT_FLOAT_EQ(PixelFilterSampler(PixelFilter::gaussian, 0.0f).radius(), 1.5f);
  EXPECT_FLOAT_EQ(PixelFilterSampler(PixelFilter::blackman_harris, 0.0f).radius(), 1.5f);
  for (const Profile& p : profiles()) {
    const PixelFilterSampler sampler(p.filter, 2.0f);
    EXPECT_FLOAT_EQ(sampler.radius(), 2.0f);
    EXPECT_NEAR(sampler.sample(vec2(0.0f)).x, -2.0f, 1e-3f) << p.name;
    EXPECT_LE(sampler.sample(vec2(0x1.fffffep-1f)).x, 2.0f) << p.name;
    EXPECT_GT(sampler.sample(vec2(0x1.fffffep-1f)).x, 1.9f) << p.name;
  }
}

}  // namespace
}  // namespace candela
