#include <gtest/gtest.h>

#include <cmath>

#include "math/types.h"
#include "shade/area_light.glsl.h"
#include "shade/microfacet.glsl.h"

// Light of polygons in closed form, against formulas of others and against plain sums.

namespace candela {
namespace {

using namespace shade;

struct Quad {
  vec3 middle, x, y;  ///< half sides

  vec3 corner(float u, float v) const { return middle + u * x + v * y; }
  float share(const mat3& m = mat3(1.0f)) const {
    return area_share(m * corner(-1, -1), m * corner(1, -1), m * corner(1, 1), m * corner(-1, 1));
  }
  /// ∫ f(direction) dω over what lies above the horizon, by the middles of many small parts.
  template <class F>
  double sum(const F& f) const {
    constexpr int kSide = 400;
    const vec3 across = glm::cross(x, y);
    double total = 0.0;
    for (int i = 0; i < kSide; ++i) {
      for (int j = 0; j < kSide; ++j) {
        const vec3 p = corner(2.0f * (static_cast<float>(i) + 0.5f) / kSide - 1.0f,
                              2.0f * (static_cast<float>(j) + 0.5f) / kSide - 1.0f);
        if (p.z <= 0.0f) continue;
        const double d2 = static_cast<double>(glm::dot(p, p));
        const vec3 w = p / static_cast<float>(std::sqrt(d2));
        total += f(w) * std::abs(static_cast<double>(glm::dot(across, w))) * 4.0 / d2 / (kSide * kSide);
      }
    }
    return total;
  }
};

TEST(law_area_light, a_rectangle_overhead_has_the_form_factor_of_textbooks) {
  // Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", B-3: from a small element to a parallel
  // rectangle whose corner is above it; four of them make one whose middle is.
  for (const float a : {0.3f, 1.0f, 4.0f}) {
    for (const float b : {0.2f, 1.0f, 2.5f}) {
      const double x = static_cast<double>(a), y = static_cast<double>(b);
      const double quarter = (x / std::sqrt(1 + x * x) * std::atan(y / std::sqrt(1 + x * x)) +
                              y / std::sqrt(1 + y * y) * std::atan(x / std::sqrt(1 + y * y))) /
                             (2 * glm::pi<double>());
      EXPECT_NEAR(static_cast<double>(Quad{{0, 0, 1}, {a, 0, 0}, {0, b, 0}}.share()), 4 * quarter, 2e-6)
          << a << " " << b;
    }
  }
}

TEST(law_area_light, what_lies_below_the_horizon_gives_no_light) {
  const Quad whole{{1.0f, 0.2f, 0.0f}, {0, 1, 0}, {0, 0, 1}}, upper{{1.0f, 0.2f, 0.5f}, {0, 1, 0}, {0, 0, 0.5f}};
  EXPECT_NEAR(whole.share(), upper.share(), 1e-6f);
  EXPECT_EQ((Quad{{1, 0, -2}, {0, 1, 0}, {0, 0, 1}}.share()), 0.0f);
  // One corner, two and three above.
  for (const float tilt : {0.2f, 0.6f, 1.3f}) {
    const Quad q{{1.2f, 0.3f, 0.1f}, {0.3f, 0.7f, tilt}, {0.1f, -0.6f, 0.5f}};
    const double sum = q.sum([](vec3 w) { return static_cast<double>(w.z) / glm::pi<double>(); });
    EXPECT_NEAR(static_cast<double>(q.share()), sum, 1e-4) << tilt;
    EXPECT_GT(sum, 0.01);
  }
}

TEST(law_area_light, either_winding_and_a_triangle_are_right) {
  const vec3 a(-1, -1, 1), b(1, -1, 1), c(1, 1, 2), d(-1, 1, 1.5f);
  EXPECT_NEAR(area_share(a, b, c, d), area_share(d, c, b, a), 1e-6f);
  EXPECT_NEAR(area_share(a, b, c, a) + area_share(a, c, d, a), area_share(a, b, c, d), 1e-5f);
  // All of the sky.
  EXPECT_NEAR((Quad{{0, 0, 1e-3f}, {1e3f, 0, 0}, {0, 1e3f, 0}}.share()), 1.0f, 1e-4f);
}

/// How far the share of a white lobe that falls on a polygon is off: worst and mean over roughnesses, views, polygons.
std::pair<double, double> error_of_fit(float roughness_factor) {
  double worst = 0.0, sum = 0.0;
  int count = 0;
  for (const float roughness : {0.1f, 0.2f, 0.3f, 0.45f, 0.6f, 0.8f, 1.0f}) {
    const float alpha = roughness_to_alpha(roughness);
    for (const float mu : {0.1f, 0.3f, 0.5f, 0.8f, 1.0f}) {
      const vec3 wo(std::sqrt(1.0f - mu * mu), 0.0f, mu);
      double albedo = 0.0;
      constexpr int kPoints = 4096;
      for (int i = 0; i < kPoints; ++i) {
        const vec2 u((static_cast<float>(i) + 0.5f) / kPoints, glm::fract(0.618034f * static_cast<float>(i)));
        const vec3 wi = microfacet_reflect(wo, ggx_sample_visible(wo, alpha, u));
        const float lo = ggx_lambda(wo, alpha);
        if (wi.z > 0.0f) albedo += static_cast<double>((1.0f + lo) / (1.0f + lo + ggx_lambda(wi, alpha))) / kPoints;
      }
      const mat3 lobe = area_lobe(mu, roughness * roughness_factor);
      for (const Quad& q : {Quad{{-0.8f, 0.3f, 1.0f}, {0.6f, 0, 0}, {0, 0.6f, 0}},
                            Quad{{-2.0f, 0.0f, 0.6f}, {0, 0.7f, 0}, {0, 0, 0.9f}},
                            Quad{{0.3f, -1.0f, 0.8f}, {0.6f, 0, 0}, {0, 0, 0.6f}}}) {
        const double expected = q.sum([&](vec3 w) {
          return static_cast<double>(ggx_d(normalize(w + wo), alpha) * ggx_v_smith(wo, w, alpha) * w.z) / albedo;
        });
        const double error = std::abs(static_cast<double>(q.share(lobe)) - expected);
        worst = std::max(worst, error);
        sum += error;
        ++count;
      }
    }
  }
  return {worst, sum / count};
}

TEST(law_area_light, the_fitted_cosines_have_the_light_of_the_lobe) {
  const auto [worst, mean] = error_of_fit(1.0f);
  EXPECT_LT(mean, 0.013);  // of the light of a polygon that fills the whole lobe
  EXPECT_LT(worst, 0.15);  // at grazing angles, where the lobe is no stretched cosine
  // The twin: a lobe that is a fifth too wide.
  EXPECT_GT(error_of_fit(1.2f).second, 0.02);
}

}  // namespace
}  // namespace candela
