#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "unit/io/gltf_builder.h"

namespace candela::io::test {
namespace {

using ::testing::HasSubstr;

const Primitive& first(const Loaded& loaded) { return loaded.scene.meshes.at(0).primitives.at(0); }

vec3 area_direction(const Primitive& p, std::size_t f) {
  const uvec3 t = p.triangles.at(f);
  return glm::normalize(glm::cross(p.positions[t.y] - p.positions[t.x], p.positions[t.z] - p.positions[t.x]));
}

/// A strip or fan of five vertices that winds counter-clockwise seen from +z.
Builder five_vertices(int mode) {
  Builder b = triangle();
  const int strip = b.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0});
  const int fan = b.vec3s({0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0, -1, 1, 0});
  b.root["meshes"][0]["primitives"] = {{{"attributes", {{"POSITION", mode == 5 ? strip : fan}}}, {"mode", mode}}};
  return b;
}

TEST(unit_io_gltf_mesh, strips_and_fans_keep_their_orientation) {
  for (const int mode : {5, 6}) {
    const Loaded loaded = load(five_vertices(mode));
    const Primitive& p = first(loaded);
    ASSERT_EQ(p.triangles.size(), 3u) << mode;
    for (std::size_t f = 0; f < 3; ++f)
      EXPECT_EQ(area_direction(p, f), vec3(0, 0, 1)) << "mode " << mode << " triangle " << f;
  }
}

TEST(unit_io_gltf_mesh, strips_and_fans_number_their_triangles_as_specified) {
  Builder b = five_vertices(5);
  primitive(b)["attributes"]["NORMAL"] = b.vec3s({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  EXPECT_EQ(first(load(b)).triangles, (std::vector<uvec3>{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
  b = five_vertices(6);
  primitive(b)["attributes"]["NORMAL"] = b.vec3s({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  EXPECT_EQ(first(load(b)).triangles, (std::vector<uvec3>{{1, 2, 0}, {2, 3, 0}, {3, 4, 0}}));
}

TEST(unit_io_gltf_mesh, points_and_lines_are_counted_in_one_warning) {
  Builder b = triangle();
  for (const int mode : {0, 1, 2, 3}) {
    json other = primitive(b);
    other["mode"] = mode;
    b.root["meshes"][0]["primitives"].push_back(other);
  }
  const Loaded loaded = load(b);
  EXPECT_EQ(loaded.scene.meshes[0].primitives.size(), 1u);
  ASSERT_EQ(loaded.warnings.size(), 1u);
  EXPECT_EQ(loaded.warnings[0].message, "4 primitives made of points or lines are ignored");
  primitive(b)["mode"] = 7;
  EXPECT_THAT(error_of(b), HasSubstr("7 is not a primitive mode"));
}

TEST(unit_io_gltf_mesh, a_mesh_without_triangles_is_no_mesh) {
  Builder b = triangle();
  primitive(b)["mode"] = 0;
  EXPECT_EQ(load(b).scene.nodes.at(0).mesh, -1);
  EXPECT_TRUE(world_bounds(load(b).scene).empty());
}

TEST(unit_io_gltf_mesh, missing_normals_become_flat_and_split) {
  Builder b = triangle();
  // Two faces of a roof that share an edge.
  const int positions = b.vec3s({0, 0, 0, 0, 1, 0, 1, 0, -1, -1, 0, -1});
  const int colors = b.vec4s({1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 1, 1, 1, 1, 1, 1});
  b.root["meshes"][0]["primitives"] = {
      {{"attributes", {{"POSITION", positions}, {"COLOR_0", colors}}}, {"indices", b.indices({0, 2, 1, 0, 1, 3})}}};
  const Loaded loaded = load(b);
  const Primitive& p = first(loaded);
  ASSERT_EQ(p.positions.size(), 6u);
  for (std::size_t f = 0; f < 2; ++f) {
    for (int i = 0; i < 3; ++i) EXPECT_LT(glm::length(p.normals[p.triangles[f][i]] - area_direction(p, f)), 1e-6f);
  }
  EXPECT_NE(p.normals[0], p.normals[3]);
  EXPECT_EQ(p.colors[1], vec4(0, 0, 1, 1));
}

TEST(unit_io_gltf_mesh, zero_normals_are_replaced_and_others_normalised) {
  Builder b = triangle();
  primitive(b)["attributes"]["NORMAL"] = b.vec3s({0, 0, 0, 0, 3, 0, 1e-30f, 0, 0});
  const Loaded loaded = load(b);
  EXPECT_EQ(first(loaded).normals, (std::vector<vec3>{{0, 0, 1}, {0, 1, 0}, {1, 0, 0}}));
}

TEST(unit_io_gltf_mesh, degenerate_triangles_are_dropped_in_silence) {
  Builder b = triangle();
  const int positions = b.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 0, 0, 0, 0, 0});
  b.root["meshes"][0]["primitives"] = {
      {{"attributes", {{"POSITION", positions}}}, {"indices", b.indices({0, 0, 1, 0, 1, 3, 0, 4, 2, 0, 1, 2})}}};
  const Loaded loaded = load(b);
  EXPECT_EQ(first(loaded).triangles.size(), 1u);
  EXPECT_TRUE(loaded.warnings.empty());
  // Tiny ones stay.
  primitive(b)["attributes"]["POSITION"] = b.vec3s({0, 0, 0, 1e-20f, 0, 0, 0, 1e-20f, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(first(load(b)).normals.at(0), vec3(0, 0, 1));
}

TEST(unit_io_gltf_mesh, only_used_vertices_are_kept) {
  Builder b = triangle();
  std::vector<float> many(3000, 0.0f);
  many[1500] = 1;
  many[3 * 999 + 1] = 1;
  primitive(b) = {{"attributes", {{"POSITION", b.vec3s(many)}, {"NORMAL", b.vec3s(std::vector<float>(3000, 1.0f))}}},
                  {"indices", b.indices({999, 7, 500})}};
  const Loaded loaded = load(b);
  EXPECT_EQ(first(loaded).positions, (std::vector<vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(first(loaded).triangles, (std::vector<uvec3>{{2, 0, 1}}));
}

TEST(unit_io_gltf_mesh, colours_of_every_kind_are_linear_rgba) {
  const auto colour = [](auto add) {
    Builder b = triangle();
    primitive(b)["attributes"]["COLOR_0"] = add(b);
    return first(load(b)).colors.at(1);
  };
  EXPECT_EQ(colour([](Builder& b) { return b.vec3s({1, 1, 1, 0.5f, 0.25f, 0, 1, 1, 1}); }), vec4(0.5f, 0.25f, 0, 1));
  EXPECT_EQ(colour([](Builder& b) {
              return b.vec4s({1, 1, 1, 1, 0.5f, 0.25f, 0, 0.75f, 1, 1, 1, 1});
            }),
            vec4(0.5f, 0.25f, 0, 0.75f));
  EXPECT_EQ(
      colour([](Builder& b) {
        return b.accessor(std::vector<std::uint8_t>{0, 0, 0, 0, 51, 102, 255, 0, 0, 0, 0, 0}, "VEC4", 5121, 4, true);
      }),
      vec4(0.2f, 0.4f, 1, 0));
  EXPECT_EQ(colour([](Builder& b) {
              return b.accessor(std::vector<std::uint16_t>{0, 0, 0, 13107, 65535, 0, 0, 0, 0}, "VEC3", 5123, 3, true);
            }),
            vec4(0.2f, 1, 0, 1));
  Builder b = triangle();
  primitive(b)["attributes"]["COLOR_0"] = b.vec3s({2, -1, 0, 0, 0, 0, 0, 0, 0});
  const Loaded loaded = load(b);
  EXPECT_EQ(first(loaded).colors[0], vec4(1, 0, 0, 1));
  EXPECT_TRUE(loaded.warned("clamped"));
}

TEST(unit_io_gltf_mesh, two_uv_sets_are_read_and_more_where_a_texture_reads_them) {
  Builder b = triangle();
  add_texture(b);
  primitive(b)["attributes"]["TEXCOORD_1"] =
      b.accessor(std::vector<std::uint16_t>{0, 0, 65535, 0, 0, 65535}, "VEC2", 5123, 2, true);
  primitive(b)["attributes"]["TEXCOORD_2"] = b.vec2s({0, 0, 0, 0, 0, 0});
  primitive(b)["attributes"]["TEXCOORD_17"] = b.vec2s({1, 2, 3, 4, 5, 6});
  primitive(b)["material"] = 0;
  b.root["materials"] = {{{"emissiveTexture", {{"index", 0}, {"texCoord", 17}}}}};
  const Loaded loaded = load(b);
  const Primitive& p = first(loaded);
  EXPECT_EQ(p.uvs[1], (std::vector<vec2>{{0, 0}, {1, 0}, {0, 1}}));
  EXPECT_TRUE(p.uvs[2].empty()) << "nothing reads it";
  EXPECT_EQ(p.uvs[17], (std::vector<vec2>{{1, 2}, {3, 4}, {5, 6}}));
  EXPECT_EQ(loaded.scene.materials[0].emissive_texture.uv_set, 17);
  EXPECT_TRUE(loaded.warnings.empty());
  // The transform's word wins; what the file has not is 0, as of any set.
  b.root["materials"][0]["emissiveTexture"]["extensions"]["KHR_texture_transform"]["texCoord"] = 5;
  const Loaded moved = load(b);
  EXPECT_EQ(first(moved).uvs[5], std::vector<vec2>(3, vec2(0)));
  EXPECT_TRUE(first(moved).uvs[17].empty());
  EXPECT_TRUE(moved.warned("needs TEXCOORD_5, which is missing"));
  b.root["materials"][0]["emissiveTexture"]["extensions"]["KHR_texture_transform"]["texCoord"] = 4000000000u;
  EXPECT_TRUE(load(b).warned("TEXCOORD_4000000000"));
}

TEST(unit_io_gltf_mesh, tangents_are_those_of_the_normal_maps_own_set) {
  Builder b = triangle();
  add_texture(b);
  primitive(b)["attributes"]["TEXCOORD_3"] = b.vec2s({0, 0, 0, 1, 1, 0});  // u along +y
  primitive(b)["material"] = 0;
  b.root["materials"] = {{{"normalTexture", {{"index", 0}, {"texCoord", 3}}}}};
  const Loaded third = load(b);
  for (const vec4& t : first(third).tangents) EXPECT_NEAR(t.y, 1.0f, 1e-5f);
  b.root["materials"][0]["normalTexture"]["texCoord"] = 0;
  const Loaded zeroth = load(b);
  for (const vec4& t : first(zeroth).tangents) EXPECT_NEAR(t.x, 1.0f, 1e-5f);
}

TEST(unit_io_gltf_mesh, further_colours_disturb_nothing_and_are_noted) {
  Builder b = triangle();
  primitive(b)["attributes"]["COLOR_0"] = b.vec3s({1, 0, 0, 1, 0, 0, 1, 0, 0});
  primitive(b)["attributes"]["COLOR_1"] = b.vec3s({0, 9, 0, 0, 9, 0, 0, 9, 0});
  const Loaded loaded = load(b);
  EXPECT_EQ(first(loaded).colors[0], vec4(1, 0, 0, 1));
  EXPECT_TRUE(loaded.warnings.empty());
  EXPECT_TRUE(loaded.noted("COLOR_1 changes no pixel"));
}

TEST(unit_io_gltf_mesh, morph_targets_move_colours_and_all_uv_sets) {
  Builder b = triangle();
  add_texture(b);
  auto& attributes = primitive(b)["attributes"];
  attributes["TEXCOORD_0"] = b.vec2s({0, 0, 1, 0, 0, 1});
  attributes["TEXCOORD_2"] = b.vec2s({0, 0, 1, 0, 0, 1});
  attributes["COLOR_0"] = b.vec4s({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 0.5f});
  primitive(b)["material"] = 0;
  b.root["materials"] = {{{"emissiveTexture", {{"index", 0}, {"texCoord", 2}}}}};
  // Sparse: only the last vertex; normalized bytes; and what moves colour but not alpha.
  const int indices = b.view(std::vector<std::uint16_t>{2}), values = b.view(std::vector<float>{0, 0, 1, 0.5f});
  const int sparse = b.add_accessor({{"componentType", 5126},
                                     {"count", 3},
                                     {"type", "VEC4"},
                                     {"sparse",
                                      {{"count", 1},
                                       {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                                       {"values", {{"bufferView", values}}}}}});
  const int bytes =
      b.accessor(std::vector<std::int8_t>{-127, 127, 0, 0, -127, 127, 0, 0, -127, 127, 0, 0}, "VEC4", 5120, 4, true);
  const int rgb = b.vec3s({0, 0, 4, 0, 0, 4, 0, 0, 4});
  primitive(b)["targets"] = {{{"COLOR_0", sparse}, {"TEXCOORD_2", b.vec2s({1, 1, 1, 1, 1, 1})}},
                             {{"COLOR_0", bytes}, {"TEXCOORD_0", b.vec2s({0, 2, 0, 2, 0, 2})}},
                             {{"COLOR_0", rgb}}};
  const auto posed = [&b](const json& weights) {
    b.root["meshes"][0]["weights"] = weights;
    return load(b);
  };
  const Loaded last = posed({0.5, 0, 0});
  EXPECT_EQ(first(last).colors, (std::vector<vec4>{{1, 0, 0, 1}, {1, 0, 0, 1}, {1, 0, 0.5f, 0.75f}}));
  EXPECT_EQ(first(last).uvs[2][1], vec2(1.5f, 0.5f));
  EXPECT_EQ(first(last).uvs[0][1], vec2(1, 0));
  const Loaded green = posed({0, 0.75, 0});
  EXPECT_LT(glm::length(first(green).colors[0] - vec4(0.25f, 0.75f, 0, 1)), 1e-6f);
  EXPECT_EQ(first(green).uvs[0][1], vec2(1, 1.5f));
  EXPECT_EQ(first(green).uvs[2][1], vec2(1, 0));
  const Loaded blue = posed({0, 0, 1});
  EXPECT_EQ(first(blue).colors[2], vec4(1, 0, 1, 0.5f)) << "clamped after the sum, alpha as it was";
  EXPECT_TRUE(blue.warnings.empty());
  attributes.erase("COLOR_0");
  EXPECT_TRUE(posed({0, 1, 0}).warned("COLOR_0, which the primitive has not"));
}

TEST(unit_io_gltf_mesh, morph_targets_apply_with_the_meshs_and_the_nodes_weights) {
  Builder b = triangle();
  const int up = b.vec3s({0, 0, 1, 0, 0, 1, 0, 0, 1});
  const int right = b.vec3s({4, 0, 0, 4, 0, 0, 4, 0, 0});
  const int tilt = b.vec3s({0, 2, -1, 0, 0, 0, 0, 0, 0});
  primitive(b)["targets"] = {{{"POSITION", up}, {"NORMAL", tilt}}, {{"POSITION", right}}};
  b.root["meshes"][0]["weights"] = {1, 0};
  b.root["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"weights", {0, 0.5}}}, {{"mesh", 0}, {"weights", {1, 0}}}};
  b.root["scenes"] = {{{"nodes", {0, 1, 2}}}};
  const Loaded loaded = load(b);
  EXPECT_TRUE(loaded.warnings.empty());
  ASSERT_EQ(loaded.scene.meshes.size(), 2u);
  EXPECT_EQ(loaded.scene.nodes[2].mesh, loaded.scene.nodes[0].mesh);
  const auto shown = [&](std::size_t node) {
    return loaded.scene.meshes[static_cast<std::size_t>(loaded.scene.nodes[node].mesh)].primitives.at(0);
  };
  EXPECT_EQ(shown(0).positions[1], vec3(1, 0, 1));
  EXPECT_EQ(shown(0).normals[0], vec3(0, 1, 0));
  EXPECT_EQ(shown(1).positions[1], vec3(3, 0, 0));
}

/// The triangle bound to two joints: vertex 0 to the first, 1 to the second, 2 half and half.
Builder skinned() {
  Builder b = triangle();
  auto& attributes = primitive(b)["attributes"];
  attributes["JOINTS_0"] = b.accessor(std::vector<std::uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, "VEC4", 5121, 4);
  attributes["WEIGHTS_0"] = b.vec4s({1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0});
  b.root["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"name", "figure"}, {"translation", {100, 0, 0}}, {"children", {3}}},
                     {{"translation", {0, 0, 5}}},
                     {{"scale", {2, 2, 2}}},
                     json::object()};
  b.root["scenes"] = {{{"nodes", {0, 1, 2}}}};
  b.root["skins"] = {{{"joints", {1, 2}}}};
  return b;
}

TEST(unit_io_gltf_mesh, skins_pose_vertices_and_ignore_the_nodes_own_transform) {
  const Loaded loaded = load(skinned());
  EXPECT_TRUE(loaded.warnings.empty());
  EXPECT_EQ(first(loaded).positions, (std::vector<vec3>{{0, 0, 5}, {2, 0, 0}, {0, 1.5f, 2.5f}}));
  ASSERT_EQ(loaded.scene.nodes.size(), 5u);
  EXPECT_EQ(loaded.scene.nodes[0].mesh, -1);
  EXPECT_EQ(loaded.scene.nodes[4].mesh, 0);
  EXPECT_EQ(loaded.scene.nodes[4].name, "figure");
  EXPECT_EQ(loaded.scene.nodes[4].world_from_node, mat4(1));
  EXPECT_EQ(loaded.scene.nodes[3].world_from_node[3], vec4(100, 0, 0, 1));
}

TEST(unit_io_gltf_mesh, inverse_bind_matrices_come_first) {
  Builder b = skinned();
  std::vector<float> matrices{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 0,  0, 1,
                              1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  20, 0, 1};
  b.root["skins"][0]["inverseBindMatrices"] = b.floats(matrices, "MAT4", 16);
  const Loaded loaded = load(b);
  EXPECT_EQ(first(loaded).positions[0], vec3(10, 0, 5));
  EXPECT_EQ(first(loaded).positions[1], vec3(2, 40, 0));
  b.root["skins"][0]["joints"] = {1, 2, 3};
  EXPECT_THAT(error_of(b), HasSubstr("2 matrices for 3 joints"));
}

TEST(unit_io_gltf_mesh, mirrored_joints_keep_the_outside_out) {
  Builder b = skinned();
  b.root["nodes"][1] = {{"scale", {-1, 1, 1}}};
  b.root["nodes"][2] = {{"scale", {-1, 1, 1}}};
  const Loaded loaded = load(b);
  const Primitive& p = first(loaded);
  EXPECT_EQ(p.positions[1], vec3(-1, 0, 0));
  EXPECT_EQ(p.normals[0], vec3(0, 0, 1));
  EXPECT_EQ(area_direction(p, 0), vec3(0, 0, 1));
}

TEST(unit_io_gltf_mesh, bad_skins_are_errors) {
  const auto error_with = [](auto change) {
    Builder b = skinned();
    change(b);
    return error_of(b);
  };
  EXPECT_THAT(error_with([](Builder& b) { b.root["skins"][0]["joints"] = {1}; }),
              HasSubstr("joint 1 does not exist (there are 1)"));
  EXPECT_THAT(error_with([](Builder& b) { b.root["skins"][0]["joints"] = json::array(); }),
              HasSubstr("a skin needs a joint"));
  EXPECT_THAT(error_with([](Builder& b) {
                b.root["skins"][0]["joints"] = {1, 9};
              }),
              HasSubstr("#/skins/0/joints/1: node 9 does not exist"));
  EXPECT_THAT(error_with([](Builder& b) { b.root["nodes"][0]["skin"] = 1; }), HasSubstr("skin 1 does not exist"));
  EXPECT_THAT(error_with([](Builder& b) { primitive(b)["attributes"].erase("WEIGHTS_0"); }),
              HasSubstr("JOINTS_0 without WEIGHTS_0"));
}

TEST(unit_io_gltf_mesh, absurd_coordinates_are_errors) {
  Builder b = triangle();
  primitive(b)["attributes"]["POSITION"] = b.vec3s({0, 0, 0, 1e30f, 0, 0, 0, 1, 0});
  EXPECT_THAT(error_of(b), HasSubstr("beyond 1e+09 metres"));
  b = triangle();
  b.root["nodes"][0]["scale"] = {1, 1e10, 1};
  EXPECT_THAT(error_of(b), HasSubstr("#/nodes/0: the mesh reaches beyond"));
  b = triangle();
  primitive(b)["targets"] = {{{"POSITION", b.vec3s({3e38f, 0, 0, 0, 0, 0, 0, 0, 0})}}};
  b.root["meshes"][0]["weights"] = {3e38f};
  EXPECT_THAT(error_of(b), HasSubstr("not finite"));
}

TEST(unit_io_gltf_mesh, uvs_that_a_texture_needs_are_never_missing) {
  Builder b = with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"texCoord", 1}}}}}});
  add_texture(b);
  const Loaded loaded = load(b);
  EXPECT_EQ(first(loaded).uvs[1], std::vector<vec2>(3, vec2(0)));
  EXPECT_TRUE(loaded.warned("needs TEXCOORD_1"));
}

TEST(unit_io_gltf_mesh, tangents_are_there_when_a_normal_texture_is) {
  Builder b = with_material({{"normalTexture", {{"index", 0}}}});
  add_texture(b);
  // u grows with x, v falls with y: the image stands upright.
  EXPECT_EQ(first(load(b)).tangents, std::vector<vec4>(3, vec4(1, 0, 0, 1)));
  primitive(b)["attributes"]["TANGENT"] = b.vec4s({0, 2, 0, -1, 0, 2, 0, -1, 0, 0, 0, 1});
  const Loaded stored = load(b);
  EXPECT_EQ(first(stored).tangents[0], vec4(0, 1, 0, -1));
  EXPECT_NEAR(glm::dot(vec3(first(stored).tangents[2]), vec3(0, 0, 1)), 0, 1e-6);
  // Without normals, stored tangents do not count (glTF 2.0 §3.7.2.1).
  primitive(b)["attributes"].erase("NORMAL");
  EXPECT_EQ(first(load(b)).tangents, std::vector<vec4>(3, vec4(1, 0, 0, 1)));
  b.root["materials"][0].erase("normalTexture");
  EXPECT_TRUE(first(load(b)).tangents.empty());
}

TEST(unit_io_gltf_mesh, tangents_follow_the_texture_transform) {
  Builder b = with_material(
      {{"normalTexture",
        {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"rotation", 1.5707963267948966}}}}}}}});
  add_texture(b);
  const Loaded turned = load(b);
  const TextureSlot& slot = turned.scene.materials[0].normal_texture;
  // Whichever way the texture turns: along the tangent its u grows and v stays.
  const Primitive& p = first(turned);
  const vec3 t(p.tangents[0]);
  const vec2 du = slot.apply(vec2(t.x, 1 - t.y)) - slot.apply(vec2(0, 1));
  EXPECT_NEAR(du.x, 1, 1e-5);
  EXPECT_NEAR(du.y, 0, 1e-5);
  EXPECT_EQ(p.tangents[0].w, 1);
  b.root["materials"][0]["normalTexture"]["extensions"]["KHR_texture_transform"] = {{"scale", {-1, 1}}};
  EXPECT_EQ(first(load(b)).tangents[0], vec4(-1, 0, 0, -1));
}

}  // namespace
}  // namespace candela::io::test
