// What each lobe has in the value of a surface.

#include <gtest/gtest.h>

#include "laws/run_laws.h"
#include "laws/surfaces.h"
#include "math/sobol.h"
#include "shade/lobe_parts.h"

namespace candela::laws {
namespace {

/// Directions of all kinds; wi below the surface too.
template <class Check>
void for_directions(const shade::SurfaceParams& params, Check check) {
  for (std::uint32_t i = 0; i < 12; ++i) {
    SobolSampler sampler(5, i);
    const vec2 u = sampler.next_2d(), v = sampler.next_2d();
    const float zo = 0.02f + 0.97f * u.x, zi = 2.0f * v.x - 1.0f;
    const float so = std::sqrt(1.0f - zo * zo), si = std::sqrt(1.0f - zi * zi);
    const vec3 wo(so * std::cos(2.0f * kPi * u.y), so * std::sin(2.0f * kPi * u.y), zo);
    const vec3 wi(si * std::cos(2.0f * kPi * v.y), si * std::sin(2.0f * kPi * v.y), zi);
    check(shade::surface_prepare(params, wo), wo, wi);
  }
}

TEST(law_lobe_parts, add_up_to_the_value) {
  for (const NamedSurface& row : law_surfaces()) {
    for_directions(row.params, [&](const shade::Surface& s, vec3 wo, vec3 wi) {
      const vec3 value = shade::surface_eval(s, wo, wi).value;
      const shade::LobeParts p = shade::surface_parts(s, wo, wi);
      const vec3 sum = p.specular + p.diffuse + p.sheen + p.coat + p.below + p.through;
      const float slack = 1e-5f * (1e-3f + max_component(value));
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(sum[c], value[c], slack) << row.name;
    });
  }
}

TEST(law_lobe_parts, none_is_negative_nor_of_a_lobe_that_is_not_there) {
  for (const NamedSurface& row : law_surfaces()) {
    for_directions(row.params, [&](const shade::Surface& s, vec3 wo, vec3 wi) {
      const float slack = 1e-5f * (1e-3f + max_component(shade::surface_eval(s, wo, wi).value));
      const shade::LobeParts p = shade::surface_parts(s, wo, wi);
      for (const vec3& part : {p.specular, p.diffuse, p.sheen, p.coat, p.below, p.through}) {
        for (int c = 0; c < 3; ++c) ASSERT_GE(part[c], -slack) << row.name;
      }
      if ((s.lobes & shade::kLobeClearcoat) == 0) {
        EXPECT_EQ(p.coat, vec3(0.0f)) << row.name;
      }
      if ((s.lobes & shade::kLobesOfFibres) == 0) {
        EXPECT_EQ(p.sheen, vec3(0.0f)) << row.name;
      }
      if (wi.z > 0.0f) {
        EXPECT_EQ(p.below + p.through, vec3(0.0f)) << row.name;
      }
      if (wi.z < 0.0f) {
        EXPECT_EQ(p.specular + p.diffuse + p.sheen + p.coat, vec3(0.0f)) << row.name;
      }
    });
  }
}

TEST(law_lobe_parts, a_lobe_alone_has_all) {
  shade::SurfaceParams metal = shade::surface_params_default();
  metal.roughness = 0.4f;
  shade::SurfaceParams matte = metal;
  matte.metallic = 0.0f;
  matte.specular = 0.0f;
  for_directions(metal, [&](const shade::Surface& s, vec3 wo, vec3 wi) {
    if (wi.z <= 0.0f) return;
    EXPECT_EQ(shade::surface_parts(s, wo, wi).diffuse, vec3(0.0f));
    EXPECT_EQ(shade::surface_parts(s, wo, wi).specular, shade::surface_eval(s, wo, wi).value);
  });
  for_directions(matte, [&](const shade::Surface& s, vec3 wo, vec3 wi) {
    if (wi.z <= 0.0f) return;
    EXPECT_NEAR(shade::surface_parts(s, wo, wi).diffuse.x, wi.z / kPi, 1e-5f);
  });
}

}  // namespace
}  // namespace candela::laws
