#include <gtest/gtest.h>

#include <cmath>

#include "raster/render.h"
#include "scene/environment.h"
#include "unit/gl/gl_fixture.h"
#include "unit/path/scenes.h"

// Single passes: the background, and what of the light from far away a corner keeps out. Shadows, glass and scattered
// light are held against the path tracer in tests/laws/.

namespace candela {
namespace {

using namespace test;

class unit_raster_passes : public NeedsGl {};  // NOLINT(readability-identifier-naming): as its suite

constexpr int kSize = 64;

raster::Settings sized() {
  raster::Settings s;
  s.width = s.height = kSize;
  return s;
}

Scene nothing() {
  Scene scene;
  scene.materials.emplace_back();
  return scene;
}

/// The direction that the middle of a pixel is seen in.
vec3 direction_of(const View& view, int x, int y) {
  const float half = std::tan(0.5f * std::get<PerspectiveCamera>(view.projection).yfov);
  const vec2 at = (vec2(x, y) + 0.5f) / (0.5f * kSize) - 1.0f;
  return glm::normalize(mat3(view.world_from_camera) * vec3(at.x * half, -at.y * half, -1.0f));
}

TEST_F(unit_raster_passes, the_background_is_the_environment_in_every_direction) {
  Environment environment = mapped_environment(256, 128, [](vec3 d) { return 0.5f + 0.5f * d; });
  environment.rotation = 0.7f;
  environment.intensity = 2.0f;
  for (const vec3 target : {vec3(1, 0.2f, 0), vec3(-1, -0.8f, 0.3f), vec3(0.1f, 1, -0.2f)}) {
    const View view = look_at(vec3(0.0f), target, 1.2f);
    const Film film = raster::render(nothing(), environment, view, sized());
    for (const ivec2 at : {ivec2(0, 0), ivec2(63, 9), ivec2(32, 32), ivec2(7, 60)}) {
      // The map's own steps are a hundredth.
      const vec3 expected = environment_radiance(environment, direction_of(view, at.x, at.y));
      EXPECT_LT(glm::distance(film.beauty.rgb(at.x, at.y), expected), 0.04f) << at.x << ' ' << at.y;
    }
  }
}

TEST_F(unit_raster_passes, suns_are_discs_in_the_background) {
  Environment environment = dark_environment();
  SunDisc sun;
  sun.direction = glm::normalize(vec3(0.2f, 0.3f, -1));
  sun.radiance = {3, 2, 1};
  sun.angular_radius = 0.15f;
  environment.suns.push_back(sun);
  const View view = look_at(vec3(0.0f), {0, 0, -1}, 1.2f);
  raster::Settings settings = sized();
  settings.msaa = 1;
  const Film film = raster::render(nothing(), environment, view, settings);
  int lit = 0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const float angle = std::acos(std::min(glm::dot(direction_of(view, x, y), sun.direction), 1.0f));
      if (std::fabs(angle - sun.angular_radius) < 0.01f) continue;  // its rim
      EXPECT_EQ(film.beauty.rgb(x, y), angle < sun.angular_radius ? sun.radiance : vec3(0.0f)) << x << ' ' << y;
      lit += angle < sun.angular_radius ? 1 : 0;
    }
  }
  EXPECT_GT(lit, 20);
}

TEST_F(unit_raster_passes, light_from_far_away_is_kept_out_of_corners_alone) {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 4.0f), matte(vec3(0.5f)));
  b.add(quad({-4, 0, -1}, {8, 0, 0}, {0, 4, 0}), matte(vec3(0.5f)));  // a wall that looks along +z
  const Scene scene = b.build();
  View view = look_at({0, 6, 2}, {0, 0, 0.5f}, 0.6f);
  raster::Settings settings = sized();
  settings.quantity = raster::Quantity::diffuse;
  const auto floor_at = [&](float z) {
    const vec4 clip = vec4(transform_point(glm::inverse(view.world_from_camera), {0, 0, z}), 1.0f);
    const float y = clip.y / -clip.z / std::tan(0.3f);
    return static_cast<int>((0.5f - 0.5f * y) * kSize);
  };
  const Film open = raster::render(scene, constant_environment(vec3(1.0f)), view, settings);
  settings.occlusion_radius = 0.1f;  // of the diagonal: 1.2 m
  const Film occluded = raster::render(scene, constant_environment(vec3(1.0f)), view, settings);
  const auto ratio = [&](float z) {
    const int y = floor_at(z);
    return occluded.beauty.rgb(kSize / 2, y).x / open.beauty.rgb(kSize / 2, y).x;
  };
  EXPECT_LT(ratio(-0.85f), 0.9f) << "beside the wall";
  EXPECT_GT(ratio(-0.85f), 0.3f) << "half of the hemisphere stays open";
  EXPECT_NEAR(ratio(1.5f), 1.0f, 0.02f) << "far from it";
}

}  // namespace
}  // namespace candela
