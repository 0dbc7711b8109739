#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "io/gltf_extensions.h"
#include "unit/io/gltf_seeds.h"

// KHR_animation_pointer: a moment is the file with the value written in.

namespace candela::io::test {
namespace {

using ::testing::HasSubstr;

struct Keys {
  std::vector<float> values;
  std::string type;
  std::string interpolation = "LINEAR";
  std::vector<float> times = {0, 1};
};

std::size_t components_of(const std::string& type) {
  return type == "SCALAR" ? 1 : static_cast<std::size_t>(type[3] - '0');
}

json pointer_target(const std::string& pointer) {
  return {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}};
}

/// Adds a channel to the file's first animation, with an accessor of its own for the values.
void add_channel(Builder& b, const json& target, int output, const std::vector<float>& times,
                 const std::string& interpolation) {
  const int input = b.floats(times, "SCALAR", 1);
  b.root["accessors"][static_cast<std::size_t>(input)]["max"] = {times.back()};
  json& animation = b.root["animations"][0];
  animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
  animation["channels"].push_back({{"sampler", animation["samplers"].size() - 1}, {"target", target}});
}

void animate(Builder& b, const std::string& pointer, const Keys& keys) {
  add_channel(b, pointer_target(pointer), b.floats(keys.values, keys.type.c_str(), components_of(keys.type)),
              keys.times, keys.interpolation);
}

Loaded moment(const Builder& b, double time_s, const LoadOptions& options = {}) {
  Diagnostics diagnostics;
  GltfFile file(b.glb(), {}, "test", diagnostics, options);
  Scene scene = file.scene(diagnostics, Pose{"", time_s});
  return {std::move(scene), diagnostics.warnings(), diagnostics.notes()};
}

std::string pose_error(const Builder& b) {
  try {
    moment(b, 0.5);
    return "loaded";
  } catch (const Error& error) {
    return error.what();
  }
}

/// Every texture of a material gets a transform, which is what an animation moves.
void add_transforms(json& value) {
  if (!value.is_structured()) return;
  for (auto& [key, member] : value.items()) {
    if (key.ends_with("Texture")) member["extensions"]["KHR_texture_transform"] = {{"scale", {1.5, 1.25}}};
    if (key != "KHR_texture_transform") add_transforms(member);
  }
}

/// A file that has every property which an animation may move: three materials, every light and camera.
Builder everything() {
  Builder b = layered();
  json layers = b.root["materials"][0];
  layers.erase("extras");
  layers.merge_patch(json::parse(R"({"alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0},
    "metallicRoughnessTexture": {"index": 0}}, "normalTexture": {"index": 0}, "occlusionTexture": {"index": 0},
    "emissiveTexture": {"index": 0}, "emissiveFactor": [1, 1, 1],
    "extras": {"candela": {"heightTexture": {"index": 0, "scale": 0.1}}},
    "extensions": {"KHR_materials_ior": {}, "KHR_materials_emissive_strength": {},
      "KHR_materials_specular": {"specularTexture": {"index": 0}, "specularColorTexture": {"index": 0}}}})"));
  add_transforms(layers);
  b.root["materials"] = json::array({layers});
  b.root["materials"].push_back(json::parse(R"({"extensions": {"KHR_materials_pbrSpecularGlossiness": {
    "diffuseTexture": {"index": 0, "extensions": {"KHR_texture_transform": {}}},
    "specularGlossinessTexture": {"index": 0, "extensions": {"KHR_texture_transform": {}}}}}})"));
  b.root["materials"].push_back(json::parse(R"({"extensions": {"KHR_materials_volume": {"thicknessFactor": 1},
    "KHR_materials_transmission": {"transmissionFactor": 1},
    "KHR_materials_scatter": {"scatterStrengthFactor": 0.5, "multiscatterColorFactor": [1, 0.5, 0.25]}}})"));
  json& primitives = b.root["meshes"][0]["primitives"];
  for (const int material : {1, 2}) {
    primitives.push_back(primitives[0]);
    primitives.back()["material"] = material;
  }
  b.root["cameras"] = json::parse(R"([
    {"type": "perspective", "perspective": {"yfov": 1, "aspectRatio": 1, "znear": 0.1, "zfar": 9},
     "extensions": {"EXT_camera_physical": {"focalLength": 0.05, "sensorSize": [0.036, 0.024], "fStop": 4, "focusDistance": 3}}},
    {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0.1, "zfar": 9}}])");
  b.root["extensions"]["KHR_lights_punctual"]["lights"] = json::parse(R"([
    {"type": "point", "range": 5}, {"type": "spot", "spot": {"outerConeAngle": 0.9}},
    {"type": "directional", "extras": {"candela": {"temperature_k": 6500}}},
    {"type": "point", "extras": {"candela": {"lumens": 100}}}])");
  b.root["extensions"]["EXT_lights_ies"]["lights"] = {
      {{"uri", "data:application/x-ies-lm-63;base64," + base64(as_bytes(tiny_ies()))}}};
  b.root["extensions"]["EXT_lights_area"]["lights"] = json::parse(R"([{"type": "rect", "rect": {"aspect": 2}}])");
  b.root["nodes"] = json::parse(R"([{"mesh": 0, "children": [1, 2, 3, 4, 5, 6, 7]},
    {"camera": 0}, {"camera": 1}, {"extensions": {"EXT_lights_ies": {"light": 0}, "EXT_lights_area": {"light": 0}}}])");
  for (int light = 0; light < 4; ++light) {
    b.root["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
  }
  return b;
}

/// All numbers of a scene that an animation may move, as text: equal where two scenes look the same.
std::string numbers_of(const Scene& scene) {
  std::string text;
  const auto put = [&](auto... values) { ((text += std::to_string(values) + ' '), ...); };
  const auto put_all = [&](const auto& v) {
    for (int i = 0; i < v.length(); ++i) put(v[i]);
  };
  for (const Camera& camera : scene.cameras) {
    put(camera.near_plane, camera.far_plane, camera.f_number, camera.focal_length, camera.focus_distance);
    if (const auto* p = std::get_if<PerspectiveCamera>(&camera.projection)) {
      put(p->yfov, p->aspect_ratio.value_or(-1.0f));
    } else {
      const auto& o = std::get<OrthographicCamera>(camera.projection);
      put(o.xmag, o.ymag);
    }
  }
  for (const Light& light : scene.lights) {
    put_all(light.color);
    put(light.intensity, light.range, light.inner_cone, light.outer_cone);
  }
  for (const Node& node : scene.nodes) {
    for (int c = 0; c < 4; ++c) put_all(node.world_from_node[c]);
  }
  for (const Mesh& mesh : scene.meshes) {
    for (const Primitive& primitive : mesh.primitives) {
      for (const vec3 p : primitive.positions) put_all(p);
      for (const vec4& t : primitive.tangents) put_all(t);
    }
  }
  return text;
}

struct Case {
  std::string pointer;
  std::vector<float> value;
};

std::vector<Case> all_cases() {
  std::vector<Case> cases = {
      {"/nodes/0/translation", {1, 2, 3}},
      {"/nodes/0/scale", {1, 2, 3}},
      {"/nodes/0/rotation", {0.6f, 0, 0, 0.8f}},
      {"/cameras/0/perspective/yfov", {0.5f}},
      {"/cameras/0/perspective/aspectRatio", {2}},
      {"/cameras/0/perspective/znear", {0.5f}},
      {"/cameras/0/perspective/zfar", {5}},
      {"/cameras/0/extensions/EXT_camera_physical/fStop", {2}},
      {"/cameras/0/extensions/EXT_camera_physical/focalLength", {0.1f}},
      {"/cameras/0/extensions/EXT_camera_physical/focusDistance", {7}},
      {"/cameras/1/orthographic/znear", {0.5f}},
      {"/cameras/1/orthographic/zfar", {5}},
      {"/extensions/EXT_lights_area/lights/0/color", {0.5f, 0.25f, 0}},
      {"/extensions/EXT_lights_area/lights/0/intensity", {7}},
      {"/extensions/EXT_lights_area/lights/0/size", {3}},
      {"/extensions/EXT_lights_area/lights/0/rect/aspect", {4}},
      {"/cameras/1/orthographic/xmag", {3}},
      {"/cameras/1/orthographic/ymag", {4}},
      {"/extensions/KHR_lights_punctual/lights/0/color", {0.5f, 0.25f, 0}},
      {"/extensions/KHR_lights_punctual/lights/0/intensity", {7}},
      {"/extensions/KHR_lights_punctual/lights/0/range", {2}},
      {"/extensions/KHR_lights_punctual/lights/1/spot/innerConeAngle", {0.25f}},
      {"/extensions/KHR_lights_punctual/lights/1/spot/outerConeAngle", {0.5f}},
      {"/extensions/KHR_lights_punctual/lights/2/extras/candela/temperature_k", {3000}},
      {"/extensions/KHR_lights_punctual/lights/3/extras/candela/lumens", {200}},
      {"/nodes/3/extensions/EXT_lights_ies/multiplier", {3}},
      {"/nodes/3/extensions/EXT_lights_ies/color", {0.5f, 0.25f, 0}},
      {"/materials/1/extensions/KHR_materials_pbrSpecularGlossiness/diffuseFactor", {0.5f, 0.25f, 0, 0.5f}},
      {"/materials/1/extensions/KHR_materials_pbrSpecularGlossiness/specularFactor", {0.5f, 0.25f, 0}},
      {"/materials/1/extensions/KHR_materials_pbrSpecularGlossiness/glossinessFactor", {0.25f}},
      {"/materials/2/extensions/KHR_materials_scatter/scatterStrengthFactor", {0.25f}},
      {"/materials/2/extensions/KHR_materials_scatter/multiscatterColorFactor", {0.5f, 0.25f, 0}},
      {"/materials/2/extensions/KHR_materials_scatter/scatterAnisotropy", {0.5f}},
      {"/materials/0/alphaCutoff", {0.75f}},
      {"/materials/0/emissiveFactor", {0.5f, 0.25f, 0}},
      {"/materials/0/normalTexture/scale", {0.5f}},
      {"/materials/0/occlusionTexture/strength", {0.5f}},
      {"/materials/0/pbrMetallicRoughness/baseColorFactor", {0.5f, 0.25f, 0, 0.75f}},
      {"/materials/0/pbrMetallicRoughness/metallicFactor", {0.5f}},
      {"/materials/0/pbrMetallicRoughness/roughnessFactor", {0.5f}},
      {"/materials/0/extras/candela/heightTexture/scale", {0.5f}},
      {"/materials/0/extras/candela/heightTexture/level", {0.5f}}};
  const std::vector<Case> of_extensions = {{"anisotropy/anisotropyStrength", {0.25f}},
                                           {"anisotropy/anisotropyRotation", {2}},
                                           {"clearcoat/clearcoatFactor", {0.25f}},
                                           {"clearcoat/clearcoatRoughnessFactor", {0.75f}},
                                           {"clearcoat/clearcoatNormalTexture/scale", {0.25f}},
                                           {"diffuse_transmission/diffuseTransmissionFactor", {0.25f}},
                                           {"diffuse_transmission/diffuseTransmissionColorFactor", {0.25f, 0.5f, 1}},
                                           {"dispersion/dispersion", {0.25f}},
                                           {"emissive_strength/emissiveStrength", {3}},
                                           {"ior/ior", {1.25f}},
                                           {"iridescence/iridescenceFactor", {0.25f}},
                                           {"iridescence/iridescenceIor", {1.75f}},
                                           {"iridescence/iridescenceThicknessMinimum", {150}},
                                           {"iridescence/iridescenceThicknessMaximum", {550}},
                                           {"sheen/sheenColorFactor", {0.25f, 0.5f, 1}},
                                           {"sheen/sheenRoughnessFactor", {0.25f}},
                                           {"specular/specularFactor", {0.25f}},
                                           {"specular/specularColorFactor", {0.25f, 0.5f, 2}},
                                           {"transmission/transmissionFactor", {0.25f}},
                                           {"volume/thicknessFactor", {0.25f}},
                                           {"volume/attenuationDistance", {0.75f}},
                                           {"volume/attenuationColor", {0.25f, 0.5f, 1}},
                                           {"volume_scatter/multiscatterColor", {0.25f, 0.5f, 1}},
                                           {"volume_scatter/scatterAnisotropy", {-0.5f}}};
  for (const Case& c : of_extensions) cases.push_back({"/materials/0/extensions/KHR_materials_" + c.pointer, c.value});
  // Every texture that the materials have, and how it lies.
  const json document = everything().root;
  const std::function<void(const json&, const std::string&)> visit = [&](const json& value, const std::string& place) {
    if (!value.is_structured()) return;
    for (const auto& [key, member] : value.items()) {
      std::string here = place;
      here.append("/").append(key);
      if (key == "KHR_texture_transform") {
        cases.push_back({here + "/offset", {0.25f, 0.5f}});
        cases.push_back({here + "/rotation", {0.5f}});
        cases.push_back({here + "/scale", {2, 3}});
      }
      visit(member, here);
    }
  };
  visit(document["materials"], "/materials");
  return cases;
}

TEST(unit_io_gltf_pointer, a_moment_is_the_file_with_the_value_written_in) {
  const Scene rest = load(everything()).scene;
  const std::vector<Case> cases = all_cases();
  EXPECT_GT(cases.size(), 110u) << "21 textures three times, and the factors";
  for (const Case& c : cases) {
    const std::string type = c.value.size() == 1 ? "SCALAR" : "VEC" + std::to_string(c.value.size());
    Builder moving = everything(), still = everything();
    std::vector<float> keys(c.value.size(), 1.0f);
    keys.insert(keys.end(), c.value.begin(), c.value.end());
    animate(moving, c.pointer, {keys, type});
    json& place = still.root[json::json_pointer(c.pointer)];
    place = c.value.size() == 1 ? json(c.value[0]) : json(c.value);
    const Loaded found = moment(moving, 1.0), expected = load(still);
    EXPECT_TRUE(found.scene.materials == expected.scene.materials) << c.pointer;
    EXPECT_EQ(numbers_of(found.scene), numbers_of(expected.scene)) << c.pointer;
    EXPECT_EQ(found.warnings.size(), expected.warnings.size()) << c.pointer;
    const bool is_other = !(found.scene.materials == rest.materials) || numbers_of(found.scene) != numbers_of(rest);
    EXPECT_TRUE(is_other) << c.pointer << " changes nothing";
  }
}

TEST(unit_io_gltf_pointer, defaults_count_as_there_where_their_object_is) {
  Builder b = with_material({{"pbrMetallicRoughness", json::object()}});
  animate(b, "/materials/0/pbrMetallicRoughness/roughnessFactor", {{0, 1}, "SCALAR"});
  EXPECT_EQ(moment(b, 0.25).scene.materials[0].roughness, 0.25f);
  EXPECT_EQ(load(b).scene.materials[0].roughness, 1.0f) << "at rest";
}

TEST(unit_io_gltf_pointer, values_become_numbers_before_they_are_joined) {
  Builder b = with_material({{"pbrMetallicRoughness", json::object()}});
  const int colors = b.accessor(std::vector<std::uint8_t>{0, 0, 0, 0, 255, 51, 255, 255}, "VEC4", 5121, 4, true);
  add_channel(b, pointer_target("/materials/0/pbrMetallicRoughness/baseColorFactor"), colors, {0, 1}, "LINEAR");
  EXPECT_EQ(moment(b, 0.5).scene.materials[0].base_color, vec3(0.5f, 0.1f, 0.5f));
  Builder plain = with_material(json::parse(R"({"extensions": {"KHR_materials_emissive_strength": {}},
                                                "emissiveFactor": [1, 1, 1]})"));
  const int strengths = plain.accessor(std::vector<std::uint16_t>{2, 5}, "SCALAR", 5123, 1);
  add_channel(plain, pointer_target("/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength"),
              strengths, {0, 1}, "LINEAR");
  EXPECT_EQ(moment(plain, 0.5).scene.materials[0].emission, vec3(3.5f)) << "integers that are not normalised";
}

TEST(unit_io_gltf_pointer, keys_are_joined_as_their_sampler_says) {
  const auto roughness = [](const Keys& keys, double time) {
    Builder b = with_material({{"pbrMetallicRoughness", json::object()}});
    animate(b, "/materials/0/pbrMetallicRoughness/roughnessFactor", keys);
    return moment(b, time).scene.materials[0].roughness;
  };
  EXPECT_EQ(roughness({{0.25f, 0.75f}, "SCALAR", "STEP"}, 0.9), 0.25f);
  EXPECT_EQ(roughness({{0.25f, 0.75f}, "SCALAR", "LINEAR"}, 0.5), 0.5f);
  EXPECT_EQ(roughness({{0.25f, 0.75f}, "SCALAR", "LINEAR"}, 7.0), 0.75f) << "after the end";
  EXPECT_EQ(roughness({{0, 0, 1, 0, 0.5f, 0}, "SCALAR", "CUBICSPLINE"}, 0.5), 0.375f) << "of a tangent of 1";
  Builder turned = triangle();
  animate(turned, "/nodes/0/rotation", {{0, 0, 0, 1, 0, 0, 1, 0}, "VEC4"});
  EXPECT_NEAR(moment(turned, 1.0 / 6).scene.nodes[0].world_from_node[0][0], std::cos(kPi / 6), 1e-6f)
      << "a sixth of half a turn";
}

TEST(unit_io_gltf_pointer, two_of_the_weights_move_alone) {
  Builder b = triangle();
  const int up = b.vec3s({0, 0, 1, 0, 0, 1, 0, 0, 1}), aside = b.vec3s({1, 0, 0, 1, 0, 0, 1, 0, 0});
  primitive(b)["targets"] = {{{"POSITION", up}}, {{"POSITION", aside}}};
  b.root["meshes"][0]["weights"] = {0.25, 0.5};
  Builder one = b, all = b, of_mesh = b, of_mesh_one = b;
  animate(one, "/nodes/0/weights/1", {{0, 1}, "SCALAR"});
  const auto first = [](const Builder& file) { return moment(file, 0.75).scene.meshes[0].primitives[0].positions[0]; };
  EXPECT_EQ(first(one), vec3(0.75f, 0, 0.25f)) << "the other keeps what the mesh gives it";
  animate(all, "/nodes/0/weights", {{0, 0, 0, 0}, "SCALAR"});
  EXPECT_EQ(first(all), vec3(0, 0, 0)) << "0 is a weight, too";
  animate(of_mesh, "/meshes/0/weights", {{0, 0, 1, 1}, "SCALAR"});
  EXPECT_EQ(first(of_mesh), vec3(0.75f, 0, 0.75f));
  animate(of_mesh_one, "/meshes/0/weights/0", {{0, 1}, "SCALAR"});
  EXPECT_EQ(first(of_mesh_one), vec3(0.5f, 0, 0.75f));
  of_mesh_one.root["meshes"][0].erase("weights");
  EXPECT_EQ(first(of_mesh_one), vec3(0, 0, 0.75f)) << "weights that the mesh does not have are 0";
}

TEST(unit_io_gltf_pointer, a_pointer_moves_a_matrix_but_turns_none) {
  Builder b = triangle();
  b.root["nodes"][0]["matrix"] = {0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1};
  Builder moved = b, turned = b;
  animate(moved, "/nodes/0/translation", {{0, 0, 0, 2, 4, 6}, "VEC3"});
  const mat4 m = moment(moved, 0.5).scene.nodes[0].world_from_node;
  EXPECT_EQ(vec3(m[3]), vec3(1, 2, 3));
  EXPECT_EQ(vec3(m[0]), vec3(0, 2, 0)) << "the rest of it stays";
  animate(turned, "/nodes/0/scale", {{1, 1, 1, 3, 3, 3}, "VEC3"});
  const Loaded still = moment(turned, 0.5);
  EXPECT_TRUE(still.warned("has a matrix"));
  EXPECT_EQ(vec3(still.scene.nodes[0].world_from_node[0]), vec3(0, 2, 0));
}

TEST(unit_io_gltf_pointer, nodes_are_hidden_and_shown) {
  if (!is_supported_extension("KHR_node_visibility")) GTEST_SKIP() << "visibility is not read";
  Builder b = triangle();
  b.root["nodes"][0]["extensions"]["KHR_node_visibility"] = json::object();
  const std::string pointer = "/nodes/0/extensions/KHR_node_visibility/visible";
  Builder good = b, joined = b, wide = b;
  const int flags = good.accessor(std::vector<std::uint8_t>{1, 0, 7}, "SCALAR", 5121, 1);
  add_channel(good, pointer_target(pointer), flags, {0, 1, 2}, "STEP");
  const auto is_shown = [&](double time) { return !world_bounds(moment(good, time).scene).empty(); };
  EXPECT_TRUE(is_shown(0.5));
  EXPECT_FALSE(is_shown(1.5));
  EXPECT_TRUE(is_shown(2.5)) << "whatever is not 0 is true";
  add_channel(joined, pointer_target(pointer), joined.accessor(std::vector<std::uint8_t>{1, 0}, "SCALAR", 5121, 1),
              {0, 1}, "LINEAR");
  EXPECT_THAT(pose_error(joined), HasSubstr("must be STEP"));
  animate(wide, pointer, {{1, 0}, "SCALAR", "STEP"});
  EXPECT_THAT(pose_error(wide), HasSubstr("unsigned bytes"));
}

TEST(unit_io_gltf_pointer, what_some_moments_hide_keeps_its_number_in_all_of_them) {
  if (!is_supported_extension("KHR_node_visibility")) GTEST_SKIP() << "visibility is not read";
  // Known meshes keep the material that they had, by its number.
  Builder b = with_material({{"name", "first"}});
  b.root["materials"].push_back({{"name", "second"}});
  b.root["meshes"].push_back(b.root["meshes"][0]);
  b.root["meshes"][1]["primitives"][0]["material"] = 1;
  b.root["nodes"].push_back({{"mesh", 1}});
  b.root["scenes"] = {{{"nodes", {0, 1}}}};
  b.root["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = false;
  const int flags = b.accessor(std::vector<std::uint8_t>{0, 1}, "SCALAR", 5121, 1);
  add_channel(b, pointer_target("/nodes/0/extensions/KHR_node_visibility/visible"), flags, {0, 1}, "STEP");
  Diagnostics diagnostics;
  GltfFile file(b.glb(), {}, "test", diagnostics);
  const Scene rest = file.scene(diagnostics), before = file.scene(diagnostics, Pose{"", 0.5}),
              after = file.scene(diagnostics, Pose{"", 1.5});
  EXPECT_EQ(rest.nodes[0].mesh, -1);
  EXPECT_EQ(before.nodes[0].mesh, -1);
  EXPECT_EQ(after.nodes[0].mesh, 0);
  for (const Scene* scene : {&rest, &before, &after}) {
    ASSERT_EQ(scene->materials.size(), 2u);
    EXPECT_EQ(scene->materials[1].name, "second");
    ASSERT_EQ(scene->meshes.size(), 2u);
    EXPECT_EQ(scene->nodes[1].mesh, 1);
    EXPECT_EQ(scene->meshes[1].primitives[0].material, 1);
  }
}

TEST(unit_io_gltf_pointer, an_index_of_refraction_of_0_is_no_number) {
  const std::string pointer = "/materials/0/extensions/KHR_materials_ior/ior";
  Builder b = with_material({{"extensions", {{"KHR_materials_ior", {{"ior", 0}}}}}});
  animate(b, pointer, {{1.5f, 2}, "SCALAR"});
  const Loaded permanent = moment(b, 0.5);
  EXPECT_EQ(permanent.scene.materials[0].ior, 0.0f) << "the mode is permanent";
  EXPECT_TRUE(permanent.warned("cannot be animated and stays"));
  Builder to_zero = with_material({{"extensions", {{"KHR_materials_ior", {{"ior", 1.5}}}}}});
  animate(to_zero, pointer, {{1.5f, 0}, "SCALAR"});
  const Loaded end = moment(to_zero, 1.0);
  EXPECT_EQ(end.scene.materials[0].ior, 1.0f);
  EXPECT_TRUE(end.warned("below 1"));
}

TEST(unit_io_gltf_pointer, pointers_into_nothing_are_errors_before_anything_moves) {
  const auto error = [](const std::string& pointer, const json& material = json::object()) {
    Builder b = with_material(material);
    animate(b, pointer, {{0, 1}, "SCALAR"});
    return error_of(b);
  };
  EXPECT_THAT(error("/materials/9/alphaCutoff"), HasSubstr("points at nothing: there is no /materials/9"));
  EXPECT_THAT(error("/materials/0/pbrMetallicRoughness/roughnessFactor"),
              HasSubstr("there is no /materials/0/pbrMetallicRoughness"));
  EXPECT_THAT(error("/materials/0/extensions/KHR_materials_sheen/sheenRoughnessFactor"), HasSubstr("there is no"));
  EXPECT_THAT(error("/materials/0/normalTexture/extensions/KHR_texture_transform/rotation"), HasSubstr("there is no"));
  EXPECT_THAT(error("/nothing/here"), HasSubstr("there is no /nothing"));
  EXPECT_THAT(error("/nodes/5/weights/0"), HasSubstr("no such morph target"));
  EXPECT_THAT(error("/nodes/0/weights/0"), HasSubstr("no such morph target"));
  EXPECT_THAT(error("/nodes/00/translation"), HasSubstr("there is no /nodes/00"));
  EXPECT_THAT(error("/nodes/-/translation"), HasSubstr("there is no /nodes/-"));
  for (const char* broken : {"", "materials/0/alphaCutoff", "/materials/0/alpha~2Cutoff", "/materials/0/alpha~"}) {
    EXPECT_THAT(error(broken), HasSubstr("is no JSON pointer")) << broken;
  }
  EXPECT_LT(error("/" + std::string(100000, 'a') + "/b").size(), 700u) << "told in a line";
  Builder camera = triangle();
  camera.root["cameras"] = json::parse(R"([{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}])");
  animate(camera, "/cameras/0/perspective/zfar", {{5, 9}, "SCALAR"});
  EXPECT_THAT(error_of(camera), HasSubstr("zfar has no value in the file, and no default"));
  Builder number = with_material({});
  animate(number, "/materials/0/alphaCutoff", {{0, 1}, "SCALAR"});
  number.root["animations"][0]["channels"][0]["target"]["extensions"]["KHR_animation_pointer"]["pointer"] = 5;
  EXPECT_THAT(error_of(number), HasSubstr("must be a string"));
}

TEST(unit_io_gltf_pointer, values_of_another_type_are_errors) {
  const auto error = [](const Keys& keys) {
    Builder b = with_material({{"pbrMetallicRoughness", json::object()}});
    animate(b, "/materials/0/pbrMetallicRoughness/baseColorFactor", keys);
    return pose_error(b);
  };
  EXPECT_EQ(error({{0, 0, 0, 0, 1, 1, 1, 1}, "VEC4"}), "loaded");
  EXPECT_THAT(error({{0, 0, 0, 1, 1, 1}, "VEC3"}), HasSubstr("VEC3"));
  EXPECT_THAT(error({{0, 0, 0, 0, 1, 1, 1, 1}, "SCALAR"}), HasSubstr("SCALAR"));
  EXPECT_THAT(error({{0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1}, "VEC4"}), HasSubstr("6 numbers for each key"));
  EXPECT_THAT(error({{0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0, 1, 1, 1, 1}, "VEC4"}), HasSubstr("8 numbers for each key"));
}

TEST(unit_io_gltf_pointer, two_channels_for_one_property_are_told_and_the_last_one_counts) {
  Builder b = with_material({{"pbrMetallicRoughness", json::object()}});
  animate(b, "/materials/0/pbrMetallicRoughness/roughnessFactor", {{0, 0}, "SCALAR"});
  animate(b, "/materials/0/pbrMetallicRoughness/metallicFactor", {{0, 0}, "SCALAR"});
  EXPECT_FALSE(load(b).warned("two channels"));
  animate(b, "/materials/0/pbrMetallicRoughness/roughnessFactor", {{0.5f, 0.5f}, "SCALAR"});
  EXPECT_TRUE(load(b).warned("two channels move /materials/0/pbrMetallicRoughness/roughnessFactor; the last one"));
  EXPECT_EQ(moment(b, 0.5).scene.materials[0].roughness, 0.5f);
  Builder node = triangle();
  animate(node, "/nodes/0/translation", {{0, 0, 0, 1, 1, 1}, "VEC3"});
  add_channel(node, {{"node", 0}, {"path", "translation"}}, node.vec3s({5, 5, 5, 5, 5, 5}), {0, 1}, "LINEAR");
  EXPECT_TRUE(load(node).warned("two channels move the translation of node 0")) << "one by a pointer, one without";
  EXPECT_EQ(vec3(moment(node, 0.5).scene.nodes[0].world_from_node[3]), vec3(5, 5, 5));
  for (const bool whole_first : {true, false}) {
    Builder weights = triangle();
    primitive(weights)["targets"] = {{{"POSITION", weights.vec3s({0, 0, 1, 0, 0, 1, 0, 0, 1})}}};
    animate(weights, whole_first ? "/nodes/0/weights" : "/nodes/0/weights/0", {{0, 1}, "SCALAR"});
    animate(weights, whole_first ? "/nodes/0/weights/0" : "/nodes/0/weights", {{0, 1}, "SCALAR"});
    EXPECT_TRUE(load(weights).warned("two channels move the weight")) << "an array and one of its elements";
  }
}

TEST(unit_io_gltf_pointer, what_is_not_drawn_or_not_to_be_moved_is_told) {
  Builder b = with_material(json::parse(R"({"extras": {"mood": 1}, "extensions": {"VENDOR_glow": {"strength": 1}}})"));
  b.root["nodes"][0]["extensions"]["KHR_node_hoverability"]["hoverable"] = true;
  Builder unknown = b, own = b, unseen = b, still = b, with_node = b;
  animate(unknown, "/materials/0/extensions/VENDOR_glow/strength", {{0, 1}, "SCALAR"});
  EXPECT_TRUE(moment(unknown, 0.5).warned("'/materials/0/extensions/VENDOR_glow/strength' is not supported"));
  animate(own, "/materials/0/extras/mood", {{0, 1}, "SCALAR"});
  EXPECT_TRUE(moment(own, 0.5).noted("'/materials/0/extras/mood' changes no pixel"));
  animate(unseen, "/nodes/0/extensions/KHR_node_hoverability/hoverable", {{0, 1}, "SCALAR", "STEP"});
  EXPECT_TRUE(moment(unseen, 0.5).noted("changes no pixel"));
  animate(still, "/materials/0/doubleSided", {{0, 1}, "SCALAR", "STEP"});
  EXPECT_TRUE(moment(still, 0.5).warned("'/materials/0/doubleSided' is not supported"))
      << "the object model: read-only";
  animate(with_node, "/materials/0/alphaCutoff", {{0, 1}, "SCALAR"});
  with_node.root["animations"][0]["channels"][0]["target"]["node"] = 0;
  EXPECT_TRUE(moment(with_node, 0.5).warned("must have no node"));
  EXPECT_EQ(moment(with_node, 0.5).scene.materials[0].alpha_cutoff, 0.5f);
}

TEST(unit_io_gltf_pointer, images_and_geometry_are_read_once) {
  Builder b = with_material(json::parse(R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})"));
  add_texture(b);
  animate(b, "/materials/0/pbrMetallicRoughness/baseColorFactor", {{0, 0, 0, 1, 1, 1, 1, 1}, "VEC4"});
  Diagnostics diagnostics;
  GltfFile file(b.glb(), {}, "test", diagnostics);
  const Scene rest = file.scene(diagnostics), now = file.scene(diagnostics, Pose{"", 0.25}),
              later = file.scene(diagnostics, Pose{"", 0.75}), again = file.scene(diagnostics);
  EXPECT_EQ(now.materials[0].base_color, vec3(0.25f));
  EXPECT_EQ(later.materials[0].base_color, vec3(0.75f));
  EXPECT_EQ(again.materials[0].base_color, vec3(1.0f)) << "at rest again";
  ASSERT_NE(rest.meshes[0].identity, nullptr);
  for (const Scene* scene : {&now, &later, &again}) {
    EXPECT_EQ(scene->images[0], rest.images[0]);
    EXPECT_EQ(scene->meshes[0].identity, rest.meshes[0].identity);
  }
}

TEST(unit_io_gltf_pointer, an_image_that_only_some_moments_show_does_not_change_the_others) {
  // A relief without height does not read its image.
  Builder b = with_material(json::parse(R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 1}},
    "extras": {"candela": {"heightTexture": {"index": 0, "scale": 1}}}})"));
  add_texture(b);
  b.root["images"].push_back({{"uri", "data:image/png;base64," + base64(tiny_png())}});
  b.root["textures"].push_back({{"source", 1}});
  animate(b, "/materials/0/extras/candela/heightTexture/scale", {{0, 1}, "SCALAR"});
  Diagnostics diagnostics;
  GltfFile file(b.glb(), {}, "test", diagnostics);
  const Scene flat = file.scene(diagnostics, Pose{"", 0.0}), high = file.scene(diagnostics, Pose{"", 1.0});
  ASSERT_EQ(flat.images.size(), 1u);
  ASSERT_EQ(high.images.size(), 2u);
  EXPECT_EQ(high.images[1], flat.images[0]);
}

TEST(unit_io_gltf_pointer, tangents_follow_what_a_moment_asks_for) {
  Builder b = with_material(json::parse(R"({"extensions": {"KHR_materials_anisotropy": {}}})"));
  animate(b, "/materials/0/extensions/KHR_materials_anisotropy/anisotropyStrength", {{0, 1}, "SCALAR"});
  Diagnostics diagnostics;
  GltfFile file(b.glb(), {}, "test", diagnostics);
  EXPECT_TRUE(file.scene(diagnostics, Pose{"", 0.0}).meshes[0].primitives[0].tangents.empty());
  EXPECT_FALSE(file.scene(diagnostics, Pose{"", 0.5}).meshes[0].primitives[0].tangents.empty());
  EXPECT_TRUE(file.scene(diagnostics).meshes[0].primitives[0].tangents.empty()) << "at rest again";
}

TEST(unit_io_gltf_pointer, materials_of_a_variant_move_too) {
  Builder b = dressed();
  animate(b, "/materials/1/extensions/KHR_materials_pbrSpecularGlossiness/glossinessFactor", {{0, 1}, "SCALAR"});
  EXPECT_EQ(moment(b, 0.25, LoadOptions{.variant = "glossy"}).scene.materials[0].roughness, 0.75f);
  EXPECT_FALSE(moment(b, 0.25).scene.materials[0].specular_glossiness) << "nobody wears it";
}

TEST(unit_io_gltf_pointer, info_lists_them) {
  Builder b = with_material({{"pbrMetallicRoughness", json::object()}});
  animate(b, "/materials/0/pbrMetallicRoughness/roughnessFactor", {{0, 1}, "SCALAR", "LINEAR", {0, 2.5f}});
  b.root["extensionsUsed"] = b.root["extensionsRequired"] = {"KHR_animation_pointer"};
  Diagnostics diagnostics;
  FileInfo info;
  load_gltf(b.glb(), {}, diagnostics, {}, &info);
  ASSERT_EQ(info.animations.size(), 1u);
  EXPECT_EQ(info.animations[0].duration_s, 2.5f) << "of pointers alone";
  EXPECT_EQ(info.animations[0].pointers, std::vector<std::string>{"/materials/0/pbrMetallicRoughness/roughnessFactor"});
  EXPECT_TRUE(diagnostics.warnings().empty());
}

}  // namespace
}  // namespace candela::io::test
