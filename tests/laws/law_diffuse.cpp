// Lambert and cosine-weighted directions.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "shade/diffuse.glsl.h"
#include "support/quadrature.h"
#include "support/random.h"
#include "support/statistics.h"

namespace candela::laws {
namespace {

using shade::vec2;
using shade::vec3;
using Warp = std::function<vec3(vec2)>;
using Density = std::function<float(float cos_theta)>;

double integral(const Density& pdf) {
  const test::DirectionFunction f = [&](vec3 w) { return glm::dvec4(static_cast<double>(pdf(w.z))); };
  return test::HemisphereQuadrature(f, {}).integral().x;
}

bool warp_follows(const Warp& warp, const Density& pdf) {
  constexpr int kSamples = 100000;
  const test::DirectionFunction f = [&](vec3 w) { return glm::dvec4(0.0, 0.0, 0.0, static_cast<double>(pdf(w.z))); };
  const test::HemisphereQuadrature cells(f, {}, {1e-6, 0.005});
  std::vector<double> expected;
  for (const glm::dvec4& cell : cells.cells()) expected.push_back(cell.w * kSamples);
  std::vector<double> observed(expected.size(), 0.0);
  test::Pcg32 random(5);
  for (int i = 0; i < kSamples; ++i) observed[cells.cell_of(warp(random.next_vec2()))] += 1.0;
  return test::chi_square_test(observed, expected).p_value > test::kFamilySignificance;
}

TEST(law_diffuse, cosine_pdf_integrates_to_one) {
  EXPECT_NEAR(integral(shade::cosine_pdf), 1.0, 1e-5);
  EXPECT_GT(std::abs(integral([](float c) { return 1.03f * shade::cosine_pdf(c); }) - 1.0), 1e-2);
  EXPECT_EQ(shade::cosine_pdf(-0.5f), 0.0f);
}

TEST(law_diffuse, cosine_sample_follows_its_pdf) {
  EXPECT_TRUE(warp_follows(shade::cosine_sample, shade::cosine_pdf));
  const Warp uniform = [](vec2 u) {
    const float r = std::sqrt(1.0f - u.x * u.x);
    const float phi = 2.0f * shade::kShadePi * u.y;
    return vec3(r * std::cos(phi), r * std::sin(phi), u.x);
  };
  EXPECT_FALSE(warp_follows(uniform, shade::cosine_pdf));
  const Warp without_area = [](vec2 u) {  // polar coordinates without the square root
    const float phi = 2.0f * shade::kShadePi * u.y;
    return vec3(u.x * std::cos(phi), u.x * std::sin(phi), std::sqrt(1.0f - u.x * u.x));
  };
  EXPECT_FALSE(warp_follows(without_area, shade::cosine_pdf));
}

TEST(law_diffuse, cosine_sample_is_unit_and_above_for_all_corners) {
  for (const float x : {0.0f, 1e-7f, 0.5f, 0.75f, 0x1.fffffep-1f}) {
    for (const float y : {0.0f, 1e-7f, 0.5f, 0.75f, 0x1.fffffep-1f}) {
      const vec3 w = shade::cosine_sample(vec2(x, y));
      EXPECT_NEAR(glm::length(w), 1.0f, 1e-6f) << x << ' ' << y;
      EXPECT_GE(w.z, 0.0f);
    }
  }
}

TEST(law_diffuse, lambert_reflects_its_albedo) {
  const vec3 albedo(0.2f, 0.5f, 1.0f);
  const test::DirectionFunction f = [&](vec3 w) { return glm::dvec4(glm::dvec3(shade::lambert_f(albedo) * w.z), 0.0); };
  const glm::dvec4 reflected = test::HemisphereQuadrature(f, {}).integral();
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(reflected[c], static_cast<double>(albedo[c]), 1e-5);
}

}  // namespace
}  // namespace candela::laws
