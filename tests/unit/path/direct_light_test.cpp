#include "path/direct_light.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "unit/path/scenes.h"

// Light that comes straight from its source, by the kind of source, and as if nothing were in its way.

namespace candela {
namespace {

using namespace test;

path::DirectLight trace(const Scene& scene, const Environment& environment, const View& view,
                        const path::Settings& settings) {
  return path::trace_direct_light(path::Tracer(borrowed(scene), environment), view, settings);
}

/// Brighter towards +x, with a sun where it is asked for.
Environment uneven_environment(bool has_sun) {
  Environment environment = mapped_environment(
      32, 16, [](vec3 d) { return vec3(0.6f, 0.5f, 0.4f) * (1.2f + d.x) * (d.x > 0.8f ? 6.0f : 1.0f); });
  if (has_sun) {
    environment.suns.push_back(
        {.direction = glm::normalize(vec3(1, 2, 0.5f)), .angular_radius = 0.05f, .radiance = vec3(200.0f)});
  }
  return environment;
}

/// A ground with a metal ball and a box that shades it, under a lamp and a glowing quad.
SceneBuilder still_life() {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 4.0f), matte({0.7f, 0.5f, 0.3f}));
  b.add(sphere({-0.6f, 0.5f, 0}, 0.5f, 4, false), metal({0.9f, 0.8f, 0.6f}, 0.3f));
  b.add(box({0.3f, 0, -0.6f}, {0.9f, 1.2f, 0.2f}), plastic({0.2f, 0.3f, 0.6f}, 0.4f));
  b.add_light(point_light(vec3(1.0f), 5.0f), translation({1.5f, 2, 1}));
  b.add(quad({-1, 2, -1}, {0.8f, 0, 0}, {0, 0, 0.8f}), lamp(vec3(4.0f)));
  return b;
}

TEST(unit_path_direct_light, parts_add_up_to_the_picture_of_one_bounce) {
  const Scene scene = still_life().build();
  const Environment environment = uneven_environment(true);
  const View view = look_at({1.5f, 2.5f, 3.5f}, {0, 0.4f, 0}, 0.7f);
  path::Settings s = settings(24, 1024, 1);
  const Image picture = shoot(scene, environment, view, s).beauty;
  s.seed = 1;
  const path::DirectLight light = trace(scene, environment, view, s);
  for (int y = 0; y < 24; y += 8) {
    for (int x = 0; x < 24; x += 8) {
      dvec3 sum(0.0);
      for (int j = y; j < y + 8; ++j) {
        for (int i = x; i < x + 8; ++i) sum += dvec3(light.seen.rgb(i, j) + light.arriving(i, j)) / 64.0;
      }
      const dvec3 whole = mean_of(picture, {x, y, x + 8, y + 8});
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], whole[c], 0.015 * whole[c] + 0.002) << x << ' ' << y << ' ' << c;
    }
  }
}

TEST(unit_path_direct_light, each_source_has_its_part) {
  const View view = from_above(2.0f, 0.5f);
  const path::Settings s = settings(8, 64, 8);
  const auto means = [&](const Scene& scene, const Environment& environment) {
    const path::DirectLight light = trace(scene, environment, view, s);
    return vec3(mean_luminance(light.far.arriving), mean_luminance(light.lamps.arriving),
                mean_luminance(light.areas.arriving));
  };
  SceneBuilder ground;
  ground.add(plane(vec3(0.0f), 1.0f), matte(vec3(0.5f)));
  const vec3 far = means(ground.build(), constant_environment(vec3(2.0f)));
  EXPECT_NEAR(far.x, 1.0f, 0.01f);
  EXPECT_EQ(vec2(far.y, far.z), vec2(0.0f));

  SceneBuilder sunny = ground;
  sunny.add_light(sunlight(vec3(1.0f), kPi), aimed({0, 1, 0}, vec3(0.0f)));
  const vec3 lamp_alone = means(sunny.build(), dark_environment());
  EXPECT_NEAR(lamp_alone.y, 0.5f, 0.001f);
  EXPECT_EQ(vec2(lamp_alone.x, lamp_alone.z), vec2(0.0f));

  Environment sun = dark_environment();
  sun.suns.push_back({.direction = {0, 1, 0}, .angular_radius = 0.05f, .radiance = vec3(400.0f)});
  const vec3 by_sun = means(ground.build(), sun);
  EXPECT_NEAR(by_sun.y, 0.5f * 400.0f * 0.05f * 0.05f, 0.01f);
  EXPECT_EQ(vec2(by_sun.x, by_sun.z), vec2(0.0f));

  SceneBuilder glowing = ground;
  glowing.add(turned_inside_out(plane({0, 0.2f, 40}, 39.0f)), lamp(vec3(1.0f)));  // out of the view, looking down
  const vec3 by_area = means(glowing.build(), dark_environment());
  EXPECT_GT(by_area.z, 0.0f);
  EXPECT_EQ(vec2(by_area.x, by_area.y), vec2(0.0f));
}

TEST(unit_path_direct_light, what_nothing_hinders_arrives) {
  SceneBuilder b;
  b.add(sphere(vec3(0.0f), 1.0f, 5, false), plastic(vec3(0.6f), 0.3f));
  b.add_light(point_light(vec3(1.0f), 5.0f), translation({2, 2, 2}));
  const path::DirectLight light =
      trace(b.build(), uneven_environment(true), look_at({0, 0, 4}, vec3(0.0f), 0.7f), settings(16, 32, 8));
  EXPECT_EQ(largest_difference(light.far.arriving, light.far.unhindered), 0.0);
  EXPECT_EQ(largest_difference(light.lamps.arriving, light.lamps.unhindered), 0.0);
}

TEST(unit_path_direct_light, unhindered_light_passes_walls) {
  // Within a closed box nothing arrives from outside of it.
  SceneBuilder b;
  b.add(turned_inside_out(box(vec3(-1.0f), vec3(1.0f))), matte(vec3(0.5f)));
  b.add_light(sunlight(vec3(1.0f), kPi), aimed({0, 3, 0}, vec3(0.0f)));
  const path::DirectLight light =
      trace(b.build(), constant_environment(vec3(2.0f)), from_above(0.5f, 0.5f), settings(8, 64, 8));
  EXPECT_EQ(mean_luminance(light.far.arriving), 0.0);
  EXPECT_EQ(mean_luminance(light.lamps.arriving), 0.0);
  EXPECT_NEAR(mean_luminance(light.far.unhindered), 1.0, 0.01);
  EXPECT_NEAR(mean_luminance(light.lamps.unhindered), 0.5, 0.001);
}

TEST(unit_path_direct_light, glowing_surfaces_behind_others_are_unhindered) {
  // Rough metal meets the lamp by its own samples too, through the sheet.
  const auto areas = [](bool has_sheet, bool is_open) {
    SceneBuilder b;
    b.add(plane(vec3(0.0f), 1.0f), metal(vec3(0.9f), 0.35f));
    b.add(turned_inside_out(plane({0, 6, 0}, 1.0f)), lamp(vec3(3.0f)));
    if (has_sheet) b.add(plane({0, 4, 0}, 3.0f), matte(vec3(0.5f)));
    const path::DirectLight light = trace(b.build(), dark_environment(), from_above(2.0f, 0.4f), settings(8, 256, 8));
    return mean_luminance(is_open ? light.areas.unhindered : light.areas.arriving);
  };
  const double bare = areas(false, false);
  EXPECT_GT(bare, 0.1);
  EXPECT_EQ(areas(true, false), 0.0);
  EXPECT_NEAR(areas(true, true), bare, 0.02 * bare);
}

TEST(unit_path_direct_light, a_stop_and_settings_that_no_picture_has_are_told) {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 1.0f), matte(vec3(0.5f)));
  const Scene scene = b.build();
  EXPECT_THROW(trace(scene, dark_environment(), from_above(2.0f, 0.4f), settings(0, 4, 1)), Error);
  const std::atomic<bool> stop{true};
  const path::Tracer tracer(borrowed(scene), dark_environment());
  EXPECT_THROW(path::trace_direct_light(tracer, from_above(2.0f, 0.4f), settings(8, 4, 1), {.stop = &stop}),
               Interrupted);
}

}  // namespace
}  // namespace candela
