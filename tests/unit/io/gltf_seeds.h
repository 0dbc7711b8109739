#pragma once

#include "unit/io/gltf_builder.h"

namespace candela::io::test {

/// Every extension that a metallic-roughness material may have, each with all its members.
inline Builder layered() {
  Builder b = with_material(json::parse(R"({
      "name": "layers", "extras": {"candela": {"conductor": "gold"}}, "extensions": {
        "KHR_materials_clearcoat": {"clearcoatFactor": 0.5, "clearcoatTexture": {"index": 0}, "clearcoatRoughnessFactor": 0.2,
          "clearcoatRoughnessTexture": {"index": 0}, "clearcoatNormalTexture": {"index": 0, "scale": 0.5, "texCoord": 1}},
        "KHR_materials_sheen": {"sheenColorFactor": [0.1, 0.2, 0.3], "sheenColorTexture": {"index": 0},
          "sheenRoughnessFactor": 0.4, "sheenRoughnessTexture": {"index": 0}},
        "KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyRotation": 1, "anisotropyTexture": {"index": 0}},
        "KHR_materials_iridescence": {"iridescenceFactor": 0.5, "iridescenceTexture": {"index": 0}, "iridescenceIor": 1.4,
          "iridescenceThicknessMinimum": 200, "iridescenceThicknessMaximum": 300, "iridescenceThicknessTexture": {"index": 0}},
        "KHR_materials_transmission": {"transmissionFactor": 0.5, "transmissionTexture": {"index": 0}},
        "KHR_materials_volume": {"thicknessFactor": 0.5, "thicknessTexture": {"index": 0}, "attenuationDistance": 0.25,
          "attenuationColor": [0, 0.5, 1]},
        "KHR_materials_dispersion": {"dispersion": 0.5},
        "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.5, "diffuseTransmissionTexture": {"index": 0},
          "diffuseTransmissionColorFactor": [1, 0.5, 0], "diffuseTransmissionColorTexture": {"index": 0}},
        "KHR_materials_volume_scatter": {"multiscatterColor": [0.5, 0.25, 0], "scatterAnisotropy": 0.25}}})"));
  add_texture(b);
  return b;
}

/// Two variants of one triangle: specular-glossiness, and without light. A third material scatters by the later draft.
inline Builder dressed() {
  Builder b = with_material(json::parse(R"({
      "extensions": {"KHR_materials_volume": {"thicknessFactor": 1}, "KHR_materials_transmission": {"transmissionFactor": 1},
        "KHR_materials_scatter": {"scatterStrengthFactor": 0.5, "scatterStrengthTexture": {"index": 0},
        "multiscatterColorTexture": {"index": 0}, "multiscatterColorFactor": [1, 0.5, 0.25], "scatterAnisotropy": -0.5}}})"));
  b.root["materials"].push_back(json::parse(R"({
      "name": "glossy", "extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [0.1, 0.2, 0.3, 0.4],
        "diffuseTexture": {"index": 0}, "specularFactor": [0.5, 0.6, 0.7], "glossinessFactor": 0.25,
        "specularGlossinessTexture": {"index": 0}}}})"));
  b.root["materials"].push_back({{"extensions", {{"KHR_materials_unlit", json::object()}}}});
  add_texture(b);
  b.root["extensions"]["KHR_materials_variants"]["variants"] = json::array({{{"name", "glossy"}}, {{"name", "flat"}}});
  primitive(b)["extensions"]["KHR_materials_variants"]["mappings"] = json::array(
      {{{"material", 1}, {"variants", json::array({0})}}, {{"material", 2}, {"variants", json::array({1})}}});
  return b;
}

/// A downlight: 100 cd straight down, nothing sideways.
inline std::string tiny_ies() {
  return "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 2 1 2 0 0 0\n1 1 50\n0 45 90\n0 90\n100 50 0\n100 40 0\n";
}

/// Small files that together touch every part of the loader: what mutation and fuzzing start from.
/// A triangle with a skin and a morph target that every kind of channel and interpolation moves, and instances of it.
inline Builder moving() {
  Builder b = triangle();
  const int up = b.vec3s({0, 0, 1, 0, 0, 1, 0, 0, 1});
  const int joints = b.accessor(std::vector<std::uint8_t>(12, 0), "VEC4", 5121, 4);
  const int weights = b.vec4s({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  primitive(b)["targets"] = json::array({{{"POSITION", up}}});
  primitive(b)["attributes"]["JOINTS_0"] = joints;
  primitive(b)["attributes"]["WEIGHTS_0"] = weights;
  const int places = b.vec3s({0, 0, 0, 1, 0, 0});
  b.root["nodes"] = json::parse(R"([{"children": [1, 2]}, {"mesh": 0, "skin": 0}, {"mesh": 0}])");
  b.root["nodes"][2]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = places;
  b.root["extensionsUsed"] = json::array({"EXT_mesh_gpu_instancing"});
  b.root["skins"] = json::parse(R"([{"joints": [0]}])");
  const int times = b.floats({0, 1}, "SCALAR", 1);
  b.root["accessors"][static_cast<std::size_t>(times)]["max"] = json::array({1});
  const int moves = b.vec3s({0, 0, 0, 1, 2, 3}), turns = b.vec4s({0, 0, 0, 1, 0, 0, 1, 0});
  const int spline = b.vec3s({0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 2, 2, 2, 0, 0, 0});
  const int shares = b.floats({0, 1}, "SCALAR", 1);
  b.root["animations"] =
      json::array({{{"samplers",
                     {{{"input", times}, {"output", moves}, {"interpolation", "STEP"}},
                      {{"input", times}, {"output", turns}},
                      {{"input", times}, {"output", spline}, {"interpolation", "CUBICSPLINE"}},
                      {{"input", times}, {"output", shares}}}},
                    {"channels", json::parse(R"([{"sampler": 0, "target": {"node": 0, "path": "translation"}},
                                    {"sampler": 1, "target": {"node": 0, "path": "rotation"}},
                                    {"sampler": 2, "target": {"node": 0, "path": "scale"}},
                                    {"sampler": 3, "target": {"node": 1, "path": "weights"}}])")}}});
  return b;
}

/// A triangle whose node, weights, visibility, material, texture, light and camera move by pointers.
inline Builder pointed() {
  Builder b =
      with_material(json::parse(R"({"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0,
      "extensions": {"KHR_texture_transform": {}}}}, "extensions": {"KHR_materials_ior": {}, "KHR_materials_anisotropy": {},
      "KHR_materials_iridescence": {}, "KHR_materials_volume": {}}})"));
  add_texture(b);
  primitive(b)["targets"] = json::array({{{"POSITION", b.vec3s({0, 0, 1, 0, 0, 1, 0, 0, 1})}}});
  b.root["nodes"] = json::parse(R"([{"mesh": 0, "children": [1], "extensions": {"KHR_node_visibility": {}}},
    {"camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}}])");
  b.root["cameras"] = json::parse(R"([{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}])");
  b.root["extensions"]["KHR_lights_punctual"]["lights"] = json::parse(R"([{"type": "spot", "range": 2, "spot": {}}])");
  b.root["extensionsUsed"] = json::array({"KHR_animation_pointer"});
  const int times = b.floats({0, 0.75f}, "SCALAR", 1);
  b.root["accessors"][static_cast<std::size_t>(times)]["max"] = {0.75};
  json& animation = b.root["animations"][0];
  const auto move = [&](const char* pointer, int output, const char* interpolation = "LINEAR") {
    animation["samplers"].push_back({{"input", times}, {"output", output}, {"interpolation", interpolation}});
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size() - 1},
         {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}});
  };
  const int flags = b.accessor(std::vector<std::uint8_t>{1, 0}, "SCALAR", 5121, 1);
  const int share = b.floats({0, 1}, "SCALAR", 1), spline = b.floats({1, 1, 0, 0, 2, 1}, "SCALAR", 1);
  const int pair = b.vec2s({0, 1, 2, 3}), triple = b.vec3s({0, 0, 0, 1, 1, 1});
  const int bytes = b.accessor(std::vector<std::uint8_t>{0, 0, 0, 0, 255, 51, 255, 255}, "VEC4", 5121, 4, true);
  move("/nodes/0/translation", triple);
  move("/nodes/0/rotation", b.vec4s({0, 0, 0, 1, 0, 0, 1, 0}));
  move("/nodes/0/weights/0", share);
  move("/nodes/0/extensions/KHR_node_visibility/visible", flags, "STEP");
  move("/materials/0/pbrMetallicRoughness/baseColorFactor", bytes);
  move("/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/scale", pair);
  move("/materials/0/extensions/KHR_materials_ior/ior", spline, "CUBICSPLINE");
  move("/materials/0/extensions/KHR_materials_anisotropy/anisotropyStrength", share);
  move("/materials/0/extensions/KHR_materials_iridescence/iridescenceFactor", share);
  move("/materials/0/extensions/KHR_materials_volume/attenuationColor", triple);
  move("/extensions/KHR_lights_punctual/lights/0/range", spline, "CUBICSPLINE");
  move("/extensions/KHR_lights_punctual/lights/0/spot/outerConeAngle", share);
  move("/cameras/0/perspective/yfov", spline, "CUBICSPLINE");
  return b;
}

inline std::vector<Builder> seed_files() {
  std::vector<Builder> seeds;
  seeds.push_back(triangle());

  Builder material = with_material(json::parse(R"({
      "name": "all", "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.25, "emissiveFactor": [0.5, 0.25, 1],
      "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.6,
        "baseColorTexture": {"index": 0, "texCoord": 1, "extensions": {"KHR_texture_transform": {"offset": [1, 2], "rotation": 0.3, "scale": [2, -1], "texCoord": 0}}},
        "metallicRoughnessTexture": {"index": 0}},
      "normalTexture": {"index": 1, "scale": 2}, "occlusionTexture": {"index": 0, "strength": 0.5}, "emissiveTexture": {"index": 1},
      "extensions": {"KHR_materials_ior": {"ior": 1.33}, "KHR_materials_emissive_strength": {"emissiveStrength": 8},
        "KHR_materials_specular": {"specularFactor": 0.9, "specularColorFactor": [2, 1, 0.5], "specularTexture": {"index": 0}}}})"));
  add_texture(material);
  material.root["images"].push_back({{"uri", "data:image/png;base64," + base64(tiny_png())}});
  material.root["textures"].push_back({{"source", 1}, {"sampler", 0}});
  material.root["samplers"] = json::array({{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}});
  material.root["extensionsUsed"] = json::array({"KHR_materials_ior", "KHR_texture_transform", "KHR_texture_basisu"});
  material.root["extensionsRequired"] = json::array({"KHR_texture_transform"});
  seeds.push_back(material);

  seeds.push_back(layered());
  seeds.push_back(dressed());
  seeds.push_back(moving());
  seeds.push_back(pointed());

  Builder skinned = triangle();
  auto& attributes = primitive(skinned)["attributes"];
  attributes["JOINTS_0"] =
      skinned.accessor(std::vector<std::uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, "VEC4", 5121, 4);
  attributes["WEIGHTS_0"] = skinned.vec4s({1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0});
  attributes["COLOR_0"] =
      skinned.accessor(std::vector<std::uint16_t>{0, 0, 0, 13107, 65535, 0, 0, 0, 0}, "VEC3", 5123, 3, true);
  std::vector<float> matrices(32, 0.0f);
  for (const std::size_t i : {0U, 5U, 10U, 15U, 16U, 21U, 26U, 31U}) matrices[i] = 1;
  skinned.root["skins"] =
      json::array({{{"joints", {1, 2}}, {"inverseBindMatrices", skinned.floats(matrices, "MAT4", 16)}}});
  primitive(skinned)["targets"] = json::array({{{"POSITION", skinned.vec3s({0, 0, 1, 0, 0, 1, 0, 0, 1})}},
                                               {{"NORMAL", skinned.vec3s({0, 1, 0, 0, 1, 0, 0, 1, 0})}}});
  skinned.root["meshes"][0]["weights"] = {0.5, 0.5};
  skinned.root["nodes"] = json::array({{{"mesh", 0}, {"skin", 0}, {"children", json::array({3})}, {"weights", {1, 0}}},
                                       {{"translation", {0, 0, 5}}, {"children", json::array({2})}},
                                       {{"rotation", {0, 0.6, 0, 0.8}}, {"scale", {2, 2, -2}}},
                                       {{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1}}, {"mesh", 0}}});
  skinned.root["scenes"] = json::array({{{"nodes", {0, 1}}, {"name", "scene"}}});
  seeds.push_back(skinned);

  Builder strips = triangle();
  const int interleaved = strips.view(
      std::vector<float>{0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 1, 1, 1, 0, 0, 0, 1, 0, 2, 0, 0, 0, 1}, 24);
  const int positions =
      strips.add_accessor({{"bufferView", interleaved}, {"componentType", 5126}, {"count", 5}, {"type", "VEC3"}});
  const int sparse = strips.add_accessor(
      {{"componentType", 5126},
       {"count", 5},
       {"type", "VEC3"},
       {"sparse",
        {{"count", 2},
         {"indices", {{"bufferView", strips.view(std::vector<std::uint8_t>{1, 4})}, {"componentType", 5121}}},
         {"values", {{"bufferView", strips.view(std::vector<float>{1, 0, 0, 0, 1, 0})}}}}}});
  const int bytes =
      strips.accessor(std::vector<std::int8_t>{0, 0, 0, 0, 127, 0, 0, 0, 0, 127, 0, 0, 127, 127, 0, 0, -127, 127, 0, 0},
                      "VEC4", 5120, 4, true);
  (void)bytes;
  strips.root["meshes"][0]["primitives"] = json::array({{{"attributes", {{"POSITION", positions}}}, {"mode", 5}},
                                                        {{"attributes", {{"POSITION", sparse}}}, {"mode", 6}},
                                                        {{"attributes", {{"POSITION", positions}}}, {"mode", 1}}});
  seeds.push_back(strips);

  Builder sky = triangle();
  sky.root["images"] = json::array({{{"bufferView", sky.view(tiny_png())}}});
  sky.root["extensionsUsed"] = json::array({"EXT_lights_image_based"});
  sky.root["extensions"]["EXT_lights_image_based"]["lights"] =
      json::array({{{"rotation", {0.6, 0, 0, 0.8}},
                    {"intensity", 2},
                    {"irradianceCoefficients", std::vector(9, std::vector<float>{1, 0, 0})},
                    {"specularImageSize", 1},
                    {"specularImages", json::array({std::vector<int>(6, 0)})}}});
  sky.root["scenes"][0]["extensions"]["EXT_lights_image_based"] = {{"light", 0}};
  seeds.push_back(sky);

  Builder lights = triangle();
  lights.root["extensionsUsed"] = json::array({"KHR_lights_punctual"});
  lights.root["extensions"]["KHR_lights_punctual"]["lights"] =
      json::array({{{"type", "spot"},
                    {"color", {1, 0.5, 0}},
                    {"intensity", 20},
                    {"range", 4},
                    {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.2}}}},
                   {{"type", "directional"}}});
  lights.root["extensions"]["KHR_lights_punctual"]["lights"][0]["extras"]["candela"] = {
      {"temperature_k", 3000}, {"falloff", "polynomial"}, {"polynomial", {1, 0.5, 0.1}}, {"lumens", 800}};
  const std::string ies = tiny_ies();
  lights.root["extensions"]["EXT_lights_ies"]["lights"] =
      json::array({{{"bufferView", lights.view(std::vector<char>(ies.begin(), ies.end()))},
                    {"mimeType", "application/x-ies-lm-63"}}});
  lights.root["cameras"] =
      json::array({{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"aspectRatio", 1.5}}}},
                   {{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", 3}}}}});
  lights.root["nodes"] =
      json::array({{{"camera", 0}, {"mesh", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}},
                   {{"camera", 1}, {"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}}});
  lights.root["nodes"][1]["extensions"]["EXT_lights_ies"] = {{"light", 0}, {"multiplier", 2}, {"color", {1, 0.5, 0}}};
  seeds.push_back(lights);
  return seeds;
}

}  // namespace candela::io::test
