#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "base/error.h"
#include "raster/render.h"
#include "unit/gl/gl_fixture.h"
#include "unit/path/scenes.h"

namespace candela {
namespace {

using namespace test;

class unit_raster_drawer : public NeedsGl {};  // NOLINT(readability-identifier-naming): as its suite

Scene ball(vec3 color) {
  SceneBuilder b;
  b.add(sphere(vec3(0.0f), 1.0f, 3, false), matte(color));
  b.add_light(sunlight(vec3(1.0f), 3.0f), aimed({1, 2, 3}, vec3(0.0f)));
  return b.build();
}

View from(float x) { return look_at({x, 0.5f, 4}, vec3(0.0f), 0.8f); }

raster::Settings sized(int size) {
  raster::Settings settings;
  settings.width = settings.height = size;
  settings.frames = 2;
  return settings;
}

TEST_F(unit_raster_drawer, one_drawer_makes_the_pictures_of_many) {
  const Environment sky = constant_environment({0.3f, 0.4f, 0.6f});
  const Scene gray = ball(vec3(0.5f)), red = ball({0.8f, 0.1f, 0.1f});
  const auto device = std::make_shared<raster::Device>();
  raster::Drawer drawer(borrowed(gray), sky, shade::shading_model_candela(), device);
  raster::Drawer other(borrowed(red), sky, shade::shading_model_candela(), device);
  // Other views, sizes and scenes between: nothing of them stays.
  for (const int size : {16, 24, 16}) {
    for (const float x : {-1.0f, 2.0f}) {
      raster::Statistics statistics;
      const Film film = drawer.render(from(x), sized(size), {}, &statistics);
      EXPECT_TRUE(films_are_identical(film, raster::render(gray, sky, from(x), sized(size))));
      EXPECT_EQ(statistics.frames, 2);
      EXPECT_EQ(statistics.upload_s > 0.0, x < 0.0f) << "uploaded once per size";
      EXPECT_TRUE(films_are_identical(other.render(from(x), sized(8)), raster::render(red, sky, from(x), sized(8))));
    }
  }
}

TEST_F(unit_raster_drawer, wrong_settings_and_scenes_are_refused) {
  const auto refuses = [](const std::function<void(raster::Settings&, Scene&, View&)>& change) {
    raster::Settings s = sized(8);
    Scene scene = ball(vec3(0.5f));
    View view = from(0.0f);
    change(s, scene, view);
    try {
      raster::render(scene, constant_environment(vec3(1.0f)), view, s);
    } catch (const Error&) {
      return true;
    }
    return false;
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(refuses([](auto& s, auto&, auto&) { s.frames = 0; }));
  EXPECT_TRUE(refuses([](auto& s, auto&, auto&) { s.width = 0; }));
  EXPECT_TRUE(refuses([](auto& s, auto&, auto&) { s.height = -1; }));
  EXPECT_TRUE(refuses([](auto& s, auto&, auto&) { s.msaa = 0; }));
  EXPECT_TRUE(refuses([](auto& s, auto&, auto&) { s.occlusion_radius = kNan; }));
  EXPECT_TRUE(refuses([](auto& s, auto&, auto&) { s.light_radius = -1.0f; }));
  EXPECT_TRUE(refuses([](auto& s, auto&, auto&) { s.most_textures = -1; }));
  EXPECT_TRUE(refuses([](auto& s, auto&, auto&) { s.shown_light = -1; }));
  EXPECT_TRUE(refuses([](auto&, Scene& scene, auto&) { scene.nodes[0].mesh = 7; }));
  EXPECT_TRUE(refuses([](auto&, Scene& scene, auto&) { scene.meshes[0].primitives[0].material = 7; }));
  EXPECT_TRUE(refuses([](auto&, auto&, View& view) { view.world_from_camera[3][0] = kNan; }));
  EXPECT_FALSE(refuses([](auto&, auto&, auto&) {}));
}

}  // namespace
}  // namespace candela
