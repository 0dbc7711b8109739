#include <gtest/gtest.h>

#include <cmath>

#include "laws/raster_draw.h"
#include "raster/render.h"
#include "unit/gl/gl_fixture.h"
#include "unit/path/scenes.h"

// Glass before a chosen background, as the rasterizer draws it.

namespace candela {
namespace {

using namespace test;

class law_raster_glass : public NeedsGl {};  // NOLINT(readability-identifier-naming): a suite is named as its laws

constexpr vec3 kTint(1.0f, 0.6f, 0.1f);
constexpr int kSize = 32;

Material sheet(float ior, float roughness, vec3 color = vec3(1.0f)) {
  Material m;
  m.metallic = 0.0f;
  m.base_color = color;
  m.roughness = roughness;
  m.ior = ior;
  m.transmission = 1.0f;
  m.double_sided = true;
  return m;
}

Material slab(vec3 color) {
  Material m = sheet(1.0f, 0.0f);
  m.double_sided = false;
  m.thickness = 1.0f;
  m.attenuation_color = color;
  m.attenuation_distance = 1.0f;
  return m;
}

raster::Settings before_background() {
  raster::Settings s;
  s.width = s.height = kSize;
  s.msaa = 1;
  s.specular_antialiasing = false;
  s.background = Background::transparent;
  return s;
}

/// Two metres wide and high.
View front() {
  View view;
  view.world_from_camera = translation({0, 0, 3});
  view.projection = OrthographicCamera{.xmag = 1.0f, .ymag = 1.0f};
  return view;
}

Film draw(const Scene& scene, const Environment& environment, const raster::Settings& settings) {
  return test::draw(scene, environment, front(), settings);
}

Primitive pane(float z = 0.0f) { return quad({-2, -2, z}, {4, 0, 0}, {0, 4, 0}); }
Primitive left_half(float z) { return quad({-2, -2, z}, {2, 0, 0}, {0, 4, 0}); }

vec3 at(const Image& image, int x, int y) { return image.rgb(x, y); }

TEST_F(law_raster_glass, a_filter_multiplies_the_background_by_its_colour_and_nothing_else) {
  for (const Material& material : {sheet(1.0f, 0.0f, kTint), slab(kTint)}) {
    SceneBuilder b;
    b.add(material.thickness > 0.0f ? box({-1.0f, -2, -1}, {0, 2, 0}) : left_half(0.0f), material);
    for (const int msaa : {1, 4}) {
      raster::Settings s = before_background();
      s.msaa = msaa;
      const Environment room = constant_environment({0.3f, 0.5f, 0.9f});
      const Film film = draw(b.build(), room, s);
      ASSERT_FALSE(film.through.empty());
      EXPECT_LT(glm::length(at(film.through, 8, 16) - kTint), 2e-3f);
      EXPECT_LT(glm::length(at(film.beauty, 8, 16)), 2e-3f);
      EXPECT_NEAR(film.beauty.at(8, 16)[3], 1.0f - luminance(kTint), 2e-3f);
      EXPECT_EQ(film.through.at(8, 16)[3], 1.0f);
      EXPECT_EQ(at(film.through, 24, 16), vec3(1.0f));
      EXPECT_EQ(film.beauty.at(24, 16)[3], 0.0f);
      s.environment_in_glass = true;
      const Film with_room = draw(b.build(), room, s);
      EXPECT_TRUE(with_room.through.empty());
      EXPECT_LT(glm::length(at(with_room.beauty, 8, 16) - kTint * vec3(0.3f, 0.5f, 0.9f)), 3e-3f);
      EXPECT_EQ(with_room.beauty.at(8, 16)[3], 1.0f);
    }
  }
}

TEST_F(law_raster_glass, reflections_are_those_before_the_environment) {
  const Environment room = mapped_environment(64, 32, [](vec3 d) { return vec3(d.z > 0.5f ? 2.0f : 0.3f); });
  for (const float roughness : {0.0f, 0.3f, 0.7f}) {
    SceneBuilder b;
    b.add(pane(), sheet(1.5f, roughness));
    raster::Settings s = before_background();
    const Film film = draw(b.build(), room, s);
    s.background = Background::environment;
    const Film whole = draw(b.build(), room, s);
    SceneBuilder mirror;
    Material black = sheet(1.5f, roughness, vec3(0.0f));
    mirror.add(pane(), black);
    const Film reflected = draw(mirror.build(), room, s);
    const vec3 light = at(film.beauty, 16, 16), through = at(film.through, 16, 16);
    EXPECT_LT(glm::length(light - at(reflected.beauty, 16, 16)), 2e-3f) << roughness;
    EXPECT_NEAR(light.y + 0.3f * through.y, at(whole.beauty, 16, 16).y, 0.05f) << roughness;
    EXPECT_NEAR(film.beauty.at(16, 16)[3], 1.0f - through.y, 2e-3f);
  }
}

TEST_F(law_raster_glass, both_engines_let_the_same_background_through) {
  // Behind the panes an opaque one that covers the left half; half way across it the frosted one mixes both.
  const Environment room = constant_environment(vec3(1.0f));
  for (const float roughness : {0.0f, 0.35f}) {
    for (const float thickness : {0.0f, 0.4f}) {
      Material glass = sheet(1.5f, roughness, {0.9f, 0.7f, 0.5f});
      glass.thickness = thickness;
      glass.double_sided = thickness <= 0.0f;
      SceneBuilder b;
      b.add(thickness > 0.0f ? box({-2, -2, -0.4f}, {2, 2, 0}) : pane(), glass);
      b.add(left_half(-0.6f), unlit({0.1f, 0.5f, 0.2f}));
      const Film drawn = draw(b.build(), room, before_background());
      path::Settings s = settings(kSize, 256, 32);
      s.background = Background::transparent;
      const Film traced = shoot(b.build(), room, front(), s);
      for (const Region& side : {Region{2, 12, 6, 20}, Region{26, 12, 30, 20}}) {
        const dvec3 through = mean_of(drawn.through, side), expected = mean_of(traced.through, side);
        const dvec3 light = mean_of(drawn.beauty, side), expected_light = mean_of(traced.beauty, side);
        // A body has two faces, of which the rasterizer draws one.
        const double bound = thickness > 0.0f ? 0.09 : 0.03;
        for (int c = 0; c < 3; ++c) {
          EXPECT_NEAR(through[c], expected[c], bound) << roughness << ' ' << thickness << ' ' << side.x0;
          EXPECT_NEAR(light[c], expected_light[c], bound) << roughness << ' ' << thickness << ' ' << side.x0;
        }
      }
      if (roughness > 0.0f) {
        EXPECT_GT(at(drawn.through, 15, 16).x, 0.1f);
        EXPECT_LT(at(drawn.through, 15, 16).x, 0.7f);
      }
    }
  }
}

TEST_F(law_raster_glass, what_is_blended_before_glass_covers_what_shows_through_it) {
  Material half = unlit({1.0f, 0.5f, 0.25f});
  half.alpha_mode = AlphaMode::blend, half.opacity = 0.5f;
  Material film = sheet(1.0f, 0.0f, kTint);
  film.alpha_mode = AlphaMode::blend, film.opacity = 0.5f;
  SceneBuilder b;
  b.add(pane(), sheet(1.0f, 0.0f, kTint));
  b.add(left_half(1.0f), half);
  const Film found = draw(b.build(), constant_environment(vec3(1.0f)), before_background());
  EXPECT_LT(glm::length(at(found.through, 8, 16) - 0.5f * kTint), 3e-3f);
  EXPECT_LT(glm::length(at(found.beauty, 8, 16) - vec3(0.5f, 0.25f, 0.125f)), 3e-3f);
  EXPECT_LT(glm::length(at(found.through, 24, 16) - kTint), 3e-3f);
  // Glass that is itself blended: half of it is there.
  SceneBuilder c;
  c.add(left_half(0.0f), film);
  const Film blended = draw(c.build(), constant_environment(vec3(1.0f)), before_background());
  EXPECT_LT(glm::length(at(blended.through, 8, 16) - (0.5f + 0.5f * kTint)), 3e-3f);
  EXPECT_NEAR(blended.through.at(8, 16)[3], 0.5f, 3e-3f);
}

TEST_F(law_raster_glass, edges_of_glass_are_smooth_over_samples_and_frames) {
  SceneBuilder b;
  b.add(quad({-2, -2, 0}, {2.0f + 1.0f / kSize, 0, 0}, {0, 4, 0}), sheet(1.0f, 0.0f, kTint));
  raster::Settings s = before_background();
  s.msaa = 4;
  s.frames = 64;
  const Film film = draw(b.build(), constant_environment(vec3(1.0f)), s);
  EXPECT_LT(glm::length(at(film.through, 16, 16) - (0.5f + 0.5f * kTint)), 0.06f);
  EXPECT_NEAR(film.through.at(16, 16)[3], 0.5f, 0.07f);
}

TEST_F(law_raster_glass, scattering_bodies_beside_glass_change_nothing_of_it) {
  // Both have pictures of their own beside the light.
  Material wax = slab({0.6f, 0.4f, 0.2f});
  wax.multiscatter_color = {0.9f, 0.7f, 0.5f};
  SceneBuilder b;
  b.add(left_half(0.0f), sheet(1.0f, 0.0f, kTint));
  b.add(box({0.3f, -0.7f, -0.5f}, {0.9f, 0.7f, 0.0f}), wax);
  const Film film = draw(b.build(), constant_environment(vec3(1.0f)), before_background());
  EXPECT_LT(glm::length(at(film.through, 8, 16) - kTint), 3e-3f);
  EXPECT_LT(glm::length(at(film.through, 25, 16)), 3e-3f);
  EXPECT_GT(at(film.beauty, 25, 16).x, 0.1f);
  EXPECT_EQ(at(film.through, 25, 1), vec3(1.0f));
}

TEST_F(law_raster_glass, without_glass_or_before_the_environment_there_is_nothing_to_let_through) {
  SceneBuilder matte_one;
  matte_one.add(pane(), matte(vec3(0.5f)));
  EXPECT_TRUE(draw(matte_one.build(), constant_environment(vec3(1.0f)), before_background()).through.empty());
  SceneBuilder b;
  b.add(pane(), sheet(1.5f, 0.0f));
  raster::Settings s = before_background();
  s.quantity = raster::Quantity::transmission;
  EXPECT_TRUE(draw(b.build(), constant_environment(vec3(1.0f)), s).through.empty());
  s = before_background();
  s.background = Background::environment;
  EXPECT_TRUE(draw(b.build(), constant_environment(vec3(1.0f)), s).through.empty());
}

TEST_F(law_raster_glass, what_is_in_a_body_with_the_eye_is_as_bright_as_for_the_path_tracer) {
  Material water = plastic(vec3(1.0f), 0.0f);
  water.transmission = 1.0f, water.thickness = 8.0f, water.ior = 1.5f;
  water.attenuation_distance = 2.0f;
  const View view = look_at({0, 0, 2}, vec3(0.0f), 0.6f);
  for (const Material& seen : {unlit(vec3(0.5f)), lamp(vec3(3.0f)), matte(vec3(0.8f))}) {
    const bool is_lit = max_component(seen.emission) <= 0.0f && !seen.unlit;  // over a way that takes nothing
    water.attenuation_color = is_lit ? vec3(1.0f) : vec3(0.5f, 0.9f, 1.0f);
    SceneBuilder b;
    b.add(box(vec3(-4.0f), vec3(4.0f)), water);
    b.add(quad({-2, -2, -1}, {4, 0, 0}, {0, 4, 0}), seen);
    if (is_lit) b.add_light(point_light(vec3(1.0f), 20.0f), translation({0, 0, 3}));
    const Scene scene = b.build();
    const vec3 expected(mean_of(shoot(scene, dark_environment(), view, settings(8, 64, 1)).beauty));
    raster::Settings drawn;
    drawn.width = drawn.height = 8;
    const vec3 found(mean_of(test::draw(scene, dark_environment(), view, drawn).beauty));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c] / expected[c], 1.0f, 0.03f);
  }
}

// ----- KHR_materials_scatter of a thin wall

/// Half of the sheet is as its textures say; a sun of π lux shines on its front, or through it from behind.
Image scattering_sheet(bool is_traced, bool is_behind, float g, bool has_textures) {
  SceneBuilder b;
  Material m = sheet(1.0f, 1.0f, vec3(0.0f));  // no boundary, and what is not scattered is black
  m.sheet_scatter = has_textures ? 1.0f : 0.5f;
  m.multiscatter_color = has_textures ? vec3(1.0f) : kTint;
  m.scatter_anisotropy = g;
  if (has_textures) {
    m.scatter_strength_texture = slot(b.add_texture(1, 1, {0, 0, 0, 128}, Filter::nearest));
    m.multiscatter_color_texture = slot(b.add_texture(1, 1, {255, 203, 89, 0}, Filter::nearest));  // kTint as sRGB
  }
  b.add(pane(), m);
  b.add_light(sunlight(vec3(1.0f), kPi), aimed({0, 0, is_behind ? -3.0f : 3.0f}, vec3(0.0f)));
  if (is_traced) return shoot(b.build(), dark_environment(), front(), settings(8, 16, 2)).beauty;
  raster::Settings s = before_background();
  s.width = s.height = 8;
  return draw(b.build(), dark_environment(), s).beauty;
}

TEST_F(law_raster_glass, a_thin_wall_scatters_to_both_sides_as_its_anisotropy_says_in_both_engines) {
  for (const float g : {-0.9f, 0.0f, 0.5f}) {
    for (const bool is_behind : {false, true}) {
      const vec3 expected = kTint * (0.25f * (is_behind ? 1.0f + g : 1.0f - g));
      for (const bool is_traced : {false, true}) {
        for (const bool has_textures : {false, true}) {
          const vec3 found = scattering_sheet(is_traced, is_behind, g, has_textures).rgb(4, 4);
          EXPECT_LT(glm::length(found - expected), 0.01f)
              << g << (is_behind ? " behind" : " front") << (is_traced ? " traced" : " drawn") << has_textures;
        }
      }
    }
  }
}

TEST_F(law_raster_glass, the_colour_of_a_scattering_body_is_that_of_where_it_is_entered) {
  SceneBuilder b;
  Material wax = slab(vec3(0.001f));
  wax.attenuation_distance = 0.05f;
  wax.multiscatter_color = vec3(0.9f);
  SceneBuilder plain = b;
  wax.multiscatter_color_texture =
      slot(b.add_texture(2, 1, {255, 255, 255, 255, 0, 0, 0, 255}, Filter::nearest, Wrap::clamp_to_edge));
  Primitive body = box(vec3(-0.9f), vec3(0.9f));
  for (std::size_t i = 0; i < body.positions.size(); ++i) {
    body.uvs[0].resize(body.positions.size());
    body.uvs[0][i] = vec2(body.positions[i].x > 0.0f ? 0.999f : 0.001f, 0.5f);
  }
  b.add(body, wax);
  wax.multiscatter_color_texture = {};
  plain.add(body, wax);
  const Environment light = constant_environment(vec3(1.0f));
  const Image whole = shoot(plain.build(), light, front(), settings(16, 64, 8)).beauty;
  const Image half = shoot(b.build(), light, front(), settings(16, 64, 8)).beauty;
  const auto side = [](const Image& image, bool is_right) {
    return mean_of(image, {is_right ? 10 : 2, 4, is_right ? 14 : 6, 12}).x;
  };
  EXPECT_NEAR(side(half, false), side(whole, false), 0.03);
  EXPECT_LT(side(half, true), 0.05);
  EXPECT_GT(side(whole, true), 0.5);
  raster::Settings s = before_background();
  s.width = s.height = 16;
  const Image drawn = draw(b.build(), light, s).beauty;
  EXPECT_GT(side(drawn, false), 3.0 * side(drawn, true));
}

}  // namespace
}  // namespace candela
