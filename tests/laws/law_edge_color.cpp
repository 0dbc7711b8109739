#include <gtest/gtest.h>

#include <cmath>

#include "laws/laws.h"
#include "math/types.h"

/// EXT_materials_specular_edge_color: what it says beyond the laws of every surface.
namespace candela::laws {
namespace {

using shade::SurfaceParams;
using shade::vec3;

const vec3 kColor(0.9f, 0.4f, 0.1f);

SurfaceParams colored(float metallic, vec3 base_color, vec3 specular_color, bool has_edge = true) {
  SurfaceParams p = shade::surface_params_default();
  p.lobes = has_edge ? shade::kLobeEdgeColor : 0;
  p.metallic = metallic;
  p.roughness = 0.4f;
  p.base_color = base_color;
  p.specular_color = specular_color;
  return p;
}

vec3 value(const SurfaceParams& p, vec3 wo, vec3 wi) {
  return shade::surface_eval(shade::surface_prepare(p, wo), wo, wi).value;
}

/// Largest difference, relative to the second, in mirror directions down to grazing ones.
template <class A, class B>
float largest_difference(const A& a, const B& b) {
  float worst = 0.0f;
  for (const float mu : {1.0f, 0.7f, 0.4f, 0.2f, 0.1f}) {
    const vec3 expected = b(direction(mu, 0.3f), direction(mu, 0.3f + kPi));
    const vec3 d = glm::abs(a(direction(mu, 0.3f), direction(mu, 0.3f + kPi)) - expected) / expected;
    worst = std::max(worst, shade::shade_max3(d));
  }
  return worst;
}

TEST(law_edge_color, a_dielectrics_reflection_has_the_color_at_every_angle) {
  const vec3 black(0.0f), white(1.0f);
  const auto of = [&](const SurfaceParams& p) { return [p](vec3 wo, vec3 wi) { return value(p, wo, wi); }; };
  const auto tinted = [&](vec3 wo, vec3 wi) { return kColor * value(colored(0.0f, black, white), wo, wi); };
  // Light that facets pass on to each other takes the colour on more than once.
  EXPECT_LT(largest_difference(of(colored(0.0f, black, kColor)), tinted), 0.02f);
  // The twin: KHR_materials_specular alone is white at grazing angles.
  EXPECT_GT(largest_difference(of(colored(0.0f, black, kColor, false)), tinted), 0.5f);
}

TEST(law_edge_color, the_layer_below_sees_no_color) {
  const vec3 black(0.0f), grey(0.5f), white(1.0f);
  const auto below = [&](vec3 wo, vec3 wi) {
    return value(colored(0.0f, grey, white), wo, wi) - value(colored(0.0f, black, white), wo, wi);
  };
  const auto without = [&](bool has_edge) {
    return [=](vec3 wo, vec3 wi) { return value(colored(0.0f, grey, black, has_edge), wo, wi); };
  };
  EXPECT_LT(largest_difference(without(true), below), 1e-3f);
  EXPECT_GT(largest_difference(without(false), below), 0.02f);
}

TEST(law_edge_color, a_metal_has_the_tint_near_82_degrees) {
  const vec3 gold(1.0f, 0.78f, 0.34f);
  SurfaceParams p = colored(1.0f, gold, kColor);
  p.specular = 0.5f;
  const vec3 wo = direction(0.5f, 0.0f);
  const float mu = 1.0f / 7.0f;
  const vec3 schlick = gold + (vec3(1.0f) - gold) * shade::schlick_weight(mu);
  const vec3 found = shade::terms_fresnel_opaque(shade::surface_prepare(p, wo), mu);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], 0.5f * kColor[c] * schlick[c], 1e-5f);
  const vec3 normal = shade::terms_fresnel_opaque(shade::surface_prepare(p, wo), 1.0f);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(normal[c], gold[c], 1e-5f);
}

TEST(law_edge_color, what_it_returns_of_light_from_everywhere_is_known) {
  for (const float metallic : {0.0f, 0.5f, 1.0f}) {
    for (const float roughness : {0.1f, 0.3f, 0.7f}) {
      SurfaceParams p = colored(metallic, vec3(0.9f, 0.7f, 0.4f), vec3(0.9f, 0.2f, 0.0f));
      p.roughness = roughness;
      const Bsdf bsdf = real_bsdf(p);
      for (const vec3 wo : view_directions()) {
        const glm::dvec4 returned = furnace(bsdf, wo, 1e-5);
        const vec3 known = shade::surface_albedo(shade::surface_prepare(p, wo));
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(known[c], returned[c], 0.006) << metallic << ' ' << roughness;
      }
    }
  }
}

}  // namespace
}  // namespace candela::laws
