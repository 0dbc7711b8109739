// The curves that stand in for Fresnel's, against their ends, their published shape and the exact ones.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "shade/fresnel.glsl.h"
#include "support/quadrature.h"

namespace candela::laws {
namespace {

using shade::vec3;
using Curve = std::function<float(float f0, float cos_theta)>;

struct NamedCurve {
  std::string name;
  Curve f;
};

const std::vector<NamedCurve> kCurves = {
    {"schlick", [](float f0, float c) { return shade::fresnel_schlick(vec3(f0), vec3(1.0f), c).x; }},
    {"spherical gaussian", [](float f0, float c) { return shade::fresnel_spherical_gaussian(vec3(f0), c).x; }},
    {"f82 untinted", [](float f0, float c) { return shade::fresnel_f82(vec3(f0), vec3(1.0f), c).x; }},
    {"schlick dielectric", [](float f0, float c) { return shade::schlick_dielectric(vec3(f0), c, 1.5f).x; }}};

// F0 at the normal, 1 at grazing, falling with the cosine in between.
bool rises_from_f0_to_one(const Curve& f) {
  for (const float f0 : {0.0f, 0.02f, 0.04f, 0.5f, 0.95f}) {
    if (std::abs(f(f0, 1.0f) - f0) > 2e-4f || std::abs(f(f0, 0.0f) - 1.0f) > 1e-6f) return false;
    float previous = f(f0, 0.0f);
    for (int i = 1; i <= 100; ++i) {
      const float value = f(f0, static_cast<float>(i) / 100.0f);
      if (!(value <= previous) || value > 1.0f) return false;
      previous = value;
    }
  }
  return true;
}

TEST(law_fresnel_models, every_curve_rises_from_f0_to_one) {
  for (const NamedCurve& named : kCurves) {
    EXPECT_TRUE(rises_from_f0_to_one(named.f)) << named.name;
    EXPECT_FALSE(rises_from_f0_to_one([&](float f0, float c) { return named.f(f0, 1.0f - c); })) << named.name;
    EXPECT_FALSE(rises_from_f0_to_one([&](float f0, float c) { return 0.999f * named.f(f0, c); })) << named.name;
  }
}

TEST(law_fresnel_models, spherical_gaussian_is_schlick_within_half_a_per_cent) {
  const auto worst = [](const Curve& f) {
    float error = 0.0f;
    for (int i = 0; i <= 200; ++i) {
      const float c = static_cast<float>(i) / 200.0f;
      error = std::max(error, std::abs(f(0.04f, c) - kCurves[0].f(0.04f, c)));
    }
    return error;
  };
  EXPECT_LT(worst(kCurves[1].f), 0.005f);
  EXPECT_GT(worst([](float f0, float c) { return f0 + (1.0f - f0) * std::exp((-5.55473f * c - 6.98316f) * c); }), 0.02f)
      << "e in place of 2";
}

// ----- F82

TEST(law_fresnel_models, f82_passes_through_its_three_colours) {
  using Tinted = std::function<vec3(vec3 f0, vec3 tint, float c)>;
  const auto passes = [](const Tinted& f) {
    const vec3 f0(0.9f, 0.6f, 0.3f);
    for (const vec3 tint : {vec3(1.0f, 0.8f, 0.5f), vec3(0.0f), vec3(0.3f, 1.0f, 0.9f)}) {
      const vec3 at_82 = tint * shade::fresnel_schlick(f0, vec3(1.0f), 1.0f / 7.0f);
      if (glm::length(f(f0, tint, 1.0f) - f0) > 1e-6f) return false;
      if (glm::length(f(f0, tint, 0.0f) - vec3(1.0f)) > 1e-6f) return false;
      if (glm::length(f(f0, tint, 1.0f / 7.0f) - at_82) > 1e-5f) return false;
    }
    return true;
  };
  EXPECT_TRUE(passes(shade::fresnel_f82));
  EXPECT_FALSE(passes([](vec3 f0, vec3 tint, float c) { return tint * shade::fresnel_f82(f0, vec3(1.0f), c); }));
  EXPECT_FALSE(passes([](vec3 f0, vec3 tint, float c) { return shade::fresnel_f82(f0, tint * tint, c); }));
  for (int i = 0; i <= 100; ++i) {
    EXPECT_GE(shade::fresnel_f82(vec3(0.9f), vec3(0.0f), static_cast<float>(i) / 100.0f).x, 0.0f);
  }
}

// Aluminium at 650 nm is where Schlick errs most among common metals.
TEST(law_fresnel_models, f82_follows_a_metal_better_than_schlick) {
  const float n = 1.4748f, k = 7.7941f;
  const float f0 = shade::fresnel_conductor(1.0f, n, k);
  const float tint =
      shade::fresnel_conductor(1.0f / 7.0f, n, k) / shade::fresnel_schlick(vec3(f0), vec3(1.0f), 1.0f / 7.0f).x;
  const auto worst = [&](float t) {
    float error = 0.0f;
    for (int i = 5; i <= 100; ++i) {
      const float c = static_cast<float>(i) / 100.0f;
      error = std::max(error, std::abs(shade::fresnel_f82(vec3(f0), vec3(t), c).x - shade::fresnel_conductor(c, n, k)));
    }
    return error;
  };
  EXPECT_LT(worst(tint), 0.03f);
  EXPECT_GT(worst(1.0f), 3.0f * worst(tint)) << "Schlick";
}

TEST(law_fresnel_models, conductor3_is_conductor_by_channel) {
  const vec3 n(0.2f, 0.9f, 1.5f), k(3.6f, 2.6f, 1.9f);
  const vec3 f = shade::fresnel_conductor3(0.6f, n, k);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(f[c], shade::fresnel_conductor(0.6f, n[c], k[c]));
  EXPECT_NE(f.x, f.y);
}

// ----- polarisation

TEST(law_fresnel_models, polarisations_average_to_the_unpolarised) {
  for (const float eta : {1.0f / 2.42f, 1.0f / 1.5f, 1.1f, 1.5f, 2.42f}) {
    for (int i = 0; i <= 100; ++i) {
      const float c = static_cast<float>(i) / 100.0f;
      const float s = shade::fresnel_dielectric_s(c, eta);
      const float p = shade::fresnel_dielectric_p(c, eta);
      EXPECT_NEAR(0.5f * (s + p), shade::fresnel_dielectric(c, eta), 1e-5f) << eta << ' ' << c;
      EXPECT_GE(s, p - 1e-6f);
    }
  }
}

TEST(law_fresnel_models, parallel_light_passes_at_brewsters_angle) {
  for (const float eta : {1.0f / 2.42f, 1.0f / 1.5f, 1.33f, 1.5f, 2.42f}) {
    const float brewster = 1.0f / std::sqrt(1.0f + eta * eta);  // tan θ = eta
    EXPECT_LT(shade::fresnel_dielectric_p(brewster, eta), 1e-10f);
    EXPECT_GT(shade::fresnel_dielectric_s(brewster, eta), 1e-3f) << "the other polarisation does not vanish";
    EXPECT_GT(shade::fresnel_dielectric_p(1.05f * brewster, eta), 1e-6f);
  }
}

// ----- both sides of a boundary

using Boundary = std::function<vec3(vec3 f0, float cos_theta, float eta)>;

TEST(law_fresnel_models, schlick_reflects_the_same_from_both_sides) {
  const auto reversible = [](const Boundary& f) {
    for (const float n : {1.33f, 1.5f, 2.42f}) {
      const vec3 f0(shade::f0_from_eta(n));
      for (int i = 1; i <= 50; ++i) {
        const float outside = static_cast<float>(i) / 50.0f;
        const float inside = std::sqrt(1.0f - (1.0f - outside * outside) / (n * n));
        if (std::abs(f(f0, outside, n).x - f(f0, inside, 1.0f / n).x) > 1e-4f) return false;
      }
      const float critical = std::sqrt(1.0f - 1.0f / (n * n));
      if (f(f0, critical - 1e-4f, 1.0f / n).x != 1.0f || f(f0, 0.0f, 1.0f / n).x != 1.0f) return false;
    }
    return true;
  };
  EXPECT_TRUE(reversible(shade::schlick_dielectric));
  EXPECT_FALSE(reversible([](vec3 f0, float c, float) { return shade::fresnel_schlick(f0, vec3(1.0f), c); }))
      << "the denser side's angle";
  EXPECT_FALSE(reversible([](vec3 f0, float c, float eta) { return shade::schlick_dielectric(f0, c, 1.0f / eta); }));
}

// ----- averages and scales

TEST(law_fresnel_models, average_of_schlick_is_its_integral) {
  const vec3 f0(0.04f, 0.5f, 1.0f);
  const vec3 f90(1.0f, 0.9f, 1.0f);
  const vec3 average = shade::fresnel_average_schlick(f0, f90);
  for (int c = 0; c < 3; ++c) {
    const auto integrand = [&](double mu) {
      return 2.0 * mu * static_cast<double>(shade::fresnel_schlick(f0, f90, static_cast<float>(mu))[c]);
    };
    EXPECT_NEAR(test::integrate(integrand, 0.0, 1.0, 1e-8), static_cast<double>(average[c]), 1e-6);
  }
  EXPECT_NEAR(average.x, 0.085714f, 1e-5f) << "7 % below the exact average of index 1.5, .09178";
  EXPECT_GT(std::abs(average.x - (0.04f + 0.96f / 20.0f)), 1e-3f);
}

TEST(law_fresnel_models, specular_one_half_is_glass) {
  EXPECT_NEAR(shade::f0_from_specular(0.5f), shade::f0_from_eta(1.5f), 1e-7f);
  EXPECT_GT(std::abs(shade::f0_from_specular(0.55f) - shade::f0_from_eta(1.5f)), 1e-3f);
  EXPECT_EQ(shade::f0_from_specular(0.0f), 0.0f);
}

}  // namespace
}  // namespace candela::laws
