#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "scene/environment.h"
#include "unit/path/scenes.h"

// The ground shows what is behind it, times what the scene leaves of its light.

namespace candela {
namespace {

using namespace test;

constexpr vec3 kColor(0.6f, 0.4f, 0.2f);

Environment sky_with_patch() {
  const vec3 towards = glm::normalize(vec3(1.0f, 0.9f, 0.4f));
  Environment sky = mapped_environment(64, 32, [&](vec3 d) {
    return vec3(0.4f, 0.5f, 0.7f) * (1.2f + d.y) + (glm::dot(d, towards) > 0.95f ? vec3(12, 10, 8) : vec3(0.0f));
  });
  sky.rotation = 0.4f;
  return sky;
}

/// Standing on y = 0.
SceneBuilder subject() {
  SceneBuilder b;
  b.add(box({-0.5f, 0, -0.5f}, {0.2f, 0.8f, 0.2f}), matte({0.8f, 0.2f, 0.2f}));
  b.add(sphere({0.6f, 0.4f, 0.3f}, 0.4f, 4, true), plastic({0.2f, 0.7f, 0.3f}, 0.5f));
  return b;
}

Scene with_ground(Scene scene, Ground ground = {.color = kColor}) {
  scene.ground = ground;
  return scene;
}

path::Settings transparent(int size, int samples) {
  path::Settings s = settings(size, samples, 4);
  s.background = Background::transparent;
  return s;
}

/// What an evenly lit ground shows.
vec3 bare(const Environment& environment) { return kColor / kPi * irradiance_from_above(environment); }

/// A film before a background.
Image before(const Film& film, vec3 background) {
  Image picture = film.beauty;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      picture.set_rgb(x, y, picture.rgb(x, y) + film.through.rgb(x, y) * background);
      picture.at(x, y)[3] = 1.0f;
    }
  }
  return picture;
}

void expect_near_in_blocks(const Image& a, const Image& b, double relative) {
  constexpr int kBlock = 8;
  for (int y = 0; y < a.height; y += kBlock) {
    for (int x = 0; x < a.width; x += kBlock) {
      const Region region{x, y, x + kBlock, y + kBlock};
      const dvec3 in_a = mean_of(a, region), in_b = mean_of(b, region);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(in_a[c], in_b[c], relative * in_b[c]) << x << ' ' << y << ' ' << c;
    }
  }
}

TEST(law_path_ground, before_a_picture_of_itself_it_is_the_ground_that_reflects) {
  const Environment sky = sky_with_patch();
  SceneBuilder with_plane = subject();
  with_plane.add(plane(vec3(0.0f), 500.0f), matte(kColor));
  const View view = from_above(4.0f, 1.6f);
  const Film real = shoot(with_plane.build(), sky, view, settings(32, 1024, 4));
  const Film shown = shoot(with_ground(subject().build()), sky, view, transparent(32, 1024));
  expect_near_in_blocks(before(shown, bare(sky)), real.beauty, 0.02);
}

TEST(law_path_ground, keeps_away_the_light_of_punctual_lamps) {
  const auto lit = [](SceneBuilder b) {
    b.add_light(point_light(vec3(1.0f), 20.0f), translation({1.0f, 2.5f, 0.5f}));
    return b;
  };
  SceneBuilder with_plane = lit(subject());
  with_plane.add(plane(vec3(0.0f), 500.0f), matte(kColor));
  SceneBuilder bare_plane = lit(SceneBuilder());
  bare_plane.add(plane(vec3(0.0f), 500.0f), matte(kColor));
  const View view = from_above(4.0f, 1.6f);
  const Film real = shoot(with_plane.build(), dark_environment(), view, settings(32, 256, 4));
  const Film empty = shoot(bare_plane.build(), dark_environment(), view, settings(32, 256, 4));
  const Film shown = shoot(with_ground(lit(subject()).build()), dark_environment(), view, transparent(32, 256));
  Image picture = shown.beauty;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      picture.set_rgb(x, y, picture.rgb(x, y) + shown.through.rgb(x, y) * empty.beauty.rgb(x, y));
    }
  }
  expect_near_in_blocks(picture, real.beauty, 0.03);
}

TEST(law_path_ground, is_not_there_where_the_scene_changes_nothing) {
  SceneBuilder far_away;
  far_away.add(box({900, 0, 900}, {900.001f, 0.001f, 900.001f}), matte(vec3(0.5f)));
  const Film film = shoot(with_ground(far_away.build()), sky_with_patch(), from_above(4.0f, 1.0f), transparent(8, 4));
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      EXPECT_EQ(film.through.rgb(x, y), vec3(1.0f));
      EXPECT_EQ(film.beauty.rgb(x, y), vec3(0.0f));
      EXPECT_EQ(film.beauty.at(x, y)[3], 0.0f);
    }
  }
}

TEST(law_path_ground, shows_the_environment_where_no_other_background_is_asked_for) {
  const Environment sky = constant_environment({0.3f, 0.6f, 0.9f});
  const Scene scene = with_ground(subject().build());
  const View view = from_above(4.0f, 1.6f);
  const Film seen = shoot(scene, sky, view, settings(16, 256, 4));
  const Film open = shoot(scene, sky, view, transparent(16, 256));
  EXPECT_TRUE(seen.through.empty());
  for (std::size_t i = 3; i < seen.beauty.pixels.size(); i += 4) EXPECT_EQ(seen.beauty.pixels[i], 1.0f);
  EXPECT_LT(largest_difference(before(open, sky.constant), seen.beauty), 1e-4);
}

TEST(law_path_ground, is_in_no_layer_and_has_no_back) {
  path::Settings s = transparent(16, 4);
  s.layers = {Layer::depth, Layer::object_id, Layer::normal, Layer::albedo};
  const Scene scene = with_ground(subject().build());
  const Scene without = subject().build();
  const Environment sky = constant_environment(vec3(1.0f));
  const View above = from_above(4.0f, 1.6f);
  for (const View& view : {above, look_at({0.1f, -3, 0.2f}, vec3(0.0f), 0.6f)}) {
    const Film film = shoot(scene, sky, view, s), expected = shoot(without, sky, view, s);
    for (const Layer layer : s.layers) {
      EXPECT_EQ(film.layers.at(layer).pixels, expected.layers.at(layer).pixels) << layer_name(layer);
    }
  }
  const Film below = shoot(scene, sky, look_at({0.1f, -3, 0.2f}, {0, 0, 0}, 0.6f), s);
  EXPECT_NEAR(below.beauty.at(0, 0)[3], 0.0f, 1e-6f);
  EXPECT_EQ(below.through.rgb(0, 0), vec3(1.0f));
}

TEST(law_path_ground, mirrors_as_much_as_it_says) {
  SceneBuilder b;
  b.add(turned_inside_out(plane({0, 1, 0}, 2.0f)), unlit({0.2f, 0.5f, 0.8f}));
  const View view = look_at({0, 0.5f, 0}, {0, 0, 0.01f}, 0.3f);
  const Film film =
      shoot(with_ground(b.build(), {.mirror = 0.25f}), constant_environment(vec3(1.0f)), view, transparent(16, 1024));
  const dvec3 light = mean_of(film.beauty);
  EXPECT_NEAR(light.x, 0.25 * 0.2, 0.005);
  EXPECT_NEAR(light.z, 0.25 * 0.8, 0.01);
  // A polished ground with nothing to mirror is as it was.
  const Film nothing = shoot(with_ground(subject().build(), {.mirror = 1.0f}), constant_environment(vec3(1.0f)),
                             look_at({50, 1, 0}, {50, 0, 0.01f}, 0.3f), transparent(4, 4));
  EXPECT_EQ(nothing.through.rgb(2, 2), vec3(1.0f));
}

TEST(law_path_ground, has_a_mean_that_all_its_integrators_share) {
  SceneBuilder b = subject();
  Material glass;
  glass.metallic = 0.0f;
  glass.roughness = 0.0f;
  glass.transmission = 1.0f;
  glass.thickness = 1.0f;
  b.add(sphere({-0.3f, 0.5f, 0.9f}, 0.4f, 4, false), glass);
  const Scene scene = with_ground(b.build(), {.color = kColor, .mirror = 0.3f});
  Environment sky = constant_environment({0.5f, 0.7f, 1.0f});
  path::Settings full = transparent(16, 512), minimal = transparent(16, 2048);
  minimal.integrator = path::Integrator::minimal;
  const View view = look_at({1, 2, 4}, {0, 0.2f, 0}, 0.5f);
  const Film a = shoot(scene, sky, view, full), c = shoot(scene, sky, view, minimal);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(mean_of(a.beauty)[k], mean_of(c.beauty)[k], 0.01 * mean_of(c.beauty)[k]);
    EXPECT_NEAR(mean_of(a.through)[k], mean_of(c.through)[k], 0.005);
  }
  path::Settings surfaces = transparent(4, 1);
  surfaces.integrator = path::Integrator::surfaces;
  EXPECT_THROW(shoot(with_ground(subject().build()), sky, view, surfaces), Error);
}

TEST(law_path_ground, sends_light_back_into_the_scene) {
  SceneBuilder b;
  b.add(turned_inside_out(plane({0, 1, 0}, 0.5f)), matte(vec3(1.0f)));
  // From below the sheet, which only the ground lights.
  const View view = look_at({0, 0.3f, 0}, {0, 1, 0.01f}, 0.3f);
  const Environment sky = mapped_environment(32, 16, [](vec3 d) { return vec3(d.y > 0.0f ? 1.0f : 0.0f); });
  const auto seen = [&](vec3 color) {
    return mean_of(shoot(with_ground(b.build(), {.color = color}), sky, view, transparent(8, 256)).beauty);
  };
  EXPECT_NEAR(seen(vec3(0.0f)).x, 0.0, 2e-3);
  const dvec3 lit = seen(vec3(0.2f, 0.4f, 0.8f));
  EXPECT_GT(lit.x, 0.02);
  EXPECT_GT(lit.z, 2.0 * lit.x);
}

}  // namespace
}  // namespace candela
