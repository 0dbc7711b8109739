#include <gtest/gtest.h>

#include <cmath>

#include "unit/path/scenes.h"

// Glass before a chosen background: what is seen through it is that background, what it reflects the environment.

namespace candela {
namespace {

using namespace test;

constexpr vec3 kTint(1.0f, 0.6f, 0.1f);

Material glass(float ior, float roughness) {
  Material m;
  m.metallic = 0.0f;
  m.roughness = roughness;
  m.ior = ior;
  m.transmission = 1.0f;
  m.thickness = 1.0f;
  return m;
}

Material sheet(float ior, float roughness, vec3 color = vec3(1.0f)) {
  Material m = glass(ior, roughness);
  m.base_color = color;
  m.thickness = 0.0f;
  m.double_sided = true;
  return m;
}

Primitive pane() { return quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}); }
View front() { return look_at({0, 0, 3}, vec3(0.0f), 0.2f); }

path::Settings before_background(int size, int samples, int bounces = 64) {
  path::Settings s = settings(size, samples, bounces);
  s.background = Background::transparent;
  return s;
}

struct Seen {
  vec3 light{0.0f}, through{0.0f};
  float alpha = 1.0f, coverage = 1.0f;
};

/// Mean over the picture.
Seen look(const Scene& scene, const Environment& environment, const View& view, const path::Settings& s) {
  const Film film = shoot(scene, environment, view, s);
  Seen seen;
  seen.light = vec3(mean_of(film.beauty));
  if (film.through.empty()) {
    seen.through = vec3(-1.0f);
    return seen;
  }
  seen.through = vec3(mean_of(film.through));
  seen.alpha = seen.coverage = 0.0f;
  const auto pixels = static_cast<float>(film.width() * film.height());
  for (std::size_t i = 3; i < film.beauty.pixels.size(); i += 4) {
    seen.alpha += film.beauty.pixels[i] / pixels;
    seen.coverage += film.through.pixels[i] / pixels;
  }
  return seen;
}

TEST(law_path, a_filter_multiplies_the_background_by_its_colour_and_nothing_else) {
  SceneBuilder b;
  b.add(pane(), sheet(1.0f, 0.0f, kTint));
  for (const auto integrator : {path::Integrator::full, path::Integrator::minimal}) {
    path::Settings s = before_background(4, 4);
    s.integrator = integrator;
    const Environment room = constant_environment({0.3f, 0.5f, 0.9f});
    const Seen seen = look(b.build(), room, front(), s);
    EXPECT_LT(glm::length(seen.through - kTint), 1e-6f);
    EXPECT_LT(glm::length(seen.light), 1e-6f);
    EXPECT_NEAR(seen.alpha, 1.0f - luminance(kTint), 1e-6f);
    EXPECT_EQ(seen.coverage, 1.0f);
    // The room is in the glass where that is asked for, and then there is no background in it.
    s.environment_in_glass = true;
    const Film film = shoot(b.build(), room, front(), s);
    EXPECT_TRUE(film.through.empty());
    EXPECT_LT(glm::length(film.beauty.rgb(1, 1) - kTint * vec3(0.3f, 0.5f, 0.9f)), 1e-6f);
    EXPECT_EQ(film.beauty.at(1, 1)[3], 1.0f);
  }
}

TEST(law_path, what_is_in_front_and_behind_glass_keeps_its_place_before_the_background) {
  // A body of index 1 that absorbs, half covered behind by an opaque lamp, then by a blended one.
  Material body = glass(1.0f, 0.0f);
  body.attenuation_color = kTint;
  body.attenuation_distance = 1.0f;
  SceneBuilder b;
  b.add(box({-5, -5, -1}, {5, 5, 0}), body);
  b.add(quad({-5, -5, -2}, {5, 0, 0}, {0, 10, 0}), unlit({0.0f, 0.5f, 0.5f}));
  Material half = unlit(vec3(1.0f));
  half.alpha_mode = AlphaMode::blend;
  half.opacity = 0.25f;
  b.add(quad({0, -5, -2}, {5, 0, 0}, {0, 10, 0}), half);
  View view;
  view.world_from_camera = translation({0, 0, 3});
  view.projection = OrthographicCamera{.xmag = 1.0f, .ymag = 1.0f};
  const Film film = shoot(b.build(), constant_environment(vec3(5.0f)), view, before_background(8, 1024));
  EXPECT_LT(glm::length(vec3(mean_of(film.through, {0, 0, 4, 8}))), 1e-6f);
  EXPECT_LT(glm::length(vec3(mean_of(film.beauty, {0, 0, 4, 8})) - kTint * vec3(0.0f, 0.5f, 0.5f)), 1e-5f);
  EXPECT_LT(glm::length(vec3(mean_of(film.through, {4, 0, 8, 8})) - 0.75f * kTint), 0.01f);
  EXPECT_LT(glm::length(vec3(mean_of(film.beauty, {4, 0, 8, 8})) - 0.25f * kTint), 0.01f);
}

struct Shape {
  const char* name;
  Primitive shape;
  Material material;
};

std::vector<Shape> shapes() {
  Material dispersive = glass(1.6f, 0.0f);
  dispersive.dispersion = 5.0f;
  return {{"sheet", pane(), sheet(1.5f, 0.0f)},
          {"frosted sheet", pane(), sheet(1.5f, 0.4f)},
          {"ball", sphere(vec3(0.0f), 1.0f, 4, false), glass(1.5f, 0.0f)},
          {"frosted ball", sphere(vec3(0.0f), 1.0f, 3, false), glass(1.5f, 0.3f)},
          {"cube", box(vec3(-0.5f), vec3(0.5f)), glass(1.5f, 0.0f)},
          {"dispersive ball", sphere(vec3(0.0f), 1.0f, 4, false), dispersive}};
}

TEST(law_path, what_clear_glass_reflects_and_lets_through_is_all_there_is) {
  for (const Shape& shape : shapes()) {
    SceneBuilder b;
    b.add(shape.shape, shape.material, rotation({1, 1, 0}, 0.4f));
    for (const auto integrator : {path::Integrator::full, path::Integrator::minimal}) {
      path::Settings s = before_background(16, 64, 256);
      s.integrator = integrator;
      const Seen seen = look(b.build(), constant_environment(vec3(1.0f)), front(), s);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen.light[c] + seen.through[c], 1.0f, 0.02f) << shape.name;
      EXPECT_GT(seen.through.y, 0.3f) << shape.name;
      EXPECT_GT(seen.light.y, 0.03f) << shape.name;
      // One wavelength lets more than all of one colour through, and alpha cannot be below 0.
      EXPECT_NEAR(seen.alpha, 1.0f - luminance(seen.through), shape.material.dispersion > 0.0f ? 0.02f : 1e-3f)
          << shape.name;
    }
  }
}

TEST(law_path, looking_for_lamps_does_not_bring_the_environment_back_into_the_glass) {
  // A bright patch and a sun behind the sheet, which the full integrator looks for, or 0.3 there and the patch in
  // front.
  const auto room = [](float bright_side) {
    Environment e =
        mapped_environment(64, 32, [&](vec3 d) { return vec3(d.z * bright_side > 0.05f && d.y > 0.5f ? 8.0f : 0.3f); });
    SunDisc sun;
    sun.direction = glm::normalize(vec3(0.5f, 0.3f, bright_side));
    sun.angular_radius = 0.1f;
    sun.radiance = vec3(30.0f);
    e.suns.push_back(sun);
    return e;
  };
  for (const float roughness : {0.0f, 0.2f, 0.5f, 1.0f}) {
    SceneBuilder b;
    b.add(pane(), sheet(1.5f, roughness));
    path::Settings s = before_background(8, 1024);
    const Seen lit_behind = look(b.build(), room(-1.0f), front(), s);
    const Seen even = look(b.build(), constant_environment(vec3(0.3f)), front(), s);
    EXPECT_NEAR(lit_behind.light.y, even.light.y, 0.003f) << roughness;
    // What is seen with the environment behind is what is reflected and 0.3 of what is let through.
    const Seen lit_in_front = look(b.build(), room(1.0f), front(), s);
    EXPECT_GT(lit_in_front.through.y, 0.5f) << roughness;
    s.environment_in_glass = true;
    const float whole = look(b.build(), room(1.0f), front(), s).light.y;
    EXPECT_NEAR(lit_in_front.light.y + 0.3f * lit_in_front.through.y, whole, 0.015f * whole) << roughness;
  }
}

Scene still_life() {
  SceneBuilder b;
  b.add(plane({0, -1, 0}, 1.2f), matte({0.6f, 0.7f, 0.5f}));
  Material tinted = glass(1.5f, 0.4f);
  tinted.attenuation_color = {0.9f, 0.6f, 0.3f};
  tinted.attenuation_distance = 1.0f;
  b.add(sphere({-0.6f, 0, 0}, 0.7f, 3, false), tinted);
  Material leaf = sheet(1.5f, 0.5f, {0.7f, 0.9f, 0.4f});
  leaf.transmission = 0.6f;
  leaf.diffuse_transmission = 0.6f;
  b.add(quad({0.2f, -0.8f, 0.4f}, {1, 0, 0}, {0, 1.6f, 0}), leaf);
  b.add(quad({-0.3f, -0.9f, 0.9f}, {1.2f, 0, 0}, {0, 1.2f, 0}), sheet(1.5f, 0.0f, {0.5f, 0.9f, 0.8f}));
  Material wax = glass(1.4f, 0.2f);
  wax.attenuation_color = {0.6f, 0.4f, 0.2f};
  wax.attenuation_distance = 0.5f;
  wax.multiscatter_color = {0.9f, 0.7f, 0.5f};
  b.add(sphere({0.9f, 0.3f, -0.4f}, 0.5f, 3, false), wax);
  b.add(quad({-1.0f, 1.5f, -1.0f}, {2, 0, 0}, {0, 0, 2}), lamp({6, 5, 4}));
  return b.build();
}

TEST(law_path, full_and_minimal_integrator_see_the_same_background_through_glass) {
  const Scene scene = still_life();
  Environment room = mapped_environment(32, 16, [](vec3 d) { return vec3(d.z < -0.7f ? 3.0f : 0.2f); });
  SunDisc sun;
  sun.direction = glm::normalize(vec3(0.4f, 0.6f, -1.0f));
  sun.angular_radius = 0.2f;
  sun.radiance = vec3(10.0f);
  room.suns.push_back(sun);
  const View view = look_at({0.3f, 0.5f, 3.5f}, vec3(0.0f), 0.7f);
  const auto mean = [&](path::Integrator integrator, int samples, auto part) {
    return over_seeds(16, [&](std::uint32_t seed) {
      path::Settings s = before_background(8, samples, 16);
      s.integrator = integrator;
      s.seed = seed;
      return static_cast<double>(part(look(scene, room, view, s)));
    });
  };
  const double threshold = sidak_threshold(4);
  for (const auto part : {+[](const Seen& s) { return luminance(s.light); }, +[](const Seen& s) { return s.through.x; },
                          +[](const Seen& s) { return s.through.z; }, +[](const Seen& s) { return s.alpha; }}) {
    const Moments full = mean(path::Integrator::full, 64, part);
    const Moments minimal = mean(path::Integrator::minimal, 256, part);
    const double error = std::hypot(full.standard_error(), minimal.standard_error());
    EXPECT_GT(normal_p_value((full.mean() - minimal.mean()) / error), threshold)
        << full.mean() << " and " << minimal.mean() << " ± " << error;
    EXPECT_LT(error, 0.03 * minimal.mean());
  }
}

TEST(law_path, a_glass_ball_before_a_background_has_the_alpha_of_its_two_reflections) {
  SceneBuilder b;
  b.add(sphere(vec3(0.0f), 1.0f, 5, false), glass(1.5f, 0.0f));
  const View middle = look_at({0, 0, 3}, vec3(0.0f), 0.01f);
  const Seen seen = look(b.build(), constant_environment(vec3(1.0f)), middle, before_background(16, 256));
  EXPECT_NEAR(seen.alpha, 1.0f - 0.96f * 0.96f, 0.005f);
  EXPECT_EQ(seen.coverage, 1.0f);
}

TEST(law_path, reflections_inside_and_out_and_what_scatters_show_the_environment) {
  const Environment room = constant_environment({0.3f, 0.6f, 0.9f});
  const auto both = [&](const Scene& scene, const View& view) {
    path::Settings s = before_background(8, 256);
    const Seen seen = look(scene, room, view, s);
    s.environment_in_glass = true;
    const Seen whole = look(scene, room, view, s);
    EXPECT_LT(glm::length(seen.light - whole.light), 0.01f);
    EXPECT_LT(glm::length(seen.through), 0.01f);
  };
  {
    // A mirror that shows a pane; the pane itself is out of sight.
    SceneBuilder b;
    b.add(pane(), metal(vec3(1.0f), 0.0f));
    b.add(quad({-2, -2, 5}, {4, 0, 0}, {0, 4, 0}), sheet(1.5f, 0.0f, kTint));
    both(b.build(), front());
  }
  {
    // Total reflection: the back of a prism stands at 45° to the view.
    Primitive prism = box(vec3(-1.0f), vec3(1.0f));
    for (vec3& p : prism.positions) p.z = p.y < 0.0f ? 1.0f : p.z;
    for (std::size_t i = 16; i < 20; ++i) prism.normals[i] = glm::normalize(vec3(0, -1, -1));
    SceneBuilder b;
    b.add(prism, glass(1.5f, 0.0f));
    both(b.build(), look_at({0, 0, 3}, vec3(0.0f), 0.08f));
  }
  {
    SceneBuilder b;
    Material paper = matte(vec3(0.8f));
    paper.diffuse_transmission = 1.0f;
    paper.double_sided = true;
    b.add(pane(), paper);
    b.add(quad({50, 50, 0}, {1, 0, 0}, {0, 1, 0}), sheet(1.5f, 0.0f));  // some glass, far off
    both(b.build(), front());
  }
}

TEST(law_path, glass_before_a_background_comes_to_its_noise_target) {
  SceneBuilder b;
  b.add(pane(), sheet(1.5f, 0.0f));
  path::Settings s = before_background(16, 65536);
  s.noise = 0.005f;
  path::Statistics statistics;
  path::render(b.build(), constant_environment(vec3(0.25f)), front(), s, {}, &statistics);
  // A sample reflects with a chance of 0.04, where it adds light and takes background: a variance of 2 · 0.04 · 0.96 of
  // the squared light, of which about a fifth is seen at middle grey: 0.077 · 0.2² / 0.005² = 123 if samples were
  // independent.
  EXPECT_GT(statistics.mean_samples_per_pixel, 40.0);
  EXPECT_LT(statistics.mean_samples_per_pixel, 400.0);
}

}  // namespace
}  // namespace candela
