#include "raster/gpu_scene.h"

#include <gtest/gtest.h>

#include "shade/surface_params.glsl.h"
#include "unit/gl/gl_fixture.h"
#include "unit/path/scenes.h"

// A moment of a scene costs the driver what differs from the one before.

namespace candela::raster {
namespace {

using namespace test;

class unit_raster_gpu_scene : public WithGl {  // NOLINT(readability-identifier-naming): as its tests
 protected:
  Diagnostics diagnostics_;
};

/// A textured quad and a plain one, both known again by their identity.
Scene two_quads() {
  SceneBuilder b;
  Material textured = matte(vec3(1.0f));
  textured.alpha_mode = AlphaMode::blend;
  textured.base_color_texture = slot(b.add_texture(2, 1, {0, 0, 0, 51, 0, 0, 0, 255}));
  b.add(quad(vec3(0.0f), {1, 0, 0}, {0, 1, 0}), textured);
  b.add(quad({2, 0, 0}, {1, 0, 0}, {0, 1, 0}), matte(vec3(0.5f)));
  Scene scene = b.build();
  for (Mesh& mesh : scene.meshes) mesh.identity = std::make_shared<const char>();
  return scene;
}

TEST_F(unit_raster_gpu_scene, what_stays_is_not_uploaded_again) {
  const Scene rest = two_quads();
  GpuScene gpu(rest, shade::shading_model_candela(), diagnostics_);
  const auto buffers = [&] {
    std::vector<GLuint> names;
    for (const GpuPrimitive& p : gpu.primitives()) names.push_back(p.vertices);
    return names;
  };
  const std::vector<GLuint> before = buffers();
  const auto textures = gpu.material_of(gpu.draws()[0]).textures;
  Scene moment = rest;
  moment.materials[0].base_color = vec3(0.25f);
  moment.materials[0].base_color_texture.transform[2] = vec2(0.5f);
  moment.materials[1].clearcoat = 1.0f;
  gpu.set_scene(moment, diagnostics_);
  EXPECT_EQ(buffers(), before);
  EXPECT_EQ(gpu.material_of(gpu.draws()[0]).textures, textures);
  EXPECT_FALSE(gpu.material_of(gpu.draws()[0]).key.is_plain_uv);
  EXPECT_TRUE(gpu.has_lobe(shade::kLobeClearcoat)) << "what a moment adds is drawn";
  gpu.set_scene(rest, diagnostics_);
  EXPECT_FALSE(gpu.has_lobe(shade::kLobeClearcoat)) << "and gone with it";

  moment.meshes[0].identity = nullptr;
  moment.meshes[0].primitives[0].positions[0] = vec3(-1.0f);
  gpu.set_scene(moment, diagnostics_);
  EXPECT_EQ(gpu.primitives()[0].bounds.lower, vec3(-1.0f)) << "a mesh that nothing is known of is read";
  EXPECT_EQ(buffers()[1], before[1]);
}

TEST_F(unit_raster_gpu_scene, what_is_not_known_to_be_the_same_is_uploaded_and_what_is_hidden_is_not_drawn) {
  Scene scene = two_quads();
  GpuScene gpu(scene, shade::shading_model_candela(), diagnostics_);
  scene.meshes[1].identity = std::make_shared<const char>();
  scene.meshes[1].primitives[0] = moved(box(vec3(0.0f), vec3(1.0f)), {2, 0, 0});
  scene.meshes[1].primitives[0].material = 1;
  gpu.set_scene(scene, diagnostics_);
  EXPECT_EQ(gpu.primitives()[1].index_count, 36);
  ASSERT_EQ(gpu.draws().size(), 2u);
  scene.nodes[0].mesh = -1;
  gpu.set_scene(scene, diagnostics_);
  ASSERT_EQ(gpu.draws().size(), 1u);
  EXPECT_EQ(gpu.draws()[0].node, 1);
}

TEST_F(unit_raster_gpu_scene, textures_stay_when_others_come_and_go) {
  const Scene rest = two_quads();
  GpuScene gpu(rest, shade::shading_model_candela(), diagnostics_);
  const GLuint texture = gpu.material_of(gpu.draws()[0]).textures[base_color_slot];
  ASSERT_NE(texture, 0u);
  // Another image before it, as where a moment reads one that the last did not.
  Scene moment = rest;
  SceneBuilder other;
  other.add_texture(1, 1, {255, 0, 0, 255});
  moment.images.insert(moment.images.begin(), other.scene().images[0]);
  moment.textures.insert(moment.textures.begin(), other.scene().textures[0]);
  moment.textures[1].image = 1;
  moment.materials[0].base_color_texture.texture = 1;
  moment.materials[1].base_color_texture = slot(0);
  gpu.set_scene(moment, diagnostics_);
  EXPECT_EQ(gpu.material_of(gpu.draws()[0]).textures[base_color_slot], texture);
  const GLuint second = gpu.material_of(gpu.draws()[1]).textures[base_color_slot];
  EXPECT_NE(second, 0u);
  EXPECT_NE(second, texture);
}

TEST_F(unit_raster_gpu_scene, opacity_of_a_moment_decides_how_it_is_drawn) {
  SceneBuilder b;
  Material m = matte(vec3(1.0f));
  m.alpha_mode = AlphaMode::blend;
  b.add(quad(vec3(0.0f), {1, 0, 0}, {0, 1, 0}), m);
  Scene scene = b.build();
  GpuScene gpu(scene, shade::shading_model_candela(), diagnostics_);
  EXPECT_FALSE(gpu.material_of(gpu.draws()[0]).is_blended());
  scene.materials[0].opacity = 0.5f;
  gpu.set_scene(scene, diagnostics_);
  EXPECT_TRUE(gpu.material_of(gpu.draws()[0]).is_blended());
  scene.materials[0].opacity = 1.0f;
  gpu.set_scene(scene, diagnostics_);
  EXPECT_FALSE(gpu.material_of(gpu.draws()[0]).is_blended());
}

}  // namespace
}  // namespace candela::raster
