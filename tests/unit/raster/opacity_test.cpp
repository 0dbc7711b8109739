#include "raster/opacity.h"

#include <gtest/gtest.h>

#include "unit/path/scenes.h"

namespace candela::raster {
namespace {

using namespace test;

TEST(unit_raster_opacity, ranges_are_products_of_factor_texture_and_vertices) {
  SceneBuilder b;
  Material m = matte(vec3(1.0f));
  m.opacity = 0.5f;
  EXPECT_EQ(alpha_of_material(b.scene(), m).least, 0.5f);
  m.base_color_texture = slot(b.add_texture(2, 1, {0, 0, 0, 51, 0, 0, 0, 255}));
  EXPECT_NEAR(alpha_of_material(b.scene(), m).least, 0.1f, 1e-6f);
  EXPECT_EQ(alpha_of_material(b.scene(), m).most, 0.5f);
  m.base_color_texture = slot(b.add_texture_16(2, 1, {0, 0, 0, 13107, 0, 0, 0, 65535}, Filter::linear, Wrap::repeat));
  EXPECT_NEAR(alpha_of_material(b.scene(), m).least, 0.1f, 1e-6f);
  Primitive p = quad(vec3(0.0f), {1, 0, 0}, {0, 1, 0});
  EXPECT_EQ(alpha_of_vertices(p).least, 1.0f);
  p.colors = {vec4(1.0f), vec4(1.0f), {1, 1, 1, 0.2f}, vec4(1.0f)};
  EXPECT_EQ(alpha_of_vertices(p).least, 0.2f);
  EXPECT_EQ(alpha_of_vertices(p).most, 1.0f);
}

TEST(unit_raster_opacity, what_cannot_be_missing_is_opaque) {
  Material m;
  EXPECT_EQ(drawn_mode(m, {0.0f, 0.1f}), AlphaMode::opaque);
  m.alpha_mode = AlphaMode::blend;
  EXPECT_EQ(drawn_mode(m, {1.0f, 1.0f}), AlphaMode::opaque);
  EXPECT_EQ(drawn_mode(m, {254.0f / 255.0f, 1.0f}), AlphaMode::blend);
  m.alpha_mode = AlphaMode::mask;
  m.alpha_cutoff = 128.0f / 255.0f;
  EXPECT_EQ(drawn_mode(m, {128.0f / 255.0f, 1.0f}), AlphaMode::opaque);
  EXPECT_EQ(drawn_mode(m, {127.0f / 255.0f, 1.0f}), AlphaMode::mask);
  m.alpha_cutoff = 0.0f;
  EXPECT_EQ(drawn_mode(m, {0.0f, 1.0f}), AlphaMode::opaque);
}

TEST(unit_raster_opacity, the_mean_is_over_the_surface) {
  SceneBuilder b;
  Material m = matte(vec3(1.0f));
  Primitive p = quad(vec3(0.0f), {1, 0, 0}, {0, 1, 0});
  m.opacity = 0.4f;
  EXPECT_EQ(mean_opacity(b.scene(), p, m), 1.0f);
  m.alpha_mode = AlphaMode::blend;
  EXPECT_NEAR(mean_opacity(b.scene(), p, m), 0.4f, 1e-5f);
  m.opacity = 1.0f;
  p.colors = {vec4(1.0f), {1, 1, 1, 0}, {1, 1, 1, 0}, vec4(1.0f)};  // from left to right
  EXPECT_NEAR(mean_opacity(b.scene(), p, m), 0.5f, 1e-3f);
  m.alpha_mode = AlphaMode::mask, m.alpha_cutoff = 0.75f;
  EXPECT_NEAR(mean_opacity(b.scene(), p, m), 0.25f, 0.02f);
  p.colors.clear();
  m.alpha_mode = AlphaMode::blend;
  m.base_color_texture = slot(b.add_texture(4, 1, {0, 0, 0, 255, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, Filter::nearest));
  EXPECT_NEAR(mean_opacity(b.scene(), p, m), 0.25f, 0.02f);
  m.base_color_texture.transform[0] = {0.25f, 0.0f};  // the first texel alone
  EXPECT_NEAR(mean_opacity(b.scene(), p, m), 1.0f, 1e-5f);
}

}  // namespace
}  // namespace candela::raster
