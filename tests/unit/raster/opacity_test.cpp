#include "raster/opacity.h"

#include <gtest/gtest.h>

#include "unit/path/scenes.h"

namespace candela::raster {
namespace {

using namespace test;

TEST(unit_raster_opacity, ranges_are_products_of_factor_texture_and_vertices) {
  SceneBuilder b;
  b.add_texture(2, 1, {0, 0, 0, 51, 0, 0, 0, 255});
  const AlphaRange of_bytes = alpha_of_image(*b.scene().images.back());
  EXPECT_NEAR((AlphaRange{0.5f, 0.5f} * of_bytes).least, 0.1f, 1e-6f);
  EXPECT_EQ((AlphaRange{0.5f, 0.5f} * of_bytes).most, 0.5f);
  b.add_texture_16(2, 1, {0, 0, 0, 13107, 0, 0, 0, 65535}, Filter::linear, Wrap::repeat);
  EXPECT_NEAR(alpha_of_image(*b.scene().images.back()).least, 0.2f, 1e-6f);
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

}  // namespace
}  // namespace candela::raster
