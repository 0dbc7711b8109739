// The instruments themselves, against published values: a law is as good as the p-value it is judged by.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "support/quadrature.h"
#include "support/random.h"
#include "support/statistics.h"

namespace candela::test {
namespace {

// Abramowitz & Stegun 1964, table 26.8: percentage points of χ².
TEST(unit_support, chi_square_p_values_match_the_printed_table) {
  EXPECT_NEAR(chi_square_p_value(3.84146, 1), 0.05, 1e-6);
  EXPECT_NEAR(chi_square_p_value(18.3070, 10), 0.05, 1e-6);
  EXPECT_NEAR(chi_square_p_value(2.55821, 10), 0.99, 1e-6);
  EXPECT_NEAR(chi_square_p_value(149.449, 100), 0.001, 1e-6);
  EXPECT_NEAR(chi_square_p_value(10.0, 2), std::exp(-5.0), 1e-14);
  EXPECT_NEAR(chi_square_p_value(80.0, 2) / std::exp(-40.0), 1.0, 1e-10);
  EXPECT_EQ(chi_square_p_value(0.0, 5), 1.0);
}

TEST(unit_support, normal_p_values_are_two_sided) {
  EXPECT_NEAR(normal_p_value(1.959964), 0.05, 1e-7);
  EXPECT_NEAR(normal_p_value(-3.290527), 0.001, 1e-8);
}

TEST(unit_support, sidak_threshold_restores_the_family) {
  for (const std::size_t n : {1U, 10U, 1000U, 1000000U}) {
    const double one = sidak_threshold(n);
    EXPECT_NEAR(-std::expm1(static_cast<double>(n) * std::log1p(-one)), kFamilySignificance, 1e-12);
  }
}

TEST(unit_support, chi_square_test_pools_small_bins_and_sees_a_wrong_share) {
  const std::array<double, 5> expected = {1.0, 9.0, 45.0, 40.0, 5.0};
  const std::array<double, 5> observed = {2.0, 8.0, 45.0, 42.0, 3.0};
  const ChiSquare same = chi_square_test(observed, expected);
  EXPECT_EQ(same.degrees, 2);  // {1, 9}, {45}, {40, 5}
  EXPECT_EQ(same.statistic, 0.0);
  const std::array<double, 5> shifted = {2.0, 8.0, 85.0, 2.0, 3.0};
  EXPECT_LT(chi_square_test(shifted, expected).p_value, 1e-9);
  const std::array<double, 2> nothing = {100.0, 0.0};
  const std::array<double, 2> something = {99.0, 1.0};
  EXPECT_EQ(chi_square_test(something, nothing).p_value, 1.0);  // pooled: too little to tell
}

TEST(unit_support, p_values_of_true_hypotheses_are_uniform) {
  Pcg32 random(1);
  Moments chi;
  Moments z;
  for (int repeat = 0; repeat < 400; ++repeat) {
    std::vector<double> counts(20, 0.0);
    Moments mean;
    for (int i = 0; i < 2000; ++i) {
      const float u = random.next_float();
      counts[static_cast<std::size_t>(u * 20.0f)] += 1.0;
      mean.add(static_cast<double>(u));
    }
    chi.add(chi_square_test(counts, std::vector<double>(20, 100.0)).p_value);
    z.add(z_test_p_value(mean, 0.5));
  }
  // Uniform p-values have mean 1/2 and variance 1/12; five standard errors of either.
  EXPECT_NEAR(chi.mean(), 0.5, 5.0 * std::sqrt(1.0 / 12.0 / 400.0));
  EXPECT_NEAR(z.mean(), 0.5, 5.0 * std::sqrt(1.0 / 12.0 / 400.0));
  EXPECT_NEAR(chi.variance(), 1.0 / 12.0, 5.0 * std::sqrt(1.0 / 180.0 / 400.0));
  EXPECT_NEAR(z.variance(), 1.0 / 12.0, 5.0 * std::sqrt(1.0 / 180.0 / 400.0));
}

TEST(unit_support, share_test_forgives_noise_and_sees_bias) {
  EXPECT_EQ(share_p_value(100, 10000, 0.01), 1.0);
  EXPECT_EQ(share_p_value(0, 10000, 1e-4), 1.0);
  EXPECT_LT(share_p_value(400, 10000, 0.03), 1e-6);
  EXPECT_EQ(share_p_value(10, 10000, -0.01), 0.0);
  // Five counts beyond the three forgiven ones, of a standard deviation of 50.
  EXPECT_NEAR(share_p_value(5008, 10000, 0.5), normal_p_value(0.1), 1e-9);
}

TEST(unit_support, z_test_knows_events_that_did_not_happen) {
  Moments ones;  // of a variable that is 0 once in a thousand
  for (int i = 0; i < 1000; ++i) ones.add(1.0);
  EXPECT_EQ(z_test_p_value(ones, 0.999), 0.0);
  EXPECT_NEAR(z_test_p_value(ones, 0.999, 0.0, 0.001 * 0.999), normal_p_value(1.0), 1e-3);
}

TEST(unit_support, hemisphere_quadrature_knows_its_moments) {
  const DirectionFunction f = [](glm::vec3 w) {
    const double z = static_cast<double>(w.z);
    const double x = static_cast<double>(w.x);
    return glm::dvec4(1.0, z, z * z, x * x);
  };
  const HemisphereQuadrature q(f, {});
  const double pi = std::numbers::pi;
  EXPECT_NEAR(q.integral().x, 2.0 * pi, 1e-5);
  EXPECT_NEAR(q.integral().y, pi, 1e-5);
  EXPECT_NEAR(q.integral().z, 2.0 * pi / 3.0, 1e-5);
  EXPECT_NEAR(q.integral().w, 2.0 * pi / 3.0, 1e-5);
}

// von Mises-Fisher lobes of all widths and places; well above the horizon they integrate to one (Fisher 1953).
TEST(unit_support, hemisphere_quadrature_finds_narrow_peaks) {
  for (const double width : {0.3, 0.03, 0.003}) {
    const double kappa = 1.0 / (width * width);
    for (const float z : {1.0f, 0.9999f, 0.8f}) {
      const glm::vec3 axis(0.6f * std::sqrt(1.0f - z * z), -0.8f * std::sqrt(1.0f - z * z), z);
      const DirectionFunction f = [&](glm::vec3 w) {
        const glm::dvec3 d = glm::dvec3(w) - glm::dvec3(axis);
        const double density = kappa / (2.0 * std::numbers::pi) * std::exp(-0.5 * kappa * glm::dot(d, d));
        return glm::dvec4(density, 0.0, 0.0, density);
      };
      const std::array<glm::vec3, 1> peaks = {axis};
      const HemisphereQuadrature q(f, peaks, {2e-6, 0.01});
      const double tail = width > 0.1 ? 5e-2 : 1e-4;  // a wide lobe reaches below the horizon
      EXPECT_NEAR(q.integral().x, 1.0, tail) << "width " << width << " z " << z;
      for (const glm::dvec4& cell : q.cells()) EXPECT_LT(cell.w, 0.0101);
      EXPECT_LT(q.evaluations(), 100000U);
    }
  }
}

TEST(unit_support, cells_partition_the_hemisphere) {
  const DirectionFunction f = [](glm::vec3 w) {
    return glm::dvec4(0.0, 0.0, 0.0, static_cast<double>(w.z) / std::numbers::pi);
  };
  const HemisphereQuadrature q(f, {}, {2e-6, 0.01});
  Pcg32 random(7);
  std::vector<double> counts(q.cells().size(), 0.0);
  std::vector<double> expected;
  for (const glm::dvec4& cell : q.cells()) expected.push_back(cell.w * 20000.0);
  for (int i = 0; i < 20000; ++i) {
    const glm::vec2 u = random.next_vec2();
    const float r = std::sqrt(u.x);
    const float phi = 2.0f * std::numbers::pi_v<float> * u.y;
    counts[q.cell_of({r * std::cos(phi), r * std::sin(phi), std::sqrt(1.0f - u.x)})] += 1.0;
  }
  EXPECT_GT(q.cells().size(), 100U);
  EXPECT_GT(chi_square_test(counts, expected).p_value, kFamilySignificance);
}

TEST(unit_support, integrate_handles_a_root_singularity) {
  EXPECT_NEAR(integrate([](double x) { return std::sqrt(x); }, 0.0, 1.0), 2.0 / 3.0, 1e-8);
  EXPECT_NEAR(integrate([](double x) { return std::cos(x); }, 0.0, 1.0), std::sin(1.0), 1e-12);
}

}  // namespace
}  // namespace candela::test
