// Fresnel against published numbers. Hemispherical averages by quadrature: Egan & Hilgeman 1979, "Optical Properties of
// Inhomogeneous Materials"; n, k of metals at 550 nm: Palik 1985, "Handbook of Optical Constants of Solids".

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <vector>

#include "shade/fresnel.glsl.h"
#include "support/quadrature.h"

namespace candela::laws {
namespace {

using shade::vec3;
using Reflectance = std::function<double(double cos_theta, double eta)>;

double real_dielectric(double cos_theta, double eta) {
  return static_cast<double>(shade::fresnel_dielectric(static_cast<float>(cos_theta), static_cast<float>(eta)));
}

// The textbook form with both polarisations, in double and complex numbers: Born & Wolf 1999, §1.5.2, eq. 20-21.
double textbook(double cos_theta, std::complex<double> eta) {
  const double sin2 = 1.0 - cos_theta * cos_theta;
  const std::complex<double> cos_t = std::sqrt(1.0 - sin2 / (eta * eta));
  const std::complex<double> rs = (cos_theta - eta * cos_t) / (cos_theta + eta * cos_t);
  const std::complex<double> rp = (eta * cos_theta - cos_t) / (eta * cos_theta + cos_t);
  return 0.5 * (std::norm(rs) + std::norm(rp));
}

// 2 ∫ F(μ) μ dμ; split where total reflection begins, since F has a vertical tangent there.
double hemispherical_average(const Reflectance& f, double eta) {
  const double critical = eta < 1.0 ? std::sqrt(1.0 - eta * eta) : 0.0;
  const auto integrand = [&](double mu) { return 2.0 * mu * f(mu, eta); };
  return test::integrate(integrand, 0.0, critical, 1e-6) + test::integrate(integrand, critical, 1.0, 1e-6);
}

struct Average {
  double n, external, internal;
};

// Recomputed by quadrature of the textbook form; n = 1.5 agrees with Egan & Hilgeman's table.
const std::vector<Average> kAverages = {{1.33, .06593, .47195}, {1.40, .07681, .52899}, {1.50, .09178, .59635},
                                        {1.52, .09471, .60817}, {1.60, .10625, .65088}, {1.80, .13405, .73273},
                                        {2.00, .16060, .79015}, {2.42, .21254, .86554}};

bool averages_are_published(const Reflectance& f) {
  for (const Average& row : kAverages) {
    const double external = hemispherical_average(f, row.n);
    const double internal = hemispherical_average(f, 1.0 / row.n);
    if (std::abs(external - row.external) > 2e-5 || std::abs(internal - row.internal) > 2e-5) return false;
    // Reciprocity of what passes (Duntley 1942): n² T_int = T_ext.
    if (std::abs(internal - (1.0 - (1.0 - external) / (row.n * row.n))) > 2e-5) return false;
  }
  return true;
}

TEST(law_fresnel, dielectric_averages_are_the_published_ones) { EXPECT_TRUE(averages_are_published(real_dielectric)); }

TEST(law_fresnel, dielectric_averages_catch_mutants) {
  EXPECT_FALSE(averages_are_published([](double c, double eta) { return real_dielectric(c, 1.0 / eta); }))
      << "eta swapped";
  EXPECT_FALSE(averages_are_published([](double c, double eta) { return 1.001 * real_dielectric(c, eta); }));
  EXPECT_FALSE(averages_are_published([](double c, double eta) {
    return static_cast<double>(
        shade::fresnel_schlick(vec3(shade::f0_from_eta(static_cast<float>(eta))), vec3(1.0f), static_cast<float>(c)).x);
  })) << "Schlick in place of the exact curve";
}

TEST(law_fresnel, dielectric_equals_the_textbook_at_every_angle) {
  for (const double eta : {1.0 / 2.42, 1.0 / 1.5, 0.9, 1.1, 1.33, 1.5, 2.42}) {
    for (int i = 0; i <= 200; ++i) {
      const double mu = i / 200.0;
      EXPECT_NEAR(real_dielectric(mu, eta), textbook(mu, eta), 2e-5) << "eta " << eta << " cos " << mu;
    }
  }
}

TEST(law_fresnel, dielectric_limits) {
  for (const Average& row : kAverages) {
    const double f0 = std::pow((row.n - 1.0) / (row.n + 1.0), 2.0);
    EXPECT_NEAR(real_dielectric(1.0, row.n), f0, 1e-6);
    EXPECT_NEAR(real_dielectric(1.0, 1.0 / row.n), f0, 1e-6);
    EXPECT_NEAR(static_cast<double>(shade::f0_from_eta(static_cast<float>(row.n))), f0, 1e-6);
    EXPECT_NEAR(real_dielectric(0.0, row.n), 1.0, 1e-6);
  }
  for (const double mu : {1e-4, 0.1, 0.5, 1.0}) EXPECT_EQ(real_dielectric(mu, 1.0), 0.0) << "nothing changes at eta 1";
}

TEST(law_fresnel, total_internal_reflection_begins_at_the_critical_angle) {
  for (const double n : {1.33, 1.5, 2.42}) {
    const double critical = std::sqrt(1.0 - 1.0 / (n * n));
    EXPECT_EQ(real_dielectric(critical - 1e-4, 1.0 / n), 1.0);
    EXPECT_EQ(real_dielectric(0.0, 1.0 / n), 1.0);
    EXPECT_LT(real_dielectric(critical + 1e-3, 1.0 / n), 0.95);
    EXPECT_LT(real_dielectric(0.5 * (1.0 + critical), 1.0 / n), 0.3);
  }
}

// Stokes reversibility: both sides of a boundary reflect the same along one refracted path.
TEST(law_fresnel, both_sides_reflect_the_same_along_a_path) {
  const auto reversible = [](const Reflectance& f) {
    for (int i = 1; i <= 50; ++i) {
      const double mu = i / 50.0;
      const double inside = std::sqrt(1.0 - (1.0 - mu * mu) / (1.5 * 1.5));
      if (std::abs(f(mu, 1.5) - f(inside, 1.0 / 1.5)) > 1e-5) return false;
    }
    return true;
  };
  EXPECT_TRUE(reversible(real_dielectric));
  EXPECT_FALSE(reversible([](double c, double) { return real_dielectric(c, 1.5); })) << "eta not inverted inside";
}

double real_conductor(double cos_theta, double n, double k) {
  return static_cast<double>(
      shade::fresnel_conductor(static_cast<float>(cos_theta), static_cast<float>(n), static_cast<float>(k)));
}

using Conductor = std::function<double(double cos_theta, double n, double k)>;

bool conductor_is_right(const Conductor& f) {
  // Au, Ag, Al, Cu at 550 nm; and strong and weak absorption in general.
  const double metals[][2] = {{.3504, 2.7141}, {.1248, 3.3396}, {.9586, 6.6870},
                              {.9582, 2.5771}, {1.5, 0.1},      {2.0, 2.0}};
  for (const auto& [n, k] : metals) {
    const double normal = ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k);
    if (std::abs(f(1.0, n, k) - normal) > 1e-5) return false;
    for (int i = 1; i <= 100; ++i) {
      const double mu = i / 100.0;
      if (std::abs(f(mu, n, k) - textbook(mu, {n, k})) > 5e-5) return false;
    }
  }
  for (const double n : {1.1, 1.5, 2.42}) {
    for (int i = 0; i <= 100; ++i) {
      if (std::abs(f(i / 100.0, n, 0.0) - textbook(i / 100.0, n)) > 5e-5) return false;
    }
  }
  return true;
}

TEST(law_fresnel, conductor_equals_the_textbook_and_without_absorption_the_dielectric) {
  EXPECT_TRUE(conductor_is_right(real_conductor));
  EXPECT_NEAR(real_conductor(0.0, 1.5, 2.0), 1.0, 1e-6);
}

TEST(law_fresnel, conductor_catches_mutants) {
  EXPECT_FALSE(conductor_is_right([](double c, double n, double k) { return real_conductor(c, n, 1.01 * k); }));
  EXPECT_FALSE(conductor_is_right([](double c, double n, double k) { return real_conductor(c, k, n); }))
      << "n, k swapped";
  EXPECT_FALSE(conductor_is_right([](double c, double n, double k) { return real_conductor(c * c, n, k); }));
}

TEST(law_fresnel, schlick_ends_and_average) {
  const vec3 f0(0.04f, 0.5f, 1.0f);
  const vec3 f90(1.0f, 0.9f, 1.0f);
  EXPECT_EQ(shade::fresnel_schlick(f0, f90, 1.0f), f0);
  EXPECT_EQ(shade::fresnel_schlick(f0, f90, 0.0f), f0 + (f90 - f0));
  EXPECT_EQ(shade::schlick_weight(1.5f), 0.0f);
  EXPECT_EQ(shade::schlick_weight(-0.5f), 1.0f);
  float previous = 2.0f;
  for (int i = 0; i <= 100; ++i) {
    const float w = shade::schlick_weight(static_cast<float>(i) / 100.0f);
    EXPECT_LT(w, previous);
    previous = w;
  }
  // F0 + (F90 - F0) / 21, what surface_diffuse relies on.
  const auto average = [](const std::function<double(double)>& f) {
    return test::integrate([&](double mu) { return 2.0 * mu * f(mu); }, 0.0, 1.0, 1e-8);
  };
  EXPECT_NEAR(average([](double mu) { return static_cast<double>(shade::schlick_weight(static_cast<float>(mu))); }),
              1.0 / 21.0, 1e-6);
  EXPECT_GT(std::abs(average([](double mu) { return std::pow(1.0 - mu, 4.0); }) - 1.0 / 21.0), 1e-2);
}

}  // namespace
}  // namespace candela::laws
