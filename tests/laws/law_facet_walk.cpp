// What leaves a rough surface after many facets, against light that walks between them (shade/facet_walk.h).

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "laws/laws.h"
#include "shade/facet_walk.h"
#include "shade/surface.glsl.h"
#include "support/random.h"

namespace candela::laws {
namespace {

using laws::direction;
using shade::Surface;
using shade::SurfaceParams;
using shade::vec2;
using shade::vec3;
using test::Pcg32;

using Walk = shade::FacetWalk<Pcg32>;

constexpr int kWalks = 100000;
constexpr float kFromEverywhere = -1.0f;  // in place of a cosine

vec3 view(float mu, int i, int count) {
  const float from = std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(count));
  return direction(std::max(mu == kFromEverywhere ? from : mu, 1e-3f), 0.0f);
}

// ----- the walk itself

double first_facet_share(float mu, float alpha) {
  Pcg32 random(11);
  const Walk walk(alpha, random);
  int single = 0;
  for (int i = 0; i < kWalks; ++i) {
    single += walk.over_mirrors(view(mu, i, kWalks), [](float) {}).bounces == 1 ? 1 : 0;
  }
  return static_cast<double>(single) / kWalks;
}

TEST(law_facet_walk, what_leaves_after_one_facet_is_smiths_single_scattering) {
  for (const float r : {0.5f, 0.8f, 1.0f}) {
    for (const float mu : {0.9f, 0.4f, 0.1f}) {
      const vec2 ab = shade::table_ggx(mu, shade::table_ggx_roughness(r));
      EXPECT_NEAR(first_facet_share(mu, r * r), static_cast<double>(ab.x + ab.y), 6e-3) << r << ' ' << mu;
    }
  }
  const vec2 ab = shade::table_ggx(0.4f, shade::table_ggx_roughness(0.8f));
  EXPECT_GT(std::abs(first_facet_share(0.4f, 0.8f) - static_cast<double>(ab.x + ab.y)), 0.05) << "roughness for alpha";
}

struct Sides {
  double reflected = 0.0, transmitted = 0.0;
};

Sides walk_glass(float mu, float alpha, float eta) {
  Pcg32 random(12);
  const Walk walk(alpha, random);
  Sides sides;
  for (int i = 0; i < kWalks; ++i) {
    const shade::FacetExit exit = walk.over_glass(view(mu, i, kWalks), eta);
    if (!exit.is_lost) (exit.w.z > 0.0f ? sides.reflected : sides.transmitted) += 1.0 / kWalks;
  }
  return sides;
}

// As much crosses from one side as from the other, directions being n² as many there (Veach 1997, §5.2).
TEST(law_facet_walk, glass_lets_as_much_through_from_either_side) {
  for (const float r : {0.3f, 0.7f, 1.0f}) {
    for (const float eta : {1.33f, 2.0f}) {
      const Sides here = walk_glass(kFromEverywhere, r * r, eta);
      const Sides there = walk_glass(kFromEverywhere, r * r, 1.0f / eta);
      const double n2 = static_cast<double>(eta) * static_cast<double>(eta);
      EXPECT_NEAR(here.transmitted, n2 * there.transmitted, 0.02) << r << ' ' << eta;
      EXPECT_NEAR(here.reflected + here.transmitted, 1.0, 1e-3);
      EXPECT_GT(std::abs(here.transmitted - there.transmitted), 0.2);  // and not without n²
    }
  }
}

// ----- metals

constexpr vec3 kMetal(0.2f, 0.5f, 0.9f);

vec3 walk_metal(float mu, float alpha) {
  Pcg32 random(13);
  const Walk walk(alpha, random);
  glm::dvec3 sum(0.0);
  for (int i = 0; i < kWalks; ++i) {
    vec3 weight(1.0f);
    walk.over_mirrors(view(mu, i, kWalks), [&](float c) { weight *= shade::fresnel_schlick(kMetal, vec3(1.0f), c); });
    sum += glm::dvec3(weight);
  }
  return vec3(sum / static_cast<double>(kWalks));
}

/// What the surface reflects, its multiple scattering scaled by `share` of a mean reflectance.
template <class Share>
vec3 metal_albedo(float mu, float roughness, const Share& share) {
  SurfaceParams p = shade::surface_params_default();
  p.base_color = kMetal;
  p.roughness = roughness;
  constexpr int kViews = 256;
  glm::dvec3 sum(0.0);
  for (int i = 0; i < kViews; ++i) {
    const Surface s = shade::surface_prepare(p, view(mu, i, kViews));
    sum += glm::dvec3(s.single_albedo_o + share(s) * s.escape_o);
  }
  return vec3(sum / static_cast<double>(kViews));
}

vec3 real_share(const Surface& s) { return s.multiscatter * (shade::kShadePi * s.escape_mean); }

/// Kulla & Conty's series with Hill's correction, which takes every bounce for the first.
vec3 hills_share(const Surface& s) {
  const vec3 f = shade::fresnel_average_schlick(s.f0_metal, vec3(1.0f));
  return f * f * (1.0f - s.escape_mean) / (1.0f - f * s.escape_mean);
}

template <class Share>
double worst_metal(float mu, const Share& share) {
  double worst = 0.0;
  for (const float r : {0.4f, 0.7f, 0.85f, 1.0f}) {
    const vec3 expected = walk_metal(mu, r * r), found = metal_albedo(mu, r, share);
    for (int c = 0; c < 3; ++c) worst = std::max(worst, static_cast<double>(std::abs(found[c] / expected[c] - 1.0f)));
  }
  return worst;
}

TEST(law_facet_walk, rough_metals_reflect_what_walks_bring_back) {
  EXPECT_LT(worst_metal(kFromEverywhere, real_share), 0.02);
  EXPECT_GT(worst_metal(kFromEverywhere, hills_share), 0.06);
}

TEST(law_facet_walk, and_so_they_do_seen_from_any_side) {
  for (const float mu : {0.95f, 0.6f, 0.3f, 0.1f}) EXPECT_LT(worst_metal(mu, real_share), 0.07) << mu;
}

// ----- glass

Sides surface_glass(float mu, float roughness, float eta) {
  SurfaceParams p = shade::surface_params_default();
  p.lobes = shade::kLobeTransmission;
  p.metallic = 0.0f;
  p.transmission = 1.0f;
  p.is_thin = false;
  p.ior = std::max(eta, 1.0f / eta);
  p.eta = eta;
  p.roughness = roughness;
  Pcg32 random(14);
  Sides sides;
  for (int i = 0; i < kWalks; ++i) {
    const vec3 wo = view(mu, i, kWalks);
    const shade::SurfaceSample s = shade::surface_sample(shade::surface_prepare(p, wo), wo, random.next_vec3());
    if (s.pdf <= 0.0f) continue;
    const auto weight = static_cast<double>(s.weight.x) / kWalks;
    if (s.wi.z > 0.0f) {
      sides.reflected += weight;
    } else {
      sides.transmitted += weight * static_cast<double>(eta * eta);
    }
  }
  return sides;
}

TEST(law_facet_walk, rough_glass_shares_light_as_walks_do) {
  for (const float eta : {1.33f, 1.5f, 2.0f, 1.0f / 1.5f}) {
    for (const float r : {0.3f, 0.5f, 0.8f, 1.0f}) {
      const Sides expected = walk_glass(kFromEverywhere, r * r, eta), found = surface_glass(kFromEverywhere, r, eta);
      EXPECT_NEAR(found.reflected, expected.reflected, 8e-3) << eta << ' ' << r;
      EXPECT_NEAR(found.transmitted, expected.transmitted, 9e-3) << eta << ' ' << r;
    }
  }
}

// The twin: sides that share what is lost by their losses and n² alone.
TEST(law_facet_walk, glass_that_forgets_where_light_came_from_is_seen) {
  const float r = 1.0f, eta = 1.33f;
  const double here = 1.0 - static_cast<double>(shade::table_glass_mean(r, eta));
  const double there = 1.0 - static_cast<double>(shade::table_glass_mean(r, 1.0f / eta));
  const double n2 = static_cast<double>(eta) * static_cast<double>(eta);
  const double forgetful = there * n2 / (here + there * n2);
  EXPECT_GT((static_cast<double>(shade::table_glass_through(r, eta)) - forgetful) * here, 0.02);
}

}  // namespace
}  // namespace candela::laws
