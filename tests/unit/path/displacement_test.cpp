#include "path/displacement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/path/scenes.h"

// Relief as geometry: what a height map says of a plane can be worked out by hand.

namespace candela::path {
namespace {

using namespace test;

constexpr int kTexels = 32;

/// A plane two metres wide whose height rises by `rise` from u = 0 to u = 1 along +x.
struct Ramp {
  Scene scene;
  Primitive relief;

  Ramp(float rise, bool has_normal_map) {
    SceneBuilder b;
    std::vector<std::uint16_t> heights;
    for (int y = 0; y < kTexels; ++y) {
      for (int x = 0; x < kTexels; ++x) {
        const auto h = static_cast<std::uint16_t>(65535.0f * (static_cast<float>(x) + 0.5f) / kTexels);
        heights.insert(heights.end(), {h, h, h, 65535});
      }
    }
    Material m = matte(vec3(0.5f));
    m.height_texture = slot(b.add_texture_16(kTexels, kTexels, heights, Filter::linear, Wrap::clamp_to_edge));
    if (has_normal_map) m.normal_texture = slot(b.add_texture(1, 1, {128, 128, 255, 255}));
    m.height_scale = rise;
    m.height_level = 0.5f;
    b.add(plane(vec3(0.0f), 1.0f), m);
    scene = b.build();
    const TextureReader reader(scene, scene.materials.back().height_texture, Encoding::data);
    relief = displaced(scene.meshes[0].primitives[0], scene.materials.back(), reader);
  }
};

TEST(unit_path_displacement, vertices_move_along_the_normal_by_the_height) {
  const Ramp ramp(0.4f, false);
  ASSERT_GT(ramp.relief.positions.size(), 500u);
  for (std::size_t i = 0; i < ramp.relief.positions.size(); ++i) {
    const float u = ramp.relief.uvs[0][i].x;
    if (u < 1.0f / kTexels || u > 1.0f - 1.0f / kTexels) continue;  // clamped beyond the middle of the last texel
    EXPECT_NEAR(ramp.relief.positions[i].y, 0.4f * (u - 0.5f), 2e-5f);
  }
}

TEST(unit_path_displacement, places_of_the_relief_are_found_in_the_primitive_that_it_was_made_of) {
  // A flat relief: every place is where it was.
  Primitive flat;
  flat.positions = {{0, 0, 0}, {4, 1, 0}, {1, 3, 2}, {5, 5, 5}};
  flat.normals.assign(4, vec3(0, 1, 0));
  flat.uvs[0] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
  flat.triangles = {{0, 1, 2}, {1, 3, 2}};
  SceneBuilder b;
  Material material = matte(vec3(0.5f));
  material.height_scale = 0.0f;
  material.height_texture = slot(b.add_texture(5, 5, std::vector<std::uint8_t>(100, 128)));
  b.add(flat, material);
  const Scene scene = b.build();
  const TextureReader reader(scene, material.height_texture, Encoding::data);
  const Primitive fine = displaced(flat, material, reader);
  const int n = divisions_of(flat.triangles.size(), fine.triangles.size());
  ASSERT_GT(n, 2);
  ASSERT_EQ(fine.triangles.size(), flat.triangles.size() * static_cast<std::size_t>(n * n));
  const auto at = [](const Primitive& p, std::uint32_t triangle, vec2 u) {
    const uvec3 t = p.triangles[triangle];
    return p.positions[t.x] * (1.0f - u.x - u.y) + p.positions[t.y] * u.x + p.positions[t.z] * u.y;
  };
  const vec2 place(0.2f, 0.7f);
  for (std::uint32_t i = 0; i < fine.triangles.size(); ++i) {
    const UndividedPlace found = undivided({i, place}, n);
    EXPECT_LT(glm::distance(at(flat, found.triangle, found.barycentric), at(fine, i, place)), 1e-5f) << i;
  }
}

TEST(unit_path_displacement, it_is_as_fine_as_the_texture) {
  const Ramp ramp(0.4f, false);
  const auto n = static_cast<std::size_t>(std::ceil(kTexels * std::sqrt(2.0f)));
  EXPECT_EQ(ramp.relief.triangles.size(), 2 * n * n);
}

TEST(unit_path_displacement, normals_lean_by_the_slope_unless_a_map_tells_of_it) {
  const Ramp ramp(0.4f, false), mapped(0.4f, true);
  // 0.4 m of height over 2 m; which way u runs is the mesh's.
  const vec2 along = ramp.relief.uvs[0][1] - ramp.relief.uvs[0][0];
  const vec3 there = ramp.relief.positions[1] - ramp.relief.positions[0];
  ASSERT_NE(along.x, 0.0f);
  const float slope = 0.4f / 2.0f * (along.x * there.x > 0.0f ? 1.0f : -1.0f);
  const vec3 expected = glm::normalize(vec3(-slope, 1.0f, 0.0f));
  int compared = 0;
  for (std::size_t i = 0; i < ramp.relief.normals.size(); ++i) {
    const vec2 uv = ramp.relief.uvs[0][i];
    EXPECT_EQ(mapped.relief.normals[i], vec3(0, 1, 0));
    if (uv.x < 0.1f || uv.x > 0.9f) continue;
    EXPECT_LT(glm::distance(ramp.relief.normals[i], expected), 2e-3f) << uv.x;
    ++compared;
  }
  EXPECT_GT(compared, 400);
}

TEST(unit_path_displacement, light_falls_on_the_slope) {
  const Ramp ramp(1.0f, false);
  Scene flat = ramp.scene;
  flat.materials.back().height_texture = {};
  const View view = look_at({0, 5, 0.01f}, vec3(0.0f), 0.2f);
  Scene lit = ramp.scene;
  for (Scene* scene : {&lit, &flat}) {
    scene->lights.push_back(sunlight(vec3(1.0f), kPi));
    Node node;
    node.light = static_cast<int>(scene->lights.size()) - 1;
    node.parent_from_node = aimed({0, 5, 0}, vec3(0.0f));
    scene->nodes.push_back(node);
    update_world_transforms(*scene);
  }
  const double on_slope = mean_luminance(shoot(lit, dark_environment(), view, settings(8, 16, 1)).beauty);
  const double on_flat = mean_luminance(shoot(flat, dark_environment(), view, settings(8, 16, 1)).beauty);
  // One metre over two: the cosine of 26.6 degrees.
  EXPECT_NEAR(on_slope / on_flat, std::cos(std::atan(0.5)), 0.01);
}

}  // namespace
}  // namespace candela::path
