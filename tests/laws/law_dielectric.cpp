// Boundaries of dielectrics reflect by the law of Fresnel: base, coat and film, between the F0 and F90 that the
// extensions say; the models of texts by the curves that they print.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "laws/laws.h"
#include "laws/quadrature.h"
#include "shade/surface.glsl.h"

namespace candela::laws {
namespace {

using laws::direction;
using shade::Surface;
using shade::SurfaceParams;
using shade::vec2;
using shade::vec3;

constexpr float kCosines[] = {1.0f, 0.8f, 0.6f, 0.4f, 0.2f, 0.05f};
constexpr float kIndices[] = {1.0f, 1.2f, 1.33f, 1.5f, 1.76f, 2.42f};

SurfaceParams black_gloss(float ior) {
  SurfaceParams p = shade::surface_params_default();
  p.base_color = vec3(0.0f);
  p.metallic = 0.0f;
  p.roughness = 0.0f;
  p.ior = ior;
  return p;
}

/// What a smooth surface reflects.
vec3 mirrored(const SurfaceParams& p, float cosine) {
  vec3 sum(0.0f);
  for (const laws::DeltaLobe& lobe : laws::delta_lobes(laws::real_bsdf(p).seen_from(direction(cosine, 0.4f)))) {
    sum += lobe.value;
  }
  return sum;
}

float schlick(float ior, float cosine) {
  const float f0 = shade::f0_from_eta(ior);
  return f0 + (1.0f - f0) * shade::schlick_weight(cosine);
}

TEST(law_dielectric, base_reflects_by_fresnels_law) {
  for (const float ior : kIndices) {
    for (const float c : kCosines) {
      EXPECT_NEAR(mirrored(black_gloss(ior), c).x, shade::fresnel_dielectric(c, ior), 2e-5f) << ior << ' ' << c;
    }
  }
  // Computed once by hand.
  EXPECT_NEAR(mirrored(black_gloss(1.5f), 0.6f).x, 0.0645f, 1e-4f);
  EXPECT_NEAR(mirrored(black_gloss(1.5f), 0.4f).x, 0.1325f, 1e-4f);
  // The twin: Schlick's curve is told apart.
  EXPECT_GT(std::abs(mirrored(black_gloss(1.5f), 0.6f).x - schlick(1.5f, 0.6f)), 0.01f);
}

TEST(law_dielectric, specular_stretches_the_curve_between_f0_and_f90) {
  for (const float c : kCosines) {
    SurfaceParams p = black_gloss(1.5f);
    p.specular = 0.5f;
    p.specular_color = vec3(0.2f, 1.0f, 3.0f);
    const float rise = (shade::fresnel_dielectric(c, 1.5f) - 0.04f) / 0.96f;
    for (int i = 0; i < 3; ++i) {
      const float f0 = 0.04f * p.specular_color[i] * 0.5f;
      EXPECT_NEAR(mirrored(p, c)[i], f0 + (0.5f - f0) * rise, 2e-5f) << c;
    }
    EXPECT_NEAR(mirrored(black_gloss(0.0f), c).x, 1.0f, 1e-6f) << "ior 0 reflects all";
  }
}

TEST(law_dielectric, coat_reflects_by_fresnels_law) {
  for (const float c : kCosines) {
    SurfaceParams p = black_gloss(1.0f);
    p.lobes = shade::kLobeClearcoat;
    p.clearcoat = 1.0f;
    const float found = mirrored(p, c).x;
    EXPECT_NEAR(found, shade::fresnel_dielectric(c, 1.5f), 2e-5f) << c;
    if (c == 0.4f) {
      EXPECT_GT(std::abs(found - schlick(1.5f, c)), 0.01f);
    }
  }
}

// A film that covers half, and one of no thickness.
TEST(law_dielectric, what_a_film_leaves_bare_reflects_by_fresnels_law) {
  for (const float c : kCosines) {
    SurfaceParams p = black_gloss(1.5f);
    p.lobes = shade::kLobeIridescence;
    p.film_nm = 300.0f;
    p.film_ior = 1.8f;
    p.iridescence = 1.0f;
    const vec3 film = mirrored(p, c);
    p.iridescence = 0.5f;
    const vec3 both = mirrored(p, c);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(2.0f * both[i] - film[i], shade::fresnel_dielectric(c, 1.5f), 5e-5f) << c;
    p.film_nm = 0.0f;
    EXPECT_NEAR(mirrored(p, c).y, shade::fresnel_dielectric(c, 1.5f), 2e-5f) << c;
  }
}

TEST(law_dielectric, models_of_texts_keep_the_curves_of_their_texts) {
  for (const auto make : {shade::shading_model_gltf, shade::shading_model_learnopengl, shade::shading_model_thesis,
                          shade::shading_model_blinn_phong}) {
    SurfaceParams p = black_gloss(1.5f);
    p.lobes = shade::kLobeModel;
    p.model = make();
    EXPECT_NEAR(mirrored(p, 0.4f).x, schlick(1.5f, 0.4f), 1e-5f);
  }
  SurfaceParams p = black_gloss(1.5f);
  p.lobes = shade::kLobeModel;
  p.model = shade::shading_model_ue4();
  EXPECT_NEAR(mirrored(p, 0.4f).x, shade::fresnel_spherical_gaussian(vec3(0.04f), 0.4f).x, 1e-5f);
  // A metal has Schlick's by default too, and its own where it is asked for; dielectrics beside it keep Fresnel's.
  p.model = shade::shading_model_candela();
  p.model.fresnel = shade::kFresnelF82;
  EXPECT_NEAR(mirrored(p, 0.4f).x, shade::fresnel_dielectric(0.4f, 1.5f), 2e-5f);
}

// ----- what facets make of it

/// Largest error of the tables of the curve of an index, off their entries. Sharp curves of indices near 1 stand in few
/// entries.
double worst_table(float ior, float table_ior) {
  double worst = 0.0;
  for (const float mu : {0.07f, 0.23f, 0.55f, 0.97f}) {
    for (const float r : {0.15f, 0.37f, 0.71f, 0.93f}) {
      const float alpha = shade::roughness_to_alpha(r);
      const vec3 wo = direction(mu, 0.3f);
      const float scale = shade::fresnel_rise_scale(ior);
      const laws::DirectionFunction f = [&](vec3 wi) {
        const vec3 wm = glm::normalize(wo + wi);
        return glm::dvec4(static_cast<double>(shade::ggx_d(wm, alpha) * shade::ggx_v_smith(wo, wi, alpha) * wi.z *
                                              shade::fresnel_rise(glm::dot(wo, wm), ior, scale)));
      };
      const std::array<vec3, 1> peaks = {vec3(-wo.x, -wo.y, wo.z)};
      const double b = laws::HemisphereQuadrature(f, peaks, {}).integral().x;
      const vec2 ab = shade::table_ggx_curve(mu, shade::table_ggx_roughness(r), shade::table_curve(table_ior));
      worst = std::max(worst, std::abs(static_cast<double>(ab.y) - b));
    }
  }
  return worst;
}

TEST(law_dielectric, tables_of_every_index_equal_quadrature) {
  for (const float ior : {1.1f, 1.33f, 1.45f, 1.5f, 1.76f, 2.42f}) EXPECT_LT(worst_table(ior, ior), 4e-3) << ior;
  EXPECT_GT(worst_table(1.33f, 1.5f), 0.01);
}

TEST(law_dielectric, the_mean_reflectance_of_smooth_plastic_is_the_published_one) {
  // 1.33 and 1.5, unpolarised, cosine-weighted; Schlick's curve has 0.0857 at 1.5.
  const auto mean = [](float ior) {
    constexpr int kSteps = 4000;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      const double mu = (i + 0.5) / kSteps;
      const Surface s = shade::surface_prepare(black_gloss(ior), direction(static_cast<float>(mu), 0.0f));
      sum += 2.0 * mu / kSteps * static_cast<double>(s.specular_albedo_o.x);
    }
    return sum;
  };
  EXPECT_NEAR(mean(1.33f), 0.0659, 4e-4);
  EXPECT_NEAR(mean(1.5f), 0.0918, 4e-4);
  EXPECT_NEAR(mean(1.0f), 0.0, 1e-6);
}

}  // namespace
}  // namespace candela::laws
