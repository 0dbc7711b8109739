#include "candela/dataset.h"

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "scene/posed_camera.h"
#include "unit/base/temp_folder.h"
#include "unit/path/scenes.h"

namespace candela {
namespace {

using namespace test;
using Json = nlohmann::json;

Json json_of(const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = read_file(path);
  return Json::parse(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

std::vector<vec3> ply_of(const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = read_file(path);
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t body = text.find("end_header\n") + 11, at = text.find("element vertex ") + 15;
  std::vector<vec3> points(std::stoul(text.substr(at)));
  for (std::size_t i = 0; i < points.size(); ++i) std::memcpy(&points[i], text.data() + body + 24 * i, sizeof(vec3));
  return points;
}

dvec3 row_times(const Json& rows, dvec3 p) {
  dvec3 q(0.0);
  for (int i = 0; i < 9; ++i) q[i / 3] += rows.at(static_cast<std::size_t>(i)).get<double>() * p[i % 3];
  return q;
}

TEST(unit_candela_dataset, bop_has_models_with_the_scale_and_poses_without) {
  // One mesh three times: stretched and mirrored, stretched alike elsewhere, and as it is.
  SceneBuilder b;
  const int mesh = b.add_mesh(box({-0.2f, -0.3f, -0.1f}, {0.4f, 0.1f, 0.2f}), b.add_material(matte(vec3(0.5f))));
  const mat4 stretch = scaling({2.0f, 1.0f, -0.5f});
  b.add_node(mesh, translation({-0.8f, 0.1f, 0}) * rotation({0, 1, 0.2f}, 0.7f) * stretch);
  b.add_node(mesh, translation({0.9f, -0.2f, 0.3f}) * rotation({1, 0.3f, 0}, -1.1f) * stretch);
  b.add_node(mesh, translation({0.1f, 0.5f, 0.1f}));
  Scene scene = b.build();
  for (Node& node : scene.nodes) node.parent_from_node = node.world_from_node;
  TakenPicture picture;
  picture.view = look_at({0.3f, 0.4f, 4}, vec3(0.0f), 0.7f);
  path::Settings s = settings(48, 1, 1);
  s.layers = {Layer::instance, Layer::depth};
  s.has_masks = true;
  picture.film = shoot(scene, dark_environment(), picture.view, s);
  picture.scene = std::make_shared<const Scene>(scene);
  const TempFolder folder;
  Dataset dataset(DatasetKind::bop, folder / "set", InstanceKind::node);
  EXPECT_EQ(dataset.pattern(3, 9, "ignored", true), folder / "set/train_pbr/000003/rgb/%06d.png");
  dataset.add(picture, dataset.pattern(0, 1, "", false), 0, "");
  dataset.finish();
  const auto place = folder / "set/train_pbr/000000";
  const Json truth = json_of(place / "scene_gt.json").at("0"), camera = json_of(place / "scene_camera.json").at("0");
  ASSERT_EQ(truth.size(), 3u);
  EXPECT_EQ(truth[0].at("obj_id"), truth[1].at("obj_id"));
  EXPECT_NE(truth[0].at("obj_id"), truth[2].at("obj_id"));
  EXPECT_EQ(json_of(folder / "set/models/models_info.json").size(), 2u);
  const RigidCamera rigid = matrix_of_view(picture.view, {48, 48});
  const glm::dmat4 camera_from_world = glm::inverse(rigid.world_from_camera);
  const std::vector<vec3>& positions = scene.meshes[0].primitives[0].positions;
  for (std::size_t k = 0; k < 3; ++k) {
    const Json& pose = truth[k];
    const dvec3 x = row_times(pose.at("cam_R_m2c"), {1, 0, 0}), y = row_times(pose.at("cam_R_m2c"), {0, 1, 0}),
                z = row_times(pose.at("cam_R_m2c"), {0, 0, 1});
    EXPECT_LT(glm::distance(glm::cross(x, y), z), 1e-5) << "a rotation";
    EXPECT_NEAR(glm::length(x), 1.0, 1e-5);
    const std::string name = "set/models/obj_00000" + std::to_string(pose.at("obj_id").get<int>()) + ".ply";
    const std::vector<vec3> model = ply_of(folder / name);
    ASSERT_EQ(model.size(), positions.size());
    const Json& t = pose.at("cam_t_m2c");
    for (std::size_t i = 0; i < model.size(); ++i) {
      const dvec3 found = row_times(pose.at("cam_R_m2c"), dvec3(model[i])) + dvec3(t[0], t[1], t[2]);
      const dvec3 p(camera_from_world * glm::dvec4(transform_point(scene.nodes[k].world_from_node, positions[i]), 1.0));
      EXPECT_LT(glm::distance(found, 1e3 * dvec3(p.x, -p.y, -p.z)), 1e-2) << k << ", a point in millimetres";
    }
  }
  EXPECT_NEAR(camera.at("cam_K")[2].get<double>(), 23.5, 1e-4) << "the middle of the first pixel is 0";
}

TEST(unit_candela_dataset, a_scene_may_be_one_object) {
  SceneBuilder b;
  b.add(box(vec3(-1.0f), vec3(0.0f)), matte(vec3(0.5f)));
  b.add(box(vec3(0.0f), vec3(1.0f)), matte(vec3(0.5f)));
  const Scene scene = b.build();
  const std::vector<Instance> nodes = instances_of(scene, InstanceKind::node, "pair");
  ASSERT_EQ(nodes.size(), 2u);
  EXPECT_EQ(nodes[1].number, 2u);
  const std::vector<Instance> whole = instances_of(scene, InstanceKind::scene, "pair");
  ASSERT_EQ(whole.size(), 1u);
  EXPECT_EQ(whole[0].category, "pair");
  EXPECT_EQ(whole[0].nodes, (std::vector<int>{0, 1}));
}

}  // namespace
}  // namespace candela
