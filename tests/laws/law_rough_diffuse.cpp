// Rough diffuse layers: symmetry, energy and the limits in which they are Lambert's.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "laws/bsdf_laws.h"
#include "shade/diffuse.glsl.h"
#include "support/quadrature.h"

namespace candela::laws {
namespace {

/// Of a white layer unless said otherwise; `r` in [0, 1].
using Diffuse = std::function<vec3(vec3 albedo, float r, vec3 wo, vec3 wi)>;

struct NamedDiffuse {
  std::string name;
  Diffuse f;
};

float half_cosine(vec3 wo, vec3 wi) { return std::sqrt(std::max(0.5f * (1.0f + glm::dot(wo, wi)), 0.0f)); }

vec3 burley(vec3 albedo, float r, vec3 wo, vec3 wi) {
  return shade::burley_f(albedo, r, wi.z, wo.z, half_cosine(wo, wi));
}

vec3 burley_renormalised(vec3 albedo, float r, vec3 wo, vec3 wi) {
  return shade::burley_renormalised_f(albedo, r, wi.z, wo.z, half_cosine(wo, wi));
}

const std::vector<NamedDiffuse> kModels = {{"burley", burley},
                                           {"burley renormalised", burley_renormalised},
                                           {"oren-nayar", shade::oren_nayar_f},
                                           {"eon", shade::eon_f}};

const std::vector<float> kRoughness = {0.0f, 0.1f, 0.3f, 0.5f, 0.75f, 1.0f};
const std::vector<float> kCosines = {1.0f, 0.9f, 0.5f, 0.2f, 0.05f, 0.005f};

// Simpson's rule with 2 · 32 intervals: an adaptive one would chase the rounding of single precision.
double simpson(const std::function<double(double)>& f, double a, double b) {
  constexpr int kPieces = 32;
  const double h = (b - a) / (2.0 * kPieces);
  double sum = 0.0;
  for (int i = 0; i < kPieces; ++i) sum += f(a + 2 * i * h) + 4.0 * f(a + (2 * i + 1) * h) + f(a + (2 * i + 2) * h);
  return sum * h / 3.0;
}

// ∫ f cos dω, in pieces between the kinks that these models have at θi = θo and at ±90° of azimuth.
double albedo_of(const Diffuse& f, float r, float mu, float albedo = 1.0f) {
  constexpr double kRight = 0.5 * std::numbers::pi;
  const vec3 wo = direction(mu, 0.0f);
  const double theta_o = std::acos(static_cast<double>(mu));
  const auto ring = [&](double theta) {
    const auto cos_i = static_cast<float>(std::max(std::cos(theta), 0.0));
    const auto sin_i = static_cast<float>(std::sin(theta));
    const auto at = [&](double phi) {
      const vec3 wi(sin_i * static_cast<float>(std::cos(phi)), sin_i * static_cast<float>(std::sin(phi)), cos_i);
      return static_cast<double>(f(vec3(albedo), r, wo, wi).x);
    };
    const double half_ring = simpson(at, 0.0, kRight) + simpson(at, kRight, 2.0 * kRight);
    return 2.0 * half_ring * std::sin(theta) * std::cos(theta);
  };
  return simpson(ring, 0.0, theta_o) + simpson(ring, theta_o, kRight);
}

bool is_symmetric_and_finite(const Diffuse& f) {
  const vec3 albedo(0.2f, 0.7f, 1.0f);
  for (const float r : kRoughness) {
    for (const float a : {0.0f, 1e-6f, 0.03f, 0.5f, 1.0f}) {
      for (const float b : {0.0f, 1e-5f, 0.2f, 0.9f}) {
        for (const float phi : {0.0f, 1.0f, 3.14f}) {
          const vec3 wo = direction(a, 0.4f);
          const vec3 wi = direction(b, 0.4f + phi);
          const vec3 forth = f(albedo, r, wo, wi);
          const vec3 back = f(albedo, r, wi, wo);
          for (int c = 0; c < 3; ++c) {
            if (!std::isfinite(forth[c]) || forth[c] < 0.0f) return false;
            if (std::abs(forth[c] - back[c]) > 1e-5f * std::max(forth[c], 1e-3f)) return false;
          }
        }
      }
    }
  }
  return true;
}

TEST(law_rough_diffuse, every_model_is_symmetric_finite_and_not_negative) {
  for (const NamedDiffuse& named : kModels) {
    EXPECT_TRUE(is_symmetric_and_finite(named.f)) << named.name;
    EXPECT_FALSE(is_symmetric_and_finite([&](vec3 rho, float r, vec3 wo, vec3 wi) {
      return named.f(rho, r, wo, wi) * (1.0f - 0.1f * wo.z);
    })) << named.name;
    EXPECT_FALSE(is_symmetric_and_finite([&](vec3 rho, float r, vec3 wo, vec3 wi) {
      return named.f(rho, r, wo, wi) / wi.z;
    })) << named.name;
  }
}

double highest_albedo(const Diffuse& f) {
  double highest = 0.0;
  for (const float r : kRoughness) {
    for (const float mu : kCosines) highest = std::max(highest, albedo_of(f, r, mu));
  }
  return highest;
}

TEST(law_rough_diffuse, no_more_leaves_than_arrives) {
  EXPECT_LT(highest_albedo(shade::eon_f), 1.0 + 2e-5);
  // What their authors let pass at grazing angles.
  EXPECT_LT(highest_albedo(burley_renormalised), 1.03);
  EXPECT_LT(highest_albedo(shade::oren_nayar_f), 1.01);
  EXPECT_GT(highest_albedo(burley), 1.5) << "what the renormalisation is for";
  EXPECT_GT(highest_albedo([](vec3 rho, float r, vec3 wo, vec3 wi) { return 1.001f * shade::eon_f(rho, r, wo, wi); }),
            1.0 + 2e-5);
}

// ----- Lambert's limit

bool is_lambert_when_smooth(const Diffuse& f) {
  const vec3 albedo(0.2f, 0.7f, 1.0f);
  for (const float a : kCosines) {
    for (const float b : kCosines) {
      const vec3 value = f(albedo, 0.0f, direction(a, 0.4f), direction(b, 1.0f));
      if (glm::length(value - shade::lambert_f(albedo)) > 1e-6f) return false;
    }
  }
  return true;
}

TEST(law_rough_diffuse, smooth_oren_nayar_and_eon_are_lambert) {
  EXPECT_TRUE(is_lambert_when_smooth(shade::oren_nayar_f));
  EXPECT_TRUE(is_lambert_when_smooth(shade::eon_f));
  EXPECT_FALSE(is_lambert_when_smooth(burley)) << "Burley's darkens at grazing";
  EXPECT_FALSE(is_lambert_when_smooth(
      [](vec3 rho, float r, vec3 wo, vec3 wi) { return shade::oren_nayar_f(rho, r + 0.05f, wo, wi); }));
}

// ----- known values

TEST(law_rough_diffuse, oren_nayar_is_the_model_in_angles) {
  // Oren & Nayar 1994, eq. 30, with angles and in double.
  const auto worst = [](const Diffuse& f) {
    double error = 0.0;
    for (const double sigma : {0.1, 0.35, 0.9}) {
      const double s2 = sigma * sigma;
      for (const double ti : {0.2, 0.8, 1.4}) {
        for (const double to : {0.1, 0.8, 1.3}) {
          for (const double phi : {0.0, 0.5, 2.5}) {
            const double a = 1.0 - 0.5 * s2 / (s2 + 0.33);
            const double b = 0.45 * s2 / (s2 + 0.09);
            const double lobe = std::max(std::cos(phi), 0.0) * std::sin(std::max(ti, to)) * std::tan(std::min(ti, to));
            const double expected = 0.5 * (a + b * lobe) / std::numbers::pi;
            const vec3 wo = direction(static_cast<float>(std::cos(to)), 0.3f);
            const vec3 wi = direction(static_cast<float>(std::cos(ti)), 0.3f + static_cast<float>(phi));
            const auto value = static_cast<double>(f(vec3(0.5f), static_cast<float>(sigma), wo, wi).x);
            error = std::max(error, std::abs(value / expected - 1.0));
          }
        }
      }
    }
    return error;
  };
  EXPECT_LT(worst(shade::oren_nayar_f), 1e-5);
  EXPECT_GT(worst([](vec3 rho, float s, vec3 wo, vec3 wi) { return shade::oren_nayar_f(rho, s * s, wo, wi); }), 1e-2)
      << "variance for deviation";
}

TEST(law_rough_diffuse, burley_at_known_points) {
  // Along the normal the Fresnel factors are 1; retroreflection at grazing is F_D90² = (1/2 + 2 r)².
  EXPECT_NEAR(shade::burley_f(vec3(1.0f), 0.7f, 1.0f, 1.0f, 1.0f).x, 1.0f / shade::kShadePi, 1e-6f);
  EXPECT_NEAR(shade::burley_f(vec3(1.0f), 0.7f, 0.0f, 0.0f, 1.0f).x, 1.9f * 1.9f / shade::kShadePi, 1e-5f);
  EXPECT_NEAR(shade::burley_f(vec3(1.0f), 0.7f, 0.0f, 1.0f, 0.5f).x, 0.85f / shade::kShadePi, 1e-5f);
  EXPECT_NEAR(shade::burley_renormalised_f(vec3(1.0f), 1.0f, 1.0f, 1.0f, 1.0f).x, 1.0f / (1.51f * shade::kShadePi),
              1e-6f);
  EXPECT_NEAR(shade::burley_renormalised_f(vec3(1.0f), 1.0f, 0.0f, 1.0f, 1.0f).x, 2.5f / (1.51f * shade::kShadePi),
              1e-5f);
}

// ----- EON

double worst_furnace(const Diffuse& f) {
  double worst = 0.0;
  for (const float r : kRoughness) {
    for (const float mu : kCosines) worst = std::max(worst, std::abs(albedo_of(f, r, mu) - 1.0));
  }
  return worst;
}

// As the OpenPBR 1.1.1 page prints the second term: 1/π once too often.
vec3 eon_misprint(vec3 rho, float r, vec3 wo, vec3 wi) {
  const float a = 1.0f / (1.0f + shade::kEonEdge * r);
  const float s = wo.x * wi.x + wo.y * wi.y;
  const float lobe = s > 0.0f ? s / std::max(wo.z, wi.z) : s;
  const vec3 single = rho * (a * (1.0f + r * lobe) / shade::kShadePi);
  return single + (shade::eon_f(rho, r, wo, wi) - single) / shade::kShadePi;
}

TEST(law_rough_diffuse, white_eon_reflects_a_white_furnace) {
  EXPECT_LT(worst_furnace(shade::eon_f), 2e-5);
  EXPECT_GT(worst_furnace(eon_misprint), 0.1);
  EXPECT_NEAR(albedo_of(eon_misprint, 1.0f, 0.9f), 0.853, 2e-3);
  EXPECT_GT(worst_furnace(shade::oren_nayar_f), 0.1) << "the model of 1994 loses light";
}

TEST(law_rough_diffuse, eon_albedo_is_that_of_single_scattering) {
  // Single scattering is what remains of EON for small albedos.
  constexpr float kSmall = 1e-3f;
  const auto worst = [](const std::function<float(float mu, float r)>& e) {
    double error = 0.0;
    for (const float r : kRoughness) {
      for (const float mu : kCosines) {
        const double single = albedo_of(shade::eon_f, r, mu, kSmall) / static_cast<double>(kSmall);
        error = std::max(error, std::abs(static_cast<double>(e(mu, r)) - single));
      }
    }
    return error;
  };
  EXPECT_LT(worst(shade::eon_albedo), 1e-3) << "which is the albedo";
  EXPECT_LT(worst(shade::eon_albedo_fit), 1.5e-3);
  EXPECT_GT(worst([](float mu, float r) { return shade::eon_albedo(mu, r * r); }), 1e-2);
  EXPECT_GT(worst([](float, float r) { return shade::eon_albedo(0.5f, r); }), 1e-2);
}

TEST(law_rough_diffuse, eon_fit_and_mean_are_those_of_the_exact_curve) {
  const auto worst = [](const std::function<float(float)>& fit) {
    float error = 0.0f;
    for (int i = 0; i <= 200; ++i) {
      const float mu = static_cast<float>(i) / 200.0f;
      error = std::max(error, std::abs(fit(mu) - shade::eon_rise(mu)));
    }
    return error;
  };
  EXPECT_LT(worst(shade::eon_rise_fit), 7e-4f);
  EXPECT_GT(worst([](float mu) { return 1.01f * shade::eon_rise_fit(mu); }), 7e-4f);
  const auto mean =
      test::integrate([](double mu) { return 2.0 * mu * static_cast<double>(shade::eon_rise(static_cast<float>(mu))); },
                      0.0, 1.0, 1e-8);
  EXPECT_NEAR(mean, static_cast<double>(shade::kEonMean), 1e-6);
  EXPECT_NEAR(shade::eon_rise(0.0f), shade::kEonEdge, 1e-6f);
  EXPECT_NEAR(shade::eon_rise(1.0f), 0.0f, 1e-6f);
  EXPECT_NEAR(static_cast<double>(shade::kEonEdge), 0.5 - 2.0 / (3.0 * std::numbers::pi), 1e-7);
  EXPECT_NEAR(static_cast<double>(shade::kEonMean), 2.0 / 3.0 - 28.0 / (15.0 * std::numbers::pi), 1e-7);
}

TEST(law_rough_diffuse, eon_is_more_saturated_than_its_albedo_when_rough) {
  // Light that bounces between walls is tinted again: below ρ for every 0 < ρ < 1, equal at both ends.
  for (const float rho : {0.1f, 0.5f, 0.9f}) {
    EXPECT_LT(albedo_of(shade::eon_f, 1.0f, 0.7f, rho), static_cast<double>(rho));
    EXPECT_NEAR(albedo_of(shade::eon_f, 0.0f, 0.7f, rho), static_cast<double>(rho), 1e-5);
  }
}

}  // namespace
}  // namespace candela::laws
