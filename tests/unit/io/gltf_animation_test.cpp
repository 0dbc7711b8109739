#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "unit/io/gltf_builder.h"

namespace candela::io::test {
namespace {

using ::testing::HasSubstr;

/// The triangle's node, moved by one channel.
Builder with_output(const char* path, const char* interpolation, const std::vector<float>& times,
                    const std::vector<float>& values, std::size_t components) {
  Builder b = triangle();
  const char* type = components == 1 ? "SCALAR" : components == 3 ? "VEC3" : "VEC4";
  const int input = b.floats(times, "SCALAR", 1), output = b.floats(values, type, components);
  b.root["accessors"][static_cast<std::size_t>(input)]["max"] = {times.back()};
  b.root["animations"] = {{{"name", "move"},
                           {"samplers", {{{"input", input}, {"output", output}, {"interpolation", interpolation}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}}}};
  return b;
}

Scene scene_at(const Builder& b, double time_s, const std::string& animation = {}) {
  Diagnostics diagnostics;
  GltfFile file(b.glb(), {}, "test", diagnostics);
  return file.scene(diagnostics, Pose{animation, time_s});
}

std::string pose_error(const Builder& b, const std::string& animation = {}) {
  try {
    scene_at(b, 0.5, animation);
    return "loaded";
  } catch (const Error& error) {
    return error.what();
  }
}

vec3 place_of(const Scene& scene) { return vec3(scene.nodes[0].world_from_node[3]); }

TEST(unit_io_gltf_animation, linear_keys_are_joined_by_straight_lines) {
  const Builder b = with_output("translation", "LINEAR", {1, 3}, {0, 0, 0, 4, 8, -2}, 3);
  EXPECT_EQ(place_of(scene_at(b, 1.5)), vec3(1, 2, -0.5f));
  EXPECT_EQ(place_of(scene_at(b, 0.0)), vec3(0, 0, 0)) << "before the first key";
  EXPECT_EQ(place_of(scene_at(b, 9.0)), vec3(4, 8, -2)) << "after the last";
}

TEST(unit_io_gltf_animation, steps_hold_until_the_next_key) {
  const Builder b = with_output("scale", "STEP", {0, 1, 2}, {1, 4, 7, 2, 5, 8, 3, 6, 9}, 3);
  const auto scale_at = [&](double t) {
    const mat4 m = scene_at(b, t).nodes[0].world_from_node;
    return vec3(m[0][0], m[1][1], m[2][2]);
  };
  EXPECT_EQ(scale_at(0.999), vec3(1, 4, 7));
  EXPECT_EQ(scale_at(1.0), vec3(2, 5, 8));
  EXPECT_EQ(scale_at(2.5), vec3(3, 6, 9));
}

TEST(unit_io_gltf_animation, rotations_turn_evenly_and_the_shorter_way) {
  // From 0 to 120 degrees about z, the second quaternion written as its negative.
  const float s = std::sin(kPi / 3), c = std::cos(kPi / 3);
  const Builder b = with_output("rotation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0, -s, -c}, 4);
  for (const double t : {0.25, 0.5, 0.75}) {
    const float angle = 2 * kPi / 3 * static_cast<float>(t);
    const vec4 x = scene_at(b, t).nodes[0].world_from_node[0];
    EXPECT_NEAR(x.x, std::cos(angle), 1e-5f);
    EXPECT_NEAR(x.y, std::sin(angle), 1e-5f);
  }
}

TEST(unit_io_gltf_animation, cubic_splines_follow_their_tangents) {
  // One axis holds 1 + 2t + t³ over a span of 2 s, which a cubic with the right tangents is exactly.
  const Builder b = with_output("translation", "CUBICSPLINE", {0, 2},
                                {0, 0, 0, 1, 0, 0, 2, 0, 0, /**/ 14, 0, 0, 13, 0, 0, 0, 0, 0}, 3);
  for (const float t : {0.3f, 1.0f, 1.7f}) EXPECT_NEAR(place_of(scene_at(b, t)).x, 1 + 2 * t + t * t * t, 1e-4f);
}

TEST(unit_io_gltf_animation, splines_of_rotations_stay_rotations) {
  // Half way between the two quaternions there is one that is shorter than 1.
  const float s = std::sin(kPi / 3), c = std::cos(kPi / 3);
  const Builder b = with_output("rotation", "CUBICSPLINE", {0, 1},
                                {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, /**/ 0, 0, 0, 0, 0, 0, s, c, 0, 0, 0, 0}, 4);
  const vec4 x = scene_at(b, 0.5).nodes[0].world_from_node[0];
  EXPECT_NEAR(x.x, std::cos(kPi / 3), 1e-5f);
  EXPECT_NEAR(x.y, std::sin(kPi / 3), 1e-5f);
}

TEST(unit_io_gltf_animation, nodes_with_a_matrix_rest) {
  Builder b = with_output("translation", "LINEAR", {0, 1}, {0, 0, 0, 4, 8, -2}, 3);
  b.root["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 7, 0, 0, 1};
  Diagnostics diagnostics;
  GltfFile file(b.glb(), {}, "test", diagnostics);
  EXPECT_EQ(place_of(file.scene(diagnostics, Pose{{}, 0.5})), vec3(7, 0, 0));
  ASSERT_FALSE(diagnostics.warnings().empty());
  EXPECT_THAT(diagnostics.warnings().back().message, HasSubstr("cannot be animated"));
}

TEST(unit_io_gltf_animation, weights_move_morph_targets) {
  Builder b = with_output("weights", "LINEAR", {0, 1}, {0, 1, 1, 0}, 1);
  const int up = b.vec3s({0, 0, 1, 0, 0, 1, 0, 0, 1}), right = b.vec3s({1, 0, 0, 1, 0, 0, 1, 0, 0});
  primitive(b)["targets"] = {{{"POSITION", up}}, {{"POSITION", right}}};
  const Scene scene = scene_at(b, 0.25);
  EXPECT_EQ(scene.meshes[0].primitives[0].positions[0], vec3(0.75f, 0, 0.25f));
}

TEST(unit_io_gltf_animation, joints_carry_skins_along) {
  Builder b = with_output("translation", "LINEAR", {0, 1}, {0, 0, 0, 0, 6, 0}, 3);
  const int joints = b.accessor(std::vector<std::uint8_t>(12, 0), "VEC4", 5121, 4);
  const int weights = b.vec4s({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  primitive(b)["attributes"]["JOINTS_0"] = joints;
  primitive(b)["attributes"]["WEIGHTS_0"] = weights;
  b.root["nodes"] = {json::object(), {{"mesh", 0}, {"skin", 0}}};
  b.root["scenes"][0]["nodes"] = {0, 1};
  b.root["skins"] = {{{"joints", {0}}}};
  EXPECT_EQ(scene_at(b, 0.5).meshes[0].primitives[0].positions[1], vec3(1, 3, 0));
}

TEST(unit_io_gltf_animation, one_is_chosen_by_name_or_index_or_all_play) {
  Builder b = with_output("translation", "LINEAR", {0, 1}, {0, 0, 0, 2, 0, 0}, 3);
  json second = b.root["animations"][0];
  second["name"] = "grow";
  second["channels"][0]["target"]["path"] = "scale";
  b.root["animations"].push_back(second);
  EXPECT_EQ(scene_at(b, 1.0).nodes[0].world_from_node[0][0], 1.0f) << "the first";
  EXPECT_EQ(scene_at(b, 1.0, "grow").nodes[0].world_from_node[0][0], 2.0f);
  EXPECT_EQ(scene_at(b, 1.0, "1").nodes[0].world_from_node[0][0], 2.0f);
  const Scene both = scene_at(b, 1.0, "all");
  EXPECT_EQ(both.nodes[0].world_from_node[0][0], 2.0f);
  EXPECT_EQ(place_of(both), vec3(2, 0, 0));
  EXPECT_THAT(pose_error(b, "fly"), HasSubstr("there is no animation 'fly'; the file has: move, grow"));
  EXPECT_THAT(pose_error(b, "1st"), HasSubstr("there is no animation '1st'"));
  EXPECT_THAT(pose_error(triangle(), "fly"), HasSubstr("the file has: none"));
  EXPECT_EQ(pose_error(triangle()), "loaded");
}

TEST(unit_io_gltf_animation, info_lists_them) {
  Builder b = with_output("translation", "LINEAR", {0, 2.5f}, {0, 0, 0, 2, 0, 0}, 3);
  const int shorter = b.floats({0, 1}, "SCALAR", 1);
  b.root["accessors"][static_cast<std::size_t>(shorter)]["max"] = {1};
  json sampler = b.root["animations"][0]["samplers"][0];
  sampler["input"] = shorter;
  b.root["animations"][0]["samplers"].push_back(sampler);
  Diagnostics diagnostics;
  const GltfFile file(b.glb(), {}, "test", diagnostics);
  ASSERT_EQ(file.info().animations.size(), 1u);
  EXPECT_EQ(file.info().animations[0].name, "move");
  EXPECT_EQ(file.info().animations[0].duration_s, 2.5f);
  EXPECT_EQ(file.info().animations[0].channels, 1);
}

TEST(unit_io_gltf_animation, a_file_is_the_same_at_rest_after_it_moved) {
  const Builder b = with_output("translation", "LINEAR", {0, 1}, {5, 0, 0, 6, 0, 0}, 3);
  Diagnostics diagnostics;
  GltfFile file(b.glb(), {}, "test", diagnostics);
  EXPECT_EQ(place_of(file.scene(diagnostics, Pose{{}, 1.0})), vec3(6, 0, 0));
  const Scene rest = file.scene(diagnostics);
  EXPECT_EQ(place_of(rest), vec3(0));
  EXPECT_EQ(rest.meshes[0].primitives[0].positions.size(), 3u);
}

TEST(unit_io_gltf_animation, bad_ones_are_errors) {
  EXPECT_THAT(pose_error(with_output("translation", "LINEAR", {1, 1}, {0, 0, 0, 1, 1, 1}, 3)),
              HasSubstr("must ascend"));
  EXPECT_THAT(pose_error(with_output("translation", "LINEAR", {-1, 1}, {0, 0, 0, 1, 1, 1}, 3)),
              HasSubstr("must ascend"));
  EXPECT_THAT(pose_error(with_output("translation", "LINEAR", {0, 1, 2}, {0, 0, 0, 1, 1, 1}, 3)),
              HasSubstr("2 numbers for each key of a translation"));
  EXPECT_THAT(pose_error(with_output("translation", "LINEAR", {0, 1}, {0, 0, 0, 1, 1, 1, 2, 2, 2}, 3)),
              HasSubstr("9 numbers do not fit 2 keys"));
  EXPECT_THAT(pose_error(with_output("translation", "CUBICSPLINE", {0, 1}, {0, 0, 0, 1, 1, 1}, 3)),
              HasSubstr("numbers for each key"));
  EXPECT_THAT(pose_error(with_output("translation", "LINEAR", {0, 1}, {0, 0, 0, 1, 1, 1, 1, 1}, 4)),
              HasSubstr("the accessor must be VEC3, not VEC4"));
  EXPECT_THAT(pose_error(with_output("translation", "BEZIER", {0, 1}, {0, 0, 0, 1, 1, 1}, 3)),
              HasSubstr("STEP, LINEAR or CUBICSPLINE"));
  Builder b = with_output("translation", "LINEAR", {0, 1}, {0, 0, 0, 1, 1, 1}, 3);
  b.root["animations"][0]["channels"][0]["target"]["node"] = 7;
  EXPECT_THAT(pose_error(b), HasSubstr("node 7 does not exist"));
  b.root["animations"][0]["channels"][0]["target"].erase("node");
  EXPECT_EQ(pose_error(b), "loaded") << "a channel without a node is ignored";
  b.root["animations"][0]["channels"][0] = {{"sampler", 4}, {"target", {{"node", 0}, {"path", "translation"}}}};
  EXPECT_THAT(pose_error(b), HasSubstr("sampler 4 does not exist"));
}

TEST(unit_io_gltf_animation, two_channels_for_one_property_are_told_and_the_last_one_counts) {
  Builder b = triangle();
  const int times = b.floats({0, 1}, "SCALAR", 1);
  const int one = b.vec3s({1, 0, 0, 1, 0, 0}), two = b.vec3s({2, 0, 0, 2, 0, 0});
  const auto channel = [](int sampler, const char* path) {
    return json{{"sampler", sampler}, {"target", {{"node", 0}, {"path", path}}}};
  };
  b.root["animations"] = {{{"samplers", {{{"input", times}, {"output", one}}, {{"input", times}, {"output", two}}}},
                           {"channels", {channel(0, "translation"), channel(1, "translation")}}}};
  Diagnostics diagnostics;
  GltfFile file(b.glb(), {}, "twice", diagnostics);
  const Scene scene = file.scene(diagnostics, Pose{});
  EXPECT_EQ(vec3(scene.nodes.at(0).world_from_node[3]), vec3(2, 0, 0));
  ASSERT_EQ(diagnostics.warnings().size(), 1u);
  EXPECT_EQ(diagnostics.warnings()[0].text(),
            "twice#/animations/0/channels/1: two channels move the translation of node 0; the last one counts");
  EXPECT_EQ(load(b).warnings.size(), 1u) << "at rest too";
  b.root["animations"][0]["channels"][1] = channel(1, "scale");
  EXPECT_TRUE(load(b).warnings.empty());
  // One each of two animations: they are played one at a time.
  b.root["animations"].push_back(b.root["animations"][0]);
  EXPECT_TRUE(load(b).warnings.empty());
}

TEST(unit_io_gltf_animation, instances_have_the_colours_that_the_file_gives_them) {
  Builder b = triangle();
  const int translations = b.vec3s({1, 0, 0, 0, 2, 0});
  b.root["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  auto& attributes = b.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  attributes = {{"TRANSLATION", translations}};
  EXPECT_EQ(load(b).scene.nodes.at(2).color, vec4(1));
  attributes["_COLOR_0"] = b.vec3s({1, 0.5, 0.25, 0, 1, 0});
  Loaded loaded = load(b);
  EXPECT_EQ(loaded.scene.nodes.at(0).color, vec4(1)) << "the node has no mesh of its own";
  EXPECT_EQ(loaded.scene.nodes.at(1).color, vec4(1, 0.5f, 0.25f, 1));
  EXPECT_EQ(loaded.scene.nodes.at(2).color, vec4(0, 1, 0, 1));
  EXPECT_EQ(loaded.scene.nodes[1].mesh, loaded.scene.nodes[2].mesh) << "geometry is shared";
  attributes["_COLOR_0"] = b.accessor<std::uint8_t>({255, 0, 51, 102, 0, 255, 0, 255}, "VEC4", 5121, 4, true);
  EXPECT_EQ(load(b).scene.nodes.at(1).color, vec4(1, 0, 0.2f, 0.4f));
  attributes["_COLOR_0"] = b.vec4s({2, 0, 0, 1, 0, 0, 0, -1});
  loaded = load(b);
  EXPECT_TRUE(loaded.warned("colours of instances outside 0 to 1 are clamped"));
  EXPECT_EQ(loaded.scene.nodes.at(1).color, vec4(1, 0, 0, 1));
  attributes["_COLOR_0"] = b.vec3s({1, 1, 1});
  EXPECT_THAT(error_of(b), HasSubstr("has 1 elements, but others have 2"));
}

TEST(unit_io_gltf_animation, instances_stand_where_their_attributes_say) {
  Builder b = triangle();
  const int translations = b.vec3s({1, 0, 0, 0, 2, 0}), scales = b.vec3s({1, 1, 1, 3, 3, 3});
  b.root["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  b.root["nodes"][0]["translation"] = {0, 0, 10};
  b.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", translations},
                                                                               {"SCALE", scales}};
  const Loaded loaded = load(b);
  EXPECT_TRUE(loaded.warnings.empty());
  ASSERT_EQ(loaded.scene.nodes.size(), 3u);
  EXPECT_EQ(loaded.scene.nodes[0].mesh, -1);
  EXPECT_EQ(vec3(loaded.scene.nodes[1].world_from_node[3]), vec3(1, 0, 10));
  EXPECT_EQ(loaded.scene.nodes[2].world_from_node[1][1], 3.0f);
  b.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] = b.vec3s({1, 1, 1});
  EXPECT_THAT(error_of(b), HasSubstr("has 1 elements, but others have 2"));
  b.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = json::object();
  EXPECT_THAT(error_of(b), HasSubstr("none of TRANSLATION, ROTATION and SCALE"));
}

TEST(unit_io_gltf_animation, an_open_file_changes_its_variant_with_what_its_meshes_wear) {
  Builder b = with_output("translation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0}, 3);
  b.root["materials"] = {{{"name", "plain"}}, {{"name", "sun"}}, {{"name", "moon"}}};
  json& primitives = b.root["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  primitives[0]["material"] = 0;
  primitives[1]["material"] = 2;
  primitives[0]["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 1}, {"variants", {0}}},
                                                                       {{"material", 2}, {"variants", {1}}}};
  b.root["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "day"}}, {{"name", "night"}}};
  Diagnostics diagnostics;
  GltfFile file(b.glb(), {}, "test", diagnostics);
  const auto worn = [&](const std::string& variant) {
    const Scene scene = file.scene(diagnostics, Pose{{}, 0.5}, variant);
    std::vector<std::string> names;
    for (const Primitive& p : scene.meshes.at(0).primitives) {
      names.push_back(scene.materials.at(static_cast<std::size_t>(p.material)).name);
    }
    return names;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(worn("day"), (Names{"sun", "moon"}));
  EXPECT_EQ(worn("night"), (Names{"moon", "moon"}));
  EXPECT_EQ(worn("day"), (Names{"sun", "moon"}));
}

}  // namespace
}  // namespace candela::io::test
