#include "scene/surface_layers.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "base/error.h"
#include "scene/posed_camera.h"

namespace candela {
namespace {

/// A triangle in the plane z = 0, at a node that stands at `at`.
Scene triangle_scene(vec3 at) {
  Scene scene;
  scene.materials.resize(3);
  scene.materials[2].file_index = 11;
  Primitive p;
  p.positions = {{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}};
  p.normals.assign(3, vec3(0, 0, 1));
  p.uvs[0] = {{0, 0}, {1, 0}, {0, 1}};
  p.triangles = {{0, 1, 2}};
  p.material = 2;
  scene.meshes.resize(1);
  scene.meshes[0].primitives = {p};
  scene.meshes[0].file_index = 4;
  scene.nodes.resize(2);
  scene.nodes[1].mesh = 0;
  scene.nodes[1].file_index = 7;
  scene.nodes[1].parent_from_node[3] = vec4(at, 1.0f);
  update_world_transforms(scene);
  return scene;
}

SurfaceMap map_of(const Scene& scene, vec2 barycentric) {
  SurfaceMap map(2, 1);
  map.at(0, 0) = {1, 0, 0, barycentric, position_at(scene, 1, 0, 0, barycentric), uv_at(scene, 1, 0, 0, barycentric)};
  return map;
}

TEST(unit_scene_surface_layers, depth_is_along_the_axis_and_distance_along_the_ray) {
  const Scene scene = triangle_scene({0, 0, -4});
  View view;
  view.projection = PerspectiveCamera();
  std::set<Layer> layers;
  for (const LayerInfo& info : kLayers) layers.insert(info.layer);
  Film film;
  add_surface_layers(scene, view, map_of(scene, {0.5f, 0.25f}), layers, film);
  const auto at = [&](Layer layer, int x) { return film.layers.at(layer).at(x, 0); };
  EXPECT_EQ(film.layers.size(), 9u) << "all without a mean but motion";
  EXPECT_FLOAT_EQ(at(Layer::depth, 0)[0], 4.0f);
  EXPECT_FLOAT_EQ(at(Layer::distance, 0)[0], std::sqrt(1.0f + 16.0f));
  EXPECT_EQ(film.layers.at(Layer::position).rgb(0, 0), vec3(1, 0, -4));
  EXPECT_EQ(at(Layer::uv, 0)[0], 0.5f);
  EXPECT_EQ(at(Layer::uv, 0)[1], 0.25f);
  EXPECT_EQ(at(Layer::object_id, 0)[0], 8.0f);
  EXPECT_EQ(at(Layer::instance, 0)[0], 2.0f);
  EXPECT_EQ(at(Layer::mesh, 0)[0], 5.0f);
  EXPECT_EQ(at(Layer::material, 0)[0], 12.0f);
  EXPECT_EQ(at(Layer::face, 0)[0], 1.0f);
  EXPECT_EQ(at(Layer::depth, 1)[0], kInfinity);
  EXPECT_EQ(at(Layer::material, 1)[0], 0.0f);
  // The camera turned about its own axis, and one whose axis is not in the middle, see the same depth.
  view = view_of_matrix({.k = {100, 0, 0, 3, 90, 0, 40, 10, 1}, .size = {64, 48}}, mat4(1.0f));
  add_surface_layers(scene, view, map_of(scene, {0.5f, 0.25f}), layers, film);
  EXPECT_NEAR(at(Layer::depth, 0)[0], 4.0f, 1e-5f);
  view.projection = OrthographicCamera{};
  add_surface_layers(scene, view, map_of(scene, {0.5f, 0.25f}), layers, film);
  EXPECT_NEAR(at(Layer::distance, 0)[0], 4.0f, 1e-5f) << "rays are parallel";
}

TEST(unit_scene_surface_layers, motion_is_where_the_surface_will_be_in_pixels) {
  const Scene before = triangle_scene({0, 0, -4}), after = triangle_scene({0.5f, 0.25f, -4});
  View view;
  view.projection = OrthographicCamera{.xmag = 4.0f, .ymag = 2.0f};
  const SurfaceMap map = map_of(before, {0.5f, 0.25f});
  const Image motion = motion_layer(before, view, map, after, view);
  EXPECT_FLOAT_EQ(motion.at(0, 0)[0], 0.5f / 8.0f * 2.0f);  // two pixels for eight metres
  EXPECT_FLOAT_EQ(motion.at(0, 0)[1], -0.25f / 4.0f);       // down
  EXPECT_EQ(motion.at(1, 0)[0], 0.0f) << "where nothing is";
  // A camera that moves with it sees it rest; one that moves alone sees it move the other way.
  View moved = view;
  moved.world_from_camera[3] = vec4(0.5f, 0.25f, 0, 1);
  EXPECT_NEAR(motion_layer(before, view, map, after, moved).at(0, 0)[0], 0.0f, 1e-6f);
  EXPECT_FLOAT_EQ(motion_layer(before, view, map, before, moved).at(0, 0)[0], -0.125f);
  // What the other moment has not, and what has gone behind the eye, does not move.
  Scene gone = after;
  gone.nodes[1].mesh = -1;
  EXPECT_EQ(motion_layer(before, view, map, gone, view).at(0, 0)[0], 0.0f);
  view.projection = PerspectiveCamera{};
  EXPECT_EQ(motion_layer(before, view, map, triangle_scene({1, 0, 9}), view).at(0, 0)[0], 0.0f);
}

TEST(unit_scene_surface_layers, normals_turn_into_the_cameras_axes) {
  const View view = look_at({5, 0, 0}, vec3(0.0f), 1.0f);
  Image normals(2, 1, 3);
  normals.set_rgb(0, 0, {1, 0, 0});
  normals.set_rgb(1, 0, {0, 0, -1});
  turn_to_camera(view, normals);
  EXPECT_LT(glm::distance(normals.rgb(0, 0), vec3(0, 0, 1)), 1e-6f) << "towards the viewer";
  EXPECT_LT(glm::distance(normals.rgb(1, 0), vec3(1, 0, 0)), 1e-6f) << "to the right";
}

TEST(unit_scene_surface_layers, names_of_mattes_tell_everything_apart) {
  Scene scene;
  scene.nodes.resize(6);
  const std::array<const char*, 6> names = {"leg", "leg", "", "hidden", "leg.1", ""};
  for (std::size_t i = 0; i < 6; ++i) scene.nodes[i].name = names[i], scene.nodes[i].mesh = i == 3 ? -1 : 0;
  scene.nodes[5].file_index = 2;  // as of an instance
  const auto found = matte_names(scene, MatteKind::object);
  EXPECT_EQ(found.size(), 5u);
  EXPECT_EQ(found.at(0), "leg.0");
  EXPECT_EQ(found.at(1), "leg.1");
  EXPECT_EQ(found.at(2), "node 2");
  std::set<std::string> all;
  for (const auto& [number, name] : found) all.insert(name);
  EXPECT_EQ(all.size(), 5u);
}

TEST(unit_scene_surface_layers, a_number_that_no_float_holds_is_refused) {
  Scene scene = triangle_scene(vec3(0.0f));
  scene.nodes[1].file_index = 1 << 24;
  EXPECT_NO_THROW(check_numbers(scene, {Layer::instance, Layer::face}));
  try {
    check_numbers(scene, {Layer::object_id});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(error.message().find("\"id\" has numbers up to 16777217"), std::string::npos) << error.message();
  }
}

}  // namespace
}  // namespace candela
