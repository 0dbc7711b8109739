#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "unit/path/scenes.h"

// The integrator with all its strategies has the mean of the one that only follows the material.

namespace candela {
namespace {

using namespace test;

struct Case {
  std::string name;
  Scene scene;
  Environment environment = dark_environment();
  View view;
  int full_samples = 64;
  int minimal_samples = 64;
};

Case room_with_lamp() {
  SceneBuilder b;
  b.add(turned_inside_out(box({-1, 0, -1}, {1, 2, 1})), matte({0.7f, 0.5f, 0.3f}));
  b.add(quad({-0.4f, 1.95f, -0.4f}, {0.8f, 0, 0}, {0, 0, 0.8f}), lamp({8, 7, 6}));
  b.add(box({-0.5f, 0, -0.5f}, {0.1f, 0.6f, 0.1f}), plastic({0.2f, 0.6f, 0.8f}, 0.4f));
  return {
      "room with an area light", b.build(), dark_environment(), look_at({0, 1, 0.95f}, {0, 0.8f, -1}, 1.2f), 32, 128};
}

Case metal_under_map() {
  SceneBuilder b;
  b.add(sphere(vec3(0.0f), 1.0f, 4, true), metal({0.9f, 0.7f, 0.4f}, 0.35f));
  b.add(plane({0, -1, 0}, 4.0f), plastic(vec3(0.5f), 0.3f));
  Case c{"glossy metal under a map with a small bright patch",
         b.build(),
         {},
         look_at({2, 1.5f, 3}, vec3(0.0f), 0.7f),
         64,
         512};
  const vec3 sun = glm::normalize(vec3(1.0f, 1.2f, 0.6f));
  c.environment = mapped_environment(64, 32, [&](vec3 d) {
    return vec3(0.3f, 0.4f, 0.6f) * (1.0f + d.y) + (glm::dot(d, sun) > 0.97f ? vec3(20, 18, 15) : vec3(0.0f));
  });
  c.environment.rotation = 0.7f;
  return c;
}

Case textured_lamp() {
  SceneBuilder b;
  std::vector<std::uint8_t> rgba;
  for (int i = 0; i < 16; ++i) {
    const auto v = static_cast<std::uint8_t>(i % 5 == 0 ? 255 : 8 * i);
    rgba.insert(rgba.end(), {v, static_cast<std::uint8_t>(255 - v), 128, 255});
  }
  Material m = lamp({6, 6, 6});
  m.emissive_texture = slot(b.add_texture(4, 4, rgba, Filter::nearest));
  m.emissive_texture.transform = {vec2(2, 0), vec2(0, 1), vec2(0.1f, 0.2f)};
  m.double_sided = true;
  b.add(quad({-1, 0, -1}, {2, 0, 0}, {0, 2, 0}), m);
  b.add(plane(vec3(0.0f), 3.0f), matte(vec3(0.8f)));
  return {"textured emission", b.build(), dark_environment(), look_at({1.5f, 1.5f, 3}, {0, 0.3f, 0}, 0.8f), 64, 128};
}

Case alpha() {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 3.0f), matte({0.8f, 0.7f, 0.6f}));
  Material blend = matte({0.9f, 0.2f, 0.1f});
  blend.alpha_mode = AlphaMode::blend;
  blend.opacity = 0.4f;
  blend.double_sided = true;
  b.add(quad({-1, 0.7f, -1}, {0, 0, 2}, {2, 0, 0}), blend);
  std::vector<std::uint8_t> checker;
  for (int i = 0; i < 16; ++i) {
    checker.insert(checker.end(), {200, 220, 90, static_cast<std::uint8_t>((i + i / 4) % 2 == 0 ? 255 : 0)});
  }
  Material mask = matte(vec3(1.0f));
  mask.alpha_mode = AlphaMode::mask;
  mask.base_color_texture = slot(b.add_texture(4, 4, checker, Filter::nearest));
  mask.double_sided = true;
  b.add(quad({-1, 0.2f, -1}, {2, 0, 0}, {0, 1.5f, 0}), mask);
  Material glass_lamp = lamp({10, 12, 9});
  glass_lamp.alpha_mode = AlphaMode::blend;
  glass_lamp.opacity = 0.6f;
  b.add(quad({-0.5f, 1.6f, -0.5f}, {1, 0, 0}, {0, 0, 1}), glass_lamp);
  return {"alpha blend, mask and a half transparent lamp", b.build(), constant_environment({0.1f, 0.15f, 0.2f}),
          look_at({2, 1.2f, 2.5f}, {0, 0.5f, 0}, 0.8f),    64,        512};
}

Case instances() {
  SceneBuilder b;
  const int ball = b.add_mesh(sphere(vec3(0.0f), 0.5f, 2, true), b.add_material(plastic({0.3f, 0.5f, 0.8f}, 0.3f)));
  const int light = b.add_mesh(quad({-0.4f, 0, -0.4f}, {0.8f, 0, 0}, {0, 0, 0.8f}), b.add_material(lamp({9, 8, 7})));
  b.add_node(ball, translation({-0.6f, 0.5f, 0}));
  b.add_node(ball, translation({0.6f, 0.4f, 0}) * rotation({1, 1, 0}, 0.5f) * scaling({-1.0f, 0.8f, 1.2f}));
  b.add_node(light, translation({-1, 1.6f, 0}));
  b.add_node(light, translation({0.8f, 1.5f, 0.3f}) * rotation({0, 0, 1}, 0.4f) * scaling({1.5f, 1, -0.5f}));
  b.add(plane(vec3(0.0f), 3.0f), matte(vec3(0.7f)));
  return {"instances, some mirrored, some lamps",       b.build(), dark_environment(),
          look_at({0.5f, 1.4f, 3}, {0, 0.4f, 0}, 0.8f), 64,        256};
}

Case sun() {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 3.0f), plastic({0.4f, 0.5f, 0.3f}, 0.5f));
  b.add(box({-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}), metal({0.8f, 0.8f, 0.9f}, 0.4f));
  Case c{"sun disc and sky",
         b.build(),
         constant_environment({0.2f, 0.3f, 0.5f}),
         look_at({2, 1.5f, 2.5f}, {0, 0.3f, 0}, 0.8f),
         64,
         512};
  SunDisc disc;
  disc.direction = glm::normalize(vec3(1.0f, 1.0f, 0.3f));
  disc.angular_radius = 0.15f;  // so wide that the minimal integrator meets it often enough
  disc.radiance = {30, 28, 25};
  c.environment.suns.push_back(disc);
  c.environment.rotation = -0.4f;
  return c;
}

Case polished() {
  // A mirror over a diffuse layer: only one of them leaves light to next-event estimation.
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 3.0f), plastic(vec3(0.2f), 0.0f));
  b.add(quad({-1, 1, -1.2f}, {2, 0, 0}, {0, 1, 0.4f}), lamp({5, 4, 3}));
  b.add(quad({-1, 0, -1}, {0, 0, 2}, {0, 1, 0}), metal(vec3(0.9f), 0.0f));
  Case c{"mirrors that see a lamp, a map and a sun",
         b.build(),
         mapped_environment(32, 16, [](vec3 d) { return vec3(d.z < -0.8f ? 4.0f : 0.2f); }),
         look_at({0.6f, 0.8f, 2.5f}, {0, 0, -0.5f}, 0.9f),
         64,
         256};
  SunDisc disc;
  disc.direction = glm::normalize(vec3(0.4f, 0.6f, -1.0f));
  disc.angular_radius = 0.15f;
  disc.radiance = vec3(20.0f);
  c.environment.suns.push_back(disc);
  return c;
}

// The shorter one draws the same numbers in the same order where nothing is at one place and nothing is glass, so that
// not only the means agree.
TEST(law_path, surfaces_alone_are_the_minimal_integrator_where_there_is_nothing_else) {
  for (const Case& c : {room_with_lamp(), metal_under_map(), textured_lamp(), instances(), sun(), polished()}) {
    path::Settings s = settings(16, 64, 6);
    s.integrator = path::Integrator::minimal;
    const dvec3 minimal = mean_of(shoot(c.scene, c.environment, c.view, s).beauty);
    s.integrator = path::Integrator::surfaces;
    const dvec3 surfaces = mean_of(shoot(c.scene, c.environment, c.view, s).beauty);
    EXPECT_LT(glm::distance(minimal, surfaces), 1e-5 * glm::length(minimal)) << c.name;
    s.bounces = 0;
    EXPECT_GT(glm::distance(minimal, mean_of(shoot(c.scene, c.environment, c.view, s).beauty)),
              1e-3 * glm::length(minimal))
        << c.name << ", the twin: no path beyond the first hit";
  }
  SceneBuilder b;
  Material glass = plastic(vec3(1.0f), 0.0f);
  glass.transmission = 1.0f, glass.thickness = 1.0f;
  b.add(sphere(vec3(0.0f), 1.0f, 2, false), glass);
  path::Settings s = settings(4, 1, 1);
  s.integrator = path::Integrator::surfaces;
  EXPECT_THROW(shoot(b.build(), dark_environment(), look_at({0, 0, 4}, vec3(0.0f), 0.8f), s), Error);
}

TEST(law_path, full_and_minimal_integrator_have_the_same_mean) {
  const Case cases[] = {room_with_lamp(), metal_under_map(), textured_lamp(), alpha(), instances(), sun(), polished()};
  const double threshold = sidak_threshold(3 * std::size(cases));
  for (const Case& c : cases) {
    path::Settings s = settings(8, c.full_samples, 6);
    const auto full = mean_over_seeds(24, c.scene, c.environment, c.view, s);
    s.integrator = path::Integrator::minimal;
    s.samples = c.minimal_samples;
    const auto minimal = mean_over_seeds(24, c.scene, c.environment, c.view, s);
    for (std::size_t i = 0; i < 3; ++i) {
      const double error = std::hypot(full[i].standard_error(), minimal[i].standard_error());
      const double z = (full[i].mean() - minimal[i].mean()) / error;
      EXPECT_GT(normal_p_value(z), threshold) << c.name << ", channel " << i << ": full " << full[i].mean()
                                              << " minimal " << minimal[i].mean() << " ± " << error;
      // The twin: 4 % more light from one of them would be seen.
      EXPECT_LT(normal_p_value((1.04 * full[i].mean() - minimal[i].mean()) / error), threshold)
          << c.name << ", channel " << i << ": relative error " << error / minimal[i].mean();
      // And next-event estimation is no loss, even where the picture's noise is that of alpha.
      EXPECT_LT(full[i].variance() * c.full_samples, 1.5 * minimal[i].variance() * c.minimal_samples) << c.name;
    }
  }
}

}  // namespace
}  // namespace candela
