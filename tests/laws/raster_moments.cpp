#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "laws/raster_draw.h"
#include "raster/render.h"
#include "unit/gl/gl_fixture.h"
#include "unit/path/scenes.h"

// What moves in a scene, materials and lights as well as nodes, looks at every moment as if nothing ever moved.

namespace candela {
namespace {

using namespace test;

class law_raster_moments : public NeedsGl {};  // NOLINT(readability-identifier-naming): a suite is named as its laws

constexpr int kSize = 48;

raster::Settings drawn(int frames) {
  raster::Settings s;
  s.width = s.height = kSize;
  s.msaa = 1;
  s.frames = frames;
  return s;
}

/// A ball with a textured base colour before a wall, under a lamp and a sky.
Scene scene_of(const std::function<void(Scene&)>& change) {
  SceneBuilder b;
  Material m = plastic({0.8f, 0.5f, 0.3f}, 0.4f);
  m.alpha_mode = AlphaMode::blend;
  m.base_color_texture = slot(b.add_texture(2, 1, {255, 255, 255, 255, 60, 120, 255, 255}));
  b.add_texture(1, 1, {30, 220, 60, 128});
  b.add(sphere(vec3(0.0f), 1.0f, 3, false), m);
  b.add(quad({-3, -3, -2}, {6, 0, 0}, {0, 6, 0}), matte({0.2f, 0.7f, 0.3f}));
  b.add_light(spot_light(vec3(1.0f), 40.0f, 0.2f, 0.5f), aimed({2, 3, 4}, vec3(0.0f)));
  Scene scene = b.build();
  change(scene);
  return scene;
}

struct Change {
  const char* name;
  std::function<void(Scene&)> apply;
};

std::vector<Change> changes() {
  const auto of_ball = [](auto change) { return [change](Scene& s) { change(s.materials[0]); }; };
  return {
      {"colour", of_ball([](Material& m) {
         m.base_color = {0.1f, 0.2f, 0.9f};
       })},
      {"opacity", of_ball([](Material& m) { m.opacity = 0.5f; })},
      {"transmission", of_ball([](Material& m) { m.transmission = 1.0f, m.opacity = 1.0f; })},
      {"a body that scatters", of_ball([](Material& m) {
         m.transmission = 1.0f, m.thickness = 1.0f, m.attenuation_distance = 0.2f;
         m.attenuation_color = vec3(0.5f), m.multiscatter_color = vec3(0.8f);
       })},
      {"sheen", of_ball([](Material& m) { m.sheen_color = vec3(0.9f), m.sheen_roughness = 0.5f; })},
      {"coat", of_ball([](Material& m) { m.clearcoat = 1.0f; })},
      {"film", of_ball([](Material& m) { m.iridescence = 1.0f; })},
      {"glow", of_ball([](Material& m) { m.emission = vec3(3.0f, 1.0f, 0.5f); })},
      {"where a texture lies", of_ball([](Material& m) { m.base_color_texture.transform[2] = vec2(0.25f, 0.0f); })},
      {"light",
       [](Scene& s) {
         s.lights[0].intensity = 10.0f, s.lights[0].color = {1.0f, 0.2f, 0.2f};
       }},
      {"another texture", of_ball([](Material& m) { m.base_color_texture.texture = 1; })},
      {"another image", [](Scene& s) { s.textures[0].image = 1; }},
      {"a filter", [](Scene& s) { s.textures[0].filter = Filter::nearest; }},
      {"what is masked", of_ball([](Material& m) {
         m.alpha_mode = AlphaMode::mask, m.alpha_cutoff = 0.6f, m.base_color_texture.texture = 1;
       })},
      {"a mirror",
       [](Scene& s) {
         s.nodes[0].world_from_node = scaling({-1, 0.6f, 1});
       }},
      {"something hidden", [](Scene& s) { s.nodes[0].mesh = -1; }},
      {"a node's colour", [](Scene& s) { s.nodes[1].color = vec4(0.2f, 0.9f, 1.0f, 1.0f); }},
      {"cone", [](Scene& s) { s.lights[0].outer_cone = 0.25f; }},
  };
}

/// The second of two pictures of one run: of a scene that was another at the first.
Film after(const Scene& first, const Scene& second, const Environment& sky, const View& view,
           const raster::Settings& settings) {
  raster::Drawer drawer(borrowed(first), sky);
  drawer.render(view, settings);
  drawer.set_scene(borrowed(second));
  return drawer.render(view, settings);
}

TEST_F(law_raster_moments, a_moment_looks_as_the_scene_that_it_is) {
  const Environment sky = constant_environment(vec3(0.4f, 0.5f, 0.6f));
  const View view = look_at({0, 0, 5}, vec3(0.0f), 0.8f);
  const raster::Settings settings = drawn(1);
  const Scene rest = scene_of([](Scene&) {});
  const Film still = draw(rest, sky, view, settings);
  for (const Change& change : changes()) {
    const Scene moment = scene_of(change.apply);
    const Film expected = draw(moment, sky, view, settings);
    EXPECT_GT(largest_difference(expected.beauty, still.beauty), 0.02) << change.name << " changes the picture";
    EXPECT_LT(largest_difference(after(rest, moment, sky, view, settings).beauty, expected.beauty), 1e-3)
        << change.name << " comes";
    EXPECT_LT(largest_difference(after(moment, rest, sky, view, settings).beauty, still.beauty), 1e-3)
        << change.name << " goes";
  }
}

TEST_F(law_raster_moments, blur_of_what_fades_is_the_mean_of_its_moments) {
  const Environment sky = constant_environment(vec3(0.4f));
  const View view = look_at({0, 0, 5}, vec3(0.0f), 0.8f);
  raster::Settings settings = drawn(2);
  settings.background = Background::transparent;
  const Scene rest = scene_of([](Scene&) {});
  for (const Change& change : changes()) {
    const Scene moment = scene_of(change.apply);
    const auto film_of = [&](const Scene& a, const Scene& b) {
      raster::Drawer drawer(borrowed(a), sky);
      return drawer.render([&](int frame) { return raster::Moment{borrowed(frame == 0 ? a : b), view}; }, settings);
    };
    // Each scene twice as the first and as the second half: together both halves of both.
    const Image forth = film_of(rest, moment).beauty, back = film_of(moment, rest).beauty;
    const Image one = film_of(rest, rest).beauty, other = film_of(moment, moment).beauty;
    double worst = 0.0;
    for (std::size_t i = 0; i < forth.pixels.size(); ++i) {
      const float sum = forth.pixels[i] + back.pixels[i] - one.pixels[i] - other.pixels[i];
      worst = std::max(worst, static_cast<double>(std::fabs(sum)));
    }
    EXPECT_LT(worst, 4e-3) << change.name;
  }
}

}  // namespace
}  // namespace candela
