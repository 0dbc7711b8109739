// GGX against identities of microfacet theory and published albedos.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "laws/bsdf_laws.h"
#include "shade/fresnel.glsl.h"
#include "shade/microfacet.glsl.h"
#include "support/quadrature.h"
#include "support/random.h"
#include "support/statistics.h"

namespace candela::laws {
namespace {

using test::HemisphereQuadrature;

const std::vector<float> kAlphas = {0.001f, 0.0025f, 0.01f, 0.09f, 0.25f, 0.64f, 1.0f};
const std::vector<float> kCosines = {1.0f, 0.8f, 0.4f, 0.1f, 0.02f};
constexpr vec3 kNormal(0.0f, 0.0f, 1.0f);

using Distribution = std::function<float(vec3 wm, float alpha)>;
using Visibility = std::function<float(vec3 wo, vec3 wi, float alpha)>;
using NormalPdf = std::function<float(vec3 wo, vec3 wm, float alpha)>;
using NormalSampler = std::function<vec3(vec3 wo, float alpha, vec2 u)>;

// ----- D: facets project onto the plane they come from, ∫ D(m) (n·m) dm = 1 (Heitz 2014, eq. 5)

bool projects_to_one(const Distribution& d) {
  for (const float alpha : kAlphas) {
    const test::DirectionFunction f = [&](vec3 wm) { return glm::dvec4(static_cast<double>(d(wm, alpha) * wm.z)); };
    const std::array<vec3, 1> peaks = {kNormal};
    const double area = HemisphereQuadrature(f, peaks, {1e-6, 1e30, 0.25 * static_cast<double>(alpha)}).integral().x;
    if (std::abs(area - 1.0) > 1e-4) return false;
  }
  return true;
}

TEST(law_ggx, projected_area_is_one) {
  EXPECT_TRUE(projects_to_one(shade::ggx_d));
  EXPECT_FALSE(projects_to_one([](vec3 wm, float a) { return 1.001f * shade::ggx_d(wm, a); }));
  EXPECT_FALSE(projects_to_one([](vec3 wm, float a) { return shade::ggx_d(wm, a) / std::max(wm.z, 1e-6f); }));
  EXPECT_FALSE(projects_to_one([](vec3 wm, float a) { return a * shade::ggx_d(wm, a); })) << "normalised by roughness";
}

TEST(law_ggx, distribution_is_walters_at_known_points) {
  // Walter et al. 2007, eq. 33: D = α² / (π cos⁴θ (α² + tan²θ)²), here in double.
  for (const float alpha : kAlphas) {
    for (const float tangent : {0.0f, 0.3f * alpha, alpha, 5.0f * alpha}) {
      const double a2 = static_cast<double>(alpha) * static_cast<double>(alpha);
      const double t2 = static_cast<double>(tangent) * static_cast<double>(tangent);
      const double cos4 = 1.0 / ((1.0 + t2) * (1.0 + t2));
      const double expected = a2 / (std::numbers::pi * cos4 * (a2 + t2) * (a2 + t2));
      const float d = shade::ggx_d(glm::normalize(vec3(0.6f * tangent, 0.8f * tangent, 1.0f)), alpha);
      EXPECT_NEAR(static_cast<double>(d) / expected, 1.0, 1e-5) << "alpha " << alpha << " tan " << tangent;
    }
  }
}

// ----- V: ggx_v_smith is G2 / (4 cos cos) with G2 = 1 / (1 + Λo + Λi) (Heitz 2014, eq. 99)

double lambda(double cos_theta, double alpha) {
  const double tan2 = (1.0 - cos_theta * cos_theta) / (cos_theta * cos_theta);
  return 0.5 * (std::sqrt(1.0 + alpha * alpha * tan2) - 1.0);
}

bool is_height_correlated(const Visibility& v) {
  for (const float alpha : kAlphas) {
    for (const float cos_o : {1e-4f, 0.01f, 0.2f, 0.7f, 1.0f}) {
      for (const float cos_i : {1e-4f, 0.03f, 0.5f, 1.0f}) {
        const auto o = static_cast<double>(cos_o);
        const auto i = static_cast<double>(cos_i);
        const auto a = static_cast<double>(alpha);
        const double expected = 1.0 / ((1.0 + lambda(o, a) + lambda(i, a)) * 4.0 * o * i);
        const auto value = static_cast<double>(v(direction(cos_o, 0.4f), direction(cos_i, 2.0f), alpha));
        if (std::abs(value / expected - 1.0) > 1e-4) return false;
      }
    }
  }
  return true;
}

TEST(law_ggx, visibility_is_the_lambda_form) {
  EXPECT_TRUE(is_height_correlated(shade::ggx_v_smith));
  EXPECT_FALSE(is_height_correlated([](vec3 wo, vec3 wi, float a) {
    return shade::ggx_g1(wo, a) * shade::ggx_g1(wi, a) / (4.0f * wo.z * wi.z);
  })) << "separable";
  EXPECT_FALSE(is_height_correlated([](vec3 wo, vec3 wi, float a) { return shade::ggx_v_smith(wo, wi, std::sqrt(a)); }))
      << "roughness for alpha";
  EXPECT_FALSE(is_height_correlated([](vec3 wo, vec3 wi, float a) { return 4.0f * shade::ggx_v_smith(wo, wi, a); }));
}

TEST(law_ggx, masking_is_the_lambda_form) {
  for (const float alpha : kAlphas) {
    for (const float c : {1e-4f, 0.01f, 0.2f, 0.7f, 1.0f}) {
      const double expected = 1.0 / (1.0 + lambda(static_cast<double>(c), static_cast<double>(alpha)));
      EXPECT_NEAR(static_cast<double>(shade::ggx_g1(direction(c, 1.0f), alpha)) / expected, 1.0, 1e-4);
    }
  }
}

// ----- visible normals

// D G1 / (4 cos), and per normal it is a density: ∫ 4 (wo·m) pdf dm = 1 over facets that face wo (Heitz 2014, eq. 16).
bool is_visible_normal_pdf(const NormalPdf& pdf) {
  for (const float alpha : kAlphas) {
    for (const float cosine : kCosines) {
      const vec3 wo = direction(cosine, 0.9f);
      const float g1 = shade::ggx_g1(wo, alpha);
      for (const float cos_m : {1.0f, 1.0f - 0.3f * alpha * alpha, 0.9f, 0.5f}) {
        const vec3 wm = direction(cos_m, 0.2f);
        const float expected = shade::ggx_d(wm, alpha) * g1 / (4.0f * wo.z);
        if (std::abs(pdf(wo, wm, alpha) - expected) > 1e-4f * expected) return false;
      }
      const test::DirectionFunction f = [&](vec3 wm) {
        return glm::dvec4(static_cast<double>(4.0f * std::max(glm::dot(wo, wm), 0.0f) * pdf(wo, wm, alpha)));
      };
      const std::array<vec3, 1> peaks = {kNormal};
      const double total = HemisphereQuadrature(f, peaks, {1e-6, 1e30, 0.25 * static_cast<double>(alpha)}).integral().x;
      if (std::abs(total - 1.0) > 3e-4) return false;
    }
  }
  return true;
}

TEST(law_ggx, visible_normal_pdf_is_d_g1_over_4_cos) {
  EXPECT_TRUE(is_visible_normal_pdf(shade::ggx_pdf_visible));
  EXPECT_FALSE(
      is_visible_normal_pdf([](vec3 wo, vec3 wm, float a) { return 4.0f * shade::ggx_pdf_visible(wo, wm, a); }));
  EXPECT_FALSE(
      is_visible_normal_pdf([](vec3 wo, vec3 wm, float a) { return 1.03f * shade::ggx_pdf_visible(wo, wm, a); }));
  EXPECT_FALSE(is_visible_normal_pdf([](vec3 wo, vec3 wm, float a) {
    return shade::ggx_d(wm, a) * wm.z / (4.0f * glm::dot(wo, wm));
  })) << "density of all normals";
}

double visible_normals_p_value(const NormalSampler& sample, float alpha, float cosine, std::uint64_t seed) {
  constexpr int kSamples = 30000;
  const vec3 wo = direction(cosine, 0.9f);
  const test::DirectionFunction f = [&](vec3 wm) {
    const float facing = std::max(glm::dot(wo, wm), 0.0f);
    return glm::dvec4(0.0, 0.0, 0.0, static_cast<double>(4.0f * facing * shade::ggx_pdf_visible(wo, wm, alpha)));
  };
  const std::array<vec3, 1> peaks = {kNormal};
  const HemisphereQuadrature cells(f, peaks, {1e-6, 0.01, 0.25 * static_cast<double>(alpha)});
  std::vector<double> expected;
  for (const glm::dvec4& cell : cells.cells()) expected.push_back(cell.w * kSamples);
  std::vector<double> observed(expected.size(), 0.0);
  test::Pcg32 random(seed);
  for (int i = 0; i < kSamples; ++i) observed[cells.cell_of(sample(wo, alpha, random.next_vec2()))] += 1.0;
  return test::chi_square_test(observed, expected).p_value;
}

bool follows_visible_normals(const NormalSampler& sample) {
  const double threshold = test::sidak_threshold(kAlphas.size() * kCosines.size());
  for (std::size_t a = 0; a < kAlphas.size(); ++a) {
    for (std::size_t c = 0; c < kCosines.size(); ++c) {
      if (visible_normals_p_value(sample, kAlphas[a], kCosines[c], 10 * a + c) < threshold) return false;
    }
  }
  return true;
}

TEST(law_ggx, sampled_normals_are_the_visible_ones) {
  EXPECT_TRUE(follows_visible_normals(shade::ggx_sample_visible));
  EXPECT_FALSE(
      follows_visible_normals([](vec3 wo, float a, vec2 u) { return shade::ggx_sample_visible(wo, 1.05f * a, u); }));
  EXPECT_FALSE(follows_visible_normals([](vec3 wo, float a, vec2 u) {
    return shade::ggx_sample_visible(vec3(wo.x, -wo.y, wo.z), a, u);
  })) << "mirrored frame";
  EXPECT_FALSE(follows_visible_normals([](vec3, float a, vec2 u) {
    const float tan2 = a * a * u.x / std::max(1.0f - u.x, 1e-7f);
    return direction(1.0f / std::sqrt(1.0f + tan2), 2.0f * shade::kShadePi * u.y);
  })) << "Walter et al. 2007, eq. 35";
}

TEST(law_ggx, sampled_normals_face_the_viewer_at_all_corners) {
  for (const float alpha : kAlphas) {
    for (const float c : {1e-4f, 0.02f, 0.5f, 1.0f}) {
      for (const float x : {0.0f, 0.25f, 0.5f, 0x1.fffffep-1f}) {
        for (const float y : {0.0f, 1e-6f, 0.5f, 0x1.fffffep-1f}) {
          const vec3 wo = direction(c, 0.0f);
          const vec3 wm = shade::ggx_sample_visible(wo, alpha, vec2(x, y));
          EXPECT_NEAR(glm::length(wm), 1.0f, 1e-5f);
          EXPECT_GT(wm.z, 0.0f);
          // At (1/2, 1) the spherical cap is opposite to wo and the normal is noise; then the reflection must fail.
          if (glm::dot(wo, wm) < -1e-5f) {
            EXPECT_LE(shade::microfacet_reflect(wo, wm).z, 0.0f)
                << "alpha " << alpha << " cos " << c << " u " << x << ' ' << y;
            EXPECT_GT(y, 0.99f);
          }
        }
      }
    }
  }
}

// ----- published albedos

using Lobe = std::function<float(vec3 wo, vec3 wi, float roughness)>;

float real_lobe(vec3 wo, vec3 wi, float roughness) {
  const float alpha = shade::roughness_to_alpha(roughness);
  return shade::ggx_d(glm::normalize(wo + wi), alpha) * shade::ggx_v_smith(wo, wi, alpha) * wi.z;
}

// E = (∫ f cos, ∫ f cos (1-F_c), ∫ f cos F_c, -) with Schlick's weight F_c: total, and the two columns of the split
// sum.
glm::dvec4 albedo(const Lobe& lobe, float mu, float roughness) {
  const vec3 wo = direction(mu, 0.9f);
  const test::DirectionFunction f = [&](vec3 wi) {
    const auto value = static_cast<double>(lobe(wo, wi, roughness));
    const auto fc = static_cast<double>(shade::schlick_weight(glm::dot(wo, glm::normalize(wo + wi))));
    return glm::dvec4(value, value * (1.0 - fc), value * fc, 0.0);
  };
  const std::array<vec3, 1> peaks = {vec3(-wo.x, -wo.y, wo.z)};
  return HemisphereQuadrature(f, peaks).integral();
}

struct AlbedoRow {
  float roughness;
  std::array<double, 6> at;  // of mu = .1 .2 .4 .6 .8 1
  double average;            // 2 ∫ E μ dμ
};

// Single scattering, F = 1, height-correlated Smith; agrees with the table of three.js pull request 33983.
const std::vector<AlbedoRow> kAlbedos = {{0.2f, {.9291, .9753, .9934, .9967, .9977, .9983}, .9941},
                                         {0.3f, {.8843, .9140, .9646, .9813, .9877, .9907}, .9765},
                                         {0.4f, {.8883, .8698, .9079, .9404, .9581, .9677}, .9404},
                                         {0.5f, {.8916, .8482, .8443, .8717, .8973, .9158}, .8823},
                                         {0.6f, {.8824, .8258, .7839, .7867, .8044, .8245}, .8029},
                                         {0.7f, {.8619, .7927, .7211, .6946, .6906, .6978}, .7074},
                                         {0.8f, {.8331, .7489, .6514, .5988, .5699, .5552}, .6042},
                                         {0.9f, {.7985, .6974, .5759, .5028, .4541, .4200}, .5024},
                                         {1.0f, {.7602, .6417, .4989, .4115, .3513, .3069}, .4092}};

double worst_albedo_error(const Lobe& lobe) {
  constexpr std::array<float, 6> kMu = {0.1f, 0.2f, 0.4f, 0.6f, 0.8f, 1.0f};
  double worst = 0.0;
  for (const AlbedoRow& row : kAlbedos) {
    for (std::size_t i = 0; i < kMu.size(); ++i) {
      worst = std::max(worst, std::abs(albedo(lobe, kMu[i], row.roughness).x - row.at[i]));
    }
  }
  return worst;
}

TEST(law_ggx, directional_albedo_is_the_published_one) {
  EXPECT_LT(worst_albedo_error(real_lobe), 2e-4);
  EXPECT_GT(worst_albedo_error([](vec3 wo, vec3 wi, float r) { return 1.001f * real_lobe(wo, wi, r); }), 2e-4);
  EXPECT_GT(worst_albedo_error([](vec3 wo, vec3 wi, float r) { return real_lobe(wo, wi, std::sqrt(r)); }), 0.1)
      << "roughness in place of alpha";
  EXPECT_GT(worst_albedo_error([](vec3 wo, vec3 wi, float r) { return real_lobe(wo, wi, r) / wi.z; }), 0.1);
  EXPECT_GT(worst_albedo_error([](vec3 wo, vec3 wi, float r) {
              const float a = shade::roughness_to_alpha(r);
              const float separable = shade::ggx_g1(wo, a) * shade::ggx_g1(wi, a) / (4.0f * wo.z * wi.z);
              return real_lobe(wo, wi, r) * separable / shade::ggx_v_smith(wo, wi, a);
            }),
            0.01)
      << "separable masking and shadowing";
}

TEST(law_ggx, average_albedo_is_the_published_one) {
  for (const AlbedoRow& row : kAlbedos) {
    const auto integrand = [&](double mu) {
      return 2.0 * mu * albedo(real_lobe, static_cast<float>(mu), row.roughness).x;
    };
    EXPECT_NEAR(test::integrate(integrand, 0.0, 1.0, 1e-5), row.average, 2e-4) << "roughness " << row.roughness;
  }
}

TEST(law_ggx, albedo_of_alpha_one_at_the_normal_is_one_minus_log_two) {
  EXPECT_NEAR(albedo(real_lobe, 1.0f, 1.0f).x, 1.0 - std::numbers::ln2, 2e-5);
}

TEST(law_ggx, split_sum_columns_are_the_published_ones) {
  struct Row {
    float roughness, mu;
    double a, b;
  };
  // Karis 2013, "Real Shading in Unreal Engine 4", listing 3, with the height-correlated term; F90 = 1.
  const std::vector<Row> rows = {
      {0.25f, 0.1f, .50514, .39162}, {0.25f, 0.5f, .95572, .03264}, {0.25f, 1.0f, .99570, 0.0},
      {0.5f, 0.1f, .75193, .13969},  {0.5f, 0.5f, .83492, .02235},  {0.5f, 1.0f, .91579, .00003},
      {0.75f, 0.1f, .79577, .05258}, {0.75f, 0.5f, .65469, .00848}, {0.75f, 1.0f, .62684, .00005},
      {1.0f, 0.1f, .73634, .02387},  {1.0f, 0.5f, .44771, .00299},  {1.0f, 1.0f, .30682, .00003}};
  for (const Row& row : rows) {
    const glm::dvec4 e = albedo(real_lobe, row.mu, row.roughness);
    EXPECT_NEAR(e.y, row.a, 1e-4) << "A, roughness " << row.roughness << " mu " << row.mu;
    EXPECT_NEAR(e.z, row.b, 1e-4) << "B, roughness " << row.roughness << " mu " << row.mu;
  }
}

}  // namespace
}  // namespace candela::laws
