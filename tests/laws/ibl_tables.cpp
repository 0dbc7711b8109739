// The split-sum tables, and what they and the prefiltered levels make of a white furnace.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "ibl/prefilter.h"
#include "ibl/tables.h"
#include "ibl/verify.h"
#include "laws/ibl_scenes.h"
#include "laws/laws.h"
#include "laws/quadrature.h"
#include "laws/split_sums.h"
#include "shade/fresnel.glsl.h"
#include "shade/microfacet.glsl.h"
#include "shade/surface_constants.glsl.h"

namespace candela::laws {
namespace {

constexpr std::array<float, 4> kCosines = {0.08f, 0.3f, 0.6f, 0.97f};
constexpr std::array<float, 4> kRoughnesses = {0.2f, 0.4f, 0.7f, 1.0f};

/// Over the hemisphere by another quadrature than the tables'.
template <class F>
double over_hemisphere(vec3 wo, const F& f) {
  const laws::DirectionFunction g = [&](vec3 wi) { return glm::dvec4(static_cast<double>(f(wi))); };
  const std::array<vec3, 1> peaks = {vec3(-wo.x, -wo.y, wo.z)};
  return laws::HemisphereQuadrature(g, peaks, laws::QuadratureOptions{}).integral().x;
}

TEST(law_ibl_tables, equal_quadrature) {
  for (const float mu : kCosines) {
    for (const float r : kRoughnesses) {
      const vec3 wo = laws::direction(mu, 0.0f);
      const float alpha = shade::roughness_to_alpha(r), k = shade::schlick_k_ibl(r);
      const auto sum = [&](bool is_k, bool grazing) {
        return over_hemisphere(wo, [&](vec3 wi) {
          const vec3 wm = glm::normalize(wo + wi);
          const float fresnel = shade::schlick_weight(glm::dot(wo, wm));
          const float v = is_k ? shade::v_schlick_ggx(wo, wi, k) : shade::ggx_v_smith(wo, wi, alpha);
          return shade::ggx_d(wm, alpha) * v * wi.z * (grazing ? fresnel : 1.0f - fresnel);
        });
      };
      const vec2 ab = ibl::split_sum(mu, r), k_ibl = ibl::split_sum_k_ibl(mu, r);
      EXPECT_NEAR(static_cast<double>(ab.x), sum(false, false), 3e-4) << mu << ' ' << r;
      EXPECT_NEAR(static_cast<double>(ab.y), sum(false, true), 3e-4) << mu << ' ' << r;
      EXPECT_NEAR(static_cast<double>(k_ibl.x), sum(true, false), 3e-4) << mu << ' ' << r;
      EXPECT_NEAR(static_cast<double>(k_ibl.y), sum(true, true), 3e-4) << mu << ' ' << r;
      const float sheen = shade::sheen_alpha(r);
      const double albedo = over_hemisphere(wo, [&](vec3 wi) {
        return shade::charlie_d(glm::normalize(wo + wi), sheen) * shade::neubelt_v(wo, wi) * wi.z;
      });
      EXPECT_NEAR(static_cast<double>(ibl::sheen_albedo(mu, r)), albedo, 5e-4) << mu << ' ' << r;
    }
  }
  // k of direct light in place of the one for images.
  EXPECT_GT(std::abs(ibl::split_sum_k_ibl(0.3f, 1.0f).x - ibl::split_sum(0.3f, 1.0f).x), 0.05f);
}

TEST(law_ibl_tables, have_the_published_split_sums) {
  for (const laws::SplitSum& e : laws::kSplitSums) {
    const vec2 ab = ibl::split_sum(e.mu, e.roughness);
    EXPECT_NEAR(ab.x, e.a, 3e-4f) << e.roughness << ' ' << e.mu;
    EXPECT_NEAR(ab.y, e.b, 3e-4f) << e.roughness << ' ' << e.mu;
  }
  EXPECT_NEAR(ibl::split_sum(1.0f, 1.0f).x, 1.0f - std::log(2.0f), 1e-4f);
}

TEST(law_ibl_tables, texels_stand_where_they_are_said_to) {
  const ibl::Tables tables = ibl::make_tables(8);
  const vec2 ab = ibl::split_sum(2.5f / 8.0f, 5.5f / 8.0f);
  EXPECT_EQ(tables.dfg.rgb(2, 5), vec3(ab, ibl::sheen_albedo(2.5f / 8.0f, 5.5f / 8.0f)));
  EXPECT_EQ(tables.dfg_k_ibl.rgb(2, 5), vec3(ibl::split_sum_k_ibl(2.5f / 8.0f, 5.5f / 8.0f), 0.0f));
}

TEST(law_ibl_tables, prefilter_and_table_reflect_of_a_furnace_what_the_lobe_does_once) {
  const ibl::Source furnace = panorama(64, [](dvec3) { return dvec3(1.0); });
  const std::vector<dvec3> directions = ibl::random_directions(12, 3);
  double uncompensated = 0.0;
  for (const float r : kRoughnesses) {
    const ibl::Kernel kernel(ibl::Lobe::ggx, static_cast<double>(r));
    const std::vector<dvec3> filtered = ibl::Prefilter(furnace, {kernel}, {}).at(kernel, directions);
    for (const float mu : kCosines) {
      const vec2 ab = ibl::split_sum(mu, r);
      // What the material reflects of a white furnace once, by quadrature.
      const vec3 wo = laws::direction(mu, 0.0f);
      const float alpha = shade::roughness_to_alpha(r);
      const double once = over_hemisphere(wo, [&](vec3 wi) {
        return shade::ggx_d(glm::normalize(wo + wi), alpha) * shade::ggx_v_smith(wo, wi, alpha) * wi.z;
      });
      for (const dvec3& v : filtered) {
        const double split = v.x * static_cast<double>(ab.x + ab.y);
        EXPECT_NEAR(split, once, 8e-4) << r << ' ' << mu;
        uncompensated = std::max(uncompensated, 1.0 - split);
      }
    }
  }
  EXPECT_GT(uncompensated, 0.3) << "where light leaves after several reflections, once is not all";
}

}  // namespace
}  // namespace candela::laws
