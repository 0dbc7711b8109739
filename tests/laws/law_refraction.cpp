// Refraction at facets: Snell's law, the Jacobian by numerical differentiation, the density against sampled directions.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "laws/bsdf_laws.h"
#include "shade/microfacet.glsl.h"
#include "support/quadrature.h"
#include "support/random.h"
#include "support/statistics.h"

namespace candela::laws {
namespace {

constexpr std::array<float, 6> kEtas = {1.0f / 2.42f, 1.0f / 1.5f, 0.9f, 1.1f, 1.5f, 2.42f};

using Refract = std::function<vec3(vec3 wo, vec3 wm, float eta)>;

// Unit, in the plane of wo and wm, behind the facet, sin θo = eta sin θi; the zero vector exactly where that has no
// solution.
bool obeys_snell(const Refract& refract) {
  test::Pcg32 random(3);
  for (const float eta : kEtas) {
    for (int i = 0; i < 400; ++i) {
      const vec3 wm = direction(1.0f - 0.5f * random.next_float(), 6.28f * random.next_float());
      const vec3 wo = direction(random.next_float(), 6.28f * random.next_float());
      const float cos_o = glm::dot(wo, wm);
      if (cos_o <= 0.0f) continue;
      const vec3 tangent = wo - cos_o * wm;  // of length sin θo
      const float sin_o = glm::length(tangent);
      if (std::abs(sin_o - eta) < 1e-4f) continue;
      const vec3 wi = refract(wo, wm, eta);
      if (sin_o > eta) {
        if (wi != vec3(0.0f)) return false;
        continue;
      }
      if (std::abs(glm::length(wi) - 1.0f) > 1e-5f || glm::dot(wi, wm) >= 0.0f) return false;
      if (glm::length(wi - glm::dot(wi, wm) * wm + tangent / eta) > 1e-5f) return false;
    }
  }
  return true;
}

TEST(law_refraction, obeys_snell_and_reflects_totally) {
  EXPECT_TRUE(obeys_snell(shade::microfacet_refract));
  EXPECT_FALSE(obeys_snell([](vec3 wo, vec3 wm, float eta) { return shade::microfacet_refract(wo, wm, 1.0f / eta); }));
  EXPECT_FALSE(
      obeys_snell([](vec3 wo, vec3 wm, float eta) { return shade::microfacet_refract(wo, wm, 1.001f * eta); }));
  EXPECT_FALSE(obeys_snell([](vec3 wo, vec3 wm, float eta) {
    const vec3 wi = shade::microfacet_refract(wo, wm, eta);
    return wi == vec3(0.0f) ? -wo : wi;
  })) << "passes straight on at total reflection";
}

TEST(law_refraction, path_is_reversible_and_finds_its_facet) {
  const auto finds = [](const std::function<vec3(vec3, vec3, float)>& half_vector) {
    test::Pcg32 random(5);
    for (const float eta : kEtas) {
      for (int i = 0; i < 200; ++i) {
        const vec3 wm = direction(1.0f - 0.3f * random.next_float(), 6.28f * random.next_float());
        const vec3 wo = direction(0.2f + 0.8f * random.next_float(), 6.28f * random.next_float());
        if (glm::dot(wo, wm) <= 0.05f) continue;
        const vec3 wi = shade::microfacet_refract(wo, wm, eta);
        if (wi == vec3(0.0f) || wi.z >= 0.0f) continue;
        if (glm::length(half_vector(wo, wi, eta) - wm) > 2e-4f) return false;
        if (glm::dot(wi, wm) > -0.05f) continue;
        if (glm::length(shade::microfacet_refract(wi, -wm, 1.0f / eta) - wo) > 1e-4f) return false;
      }
    }
    return true;
  };
  EXPECT_TRUE(finds(shade::microfacet_half_refract));
  EXPECT_FALSE(finds([](vec3 wo, vec3 wi, float eta) { return shade::microfacet_half_refract(wo, wi, 1.0f / eta); }));
  EXPECT_FALSE(finds([](vec3 wo, vec3 wi, float) { return glm::normalize(wo + wi); })) << "half vector of reflection";
  EXPECT_EQ(shade::microfacet_half_refract(direction(0.3f, 1.0f), -direction(0.3f, 1.0f), 1.0f), vec3(0.0f));
}

// ----- Jacobian

// Solid angle that wi sweeps when the facet moves over a small square, by central differences.
double swept_solid_angle(vec3 wo, vec3 wm, float eta) {
  constexpr float kStep = 4e-3f;
  const vec3 a = glm::normalize(glm::cross(wm, vec3(1.0f, 0.2f, 0.1f)));
  const vec3 b = glm::cross(wm, a);
  const auto change = [&](vec3 t) {
    const vec3 up = shade::microfacet_refract(wo, glm::normalize(wm + kStep * t), eta);
    const vec3 down = shade::microfacet_refract(wo, glm::normalize(wm - kStep * t), eta);
    return glm::dvec3(up - down) / static_cast<double>(2.0f * kStep);
  };
  return glm::length(glm::cross(change(a), change(b)));
}

double worst_jacobian(const std::function<float(float cos_o, float cos_i, float eta)>& jacobian) {
  double worst = 0.0;
  test::Pcg32 random(7);
  for (const float eta : kEtas) {
    for (int i = 0; i < 100; ++i) {
      const vec3 wm = direction(1.0f - 0.3f * random.next_float(), 6.28f * random.next_float());
      const vec3 wo = direction(0.3f + 0.7f * random.next_float(), 6.28f * random.next_float());
      const float cos_o = glm::dot(wo, wm);
      const vec3 wi = shade::microfacet_refract(wo, wm, eta);
      const float cos_i = glm::dot(wi, wm);
      if (cos_o < 0.2f || cos_i > -0.3f) continue;  // too curved for differences
      const double product = static_cast<double>(jacobian(cos_o, cos_i, eta)) * swept_solid_angle(wo, wm, eta);
      worst = std::max(worst, std::abs(product - 1.0));
    }
  }
  return worst;
}

TEST(law_refraction, jacobian_is_the_inverse_of_the_swept_solid_angle) {
  EXPECT_LT(worst_jacobian(shade::microfacet_refract_jacobian), 3e-3);
  EXPECT_GT(worst_jacobian([](float o, float i, float eta) {
              return shade::microfacet_refract_jacobian(o, i, eta) / (eta * eta);
            }),
            0.1)
      << "without the square of the index";
  EXPECT_GT(worst_jacobian([](float o, float i, float eta) { return shade::microfacet_refract_jacobian(-i, -o, eta); }),
            0.1)
      << "directions swapped";
  EXPECT_GT(worst_jacobian([](float o, float, float) { return 1.0f / (4.0f * o); }), 0.1) << "of reflection";
}

// ----- density

using RefractPdf = std::function<float(vec3 wo, vec3 wi, vec3 wm, float ax, float ay, float eta)>;

double density_p_value(const RefractPdf& pdf, vec3 wo, float ax, float ay, float eta, std::uint64_t seed) {
  constexpr int kSamples = 30000;
  const test::DirectionFunction f = [&](vec3 w) {
    const vec3 wi(w.x, w.y, -w.z);
    const vec3 wm = shade::microfacet_half_refract(wo, wi, eta);
    return glm::dvec4(0.0, 0.0, 0.0, static_cast<double>(pdf(wo, wi, wm, ax, ay, eta)));
  };
  const vec3 straight = shade::microfacet_refract(wo, vec3(0.0f, 0.0f, 1.0f), eta);
  std::vector<vec3> peaks;
  if (straight.z < 0.0f) peaks.emplace_back(straight.x, straight.y, -straight.z);
  const test::HemisphereQuadrature cells(f, peaks, {1e-6, 0.01, 0.02});
  std::vector<double> expected;
  for (const glm::dvec4& cell : cells.cells()) expected.push_back(cell.w * kSamples);
  expected.push_back(std::max(1.0 - cells.integral().w, 0.0) * kSamples);  // total reflection, or wi.z ≥ 0
  std::vector<double> observed(expected.size(), 0.0);
  test::Pcg32 random(seed);
  for (int i = 0; i < kSamples; ++i) {
    const vec3 wm = shade::ggx_sample_visible_aniso(wo, ax, ay, random.next_vec2());
    const vec3 wi = glm::dot(wo, wm) > 0.0f ? shade::microfacet_refract(wo, wm, eta) : vec3(0.0f);
    const bool passes = wi.z < 0.0f;
    observed[passes ? cells.cell_of(vec3(wi.x, wi.y, -wi.z)) : observed.size() - 1] += 1.0;
  }
  return test::chi_square_test(observed, expected, 20.0).p_value;
}

bool follows_density(const RefractPdf& pdf) {
  const double threshold = test::sidak_threshold(24);
  std::uint64_t seed = 1;
  for (const float eta : {1.0f / 1.5f, 1.3f, 2.42f}) {
    for (const glm::vec2 width : {glm::vec2(0.1f, 0.1f), glm::vec2(0.4f, 0.15f)}) {
      for (const float cosine : {1.0f, 0.8f, 0.5f, 0.2f}) {
        const vec3 wo = direction(cosine, 0.9f);
        if (density_p_value(pdf, wo, width.x, width.y, eta, seed++) < threshold) return false;
      }
    }
  }
  return true;
}

TEST(law_refraction, sampled_directions_follow_the_density) {
  EXPECT_TRUE(follows_density(shade::ggx_pdf_refract_aniso));
  EXPECT_FALSE(follows_density([](vec3 wo, vec3 wi, vec3 wm, float ax, float ay, float eta) {
    return shade::ggx_pdf_refract_aniso(wo, wi, wm, ax, ay, eta) / (eta * eta);
  }));
  EXPECT_FALSE(follows_density([](vec3 wo, vec3 wi, vec3 wm, float ax, float ay, float eta) {
    return shade::ggx_pdf_refract_aniso(wo, wi, wm, ay, ax, eta);
  }));
}

TEST(law_refraction, isotropic_density_is_the_anisotropic_one) {
  for (const float eta : kEtas) {
    const vec3 wo = direction(0.8f, 0.4f);
    const vec3 wm = direction(0.97f, 2.0f);
    const vec3 wi = shade::microfacet_refract(wo, wm, eta);
    if (wi == vec3(0.0f)) continue;
    const float expected = shade::ggx_pdf_refract_aniso(wo, wi, wm, 0.2f, 0.2f, eta);
    EXPECT_NEAR(shade::ggx_pdf_refract(wo, wi, wm, 0.2f, eta) / expected, 1.0f, 1e-5f);
    EXPECT_GT(std::abs(shade::ggx_pdf_refract(wo, wi, wm, 0.21f, eta) / expected - 1.0f), 1e-3f);
    EXPECT_EQ(shade::ggx_pdf_refract(wo, -wi, wm, 0.2f, eta), 0.0f) << "the reflecting side";
    EXPECT_EQ(shade::ggx_pdf_refract_aniso(wo, -wi, wm, 0.2f, 0.2f, eta), 0.0f);
  }
}

}  // namespace
}  // namespace candela::laws
