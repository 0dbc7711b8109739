#include "ibl/kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "laws/quadrature.h"
#include "shade/microfacet.glsl.h"

namespace candela::ibl {
namespace {

constexpr double kPiD = std::numbers::pi;

/// 2π ∫ K(c) c^power dc by other panels than the kernel's own.
double moment(const Kernel& kernel, int power) {
  return laws::integrate(
      [&](double theta) {
        const double s = std::sin(0.5 * theta);
        return 2.0 * kPiD * std::sin(theta) * kernel(2.0 * s * s) * std::pow(std::cos(theta), power);
      },
      0.0, kPiD / 2.0, 1e-10);
}

TEST(kernel, every_lobe_integrates_to_one) {
  for (const Lobe lobe : {Lobe::cosine, Lobe::ggx, Lobe::charlie}) {
    for (const double roughness : {0.15, 0.3, 0.6, 1.0}) EXPECT_NEAR(moment(Kernel(lobe, roughness), 0), 1.0, 1e-6);
  }
}

TEST(kernel, its_coefficients_are_its_legendre_moments) {
  for (const Lobe lobe : {Lobe::cosine, Lobe::ggx, Lobe::charlie}) {
    for (const double roughness : {0.15, 0.4, 1.0}) {
      const Kernel kernel(lobe, roughness);
      const std::vector<double> k = kernel.coefficients(300);
      const double c1 = moment(kernel, 1), c2 = moment(kernel, 2), c3 = moment(kernel, 3);
      EXPECT_NEAR(k[0], 1.0, 1e-6);
      EXPECT_NEAR(k[1], c1, 1e-6);
      EXPECT_NEAR(k[2], 0.5 * (3.0 * c2 - 1.0), 1e-6);
      EXPECT_NEAR(k[3], 0.5 * (5.0 * c3 - 3.0 * c1), 1e-6);
    }
  }
}

TEST(kernel, the_cosine_lobe_has_the_published_coefficients) {
  // Ramamoorthi & Hanrahan 2001, eq. 8, over π.
  const std::vector<double> k = Kernel(Lobe::cosine, 1.0).coefficients(8);
  const double expected[] = {1.0, 2.0 / 3.0, 0.25, 0.0, -1.0 / 24.0, 0.0, 1.0 / 64.0, 0.0};
  for (std::size_t l = 0; l < 8; ++l) EXPECT_NEAR(k[l], expected[l], 1e-12) << l;
}

TEST(kernel, ggx_is_the_materials_distribution_at_the_halfway_vector) {
  for (const float roughness : {0.2f, 0.5f, 1.0f}) {
    const Kernel kernel(Lobe::ggx, static_cast<double>(roughness));
    const auto ratio = [&](float theta) {
      const shade::vec3 wm(std::sin(0.5f * theta), 0.0f, std::cos(0.5f * theta));
      const double d = static_cast<double>(shade::ggx_d(wm, shade::roughness_to_alpha(roughness)) * std::cos(theta));
      return kernel(1.0 - std::cos(static_cast<double>(theta))) / d;
    };
    for (const float theta : {0.1f, 0.4f, 1.2f}) EXPECT_NEAR(ratio(theta) / ratio(0.01f), 1.0, 1e-5);
  }
}

TEST(kernel, charlie_is_the_materials_distribution_at_the_halfway_vector) {
  for (const float roughness : {0.2f, 0.5f, 1.0f}) {
    const Kernel kernel(Lobe::charlie, static_cast<double>(roughness));
    const auto ratio = [&](float theta) {
      const shade::vec3 wm(std::sin(0.5f * theta), 0.0f, std::cos(0.5f * theta));
      const double d =
          static_cast<double>(shade::charlie_d(wm, shade::roughness_to_alpha(roughness)) * std::cos(theta));
      return kernel(1.0 - std::cos(static_cast<double>(theta))) / d;
    };
    for (const float theta : {0.8f, 1.2f, 1.5f}) EXPECT_NEAR(ratio(theta) / ratio(1.0f), 1.0, 1e-4);
  }
}

}  // namespace
}  // namespace candela::ibl
