#include "raster/glow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "unit/path/scenes.h"

namespace candela::raster {
namespace {

using namespace test;

Primitive joined(Primitive a, const Primitive& b) {
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  a.normals.insert(a.normals.end(), b.normals.begin(), b.normals.end());
  a.uvs[0].insert(a.uvs[0].end(), b.uvs[0].begin(), b.uvs[0].end());
  for (const uvec3& t : b.triangles) a.triangles.push_back(t + first);
  return a;
}

/// u to the right, v up, as quad() has its corners.
Primitive square_with_uvs() {
  Primitive p = quad(vec3(0.0f), {1, 0, 0}, {0, 1, 0});
  p.uvs[0].clear();
  for (const vec3& at : p.positions) p.uvs[0].emplace_back(at);
  return p;
}

TEST(unit_raster_glow, what_sends_out_nothing_has_no_part) {
  const Scene scene;
  const Primitive square = square_with_uvs();
  EXPECT_TRUE(glowing_parts(scene, square, matte(vec3(0.8f))).empty());
  Material sign = lamp(vec3(1.0f));
  sign.unlit = true;
  EXPECT_TRUE(glowing_parts(scene, square, sign).empty()) << "it lights nothing";
  EXPECT_TRUE(glowing_parts(scene, moved(quad(vec3(0.0f), {1, 0, 0}, {1, 0, 0}), vec3(0.0f)), lamp(vec3(1.0f))).empty())
      << "it has no area";
}

TEST(unit_raster_glow, what_hangs_together_is_one_part) {
  const Scene scene;
  const Primitive square = square_with_uvs();
  const std::vector<GlowingPart> one = glowing_parts(scene, square, lamp({1, 2, 3}));
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].triangles.size(), 2u);
  EXPECT_LT(glm::distance(one[0].emission, vec3(1, 2, 3)), 1e-5f);
  EXPECT_FLOAT_EQ(one[0].share, 1.0f);
  // Side by side they are one, whatever their vertices' numbers; apart they are two.
  EXPECT_EQ(glowing_parts(scene, joined(square, moved(square, {1, 0, 0})), lamp(vec3(1.0f))).size(), 1u);
  const std::vector<GlowingPart> two = glowing_parts(scene, joined(square, moved(square, {3, 0, 0})), lamp(vec3(1.0f)));
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0].triangles, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(two[1].triangles, (std::vector<std::uint32_t>{2, 3}));
}

TEST(unit_raster_glow, a_texture_says_how_much) {
  SceneBuilder b;
  Material painted = lamp(vec3(4.0f));
  // Left black, right white.
  painted.emissive_texture = slot(b.add_texture(2, 1, {0, 0, 0, 255, 255, 255, 255, 255}, Filter::nearest));
  Primitive square = square_with_uvs();
  for (vec2& uv : square.uvs[0]) uv.x = 0.75f;
  std::vector<GlowingPart> parts = glowing_parts(b.scene(), square, painted);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_NEAR(parts[0].emission.x, 4.0f, 1e-4f);
  for (vec2& uv : square.uvs[0]) uv.x = 0.25f;
  EXPECT_TRUE(glowing_parts(b.scene(), square, painted).empty());
}

TEST(unit_raster_glow, what_is_cut_out_or_let_through_is_not_there) {
  SceneBuilder b;
  Material veil = lamp(vec3(2.0f));
  veil.alpha_mode = AlphaMode::blend;
  veil.opacity = 0.25f;
  const Primitive square = square_with_uvs();
  std::vector<GlowingPart> parts = glowing_parts(b.scene(), square, veil);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_NEAR(parts[0].share, 0.25f, 1e-5f);
  EXPECT_NEAR(parts[0].emission.x, 2.0f, 1e-4f) << "of what is there";
  veil.alpha_mode = AlphaMode::mask;
  veil.alpha_cutoff = 0.5f;
  EXPECT_TRUE(glowing_parts(b.scene(), square, veil).empty());
  veil.alpha_cutoff = 0.2f;
  parts = glowing_parts(b.scene(), square, veil);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_FLOAT_EQ(parts[0].share, 1.0f);
}

TEST(unit_raster_glow, a_ring_is_parted_so_that_its_parts_are_compact) {
  // Four bars around a hole.
  Primitive frame = quad({0, 0, 0}, {10, 0, 0}, {0, 1, 0});
  for (const auto& [corner, a, c] : {std::tuple{vec3(0, 9, 0), vec3(10, 0, 0), vec3(0, 1, 0)},
                                     std::tuple{vec3(0, 1, 0), vec3(1, 0, 0), vec3(0, 8, 0)},
                                     std::tuple{vec3(9, 1, 0), vec3(1, 0, 0), vec3(0, 8, 0)}}) {
    frame = joined(frame, quad(corner, a, c));
  }
  const Scene scene;
  const std::vector<GlowingPart> parts = glowing_parts(scene, frame, lamp(vec3(1.0f)));
  EXPECT_GT(parts.size(), 1u);
  std::vector<std::uint32_t> all;
  for (const GlowingPart& part : parts) all.insert(all.end(), part.triangles.begin(), part.triangles.end());
  std::sort(all.begin(), all.end());
  EXPECT_EQ(all, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7})) << "each triangle is in one part";
}

}  // namespace
}  // namespace candela::raster
