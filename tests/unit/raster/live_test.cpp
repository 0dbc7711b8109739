#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "raster/render.h"
#include "raster/sketch.h"
#include "scene/environment.h"
#include "unit/gl/gl_fixture.h"
#include "unit/path/scenes.h"

namespace candela {
namespace {

using namespace test;

class unit_raster_live : public NeedsGl {};  // NOLINT(readability-identifier-naming): as its suite

Scene balls() {
  SceneBuilder b;
  b.add(sphere(vec3(-1, 0, 0), 0.9f, 3, false), matte(vec3(0.6f, 0.5f, 0.4f)));
  Material metal = plastic(vec3(0.9f), 0.4f);
  metal.metallic = 1.0f;
  b.add(sphere(vec3(1, 0, 0), 0.9f, 3, false), metal);
  Material cloth = matte(vec3(0.2f));
  cloth.sheen_color = vec3(0.8f);
  cloth.sheen_roughness = 0.5f;
  b.add(sphere(vec3(0, 1, 0), 0.6f, 3, false), cloth);
  return b.build();
}

/// Bright and red to one side, and a little sun.
Environment sky() {
  Image map(64, 32, 3);
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const float a = 2.0f * kPi * (static_cast<float>(x) + 0.5f) / 64.0f;
      map.set_rgb(x, y, vec3(1.0f + std::cos(a), 0.4f, 0.3f + 0.2f * std::sin(a)));
    }
  }
  Environment environment;
  environment.map = std::make_shared<const Image>(std::move(map));
  environment.suns.push_back(
      {.direction = glm::normalize(vec3(1, 1, 1)), .angular_radius = 0.05f, .radiance = vec3(50)});
  return environment;
}

raster::Settings sized(int size) {
  raster::Settings settings;
  settings.width = settings.height = size;
  settings.frames = 1;
  return settings;
}

View eye() { return look_at({0.5f, 0.7f, 5}, vec3(0.0f, 0.3f, 0.0f), 0.8f); }

/// The largest difference of two films, over the mean of the second.
double largest_difference(const Film& a, const Film& b) {
  double worst = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < a.beauty.pixels.size(); ++i) {
    worst = std::max(worst, static_cast<double>(std::abs(a.beauty.pixels[i] - b.beauty.pixels[i])));
    sum += static_cast<double>(b.beauty.pixels[i]);
  }
  return worst / (sum / static_cast<double>(b.beauty.pixels.size()));
}

TEST_F(unit_raster_live, an_environment_that_is_turned_lights_as_one_that_is_baked_so) {
  const Scene scene = balls();
  raster::Drawer drawer(borrowed(scene), sky());
  drawer.draw_frame(eye(), sized(48));
  const Film before = drawer.read_frame();
  Environment turned = sky();
  turned.rotation = 1.1f, turned.intensity = 2.5f;
  drawer.turn_environment(1.1f, 2.5f);
  drawer.draw_frame(eye(), sized(48));
  const Film film = drawer.read_frame();
  const Film wanted = raster::render(scene, turned, eye(), sized(48));
  EXPECT_LT(largest_difference(film, wanted), 0.04);  // texels of the baked cubes lie elsewhere
  EXPECT_GT(largest_difference(before, wanted), 0.5);
  drawer.turn_environment(0.0f, 1.0f);
  drawer.draw_frame(eye(), sized(48));
  EXPECT_TRUE(films_are_identical(drawer.read_frame(), before));
}

TEST_F(unit_raster_live, light_that_another_thread_has_baked_is_the_same) {
  const Scene scene = balls();
  const Film wanted = raster::render(scene, sky(), eye(), sized(32));
  raster::Drawer drawer(borrowed(scene), constant_environment(vec3(1.0f)));
  drawer.draw_frame(eye(), sized(32));
  drawer.set_environment(sky(), raster::bake_light_of(scene, sky(), {}));
  drawer.draw_frame(eye(), sized(32));
  EXPECT_TRUE(films_are_identical(drawer.read_frame(), wanted));
}

TEST_F(unit_raster_live, a_frame_in_bands_is_the_frame) {
  const Scene scene = balls();
  raster::Drawer drawer(borrowed(scene), sky());
  drawer.draw_frame(eye(), sized(33));
  const Film whole = drawer.read_frame();
  drawer.draw_frame(eye(), sized(33), {}, 5);
  EXPECT_TRUE(films_are_identical(drawer.read_frame(), whole));
}

TEST_F(unit_raster_live, a_stop_ends_a_long_frame_and_the_next_is_whole) {
  const Scene scene = balls();
  raster::Drawer drawer(borrowed(scene), sky());
  drawer.draw_frame(eye(), sized(33));
  const Film whole = drawer.read_frame();
  std::atomic<bool> stop = true;
  EXPECT_THROW(drawer.draw_frame(eye(), sized(33), {.stop = &stop}, 5), Interrupted);
  drawer.draw_frame(eye(), sized(33));
  EXPECT_TRUE(films_are_identical(drawer.read_frame(), whole));
}

TEST_F(unit_raster_live, baking_for_another_thread_can_be_stopped) {
  std::atomic<bool> stop = true;
  const StopScope scope(&stop);
  EXPECT_THROW(raster::bake_light_of(balls(), sky(), {}), Interrupted);
}

TEST_F(unit_raster_live, what_is_shown_is_the_developed_frame) {
  const Scene scene = balls();
  raster::Drawer drawer(borrowed(scene), sky());
  drawer.draw_frame(eye(), sized(32));
  DevelopSettings settings;
  settings.exposure = 0.7f;
  settings.dither = false;
  const DisplayImage wanted = develop(drawer.read_frame(), settings);
  const DisplayImage shown = drawer.read_shown(0.7f, settings.tone_curve);
  ASSERT_EQ(shown.rgba.size(), wanted.rgba.size());
  for (std::size_t i = 0; i < shown.rgba.size(); ++i) EXPECT_NEAR(shown.rgba[i], wanted.rgba[i], 1) << i;
}

TEST_F(unit_raster_live, what_is_at_a_pixel_is_what_is_drawn_there) {
  const Scene scene = balls();
  raster::Drawer drawer(borrowed(scene), sky());
  drawer.draw_frame(eye(), sized(64));
  const SurfaceMap map = drawer.read_surfaces(eye());
  EXPECT_EQ(map.at(0, 0).node, -1);
  // The ball at the left is the first node.
  EXPECT_EQ(map.at(18, 34).node, 0);
  EXPECT_NEAR(glm::distance(map.at(18, 34).position, vec3(-1, 0, 0)), 0.9f, 0.03f);
}

TEST_F(unit_raster_live, a_sketch_shows_what_the_frame_covers) {
  Scene scene = balls();
  raster::Sketch sketch(scene, std::make_shared<raster::Device>());
  const DisplayImage image = sketch.draw(eye(), {64, 64});
  raster::Settings settings = sized(64);
  settings.background = Background::transparent;
  settings.msaa = 1;
  const Film film = raster::render(scene, sky(), eye(), settings);
  const auto background = std::array{image.rgba[0], image.rgba[1], image.rgba[2]};
  int different = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const bool is_covered = std::array{image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]} != background;
    different += is_covered != (film.beauty.pixels[i + 3] > 0.5f) ? 1 : 0;
  }
  EXPECT_LE(different, 8);
}

}  // namespace
}  // namespace candela
