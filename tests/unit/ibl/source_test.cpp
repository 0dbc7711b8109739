#include "ibl/source.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "base/error.h"
#include "content/make_environment.h"
#include "scene/environment.h"

namespace candela::ibl {
namespace {

TEST(ibl_source, texels_cover_the_sphere) {
  double sum = 0.0;
  for (int y = 0; y < 32; ++y) sum += 64 * texel_solid_angle(y, 64, 32);
  EXPECT_NEAR(sum, 4.0 * std::numbers::pi, 1e-12);
}

TEST(ibl_source, directions_look_up_the_texel_they_belong_to) {
  Environment environment = make_environment("furnace");
  auto map = std::make_shared<Image>(16, 8, 3);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 16; ++x) map->set_rgb(x, y, vec3(static_cast<float>(16 * y + x)));
  }
  environment.map = map;
  environment.constant = vec3(0.5f);
  environment.intensity = 2.0f;
  environment.rotation = 0.7f;
  const Source source = make_source(environment);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 16; ++x) {
      const vec3 there = environment_radiance(environment, vec3(texel_direction(source, x, y)));
      EXPECT_NEAR(source.map.rgb(x, y).x, there.x, 2e-3f) << x << ' ' << y;
    }
  }
}

TEST(ibl_source, suns_turn_with_the_environment) {
  Environment environment = make_environment("sky:30");
  environment.rotation = 1.1f;
  const Source source = make_source(environment);
  ASSERT_EQ(source.suns.size(), 1U);
  const vec3 sun = source.suns[0].direction;
  EXPECT_GT(max_component(environment_radiance(environment, sun)), 100.0f);
}

TEST(ibl_source, the_points_of_a_disc_have_its_flux_and_moments) {
  const SunDisc sun{glm::normalize(vec3(0.3f, 0.8f, -0.2f)), 0.02f, vec3(5.0f, 4.0f, 3.0f)};
  dvec3 flux(0.0), first(0.0);
  double second = 0.0;
  for (const Point& p : disc_points(sun)) {
    flux += p.flux;
    first += p.flux.x * p.direction;
    const dvec3 chord = p.direction - glm::normalize(dvec3(sun.direction));
    second += p.flux.x * glm::dot(chord, chord);
  }
  EXPECT_NEAR(flux.x, 5.0 * disc_solid_angle(sun), 1e-12);
  EXPECT_NEAR(glm::dot(glm::normalize(first), glm::normalize(dvec3(sun.direction))), 1.0, 1e-12);
  EXPECT_NEAR(second / flux.x, 0.5 * 0.02 * 0.02, 1e-7);
}

TEST(ibl_source, darkness_is_refused) { EXPECT_THROW(make_source(make_environment("none")), Error); }

}  // namespace
}  // namespace candela::ibl
