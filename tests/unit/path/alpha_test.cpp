#include <gtest/gtest.h>

#include <cmath>

#include "unit/path/scenes.h"

// Alpha modes of glTF 2.0 §3.9.4, to the camera and to light.

namespace candela {
namespace {

using namespace test;

Material sheet(float opacity, vec3 color = vec3(0.0f)) {
  Material m = unlit(color);
  m.alpha_mode = AlphaMode::blend;
  m.opacity = opacity;
  m.double_sided = true;
  return m;
}

/// Looks at the unit square in z = 0 from the front.
View at_unit_square() {
  View view;
  view.world_from_camera = translation({0.5f, 0.5f, 5.0f});
  view.projection = OrthographicCamera{.xmag = 0.5f, .ymag = 0.5f};
  return view;
}

Primitive unit_square(float z) { return quad({0, 0, z}, {1, 0, 0}, {0, 1, 0}); }
Primitive wide_square(float z) { return quad({-1, -1, z}, {3, 0, 0}, {0, 3, 0}); }

const vec3 kFront(0.9f, 0.2f, 0.5f), kBack(0.1f, 2.0f, 0.7f);

std::array<Moments, 3> through_sheets(const std::vector<float>& opacities) {
  SceneBuilder b;
  for (std::size_t i = 0; i < opacities.size(); ++i)
    b.add(wide_square(1.0f + static_cast<float>(i)), sheet(opacities[i], kFront));
  b.add(wide_square(0.0f), lamp(kBack));
  return mean_over_seeds(8, b.build(), dark_environment(), at_unit_square(), settings(16, 32, 0));
}

TEST(unit_path_alpha, blended_sheet_shows_its_share_of_what_is_behind) {
  for (const float a : {0.0f, 0.25f, 0.7f, 1.0f}) {
    const auto mean = through_sheets({a});
    for (std::size_t c = 0; c < 3; ++c) {
      const auto i = static_cast<int>(c);
      const auto expected = static_cast<double>(glm::mix(kBack[i], kFront[i], a));
      EXPECT_GT(z_test_p_value(mean[c], expected, 1e-6), sidak_threshold(12)) << a << ": " << mean[c].mean();
      EXPECT_LT(z_test_p_value(mean[c], expected + 0.05, 1e-6), sidak_threshold(12)) << mean[c].standard_error();
    }
  }
}

TEST(unit_path_alpha, sheets_behind_each_other_are_independent) {
  const auto mean = through_sheets({0.6f, 0.3f});
  for (std::size_t c = 0; c < 3; ++c) {
    const auto i = static_cast<int>(c);
    const auto expected = static_cast<double>(glm::mix(kFront[i], kBack[i], 0.4f * 0.7f));
    EXPECT_GT(z_test_p_value(mean[c], expected, 1e-6), sidak_threshold(3)) << mean[c].mean() << " " << expected;
  }
}

/// Radiance of white ground under a slanting sun, in the shade of `sheets` that the camera does not see.
Image ground_behind(SceneBuilder b, const Material& material, const std::vector<Primitive>& sheets) {
  b.add(plane(vec3(0.0f), 20.0f), matte(vec3(1.0f)));
  const int m = b.add_material(material);
  for (const Primitive& p : sheets) b.add_node(b.add_mesh(p, m));
  b.add_light(sunlight(vec3(1.0f), kPi), aimed({0, 1, 0}, vec3(0.0f)));
  return shoot(b.build(), dark_environment(), from_above(0.5f, 0.5f), centred(8, 1, 1)).beauty;
}

Primitive cover(float height) { return quad({-0.5f, height, 0.5f}, {1, 0, 0}, {0, 0, -1}); }

TEST(unit_path_alpha, shadow_of_a_blended_sheet_lets_the_rest_through) {
  for (const float a : {0.0f, 0.3f, 0.85f, 1.0f}) {
    const Image one = ground_behind({}, sheet(a), {cover(1.0f)});
    EXPECT_NEAR(one.rgb(2, 4).x, 1.0f - a, 1e-5f);
    const Image two = ground_behind({}, sheet(a), {cover(1.0f), cover(2.0f)});
    EXPECT_NEAR(two.rgb(2, 4).x, (1.0f - a) * (1.0f - a), 1e-5f);
  }
}

TEST(unit_path_alpha, instanced_sheets_shade_like_single_ones) {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 20.0f), matte(vec3(1.0f)));
  const int mesh = b.add_mesh(cover(0.0f), b.add_material(sheet(0.3f)));
  b.add_node(mesh, translation({0, 1, 0}));
  b.add_node(mesh, translation({0, 2, 0}));
  b.add_light(sunlight(vec3(1.0f), kPi), aimed({0, 1, 0}, vec3(0.0f)));
  const Film film = shoot(b.build(), dark_environment(), from_above(0.5f, 0.4f), centred(8, 1, 1));
  EXPECT_NEAR(film.beauty.rgb(2, 4).x, 0.49f, 1e-5f);
}

/// Shadow of a sheet whose alpha rises from 0 to 1 along x in its vertex colours.
std::array<float, 8> shadow_profile(AlphaMode mode, float factor, float cutoff) {
  Material m = sheet(factor);
  m.alpha_mode = mode;
  m.alpha_cutoff = cutoff;
  Primitive p = cover(1.0f);
  p.colors = {{1, 1, 1, 0}, {1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 0}};
  const Image image = ground_behind({}, m, {p});
  std::array<float, 8> row{};
  for (int x = 0; x < 8; ++x) row[static_cast<std::size_t>(x)] = image.rgb(x, 3).x;
  return row;
}

TEST(unit_path_alpha, vertex_colour_alpha_multiplies_the_factor) {
  const auto row = shadow_profile(AlphaMode::blend, 0.8f, 0.5f);
  for (std::size_t i = 0; i < 8; ++i)
    EXPECT_NEAR(row[i], 1.0f - 0.8f * (static_cast<float>(i) + 0.5f) / 8.0f, 1e-4f) << i;
}

TEST(unit_path_alpha, mask_is_all_or_nothing_at_its_cutoff) {
  for (const float cutoff : {0.2f, 0.5f, 0.9f}) {
    const auto row = shadow_profile(AlphaMode::mask, 1.0f, cutoff);
    for (std::size_t i = 0; i < 8; ++i) {
      const bool is_there = (static_cast<float>(i) + 0.5f) / 8.0f >= cutoff;
      EXPECT_NEAR(row[i], is_there ? 0.0f : 1.0f, 1e-5f) << i << " cutoff " << cutoff;
    }
  }
  // Exactly at the cutoff it is there (glTF 2.0 §3.9.4.1).
  EXPECT_EQ(ground_behind({},
                          [] {
                            Material m = sheet(0.5f);
                            m.alpha_mode = AlphaMode::mask;
                            return m;
                          }(),
                          {cover(1.0f)})
                .rgb(3, 3)
                .x,
            0.0f);
}

TEST(unit_path_alpha, what_equals_the_cutoff_between_vertices_has_no_holes) {
  // Weights of three corners add up to 1 but for rounding, of which colours have as much; a hole would be 1.5e-5.
  SceneBuilder b;
  Material m = unlit(vec3(1.0f));
  m.alpha_mode = AlphaMode::mask;
  m.alpha_cutoff = 0.3f;
  Primitive square = quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  square.colors.assign(square.positions.size(), vec4(1, 1, 1, 0.3f));
  b.add(square, m);
  View view;
  view.world_from_camera = translation({0, 0, 3});
  view.projection = OrthographicCamera{.xmag = 0.9f, .ymag = 0.9f};
  const Film film = shoot(b.build(), dark_environment(), view, settings(64, 16, 1));
  EXPECT_NEAR(mean_of(film.beauty).x, 1.0, 1e-6);
}

TEST(unit_path_alpha, opaque_mode_ignores_alpha) {
  const auto row = shadow_profile(AlphaMode::opaque, 0.1f, 0.5f);
  for (const float v : row) EXPECT_EQ(v, 0.0f);
}

TEST(unit_path_alpha, texture_alpha_is_read_linearly) {
  SceneBuilder b;
  Material m = sheet(1.0f);
  m.base_color_texture = slot(b.add_texture(2, 1, {255, 255, 255, 51, 255, 255, 255, 204}, Filter::nearest));
  const Image image = ground_behind(b, m, {cover(1.0f)});
  EXPECT_NEAR(image.rgb(1, 3).x, 0.8f, 1e-5f);  // 51 / 255; decoded as sRGB it would be 0.97
  EXPECT_NEAR(image.rgb(6, 3).x, 0.2f, 1e-5f);
}

TEST(unit_path_alpha, mask_shows_or_hides_to_the_camera) {
  SceneBuilder b;
  Material m = unlit(kFront);
  m.alpha_mode = AlphaMode::mask;
  m.base_color_texture = slot(b.add_texture(2, 1, {255, 255, 255, 120, 255, 255, 255, 140}, Filter::nearest));
  b.add(unit_square(1.0f), m);
  b.add(wide_square(0.0f), lamp(kBack));
  const Image image = shoot(b.build(), dark_environment(), at_unit_square(), centred(4, 8, 0)).beauty;
  for (int y = 0; y < 4; ++y) {
    EXPECT_LT(glm::length(image.rgb(1, y) - kBack), 1e-6f);
    EXPECT_LT(glm::length(image.rgb(2, y) - kFront), 1e-6f);
  }
}

TEST(unit_path_alpha, blended_lamp_gives_its_share_of_light) {
  // By next-event estimation and by chance.
  for (const auto integrator : {path::Integrator::full, path::Integrator::minimal}) {
    const auto lit_by = [&](float opacity) {
      SceneBuilder b;
      b.add(plane(vec3(0.0f), 20.0f), matte(vec3(1.0f)));
      Material m = lamp(vec3(3.0f));
      m.alpha_mode = AlphaMode::blend;
      m.opacity = opacity;
      b.add(quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}), m);
      path::Settings s = settings(8, 64, 1);
      s.integrator = integrator;
      return mean_over_seeds(8, b.build(), dark_environment(), from_above(0.5f, 0.5f), s)[0];
    };
    const Moments half = lit_by(0.5f), whole = lit_by(1.0f);
    const double error = std::hypot(2.0 * half.standard_error(), whole.standard_error());
    EXPECT_GT(normal_p_value((2.0 * half.mean() - whole.mean()) / error), sidak_threshold(2));
    EXPECT_LT(error, 0.02 * whole.mean());
  }
}

}  // namespace
}  // namespace candela
