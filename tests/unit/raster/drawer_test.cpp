#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/file.h"
#include "raster/render.h"
#include "unit/base/temp_folder.h"
#include "unit/gl/gl_fixture.h"
#include "unit/path/scenes.h"

namespace candela {
namespace {

using namespace test;

class unit_raster_drawer : public NeedsGl {};  // NOLINT(readability-identifier-naming): as its suite

SceneBuilder ball_of(vec3 color) {
  SceneBuilder b;
  b.add(sphere(vec3(0.0f), 1.0f, 3, false), matte(color));
  b.add_light(sunlight(vec3(1.0f), 3.0f), aimed({1, 2, 3}, vec3(0.0f)));
  return b;
}

Scene ball(vec3 color) { return ball_of(color).build(); }

/// With a pane of glass and a veil before it, for which there are pictures of their own.
Scene ball_behind_panes() {
  SceneBuilder b = ball_of(vec3(0.5f));
  Material glass = plastic(vec3(1.0f), 0.2f);
  glass.transmission = 1.0f;
  b.add(quad({0.2f, -1, 1.5f}, {1, 0, 0}, {0, 1, 0}), glass);
  Material veil = matte(vec3(0.5f));
  veil.alpha_mode = AlphaMode::blend;
  veil.opacity = 0.5f;
  b.add(quad({-1, -1, 1.2f}, {1, 0, 0}, {0, 1.5f, 0}), veil);
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
  bool is_uploaded = false;
  for (const int size : {16, 24, 16}) {
    for (const float x : {-1.0f, 2.0f}) {
      raster::Statistics statistics;
      const Film film = drawer.render(from(x), sized(size), {}, &statistics);
      EXPECT_TRUE(films_are_identical(film, raster::render(gray, sky, from(x), sized(size))));
      EXPECT_EQ(statistics.frames, 2);
      EXPECT_NE(statistics.upload_s > 0.0, std::exchange(is_uploaded, true)) << "uploaded once for all sizes";
      EXPECT_TRUE(films_are_identical(other.render(from(x), sized(8)), raster::render(red, sky, from(x), sized(8))));
    }
  }
}

TEST_F(unit_raster_drawer, frames_of_a_window_are_pictures_of_one_frame) {
  const Environment sky = constant_environment({0.3f, 0.4f, 0.6f});
  const Scene scene = ball_behind_panes();
  // Someone else's context, as a window's: the device opens none, and what is drawn is there.
  const auto context = gl::Context::open();
  raster::Drawer drawer(borrowed(scene), sky, shade::shading_model_candela(), raster::Device::of_current_context());
  EXPECT_THROW(drawer.read_frame(), Error);
  EXPECT_THROW(drawer.present({8, 8}, 1.0f, ToneCurve::linear), Error);
  for (const int size : {16, 24}) {
    for (const float x : {-1.0f, 2.0f}) {
      raster::Settings settings = sized(size);
      settings.frames = 1;
      drawer.draw_frame(from(x), settings);
      const Film frame = drawer.read_frame();
      EXPECT_TRUE(films_are_identical(frame, raster::render(scene, sky, from(x), settings)));
      ASSERT_TRUE(context->make_current());
    }
  }
}

TEST_F(unit_raster_drawer, frames_follow_the_scene_and_keep_the_last_one_after_a_mistake) {
  const Environment sky = constant_environment(vec3(0.5f));
  const Scene gray = ball(vec3(0.5f)), red = ball({0.8f, 0.1f, 0.1f});
  raster::Drawer drawer(borrowed(gray), sky);
  raster::Settings settings = sized(16);
  settings.frames = 1;
  drawer.draw_frame(from(0.0f), settings);
  const Film before = drawer.read_frame();
  drawer.set_scene(borrowed(red));
  raster::Settings wrong = settings;
  wrong.msaa = 0;
  EXPECT_THROW(drawer.draw_frame(from(0.0f), wrong), Error);
  EXPECT_TRUE(films_are_identical(drawer.read_frame(), before));
  drawer.draw_frame(from(0.0f), settings);
  EXPECT_TRUE(films_are_identical(drawer.read_frame(), raster::render(red, sky, from(0.0f), settings)));
}

TEST_F(unit_raster_drawer, shaders_are_read_again_when_it_is_asked_for) {
  namespace fs = std::filesystem;
  const TempFolder folder;
  const fs::path source(CANDELA_SOURCE_DIR);
  fs::copy(source / "src/raster/shaders", folder.path());
  fs::create_directory(folder / "shade");
  for (const auto& file : fs::directory_iterator(source / "src/shade")) {
    if (file.path().string().ends_with(".glsl.h")) fs::copy(file.path(), folder / "shade");
  }
  const Scene scene = ball(vec3(0.5f));
  raster::Drawer drawer(borrowed(scene), constant_environment(vec3(0.5f)));
  raster::Settings settings = sized(16);
  settings.frames = 1;
  settings.shader_folder = folder.path().string();
  drawer.draw_frame(from(0.0f), settings);
  const Film good = drawer.read_frame();
  const fs::path shader = folder / "background.frag.glsl";
  const auto text = read_file(shader);
  std::ofstream(shader, std::ios::app) << "mistake\n";
  drawer.draw_frame(from(0.0f), settings);  // not read yet
  drawer.reload_shaders();
  EXPECT_THROW(drawer.draw_frame(from(0.0f), settings), Error);
  write_file(shader, text);
  drawer.reload_shaders();
  drawer.draw_frame(from(0.0f), settings);
  EXPECT_TRUE(films_are_identical(drawer.read_frame(), good));
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
