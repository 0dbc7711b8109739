#include "check/check_samples.h"

#include <gmock/gmock.h>

#include <cstring>

namespace candela::check {
namespace {

/// Two triangles of area 1 and 3 with one material in one mesh, shown by nodes of the given scales.
Scene two_triangles(const std::vector<float>& scales) {
  Scene scene;
  scene.materials.resize(2);
  Primitive p;
  p.positions = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {10, 0, 0}, {12, 0, 0}, {10, 3, 0}};
  p.normals.assign(6, vec3(0, 0, 1));
  p.normals[3] = p.normals[4] = p.normals[5] = vec3(0, 0, -1);
  p.uvs[0] = {{0, 0}, {1, 0}, {0, 1}, {0, 0}, {1, 0}, {0, 1}};
  p.triangles = {{0, 1, 2}, {3, 4, 5}};
  scene.meshes.push_back({"", {p}});
  for (const float scale : scales) {
    Node node;
    node.mesh = 0;
    node.world_from_node = mat4(scale);
    node.world_from_node[3][3] = 1.0f;
    scene.nodes.push_back(node);
  }
  return scene;
}

TEST(unit_check_material_surface, points_are_spread_by_area) {
  const Scene scene = two_triangles({1});
  const std::vector<MaterialSurface> surfaces = material_surfaces(scene);
  ASSERT_EQ(surfaces.size(), 2);
  EXPECT_TRUE(surfaces[1].empty());
  EXPECT_NEAR(surfaces[0].area(), 4, 1e-6);
  constexpr std::uint32_t kPoints = 1024;
  std::uint32_t in_second = 0, turned = 0;
  dvec2 mean(0);
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    const SurfaceSample s = surfaces[0].sample(i);
    in_second += s.triangle.x == 3 ? 1 : 0;
    turned += s.is_normal_turned() ? 1 : 0;
    mean += dvec2(s.uv(0)) / double(kPoints);
    EXPECT_NEAR(s.barycentric.x + s.barycentric.y + s.barycentric.z, 1, 1e-6);
  }
  EXPECT_NEAR(in_second, 0.75 * kPoints, 4);
  EXPECT_EQ(turned, in_second);
  // Centroids of the uv triangles.
  EXPECT_NEAR(mean.x, 1.0 / 3, 0.01);
  EXPECT_NEAR(mean.y, 1.0 / 3, 0.01);
}

TEST(unit_check_material_surface, instances_add_their_area) {
  EXPECT_NEAR(material_surfaces(two_triangles({1, 3, -2}))[0].area(), 4 * (1 + 9 + 4), 1e-4);
  EXPECT_TRUE(material_surfaces(two_triangles({}))[0].empty());
}

TEST(unit_check_material_surface, there_are_fewer_points_of_very_many_materials) {
  EXPECT_EQ(samples_per_material(1), 4096);
  EXPECT_EQ(samples_per_material(10000), 419);
  EXPECT_EQ(samples_per_material(1000000), 256);
}

/// 2 x 2 texels, red 0, 85, 170, 255 in reading order.
Scene four_texels(Wrap wrap, int bits) {
  Scene scene;
  auto image = std::make_shared<TextureImage>();
  image->width = image->height = 2;
  image->bits = bits;
  for (int i = 0; i < 4; ++i) {
    for (int c = 0; c < 4; ++c) {
      const auto code = static_cast<std::uint8_t>(c == 0 ? 85 * i : 0);
      image->pixels.insert(image->pixels.end(), static_cast<std::size_t>(bits / 8), code);
    }
  }
  scene.images.push_back(image);
  Texture texture;
  texture.image = 0;
  texture.wrap_u = texture.wrap_v = wrap;
  scene.textures.push_back(texture);
  return scene;
}

TEST(unit_check_texel_grid, wraps_as_the_sampler_says) {
  TextureSlot slot;
  slot.texture = 0;
  const auto red = [&](Wrap wrap, vec2 uv) {
    const Scene scene = four_texels(wrap, 8);
    const TexelGrid grid(scene, 0);
    return grid.rgb(grid.texel_at(slot, uv)).x * 3;
  };
  EXPECT_NEAR(red(Wrap::repeat, {0.75f, 0.25f}), 1, 1e-6);
  EXPECT_NEAR(red(Wrap::repeat, {0.25f, 0.75f}), 2, 1e-6);
  EXPECT_NEAR(red(Wrap::repeat, {1.25f, -0.25f}), 2, 1e-6);
  EXPECT_NEAR(red(Wrap::clamp_to_edge, {1.25f, -0.25f}), 1, 1e-6);
  EXPECT_NEAR(red(Wrap::mirrored_repeat, {1.25f, -0.25f}), 1, 1e-6);
  EXPECT_NEAR(red(Wrap::mirrored_repeat, {1.75f, -0.75f}), 2, 1e-6);
  slot.transform[2] = vec2(0.5f, 0.0f);
  EXPECT_NEAR(red(Wrap::repeat, {0.25f, 0.25f}), 1, 1e-6);
}

TEST(unit_check_texel_grid, sixteen_bits_are_the_same_codes) {
  const Scene narrow = four_texels(Wrap::repeat, 8), wide = four_texels(Wrap::repeat, 16);
  for (int i = 0; i < 4; ++i) {
    const ivec2 at(i % 2, i / 2);
    EXPECT_EQ(TexelGrid(narrow, 0).rgb(at).x, TexelGrid(wide, 0).rgb(at).x);
  }
}

}  // namespace
}  // namespace candela::check
