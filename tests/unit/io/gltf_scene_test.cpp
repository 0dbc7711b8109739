#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scene/view.h"
#include "unit/io/gltf_builder.h"

namespace candela::io::test {
namespace {

using ::testing::HasSubstr;

Builder nodes_only(const json& nodes) {
  Builder b;
  b.root["nodes"] = nodes;
  return b;
}

void expect_near(const mat4& a, const mat4& b) {
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) EXPECT_NEAR(a[c][r], b[c][r], 1e-5f) << "column " << c << " row " << r;
  }
}

TEST(unit_io_gltf_nodes, translation_rotation_scale_compose_in_that_order) {
  // A quarter turn about z after a scale of x, under a parent that moves.
  const double h = std::sqrt(0.5);
  const Loaded loaded =
      load(nodes_only({{{"translation", {0, 10, 0}}, {"children", {1}}},
                       {{"translation", {1, 2, 3}}, {"rotation", {0, 0, h, h}}, {"scale", {2, 1, -1}}}}));
  const mat4 expected(vec4(0, 2, 0, 0), vec4(-1, 0, 0, 0), vec4(0, 0, -1, 0), vec4(1, 12, 3, 1));
  expect_near(loaded.scene.nodes[1].world_from_node, expected);
  EXPECT_EQ(loaded.scene.nodes[1].parent, 0);
  EXPECT_TRUE(loaded.warnings.empty());
}

TEST(unit_io_gltf_nodes, matrices_are_column_major) {
  const Loaded loaded = load(nodes_only({{{"matrix", {1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 10, 0, 11, 12, 13, 1}}}}));
  EXPECT_EQ(loaded.scene.nodes[0].parent_from_node[3], vec4(11, 12, 13, 1));
  EXPECT_EQ(loaded.scene.nodes[0].parent_from_node[0], vec4(1, 2, 3, 0));
}

TEST(unit_io_gltf_nodes, odd_transforms_are_told) {
  EXPECT_TRUE(load(nodes_only({{{"rotation", {0, 0, 0, 0}}}})).warned("zero quaternion"));
  EXPECT_EQ(load(nodes_only({{{"rotation", {0, 0, 0, 0}}}})).scene.nodes[0].world_from_node, mat4(1));
  EXPECT_TRUE(load(nodes_only({{{"rotation", {0, 0, 0, 3}}}})).warned("no unit quaternion"));
  expect_near(load(nodes_only({{{"rotation", {0, 0, 0, 3}}}})).scene.nodes[0].world_from_node, mat4(1));
  EXPECT_TRUE(load(nodes_only({{{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2}}}})).warned("0 0 0 1"));
  EXPECT_TRUE(load(nodes_only({{{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}, {"scale", {2, 2, 2}}}}))
                  .warned("both a matrix"));
  // Singular is fine.
  EXPECT_EQ(error_of(nodes_only({{{"scale", {0, 0, 0}}}})), "loaded");
}

TEST(unit_io_gltf_nodes, a_scale_of_0_is_told_where_it_flattens_a_mesh) {
  const auto scaled = [](const json& node) {
    Builder b = triangle();
    b.root["nodes"][0].update(node);
    return load(b);
  };
  EXPECT_TRUE(scaled({{"scale", {1, 0, 1}}, {"name", "sheet"}}).warned("#/nodes/0: node 0 'sheet': a scale of 0"));
  EXPECT_TRUE(scaled({{"scale", {0, 0, 0}}}).warned("node 0: a scale of 0"));
  EXPECT_TRUE(scaled({{"matrix", {1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}}).warned("a scale of 0"));
  EXPECT_TRUE(scaled({{"scale", {1e-12, -1e6, 3}}}).warnings.empty()) << "small is not 0";
  Builder parent = triangle();
  parent.root["nodes"].push_back({{"scale", {1, 1, 0}}, {"children", {0}}});
  parent.root["scenes"][0]["nodes"] = {1};
  EXPECT_TRUE(load(parent).warned("node 0: a scale of 0")) << "above it";
  // What nothing hangs on shows nothing anyway.
  Builder empty = triangle();
  empty.root["nodes"].push_back({{"scale", {0, 1, 1}}});
  empty.root["scenes"][0]["nodes"] = {0, 1};
  EXPECT_TRUE(load(empty).warnings.empty());
  Builder instances = triangle();
  instances.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] =
      instances.vec3s({1, 1, 1, 0, 1, 1});
  EXPECT_TRUE(load(instances).warned("node 0: a scale of 0")) << "an instance";
}

TEST(unit_io_gltf_nodes, numbers_are_the_files) {
  // Node 0 is another scene's, 1 a skinned triangle, 2 its joint, 3 instances, 4 a camera and a lamp, 5 a plain one.
  Builder b = triangle();
  b.root["meshes"].push_back(b.root["meshes"][0]);
  b.root["materials"] = {json::object(), json::object(), {{"normalTexture", {{"index", 2}}}}};
  for (int i = 0; i < 3; ++i) add_texture(b);
  b.root["textures"][2]["source"] = 1;
  b.root["meshes"][1]["primitives"][0]["material"] = 2;
  auto& skinned = b.root["meshes"][0]["primitives"][0]["attributes"];
  skinned["JOINTS_0"] = b.accessor<std::uint8_t>(std::vector<std::uint8_t>(12, 0), "VEC4", 5121, 4);
  skinned["WEIGHTS_0"] = b.vec4s({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  b.root["skins"] = {{{"joints", {2}}}};
  const json lens = {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}};
  b.root["cameras"] = {lens, lens};
  b.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"}}, {{"type", "point"}}};
  b.root["nodes"] = {{{"mesh", 0}, {"camera", 0}},
                     {{"mesh", 0}, {"skin", 0}},
                     json::object(),
                     {{"mesh", 1}},
                     {{"camera", 1}},
                     {{"mesh", 1}}};
  b.root["nodes"][3]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
      b.vec3s({0, 0, 0, 1, 0, 0});
  b.root["nodes"][4]["extensions"]["KHR_lights_punctual"]["light"] = 1;
  b.root["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1, 2, 3, 4, 5}}}};
  b.root["scene"] = 1;
  const Scene scene = load(b).scene;
  std::vector<int> numbers;
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    if (scene.nodes[i].mesh >= 0) numbers.push_back(number_of(scene.nodes, i));
  }
  EXPECT_THAT(numbers, ::testing::UnorderedElementsAre(1, 3, 3, 5));
  EXPECT_EQ(number_of(scene.cameras, 0), 1);
  EXPECT_EQ(number_of(scene.lights, 0), 1);
  EXPECT_EQ(number_of(scene.textures, 0), 2);
  EXPECT_EQ(image_number(scene, 0), 1);
  EXPECT_EQ(number_of(scene.meshes, 1), 1);
  EXPECT_EQ(number_of(scene.materials, 0), 2);
  EXPECT_EQ(number_of(scene.materials, 1), 3) << "glTF's default comes after the file's";
}

TEST(unit_io_gltf_nodes, bad_transforms_are_errors) {
  EXPECT_THAT(error_of(nodes_only({{{"matrix", {1, 0, 0}}}})),
              HasSubstr("#/nodes/0/matrix: must have 16 numbers, not 3"));
  EXPECT_THAT(error_of(nodes_only({{{"translation", {1, 2}}}})), HasSubstr("must have 3 numbers, not 2"));
  EXPECT_THAT(error_of(nodes_only({{{"translation", {1, "2", 3}}}})),
              HasSubstr("#/nodes/0/translation/1: must be a number, not string"));
  EXPECT_THAT(error_of(nodes_only({{{"translation", {1e300, 0, 0}}}})), HasSubstr("not finite"));
  EXPECT_THAT(error_of(nodes_only({{{"scale", {1e30, 1, 1}}, {"children", {1}}}, {{"scale", {1e30, 1, 1}}}})),
              HasSubstr("#/nodes/1: the node's world matrix is not finite"));
}

TEST(unit_io_gltf_nodes, the_hierarchy_must_be_a_forest) {
  EXPECT_THAT(error_of(nodes_only({{{"children", {0}}}})), HasSubstr("node 0 is its own ancestor"));
  EXPECT_THAT(error_of(nodes_only({{{"children", {1}}}, {{"children", {2}}}, {{"children", {1}}}})),
              HasSubstr("two parents (0 and 2)"));
  EXPECT_THAT(error_of(nodes_only({{{"name", "root"}}, {{"children", {2}}}, {{"children", {1}}}})),
              HasSubstr("#/nodes/1: node 1 is its own ancestor"));
  EXPECT_THAT(error_of(nodes_only({{{"children", {1, 1}}}, json::object()})), HasSubstr("two parents (0 and 0)"));
  EXPECT_THAT(error_of(nodes_only({{{"children", {5}}}})), HasSubstr("#/nodes/0/children/0: node 5 does not exist"));
  EXPECT_THAT(error_of(nodes_only({{{"children", {"1"}}}})), HasSubstr("must be a whole number"));
  EXPECT_THAT(error_of(nodes_only({{{"mesh", -7}}})), HasSubstr("not negative"));
  EXPECT_THAT(error_of(nodes_only({{{"mesh", 0}}})), HasSubstr("mesh 0 does not exist (there are 0)"));
  EXPECT_THAT(error_of(nodes_only({{{"camera", 1}}})), HasSubstr("camera 1 does not exist"));
  EXPECT_THAT(error_of(nodes_only({1, 2})), HasSubstr("#/nodes/0: must be an object, not number"));
  EXPECT_THAT(error_of(nodes_only({{"a", 1}})), HasSubstr("#/nodes: must be an array"));
}

TEST(unit_io_gltf_nodes, long_chains_do_not_overflow_the_stack) {
  json nodes = json::array();
  for (int i = 0; i < 100000; ++i) nodes.push_back({{"children", {i + 1}}, {"translation", {0.5, 0, 0}}});
  nodes.push_back(json::object());
  const Loaded loaded = load(nodes_only(nodes));
  EXPECT_EQ(loaded.scene.nodes.back().world_from_node[3].x, 50000.0f);
}

TEST(unit_io_gltf_nodes, the_default_scene_is_shown_and_nothing_else) {
  Builder b = triangle();
  b.root["nodes"] = {{{"name", "a"}, {"mesh", 0}}, {{"name", "b"}, {"children", {2}}}, {{"name", "c"}, {"mesh", 0}}};
  const auto names = [&](const json& scenes, const json& scene) {
    b.root["scenes"] = scenes;
    b.root["scene"] = scene;
    if (scenes.is_null()) b.root.erase("scenes");
    if (scene.is_null()) b.root.erase("scene");
    std::string result;
    for (const Node& node : load(b).scene.nodes) result += node.name;
    return result;
  };
  const json two = {{{"nodes", {0}}}, {{"nodes", {1}}, {"name", "second"}}};
  EXPECT_EQ(names(two, 1), "bc");
  EXPECT_EQ(load(b).scene.name, "second");
  EXPECT_EQ(load(b).scene.nodes[1].parent, 0);
  EXPECT_EQ(names(two, nullptr), "a");
  EXPECT_EQ(names(nullptr, nullptr), "abc");
  EXPECT_EQ(names({{{"name", "empty"}}}, 0), "");
  b.root["scene"] = 4;
  EXPECT_THAT(error_of(b), HasSubstr("#/scene: scene 4 does not exist"));
  b.root["scene"] = 0;
  b.root["scenes"] = {{{"nodes", {2}}}};
  EXPECT_THAT(error_of(b), HasSubstr("node 2 is no root: it is a child of node 1"));
}

TEST(unit_io_gltf_nodes, a_scene_is_chosen_by_its_name_or_else_its_number) {
  Builder b = triangle();
  b.root["nodes"] = {{{"name", "a"}, {"mesh", 0}}, {{"name", "b"}, {"mesh", 0}}, {{"name", "c"}}};
  b.root["scenes"] = {{{"nodes", {0}}, {"name", "day"}}, {{"nodes", {1}}}, {{"nodes", {2}}, {"name", "1"}}};
  b.root["scene"] = 0;
  const auto shown = [&](const std::string& scene) {
    Diagnostics ignored;
    LoadOptions options;
    options.scene = scene;
    FileInfo info;
    const Scene found = load_gltf(as_bytes(b.gltf()), {}, ignored, options, &info);
    EXPECT_EQ(info.scenes, (std::vector<std::string>{"day", "", "1"}));
    EXPECT_EQ(found.nodes.at(0).name, std::string(1, static_cast<char>('a' + info.scene)));
    return found.nodes.at(0).name;
  };
  EXPECT_EQ(shown(""), "a");
  EXPECT_EQ(shown("day"), "a");
  EXPECT_EQ(shown("0"), "a");
  EXPECT_EQ(shown("2"), "c");
  EXPECT_EQ(shown("1"), "c") << "a name goes before a number";
  b.root["scene"] = 7;
  EXPECT_EQ(shown("day"), "a") << "the default scene is not asked for";
  for (const char* name : {"night", "3", "-1", "0x1", "1.0", " 0"}) {
    try {
      shown(name);
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(std::string("there is no scene '") + name + "'"));
      EXPECT_THAT(error.what(), HasSubstr("the file has: 0 'day', 1, 2 '1'"));
    }
  }
}

/// Four nodes in a chain, each with a mesh, a camera and a lamp; `hidden` says which have visible = false.
Builder chain(const std::vector<int>& hidden) {
  Builder b = triangle();
  b.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
  b.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  b.root["extensionsUsed"] = {"KHR_lights_punctual", "KHR_node_visibility"};
  b.root["extensionsRequired"] = {"KHR_node_visibility"};
  b.root["nodes"] = json::array();
  for (std::size_t i = 0; i < 4; ++i) {
    b.root["nodes"].push_back({{"mesh", 0}, {"camera", 0}});
    if (i < 3) b.root["nodes"][i]["children"] = {i + 1};
    b.root["nodes"][i]["extensions"]["KHR_lights_punctual"]["light"] = 0;
    b.root["nodes"][i]["extensions"]["KHR_node_visibility"]["visible"] = true;
  }
  for (const int i : hidden)
    b.root["nodes"][static_cast<std::size_t>(i)]["extensions"]["KHR_node_visibility"]["visible"] = false;
  return b;
}

TEST(unit_io_gltf_visibility, what_is_hidden_hides_all_below_but_cameras) {
  for (int hidden = 0; hidden < 4; ++hidden) {
    const Loaded loaded = load(chain({hidden}));
    ASSERT_EQ(loaded.scene.nodes.size(), 4u);
    for (int i = 0; i < 4; ++i) {
      const Node& node = loaded.scene.nodes[static_cast<std::size_t>(i)];
      EXPECT_EQ(node.is_hidden, i >= hidden);
      EXPECT_EQ(node.mesh, i < hidden ? 0 : -1) << "visible below a hidden one stays hidden";
      EXPECT_EQ(node.light, i < hidden ? 0 : -1);
      EXPECT_EQ(node.camera, 0);
    }
    EXPECT_TRUE(loaded.warnings.empty());
  }
  EXPECT_FALSE(load(chain({})).scene.nodes[3].is_hidden);
  Builder absent = triangle();
  absent.root["nodes"][0]["extensions"]["KHR_node_visibility"] = json::object();
  EXPECT_EQ(load(absent).scene.nodes[0].mesh, 0) << "visible is true where it is not said";
  absent.root["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = 1;
  EXPECT_THAT(error_of(absent), HasSubstr("true or false"));
}

TEST(unit_io_gltf_visibility, what_is_hidden_is_not_read) {
  Builder b = chain({0});
  b.root["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 77;
  b.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 99}}}}}}};
  b.root["meshes"][0]["primitives"][0]["material"] = 0;
  const Loaded loaded = load(b);
  EXPECT_TRUE(loaded.scene.meshes.empty() && loaded.scene.lights.empty());
  EXPECT_EQ(loaded.scene.materials.size(), 1u);
}

TEST(unit_io_gltf_visibility, instances_and_skinned_meshes_are_hidden_too) {
  Builder b = chain({0});
  b.root["nodes"][1]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
      b.vec3s({0, 0, 0, 1, 0, 0});
  auto& attributes = b.root["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = b.accessor<std::uint8_t>(std::vector<std::uint8_t>(12, 0), "VEC4", 5121, 4);
  attributes["WEIGHTS_0"] = b.vec4s({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  b.root["skins"] = {{{"joints", {3}}}};
  b.root["nodes"][2]["skin"] = 0;
  const auto shown = [](const Scene& scene) {
    return std::count_if(scene.nodes.begin(), scene.nodes.end(), [](const Node& n) { return n.mesh >= 0; });
  };
  EXPECT_EQ(shown(load(b).scene), 0);
  b.root["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = true;
  EXPECT_EQ(shown(load(b).scene), 5) << "two nodes, two instances, a skinned mesh";
}

TEST(unit_io_gltf_nodes, unused_meshes_materials_and_images_are_left_alone) {
  Builder b = with_material({{"name", "used"}});
  b.root["materials"].push_back({{"name", "unused"}, {"emissiveTexture", {{"index", 0}}}});
  b.root["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", 99}}}, {"material", 1}}}}});
  b.root["images"] = {{{"uri", "does_not_exist.png"}}};
  b.root["textures"] = {{{"source", 0}}};
  const Loaded loaded = load(b);
  EXPECT_EQ(loaded.scene.meshes.size(), 1u);
  ASSERT_EQ(loaded.scene.materials.size(), 1u);
  EXPECT_EQ(loaded.scene.materials[0].name, "used");
  EXPECT_TRUE(loaded.scene.images.empty());
}

TEST(unit_io_gltf_cameras, both_kinds_are_read) {
  Builder b = nodes_only({{{"camera", 1}}, {{"camera", 0}}, {{"camera", 1}}});
  b.root["cameras"] = {
      {{"type", "perspective"},
       {"name", "eye"},
       {"perspective", {{"yfov", 0.7}, {"aspectRatio", 1.5}, {"znear", 0.01}}}},
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", -3}, {"znear", 0}, {"zfar", 9}}}}};
  const Scene scene = load(b).scene;
  ASSERT_EQ(scene.cameras.size(), 2u);
  // In the file's order, whoever uses them first.
  EXPECT_EQ(scene.cameras[0].name, "eye");
  EXPECT_EQ(scene.nodes[0].camera, scene.nodes[2].camera);
  const auto& ortho =
      std::get<OrthographicCamera>(scene.cameras[static_cast<std::size_t>(scene.nodes[0].camera)].projection);
  EXPECT_EQ(ortho.xmag, 2);
  EXPECT_EQ(ortho.ymag, 3);
  const Camera& eye = scene.cameras[static_cast<std::size_t>(scene.nodes[1].camera)];
  EXPECT_EQ(eye.name, "eye");
  EXPECT_EQ(std::get<PerspectiveCamera>(eye.projection).yfov, 0.7f);
  EXPECT_EQ(std::get<PerspectiveCamera>(eye.projection).aspect_ratio, 1.5f);
}

TEST(unit_io_gltf_cameras, planes_are_read_and_odd_ones_are_told) {
  const auto planes = [](const char* type, const json& more) {
    Builder b = nodes_only({{{"camera", 0}}});
    json projection = std::string(type) == "perspective" ? json{{"yfov", 1}} : json{{"xmag", 1}, {"ymag", 1}};
    projection.update(more);
    b.root["cameras"] = {{{"type", type}, {type, projection}}};
    const Loaded loaded = load(b);
    const Camera& camera = loaded.scene.cameras[0];
    return std::tuple(camera.near_plane, camera.far_plane, loaded.warnings.size());
  };
  using Planes = std::tuple<float, float, std::size_t>;
  EXPECT_EQ(planes("perspective", {{"znear", 0.5}, {"zfar", 9}}), Planes(0.5f, 9.0f, 0));
  EXPECT_EQ(planes("perspective", {{"znear", 0.5}}), Planes(0.5f, kInfinity, 0)) << "infinite";
  EXPECT_EQ(planes("orthographic", {{"znear", 0}, {"zfar", 9}}), Planes(0.0f, 9.0f, 0));
  EXPECT_EQ(planes("perspective", {{"znear", 0}, {"zfar", 9}}), Planes(0.0f, 9.0f, 1));
  EXPECT_EQ(planes("orthographic", {{"znear", -3}, {"zfar", 9}}), Planes(0.0f, 9.0f, 1));
  EXPECT_EQ(planes("perspective", {{"znear", 2}, {"zfar", 1}}), Planes(2.0f, kInfinity, 1));
  EXPECT_EQ(planes("orthographic", {{"znear", 2}, {"zfar", 2}}), Planes(2.0f, kInfinity, 1));
}

TEST(unit_io_gltf_cameras, the_lens_of_a_physical_camera_is_read_and_its_field_of_view_is_not) {
  const auto camera = [](const json& lens, const char* told = nullptr) {
    Builder b = nodes_only({{{"camera", 0}}});
    b.root["cameras"] = {{{"type", "perspective"},
                          {"perspective", {{"yfov", 1}, {"znear", 0.1}}},
                          {"extensions", {{"EXT_camera_physical", lens}}}}};
    const Loaded loaded = load(b);
    EXPECT_EQ(loaded.warnings.size(), told != nullptr ? 1u : 0u);
    EXPECT_TRUE(told == nullptr || loaded.warned(told));
    return loaded.scene;
  };
  const json sensor = {0.036, 0.024};
  Scene scene = camera({{"focalLength", 0.1}, {"sensorSize", sensor}, {"fStop", 2.5}, {"focusDistance", 3}});
  EXPECT_EQ(scene.cameras[0].f_number, 2.5f);
  EXPECT_EQ(scene.cameras[0].focal_length, 0.1f);
  EXPECT_EQ(scene.cameras[0].focus_distance, 3.0f);
  const View view = scene_camera(scene, scene.nodes[0], 1.5f);
  EXPECT_FLOAT_EQ(view.lens.radius, 0.02f) << "the entrance pupil is 0.1 m / 2.5 wide";
  EXPECT_EQ(view.lens.focus_distance, 3.0f);
  EXPECT_EQ(std::get<PerspectiveCamera>(view.projection).yfov, 1.0f);
  scene = camera({{"focalLength", 0.1}, {"sensorSize", sensor}});
  EXPECT_EQ(scene_camera(scene, scene.nodes[0], 1.5f).lens.radius, 0.0f) << "no stop, no blur";
  EXPECT_EQ(camera({{"fStop", 0}}, "fStop").cameras[0].f_number, 0.0f);
  EXPECT_EQ(camera({{"focusDistance", -2}}, "focusDistance").cameras[0].focus_distance, 0.0f);
}

TEST(unit_io_gltf_cameras, impossible_ones_are_errors) {
  const auto error_with = [](const json& camera) {
    Builder b = nodes_only({{{"camera", 0}}});
    b.root["cameras"] = {camera};
    return error_of(b);
  };
  EXPECT_THAT(error_with({{"type", "fisheye"}}), HasSubstr("perspective or orthographic"));
  EXPECT_THAT(error_with({{"type", "perspective"}}), HasSubstr("'perspective' is missing"));
  for (const double yfov : {0.0, -1.0, 3.2})
    EXPECT_THAT(error_with({{"type", "perspective"}, {"perspective", {{"yfov", yfov}}}}),
                HasSubstr("between 0 and pi"));
  EXPECT_THAT(error_with({{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"aspectRatio", 0}}}}),
              HasSubstr("must be positive"));
  EXPECT_THAT(error_with({{"type", "orthographic"}, {"orthographic", {{"xmag", 0}, {"ymag", 1}}}}),
              HasSubstr("must not be 0"));
}

Builder with_lights(const json& lights) {
  json nodes = json::array();
  for (std::size_t i = 0; i < lights.size(); ++i)
    nodes.push_back({{"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
  Builder b = nodes_only(nodes);
  b.root["extensionsUsed"] = {"KHR_lights_punctual"};
  b.root["extensions"]["KHR_lights_punctual"]["lights"] = lights;
  return b;
}

TEST(unit_io_gltf_lights, all_types_and_defaults) {
  const Loaded loaded =
      load(with_lights({{{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 20}, {"range", 4}, {"name", "lamp"}},
                        {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.2}}}},
                        {{"type", "spot"}},
                        {{"type", "directional"}}}));
  EXPECT_TRUE(loaded.warnings.empty());
  const auto& lights = loaded.scene.lights;
  ASSERT_EQ(lights.size(), 4u);
  EXPECT_EQ(lights[0].type, LightType::point);
  EXPECT_EQ(lights[0].name, "lamp");
  EXPECT_EQ(lights[0].color, vec3(1, 0.5f, 0));
  EXPECT_EQ(lights[0].intensity, 20);
  EXPECT_EQ(lights[0].range, 4);
  EXPECT_EQ(lights[1].inner_cone, 0.1f);
  EXPECT_EQ(lights[1].outer_cone, 0.2f);
  EXPECT_EQ(lights[2].inner_cone, 0);
  EXPECT_NEAR(lights[2].outer_cone, kPi / 4, 1e-6);
  EXPECT_EQ(lights[3].type, LightType::directional);
  EXPECT_EQ(lights[3].range, kInfinity);
  EXPECT_EQ(lights[3].intensity, 1);
}

TEST(unit_io_gltf_lights, oddities_are_told_and_nonsense_is_refused) {
  EXPECT_TRUE(load(with_lights({{{"type", "point"}, {"intensity", -1}}})).warned("intensity -1 becomes 0"));
  EXPECT_TRUE(load(with_lights({{{"type", "point"}, {"color", {-1, 0, 0}}}})).warned("negative colour"));
  EXPECT_TRUE(load(with_lights({{{"type", "spot"}, {"spot", {{"innerConeAngle", 1}, {"outerConeAngle", 0.5}}}}}))
                  .warned("spot angles"));
  EXPECT_TRUE(load(with_lights({{{"type", "spot"}, {"spot", {{"outerConeAngle", 3}}}}})).warned("spot angles"));
  EXPECT_TRUE(load(with_lights({{{"type", "spot"}, {"spot", {{"innerConeAngle", 0.5}, {"outerConeAngle", 0.5}}}}}))
                  .warnings.empty());
  EXPECT_THAT(error_of(with_lights({{{"type", "area"}}})), HasSubstr("point, spot or directional"));
  EXPECT_THAT(error_of(with_lights({{{"type", "point"}, {"range", 0}}})),
              HasSubstr("/lights/0/range: must be positive"));
  Builder b = with_lights({{{"type", "point"}}});
  b.root["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 1;
  EXPECT_THAT(error_of(b), HasSubstr("light 1 does not exist (there are 1)"));
}

}  // namespace
}  // namespace candela::io::test
