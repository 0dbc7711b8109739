#include <gtest/gtest.h>

#include <cmath>

#include "laws/raster_draw.h"
#include "path/render.h"
#include "raster/ground.h"
#include "scene/environment.h"
#include "unit/gl/gl_fixture.h"
#include "unit/path/scenes.h"

// The ground of the rasterizer is that of the path tracer.

namespace candela {
namespace {

using namespace test;

class law_raster_ground : public NeedsGl {};  // NOLINT(readability-identifier-naming): a suite is named as its laws

constexpr int kSize = 48;

raster::Settings drawn(Background background = Background::transparent) {
  raster::Settings s;
  s.width = s.height = kSize;
  s.msaa = 1;
  s.background = background;
  return s;
}

path::Settings traced(Background background = Background::transparent) {
  path::Settings s = settings(kSize, 512, 8);
  s.background = background;
  return s;
}

/// Black, so that no light is turned on its way to the ground.
Scene dark_box(Ground ground = {.height = 0.5f}) {
  SceneBuilder b;
  b.add(box({-0.4f, 0.5f, -0.4f}, {0.4f, 1.1f, 0.3f}), matte(vec3(0.0f)));
  Scene scene = b.build();
  scene.ground = ground;
  return scene;
}

Environment sky() {
  const vec3 towards = glm::normalize(vec3(1.0f, 1.2f, 0.5f));
  Environment e = mapped_environment(64, 32, [&](vec3 d) {
    return vec3(0.5f, 0.6f, 0.8f) * (1.1f + d.y) + (glm::dot(d, towards) > 0.95f ? vec3(9, 8, 6) : vec3(0.0f));
  });
  e.rotation = 1.1f;
  return e;
}

View above() { return look_at({0.4f, 4.5f, 1.5f}, {0, 0.5f, 0}, 0.55f); }

void expect_shadows_near(const Film& a, const Film& b, float bound) {
  ASSERT_FALSE(a.through.empty());
  ASSERT_FALSE(b.through.empty());
  for (int y = 0; y < kSize; y += 4) {
    for (int x = 0; x < kSize; x += 4) {
      const Region block{x, y, x + 4, y + 4};
      const dvec3 in_a = mean_of(a.through, block), in_b = mean_of(b.through, block);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(in_a[c], in_b[c], static_cast<double>(bound)) << x << ' ' << y;
    }
  }
}

TEST_F(law_raster_ground, shadows_are_those_of_the_path_tracer_under_a_sky) {
  const Scene scene = dark_box();
  expect_shadows_near(test::draw(scene, sky(), above(), drawn()), shoot(scene, sky(), above(), traced()), 0.05f);
}

TEST_F(law_raster_ground, shadows_are_those_of_the_path_tracer_under_suns_and_lamps) {
  SceneBuilder b;
  b.add(box({-0.4f, 0.5f, -0.4f}, {0.4f, 1.1f, 0.3f}), matte(vec3(0.0f)));
  b.add_light(point_light({1.0f, 0.5f, 0.2f}, 12.0f), translation({-1.0f, 2.2f, 0.4f}));
  b.add_light(sunlight({0.2f, 0.5f, 1.0f}, 3.0f), aimed({0.6f, 2, 1}, {0, 0, 0}));
  Scene scene = b.build();
  scene.ground = Ground{.height = 0.5f};
  Environment e = constant_environment(vec3(0.3f));
  e.suns.push_back({glm::normalize(vec3(0.3f, 1, -0.8f)), 0.05f, vec3(200.0f)});
  expect_shadows_near(test::draw(scene, e, above(), drawn()), shoot(scene, e, above(), traced()), 0.06f);
}

TEST_F(law_raster_ground, blended_sheets_keep_away_their_share) {
  SceneBuilder b;
  Material veil = matte(vec3(0.0f));
  veil.alpha_mode = AlphaMode::blend;
  veil.opacity = 0.4f;
  veil.double_sided = true;
  b.add(quad({-0.5f, 0.9f, -0.5f}, {1, 0, 0}, {0, 0, 1}), veil);
  b.add(quad({-0.5f, 1.0f, -0.5f}, {1, 0, 0}, {0, 0, 0.5f}), veil);
  Scene scene = b.build();
  scene.ground = Ground{.height = 0.5f};
  Environment e = dark_environment();
  e.suns.push_back({glm::normalize(vec3(1, 0.8f, 0)), 0.01f, vec3(1e4f)});
  const Film film = test::draw(scene, e, from_above(6.0f, 1.5f), drawn());
  // The sun is in +x: shadows lie beside their sheets. x and z to pixels.
  const auto through = [&](float x, float z) {
    return film.through.rgb(static_cast<int>((x + 1.5f) / 3.0f * kSize), static_cast<int>((z + 1.5f) / 3.0f * kSize)).x;
  };
  EXPECT_NEAR(through(-0.75f, 0.25f), 0.6f, 0.01f);
  EXPECT_NEAR(through(-0.75f, -0.25f), 0.36f, 0.02f);
  EXPECT_NEAR(through(1.2f, 0.25f), 1.0f, 1e-3f);
}

TEST_F(law_raster_ground, is_nothing_where_nothing_is_above) {
  const Scene scene = dark_box();
  const Film film = test::draw(scene, sky(), look_at({40, 3, 40}, {41, 0.5f, 41}, 0.3f), drawn());
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) EXPECT_EQ(film.through.rgb(x, y), vec3(1.0f));
  }
}

TEST_F(law_raster_ground, lies_before_the_environment) {
  const Scene scene = dark_box();
  const View view = look_at({0.4f, 1.5f, 4.5f}, {0, 0.8f, 0}, 0.6f);  // the horizon is in it
  const Film a = test::draw(scene, sky(), view, drawn(Background::environment));
  const Film b = shoot(scene, sky(), view, traced(Background::environment));
  EXPECT_TRUE(a.through.empty());
  double sum = 0.0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      EXPECT_EQ(a.beauty.at(x, y)[3], 1.0f);
      sum += static_cast<double>(glm::length(a.beauty.rgb(x, y) - b.beauty.rgb(x, y)));
    }
  }
  EXPECT_LT(sum / (kSize * kSize), 0.05);
}

TEST_F(law_raster_ground, mirrors_what_the_path_tracer_mirrors) {
  SceneBuilder b;
  b.add(box({-0.4f, 0.5f, -0.4f}, {0.1f, 1.1f, 0.3f}), unlit({0.2f, 0.9f, 0.4f}));
  b.add(box({0.1f, 0.5f, -0.4f}, {0.4f, 0.9f, 0.3f}), unlit({0.9f, 0.1f, 0.2f}));
  Scene scene = b.build();
  scene.ground = Ground{.height = 0.5f, .mirror = 0.5f};
  const View view = look_at({1.4f, 1.5f, 3.5f}, {0, 0.5f, 0}, 0.5f);
  const Film a = test::draw(scene, sky(), view, drawn()), c = shoot(scene, sky(), view, traced());
  double sum = 0.0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      sum += static_cast<double>(glm::length(a.beauty.rgb(x, y) - c.beauty.rgb(x, y)));
    }
  }
  EXPECT_LT(sum / (kSize * kSize), 0.02);
  expect_shadows_near(a, c, 0.15f);  // blocks with an edge of the mirror image in them
}

TEST_F(law_raster_ground, hides_what_is_below_it_as_in_the_path_tracer) {
  SceneBuilder b;
  b.add(box({-0.4f, -0.3f, -0.4f}, {0.4f, 1.1f, 0.3f}), unlit({0.2f, 0.9f, 0.4f}));
  Scene scene = b.build();
  scene.ground = Ground{.height = 0.5f};
  // From the side, and so near above the ground that it is before the near plane.
  for (const vec3 eye : {vec3(1.4f, 1.9f, 3.5f), vec3(0.5f, 0.53f, 2.0f), vec3(0.5f, -1.0f, 2.0f)}) {
    const View view = look_at(eye, {0, 0.4f, 0}, 0.5f);
    path::Settings few = traced();
    few.samples = 32;  // what is unlit has no noise
    const Film drawn_film = test::draw(scene, sky(), view, drawn()), traced_film = shoot(scene, sky(), view, few);
    double sum = 0.0;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        sum += static_cast<double>(glm::length(drawn_film.beauty.rgb(x, y) - traced_film.beauty.rgb(x, y)));
      }
    }
    EXPECT_LT(sum / (kSize * kSize), 0.02) << eye.y;
  }
}

TEST_F(law_raster_ground, light_that_comes_from_below_is_the_grounds) {
  const Environment over = raster::environment_over_ground(sky(), {.color = vec3(0.2f, 0.4f, 0.8f)});
  const vec3 expected = vec3(0.2f, 0.4f, 0.8f) / kPi * irradiance_from_above(sky());
  EXPECT_LT(glm::length(environment_radiance(over, glm::normalize(vec3(0.3f, -0.8f, 0.1f))) - expected), 1e-4f);
  const vec3 up = glm::normalize(vec3(0.3f, 0.8f, 0.1f));
  EXPECT_LT(glm::length(environment_radiance(over, up) - environment_radiance(sky(), up)), 1e-4f);
}

}  // namespace
}  // namespace candela
