// Metallic-roughness and specular-glossiness say the same.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "shade/workflow.glsl.h"
#include "support/random.h"

namespace candela::laws {
namespace {

using shade::MetallicRoughness;
using shade::SpecularGlossiness;
using shade::vec3;
using ToSpecular = std::function<SpecularGlossiness(MetallicRoughness)>;
using ToMetallic = std::function<MetallicRoughness(SpecularGlossiness)>;

constexpr int kMaterials = 5000;

MetallicRoughness metallic(vec3 base, float m, float roughness) {
  MetallicRoughness p;
  p.base_color = base;
  p.metallic = m;
  p.roughness = roughness;
  return p;
}

SpecularGlossiness specular(vec3 diffuse, vec3 f0, float glossiness) {
  SpecularGlossiness p;
  p.diffuse = diffuse;
  p.specular = f0;
  p.glossiness = glossiness;
  return p;
}

// Pure metals, pure dielectrics and everything between; dark, grey and saturated.
MetallicRoughness random_material(test::Pcg32& random) {
  const vec3 base = random.next_vec3();
  const float choice = random.next_float();
  const float m = choice < 0.2f ? 0.0f : choice < 0.4f ? 1.0f : random.next_float();
  const float dark = random.next_float() < 0.2f ? 0.03f : 1.0f;
  return metallic(dark * base, m, random.next_float());
}

float worst_conversion(const ToSpecular& convert) {
  test::Pcg32 random(1);
  float worst = 0.0f;
  for (int i = 0; i < kMaterials; ++i) {
    const MetallicRoughness m = random_material(random);
    const SpecularGlossiness s = convert(m);
    worst = std::max(worst, shade::workflow_difference(s, m));
    for (int c = 0; c < 3; ++c) {
      if (!(s.diffuse[c] >= 0.0f && s.diffuse[c] <= 1.0f && s.specular[c] >= 0.0f && s.specular[c] <= 1.0f))
        return 1e9f;
    }
    worst = std::max(worst, std::abs(1.0f - s.glossiness - m.roughness));
  }
  return worst;
}

TEST(law_workflow, specular_glossiness_is_exact) {
  EXPECT_LT(worst_conversion(shade::specular_glossiness_from_metallic), 2e-6f);
  EXPECT_GT(worst_conversion([](MetallicRoughness m) {
              SpecularGlossiness s = shade::specular_glossiness_from_metallic(m);
              s.diffuse = m.base_color * (1.0f - m.metallic);
              return s;
            }),
            1e-2f)
      << "without 1 - max specular";
  EXPECT_GT(worst_conversion([](MetallicRoughness m) {
              SpecularGlossiness s = shade::specular_glossiness_from_metallic(m);
              s.specular = s.specular * s.specular;
              return s;
            }),
            1e-2f);
}

float worst_round_trip(const ToMetallic& back) {
  test::Pcg32 random(2);
  float worst = 0.0f;
  for (int i = 0; i < kMaterials; ++i) {
    const MetallicRoughness m = random_material(random);
    const SpecularGlossiness s = shade::specular_glossiness_from_metallic(m);
    const MetallicRoughness again = back(s);
    worst = std::max(worst, shade::workflow_difference(s, again));
    worst = std::max(worst, std::abs(again.roughness - m.roughness));
  }
  return worst;
}

TEST(law_workflow, what_comes_from_metallic_returns_exactly) {
  EXPECT_LT(worst_round_trip(shade::metallic_from_specular_glossiness), 2e-4f);
  EXPECT_GT(worst_round_trip([](SpecularGlossiness s) {
              const float m = shade::shade_max3(s.specular) > 0.1f ? 1.0f : 0.0f;
              return shade::metallic_from_known_metallic(s, m);
            }),
            1e-2f)
      << "a threshold in place of the quadratic";
  EXPECT_GT(worst_round_trip([](SpecularGlossiness s) {
              MetallicRoughness m = shade::metallic_from_specular_glossiness(s);
              m.base_color = glm::mix(m.base_color, s.diffuse, 0.1f);
              return m;
            }),
            1e-2f);
}

TEST(law_workflow, parameters_return_where_they_are_unique) {
  test::Pcg32 random(3);
  for (int i = 0; i < 1000; ++i) {
    const vec3 base = vec3(0.1f) + 0.9f * random.next_vec3();  // brighter than 0.04: one root
    const float m = random.next_float() < 0.3f ? 1.0f : 0.9f * random.next_float();
    const SpecularGlossiness s = shade::specular_glossiness_from_metallic(metallic(base, m, 0.3f));
    const MetallicRoughness again = shade::metallic_from_specular_glossiness(s);
    EXPECT_NEAR(again.metallic, m, 5e-3f);
    EXPECT_LT(glm::length(again.base_color - base), 1e-2f) << "metallic " << m;
  }
}

TEST(law_workflow, residual_says_what_remains) {
  const auto residual = [](vec3 diffuse, vec3 f0) { return shade::workflow_residual(specular(diffuse, f0, 0.5f)); };
  EXPECT_LT(residual(vec3(0.5f, 0.2f, 0.1f), vec3(0.04f)), 1e-5f) << "plain plastic";
  EXPECT_LT(residual(vec3(0.0f), vec3(0.9f, 0.6f, 0.2f)), 1e-5f) << "plain metal";
  // F0 of water: nothing below 0.04 over a bright diffuse colour.
  EXPECT_NEAR(residual(vec3(0.5f), vec3(0.02f)), 0.02f, 1e-4f);
  // A blue sheen on red paint.
  EXPECT_GT(residual(vec3(0.8f, 0.0f, 0.0f), vec3(0.04f, 0.04f, 0.5f)), 0.05f);
  EXPECT_LT(residual(vec3(1.0f), vec3(1.0f)), 1e-6f) << "a mirror hides its diffuse colour";
}

TEST(law_workflow, any_pair_gives_a_material_in_range) {
  test::Pcg32 random(4);
  for (int i = 0; i < kMaterials; ++i) {
    const vec3 diffuse = random.next_vec3();
    const SpecularGlossiness s = specular(diffuse, random.next_vec3(), random.next_float());
    const MetallicRoughness m = shade::metallic_from_specular_glossiness(s);
    for (int c = 0; c < 3; ++c) EXPECT_TRUE(m.base_color[c] >= 0.0f && m.base_color[c] <= 1.0f);
    EXPECT_TRUE(m.metallic >= 0.0f && m.metallic <= 1.0f);
    // Never worse than calling it a dielectric.
    EXPECT_LE(shade::workflow_residual(s), shade::workflow_difference(s, shade::metallic_from_known_metallic(s, 0.0f)));
  }
}

}  // namespace
}  // namespace candela::laws
