// Every distribution of facets and every masking term, against what microfacet theory demands of any of them.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "laws/bsdf_laws.h"
#include "shade/image_light.glsl.h"
#include "shade/microfacet.glsl.h"
#include "support/quadrature.h"
#include "support/random.h"
#include "support/statistics.h"

namespace candela::laws {
namespace {

using test::HemisphereQuadrature;

constexpr vec3 kNormal(0.0f, 0.0f, 1.0f);
const std::vector<float> kAlphas = {0.01f, 0.09f, 0.25f, 0.64f, 1.0f};
const std::vector<float> kCosines = {1.0f, 0.8f, 0.4f, 0.1f, 0.02f};

struct Widths {
  float x, y;
};
const std::vector<Widths> kWidths = {{0.3f, 0.3f}, {0.05f, 0.5f}, {0.9f, 0.1f}, {0.01f, 0.04f}, {1.0f, 0.3f}};

using Distribution = std::function<float(vec3 wm, float alpha)>;
using Masking = std::function<float(vec3 wo, vec3 wi, float alpha)>;

struct NamedDistribution {
  std::string name;
  Distribution d;
};
struct NamedMasking {
  std::string name;
  Masking v;
};

const std::vector<NamedDistribution> kDistributions = {{"ggx", shade::ggx_d},
                                                       {"beckmann", shade::beckmann_d},
                                                       {"blinn-phong", shade::blinn_phong_d},
                                                       {"charlie", shade::charlie_d}};

const std::vector<NamedMasking> kMaskings = {
    {"smith correlated", shade::ggx_v_smith},
    {"smith separable", shade::v_smith_separable},
    {"smith anisotropic", [](vec3 o, vec3 i, float a) { return shade::ggx_v_smith_aniso(o, i, a, 0.5f * a); }},
    {"schlick direct",
     [](vec3 o, vec3 i, float a) { return shade::v_schlick_ggx(o, i, shade::schlick_k_direct(std::sqrt(a))); }},
    {"schlick ibl",
     [](vec3 o, vec3 i, float a) { return shade::v_schlick_ggx(o, i, shade::schlick_k_ibl(std::sqrt(a))); }},
    {"beckmann rational", shade::v_beckmann_rational},
    {"charlie", shade::charlie_v},
    {"neubelt", [](vec3 o, vec3 i, float) { return shade::neubelt_v(o, i); }}};

double integrate_normals(const std::function<double(vec3 wm)>& f, double width) {
  const test::DirectionFunction g = [&](vec3 wm) { return glm::dvec4(f(wm)); };
  const std::array<vec3, 1> peaks = {kNormal};
  return HemisphereQuadrature(g, peaks, {1e-6, 1e30, 0.25 * width}).integral().x;
}

// ----- D: facets project onto the plane they come from, ∫ D(m) (n·m) dm = 1 (Heitz 2014, eq. 5)

bool projects_to_one(const Distribution& d) {
  for (const float alpha : kAlphas) {
    const auto f = [&](vec3 wm) { return static_cast<double>(d(wm, alpha) * wm.z); };
    if (std::abs(integrate_normals(f, static_cast<double>(alpha)) - 1.0) > 1e-4) return false;
  }
  return true;
}

TEST(law_terms, every_distribution_has_projected_area_one) {
  for (const NamedDistribution& named : kDistributions) {
    EXPECT_TRUE(projects_to_one(named.d)) << named.name;
    EXPECT_FALSE(projects_to_one([&](vec3 wm, float a) { return 1.001f * named.d(wm, a); })) << named.name;
    EXPECT_FALSE(projects_to_one([&](vec3 wm, float a) { return a * named.d(wm, a); })) << named.name;
  }
  EXPECT_FALSE(projects_to_one([](vec3 wm, float a) {
    const float n = shade::blinn_phong_exponent(a);
    return (n + 1.0f) / (n + 2.0f) * shade::blinn_phong_d(wm, a);
  })) << "Phong normalised without the cosine";
}

bool projects_to_one_aniso(const std::function<float(vec3 wm, float ax, float ay)>& d) {
  for (const Widths w : kWidths) {
    const auto f = [&](vec3 wm) { return static_cast<double>(d(wm, w.x, w.y) * wm.z); };
    if (std::abs(integrate_normals(f, static_cast<double>(std::min(w.x, w.y))) - 1.0) > 1e-4) return false;
  }
  return true;
}

TEST(law_terms, anisotropic_ggx_has_projected_area_one) {
  EXPECT_TRUE(projects_to_one_aniso(shade::ggx_d_aniso));
  EXPECT_FALSE(projects_to_one_aniso([](vec3 wm, float ax, float ay) {
    return shade::ggx_d_aniso(wm, ax, ay) * ax / ay;
  })) << "normalised by one width alone";
}

TEST(law_terms, distributions_are_finite_and_not_negative) {
  for (const NamedDistribution& named : kDistributions) {
    for (const float alpha : {shade::kGgxMirrorAlpha, 0.04f, 1.0f}) {
      for (const float c : {0.0f, 1e-7f, 1e-3f, 0.5f, 1.0f}) {
        const float d = named.d(direction(c, 0.3f), alpha);
        EXPECT_TRUE(std::isfinite(d) && d >= 0.0f) << named.name << " alpha " << alpha << " cos " << c << ": " << d;
      }
    }
  }
}

// cosⁿ needs the sine: of a cosine near 1 nothing is left when n is a million.
TEST(law_terms, blinn_phong_is_the_power_of_the_cosine) {
  const auto worst = [](const Distribution& d) {
    double error = 0.0;
    for (const float alpha : {0.001f, 0.01f, 0.1f, 0.5f, 1.0f}) {
      for (const float tangent : {0.0f, 0.5f * alpha, alpha, 2.0f * alpha}) {
        const auto a = static_cast<double>(alpha);
        const auto t = static_cast<double>(tangent);
        const double n = 2.0 / (a * a) - 2.0;
        const double expected = (n + 2.0) / (2.0 * std::numbers::pi) * std::exp(-0.5 * n * std::log1p(t * t));
        const vec3 wm = glm::normalize(vec3(0.6f * tangent, 0.8f * tangent, 1.0f));
        error = std::max(error, std::abs(static_cast<double>(d(wm, alpha)) / expected - 1.0));
      }
    }
    return error;
  };
  EXPECT_LT(worst(shade::blinn_phong_d), 2e-5);
  EXPECT_GT(worst([](vec3 wm, float a) {
              return std::pow(wm.z, shade::blinn_phong_exponent(a)) / (shade::kShadePi * a * a);
            }),
            1e-3);
}

TEST(law_terms, narrow_blinn_phong_and_beckmann_agree) {
  // Walter et al. 2007, §5.2: the relation of the widths makes them alike for small α.
  for (const float s : {0.0f, 0.05f, 0.1f}) {
    const vec3 wm = direction(std::sqrt(1.0f - s * s), 1.0f);
    EXPECT_NEAR(shade::blinn_phong_d(wm, 0.1f) / shade::beckmann_d(wm, 0.1f), 1.0f, 0.02f) << s;
  }
  EXPECT_GT(shade::blinn_phong_d(kNormal, 0.1f) / shade::beckmann_d(kNormal, 0.11f), 1.1f);
}

// ----- G1: what is visible of the facets projects to what is visible of the plane, ∫ G1 max(wo·m, 0) D dm = cos θo
// (Heitz 2014, eq. 16). Exact for Smith's term; fits may be off by what their authors say.

double worst_visible_area(const Distribution& d, const std::function<float(vec3 wo, float alpha)>& g1) {
  double worst = 0.0;
  for (const float alpha : {0.09f, 0.25f, 0.64f, 1.0f}) {
    for (const float cosine : kCosines) {
      const vec3 wo = direction(cosine, 0.9f);
      const auto f = [&](vec3 wm) { return static_cast<double>(std::max(glm::dot(wo, wm), 0.0f) * d(wm, alpha)); };
      const double visible = integrate_normals(f, static_cast<double>(alpha)) * static_cast<double>(g1(wo, alpha));
      worst = std::max(worst, std::abs(visible / static_cast<double>(cosine) - 1.0));
    }
  }
  return worst;
}

float beckmann_g1(vec3 w, float alpha) { return w.z * shade::beckmann_g1_over_cos(w, alpha); }
float charlie_g1(vec3 w, float alpha) { return 1.0f / (1.0f + shade::charlie_lambda(w.z, alpha)); }

TEST(law_terms, masking_conserves_the_visible_area) {
  EXPECT_LT(worst_visible_area(shade::ggx_d, shade::ggx_g1), 3e-4);
  EXPECT_LT(worst_visible_area(shade::beckmann_d, beckmann_g1), 4e-3) << "Walter et al. 2007: 0.35 %";
  EXPECT_GT(worst_visible_area(shade::beckmann_d, shade::ggx_g1), 0.05) << "GGX masking on Beckmann facets";
  EXPECT_LT(worst_visible_area(shade::charlie_d, charlie_g1), 0.13) << "a fit, worst at the horizon";
  EXPECT_GT(worst_visible_area(shade::charlie_d, [](vec3 w, float a) { return charlie_g1(w, std::sqrt(a)); }), 0.13)
      << "roughness for alpha";
}

TEST(law_terms, anisotropic_masking_conserves_the_visible_area) {
  const auto conserves = [](const std::function<float(vec3, float, float)>& lambda) {
    for (const Widths w : kWidths) {
      for (const float cosine : kCosines) {
        for (const float phi : {0.2f, 1.4f}) {
          const vec3 wo = direction(cosine, phi);
          const auto f = [&](vec3 wm) {
            return static_cast<double>(std::max(glm::dot(wo, wm), 0.0f) * shade::ggx_d_aniso(wm, w.x, w.y));
          };
          const double area = integrate_normals(f, static_cast<double>(std::min(w.x, w.y)));
          const double g1 = 1.0 / (1.0 + static_cast<double>(lambda(wo, w.x, w.y)));
          if (std::abs(area * g1 / static_cast<double>(cosine) - 1.0) > 1e-3) return false;
        }
      }
    }
    return true;
  };
  EXPECT_TRUE(conserves(shade::ggx_lambda_aniso));
  EXPECT_FALSE(conserves([](vec3 w, float ax, float ay) { return shade::ggx_lambda_aniso(w, ay, ax); }))
      << "widths swapped";
}

// ----- V = G / (4 cos cos): reciprocal, finite at grazing, G in [0, 1]

bool is_reciprocal(const Masking& v) {
  for (const float alpha : kAlphas) {
    for (const float a : {1.0f, 0.7f, 0.2f, 0.01f}) {
      for (const float b : {0.9f, 0.4f, 0.03f}) {
        const vec3 wo = direction(a, 0.4f);
        const vec3 wi = direction(b, 2.0f);
        if (std::abs(v(wo, wi, alpha) / v(wi, wo, alpha) - 1.0f) > 1e-5f) return false;
      }
    }
  }
  return true;
}

bool is_finite_at_grazing(const Masking& v) {
  for (const float alpha : {shade::kGgxMirrorAlpha, 0.01f, 0.25f, 1.0f}) {
    for (const float a : {0.0f, 1e-12f, 1e-6f, 1.0f}) {
      for (const float b : {0.0f, 1e-12f, 1e-6f, 1.0f}) {
        const float value = v(direction(a, 0.4f), direction(b, 2.0f), alpha);
        if (!std::isfinite(value) || value < 0.0f || !std::isfinite(value * b)) return false;
      }
    }
  }
  return true;
}

bool is_a_share(const Masking& v) {
  for (const float alpha : kAlphas) {
    for (int i = 0; i <= 40; ++i) {
      for (const float b : {1.0f, 0.5f, 0.1f, 1e-3f}) {
        const float a = std::max(static_cast<float>(i) / 40.0f, 1e-4f);
        const float g = v(direction(a, 0.4f), direction(b, 2.0f), alpha) * 4.0f * a * b;
        if (!(g >= 0.0f && g <= 1.00001f)) return false;
      }
    }
  }
  return true;
}

TEST(law_terms, every_masking_is_reciprocal_finite_and_a_share) {
  for (const NamedMasking& named : kMaskings) {
    EXPECT_TRUE(is_reciprocal(named.v)) << named.name;
    EXPECT_TRUE(is_finite_at_grazing(named.v)) << named.name;
    EXPECT_TRUE(is_a_share(named.v)) << named.name;
    EXPECT_FALSE(is_reciprocal([&](vec3 o, vec3 i, float a) { return named.v(o, i, a) * (1.0f + 0.01f * o.z); }));
    // Without masking nothing stops the poles, except with cosines left alone.
    EXPECT_FALSE(is_finite_at_grazing([&](vec3 o, vec3 i, float a) { return named.v(o, i, a) / (o.z * i.z); }));
    EXPECT_FALSE(is_a_share([&](vec3 o, vec3 i, float a) { return named.v(o, i, a) / (0.25f * (o.z + i.z)); }))
        << named.name;
  }
  EXPECT_FALSE(is_reciprocal([](vec3 o, vec3 i, float a) {
    // Estevez & Kulla 2017, eq. 4: the softened terminator.
    const float power = 1.0f + 2.0f * std::pow(1.0f - i.z, 8.0f);
    const float li = std::pow(shade::charlie_lambda(i.z, a), power);
    return 1.0f / ((1.0f + shade::charlie_lambda(o.z, a) + li) * 4.0f * o.z * i.z);
  })) << "softened terminator";
}

TEST(law_terms, maskings_are_their_formulas) {
  const vec3 wo = direction(0.3f, 0.4f);
  const vec3 wi = direction(0.8f, 2.0f);
  for (const float alpha : kAlphas) {
    const float separable = shade::ggx_g1(wo, alpha) * shade::ggx_g1(wi, alpha) / (4.0f * wo.z * wi.z);
    EXPECT_NEAR(shade::v_smith_separable(wo, wi, alpha) / separable, 1.0f, 1e-5f);
    EXPECT_GT(std::abs(shade::v_smith_separable(wo, wi, alpha) / separable - 1.01f), 1e-3f);
    EXPECT_NEAR(shade::ggx_v_smith_aniso(wo, wi, alpha, alpha) / shade::ggx_v_smith(wo, wi, alpha), 1.0f, 1e-5f);
    EXPECT_NEAR(shade::ggx_d_aniso(wo, alpha, alpha) / shade::ggx_d(wo, alpha), 1.0f, 1e-5f);
    const float lambdas = shade::ggx_lambda_aniso(wo, alpha, 0.3f) + shade::ggx_lambda_aniso(wi, alpha, 0.3f);
    const float correlated = 1.0f / ((1.0f + lambdas) * 4.0f * wo.z * wi.z);
    EXPECT_NEAR(shade::ggx_v_smith_aniso(wo, wi, alpha, 0.3f) / correlated, 1.0f, 1e-5f);
  }
  EXPECT_NEAR(shade::schlick_k_direct(0.5f), 0.28125f, 1e-6f);
  EXPECT_NEAR(shade::schlick_k_ibl(0.5f), 0.125f, 1e-6f);
  // x / (x (1 - k) + k) of .3 and .8, over 4 · .3 · .8
  EXPECT_NEAR(shade::v_schlick_ggx(wo, wi, 0.125f), 0.25f / (0.3875f * 0.825f), 1e-5f);
  EXPECT_NEAR(shade::neubelt_v(wo, wi), 1.0f / (4.0f * (1.1f - 0.24f)), 1e-5f);
}

TEST(law_terms, charlie_masking_has_no_step_at_60_degrees) {
  for (const float alpha : {0.01f, 0.25f, 1.0f}) {
    const float below = shade::charlie_lambda(0.49999f, alpha);
    const float above = shade::charlie_lambda(0.50001f, alpha);
    EXPECT_NEAR(below / above, 1.0f, 1e-3f);
    EXPECT_GT(below, above);
  }
}

// ----- visible normals of the anisotropic distribution

using NormalPdf = std::function<float(vec3 wo, vec3 wm, float ax, float ay)>;
using NormalSampler = std::function<vec3(vec3 wo, float ax, float ay, vec2 u)>;

// Per normal it is a density: ∫ 4 (wo·m) pdf dm = 1.
bool is_visible_normal_pdf(const NormalPdf& pdf) {
  for (const Widths w : kWidths) {
    for (const float cosine : kCosines) {
      const vec3 wo = direction(cosine, 0.9f);
      const auto f = [&](vec3 wm) {
        return static_cast<double>(4.0f * std::max(glm::dot(wo, wm), 0.0f) * pdf(wo, wm, w.x, w.y));
      };
      if (std::abs(integrate_normals(f, static_cast<double>(std::min(w.x, w.y))) - 1.0) > 5e-4) return false;
    }
  }
  return true;
}

TEST(law_terms, anisotropic_visible_normal_pdf_integrates_to_one) {
  EXPECT_TRUE(is_visible_normal_pdf(shade::ggx_pdf_visible_aniso));
  EXPECT_TRUE(is_visible_normal_pdf([](vec3 wo, vec3 wm, float ax, float ay) {
    return shade::ggx_pdf_normal_aniso(wo, wm, ax, ay) / std::max(4.0f * glm::dot(wo, wm), 1e-20f);
  }));
  EXPECT_FALSE(is_visible_normal_pdf(
      [](vec3 wo, vec3 wm, float ax, float ay) { return 1.03f * shade::ggx_pdf_visible_aniso(wo, wm, ax, ay); }));
  EXPECT_FALSE(is_visible_normal_pdf([](vec3 wo, vec3 wm, float ax, float ay) {
    return shade::ggx_pdf_visible_aniso(vec3(wo.y, wo.x, wo.z), wm, ax, ay);
  })) << "masking with the widths swapped";
}

double visible_normals_p_value(const NormalSampler& sample, Widths w, float cosine, std::uint64_t seed) {
  constexpr int kSamples = 30000;
  const vec3 wo = direction(cosine, 0.9f);
  const test::DirectionFunction f = [&](vec3 wm) {
    return glm::dvec4(0.0, 0.0, 0.0, static_cast<double>(shade::ggx_pdf_normal_aniso(wo, wm, w.x, w.y)));
  };
  const std::array<vec3, 1> peaks = {kNormal};
  const HemisphereQuadrature cells(f, peaks, {1e-6, 0.01, 0.25 * static_cast<double>(std::min(w.x, w.y))});
  std::vector<double> expected;
  for (const glm::dvec4& cell : cells.cells()) expected.push_back(cell.w * kSamples);
  std::vector<double> observed(expected.size(), 0.0);
  test::Pcg32 random(seed);
  for (int i = 0; i < kSamples; ++i) observed[cells.cell_of(sample(wo, w.x, w.y, random.next_vec2()))] += 1.0;
  return test::chi_square_test(observed, expected).p_value;
}

bool follows_visible_normals(const NormalSampler& sample) {
  const double threshold = test::sidak_threshold(kWidths.size() * kCosines.size());
  for (std::size_t a = 0; a < kWidths.size(); ++a) {
    for (std::size_t c = 0; c < kCosines.size(); ++c) {
      if (visible_normals_p_value(sample, kWidths[a], kCosines[c], 10 * a + c) < threshold) return false;
    }
  }
  return true;
}

TEST(law_terms, anisotropic_sampled_normals_are_the_visible_ones) {
  EXPECT_TRUE(follows_visible_normals(shade::ggx_sample_visible_aniso));
  EXPECT_FALSE(follows_visible_normals(
      [](vec3 wo, float ax, float ay, vec2 u) { return shade::ggx_sample_visible_aniso(wo, 1.05f * ax, ay, u); }));
  EXPECT_FALSE(follows_visible_normals([](vec3 wo, float ax, float ay, vec2 u) {
    return shade::ggx_sample_visible_aniso(wo, ay, ax, u);
  })) << "widths swapped";
}

// ----- models

/// Farthest that the shares of a model are from the integral of its values, over the integral.
double worst_share(const shade::ShadingModel& model, float metallic) {
  double worst = 0.0;
  for (const float roughness : {0.3f, 0.5f, 0.7f, 1.0f}) {
    for (const float cosine : {0.9f, 0.5f, 0.2f}) {
      shade::SurfaceParams p = shade::surface_params_default();
      p.lobes = shade::kLobeModel;
      p.model = model;
      p.metallic = metallic;
      p.roughness = roughness;
      const vec3 wo = direction(cosine, 0.9f);
      const shade::Surface s = shade::surface_prepare(p, wo);
      const test::DirectionFunction f = [&](vec3 wi) {
        return glm::dvec4(static_cast<double>(shade::surface_eval(s, wo, wi).value.x), 0.0, 0.0, 0.0);
      };
      const std::array<vec3, 1> peaks = {shade::microfacet_reflect(wo, kNormal)};
      const double expected = HemisphereQuadrature(f, peaks, {1e-5, 1e30, 0.1}).integral().x;
      const shade::SurfaceShares shares = shade::surface_shares(s, wo);
      const double found = static_cast<double>(shares.specular.x + shares.spread.x + shares.diffuse.x);
      worst = std::max(worst, std::abs(found / expected - 1.0));
    }
  }
  return worst;
}

// What is drawn of light from far away: a surface in a furnace is as bright as its values say.
TEST(law_terms, shares_of_a_model_are_what_its_values_add_up_to) {
  using shade::ShadingModel;
  ShadingModel schlick = shade::shading_model_candela(), off = schlick, burley = schlick;
  schlick.fresnel = shade::kFresnelSchlick;
  off.multiscatter = false;
  burley.diffuse = shade::kDiffuseBurley;
  const std::vector<std::pair<std::string, ShadingModel>> models = {{"gltf", shade::shading_model_gltf()},
                                                                    {"ue4", shade::shading_model_ue4()},
                                                                    {"thesis", shade::shading_model_thesis()},
                                                                    {"learnopengl", shade::shading_model_learnopengl()},
                                                                    {"f=schlick", schlick},
                                                                    {"multiscatter=off", off},
                                                                    {"diffuse=burley", burley}};
  for (const auto& [name, model] : models) {
    for (const float metallic : {0.0f, 1.0f}) {
      EXPECT_LT(worst_share(model, metallic), 0.015) << name << (metallic > 0.0f ? ", metal" : "");
    }
  }
}

}  // namespace
}  // namespace candela::laws
