#include "raster/body.h"

#include <gtest/gtest.h>

#include "unit/path/scenes.h"

namespace candela::raster {
namespace {

using namespace test;

Material water() {
  Material m = plastic(vec3(1.0f), 0.0f);
  m.transmission = 1.0f, m.thickness = 1.0f;
  return m;
}

TEST(unit_raster_body, a_point_is_in_a_body_or_not) {
  SceneBuilder b;
  b.add(plane({0, -2, 0}, 5.0f), matte(vec3(1.0f)));
  const int node = b.add(sphere(vec3(0.0f), 1.0f, 2, false), water(), translation({2, 0, 0}) * scaling({-1, 1, 1}));
  const int material = b.scene()
                           .meshes[static_cast<std::size_t>(b.scene().nodes[static_cast<std::size_t>(node)].mesh)]
                           .primitives[0]
                           .material;
  const std::optional<Body> found = body_around(b.build(), {2.3f, 0.2f, 0.1f});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->material, material);
  EXPECT_LT(glm::distance(found->bounds.center(), vec3(2, 0, 0)), 1e-3f);
  EXPECT_NEAR(found->bounds.size().y, 2.0f, 0.2f);
  EXPECT_FALSE(body_around(b.build(), {0.0f, 0.0f, 0.0f}));
  EXPECT_FALSE(body_around(b.build(), {2.9f, 0.9f, 0.9f}));  // in its box
}

TEST(unit_raster_body, the_innermost_of_several_counts) {
  SceneBuilder b;
  b.add(sphere(vec3(0.0f), 2.0f, 2, false), water());
  const int inner = b.add(sphere(vec3(0.0f), 1.0f, 2, false), water());
  EXPECT_EQ(body_around(b.build(), vec3(0.1f))->material,
            b.scene().meshes[static_cast<std::size_t>(inner)].primitives[0].material);
  EXPECT_EQ(body_around(b.build(), {1.5f, 0, 0})->material, b.scene().meshes[0].primitives[0].material);
}

TEST(unit_raster_body, faces_of_other_materials_and_nodes_close_it_too) {
  SceneBuilder b;
  const Primitive cube = box(vec3(-1.0f), vec3(1.0f));
  for (const uvec3& t : cube.triangles) {
    Primitive face = cube;
    face.triangles = {t};
    b.add(face, water());
  }
  const std::optional<Body> of_faces = body_around(b.build(), vec3(0.2f));
  ASSERT_TRUE(of_faces);
  EXPECT_EQ(of_faces->bounds.size(), vec3(2.0f)) << "the box of all its faces";

  SceneBuilder lid;
  Primitive some = cube, rest = cube;
  // Four of six faces: what is left does not close by itself.
  rest.triangles.resize(8);
  some.triangles.erase(some.triangles.begin(), some.triangles.begin() + 8);
  const int mesh = lid.add_mesh(some, lid.add_material(water()));
  rest.material = lid.add_material(matte(vec3(1.0f)));
  lid.scene().meshes[static_cast<std::size_t>(mesh)].primitives.push_back(rest);
  lid.add_node(mesh);
  EXPECT_EQ(body_around(lid.build(), vec3(0.2f))->material, some.material);
}

TEST(unit_raster_body, a_room_with_windows_is_none) {
  SceneBuilder b;
  const int mesh = b.add_mesh(box(vec3(-2.0f), vec3(2.0f)), b.add_material(matte(vec3(1.0f))));
  Primitive pane = quad({-0.5f, -0.5f, 2.0f}, {1, 0, 0}, {0, 1, 0});
  pane.material = b.add_material(water());
  b.scene().meshes[static_cast<std::size_t>(mesh)].primitives.push_back(pane);
  b.add_node(mesh);
  EXPECT_FALSE(body_around(b.build(), vec3(0.0f)));
}

}  // namespace
}  // namespace candela::raster
