#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "base/file.h"
#include "math/spectrum.h"
#include "unit/base/temp_folder.h"
#include "unit/io/gltf_seeds.h"

namespace candela::io::test {
namespace {

using ::testing::HasSubstr;

/// A node that shows one punctual light.
Builder with_light(const json& light) {
  Builder b;
  b.root["nodes"] = {{{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}};
  b.root["extensionsUsed"] = {"KHR_lights_punctual"};
  b.root["extensions"]["KHR_lights_punctual"]["lights"] = {light};
  return b;
}

json point_with(const json& candela) {
  return {{"name", "lamp"}, {"type", "point"}, {"intensity", 3}, {"extras", {{"candela", candela}}}};
}

std::string data_uri(const std::string& text) {
  return "data:application/x-ies-lm-63;base64," + base64(as_bytes(text));
}

/// A node that shows profile 0.
Builder with_profile(const json& profile, const json& use) {
  Builder b;
  b.root["nodes"] = {{{"extensions", {{"EXT_lights_ies", use}}}}};
  b.root["extensionsUsed"] = {"EXT_lights_ies"};
  b.root["extensionsRequired"] = {"EXT_lights_ies"};
  b.root["extensions"]["EXT_lights_ies"]["lights"] = {profile};
  return b;
}

// ----- extras.candela

TEST(unit_io_gltf_light_extras, falloff_and_polynomial) {
  for (const auto& [name, kind] : {std::pair{"gltf", Falloff::gltf},
                                   {"inverse-square", Falloff::inverse_square},
                                   {"ue4", Falloff::ue4},
                                   {"polynomial", Falloff::polynomial}}) {
    const Loaded loaded = load(with_light(point_with({{"falloff", name}})));
    EXPECT_EQ(loaded.scene.lights.at(0).falloff, kind) << name;
    EXPECT_TRUE(loaded.warnings.empty()) << name;
  }
  const Loaded loaded = load(with_light(point_with({{"falloff", "polynomial"}, {"polynomial", {1, 0.5, 0.25}}})));
  EXPECT_EQ(loaded.scene.lights[0].polynomial, vec3(1, 0.5f, 0.25f));
  EXPECT_EQ(load(with_light({{"type", "point"}})).scene.lights[0].falloff, Falloff::gltf);
}

TEST(unit_io_gltf_light_extras, temperature_colours_and_keeps_the_luminance) {
  const Loaded loaded = load(with_light(point_with({{"temperature_k", 3000}})));
  const Light& light = loaded.scene.lights.at(0);
  EXPECT_EQ(light.color, blackbody_color(3000.0));
  EXPECT_NEAR(luminance(light.color), 1.0f, 1e-5f);
  EXPECT_GT(light.color.x, light.color.z);
  EXPECT_EQ(light.intensity, 3.0f);
}

TEST(unit_io_gltf_light_extras, lumens_become_candela) {
  EXPECT_NEAR(load(with_light(point_with({{"lumens", 800}}))).scene.lights[0].intensity, 800.0 / (4.0 * M_PI), 1e-4);
  const json spot = {{"type", "spot"},
                     {"spot", {{"innerConeAngle", 0.3}, {"outerConeAngle", 0.6}}},
                     {"extras", {{"candela", {{"lumens", 800}}}}}};
  const double solid_angle = 2.0 * M_PI * ((1.0 - std::cos(0.3)) + (std::cos(0.3) - std::cos(0.6)) / 3.0);
  EXPECT_NEAR(load(with_light(spot)).scene.lights[0].intensity, 800.0 / solid_angle, 1e-2);
}

TEST(unit_io_gltf_light_extras, profile_multiplies_or_takes_the_lumens) {
  const std::string uri = data_uri(tiny_ies());
  const Loaded plain = load(with_light(point_with({{"ies", uri}})));
  ASSERT_EQ(plain.scene.ies_profiles.size(), 1u);
  EXPECT_EQ(plain.scene.lights[0].ies, 0);
  EXPECT_EQ(plain.scene.lights[0].intensity, 3.0f);
  const Loaded bright = load(with_light(point_with({{"ies", uri}, {"lumens", 500}})));
  EXPECT_NEAR(static_cast<double>(bright.scene.lights[0].intensity) * ies_flux(bright.scene.ies_profiles[0]), 500,
              1e-2);
  json spot = point_with({{"ies", uri}});
  spot["type"] = "spot";
  const Loaded replaced = load(with_light(spot));
  EXPECT_EQ(replaced.scene.lights[0].type, LightType::point);
  EXPECT_TRUE(replaced.warned("light 'lamp': its profile replaces the cone"));
}

TEST(unit_io_gltf_light_extras, what_is_out_of_range_or_unknown_is_told_with_the_light) {
  const auto warned = [](const json& candela, const std::string& message) {
    return load(with_light(point_with(candela))).warned("light 'lamp': " + message);
  };
  EXPECT_TRUE(warned({{"temperature_k", 50}}, "temperature_k 50 becomes 1000"));
  EXPECT_TRUE(warned({{"temperature_k", 1e6}}, "temperature_k 1000000 becomes 40000"));
  EXPECT_TRUE(warned({{"lumens", -5}}, "lumens -5 becomes 0"));
  EXPECT_TRUE(warned({{"falloff", "cubic"}}, "falloff 'cubic' is unknown; gltf taken"));
  EXPECT_TRUE(warned({{"polynomial", {1, 0, 0}}}, "polynomial has no effect"));
  EXPECT_TRUE(warned({{"falloff", "polynomial"}, {"polynomial", {-1, 1, 0}}}, "polynomial has a negative coefficient"));
  EXPECT_TRUE(warned({{"falloff", "polynomial"}, {"polynomial", {0, 0, 0}}}, "polynomial is 0"));
  EXPECT_TRUE(warned({{"watts", 60}}, "'watts' is unknown and ignored"));
  EXPECT_TRUE(warned(100, "extras.candela is no object"));
  json sun = point_with({{"lumens", 5}});
  sun["type"] = "directional";
  EXPECT_TRUE(load(with_light(sun)).warned("light 'lamp': a directional light has no lumens"));
  const std::string dark = "TILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 50\n0 90\n0\n0 0\n";
  EXPECT_TRUE(warned({{"ies", data_uri(dark)}, {"lumens", 5}}, "its profile is dark"));
  EXPECT_FALSE(warned({{"temperature_k", 5000}}, ""));
  for (const json& other : {json("text"), json(1), json::array(), json::object()}) {
    EXPECT_TRUE(load(with_light({{"type", "point"}, {"extras", other}})).warnings.empty());
  }
  EXPECT_THAT(error_of(with_light(point_with({{"ies", data_uri("hello")}}))),
              HasSubstr("/lights/0/extras/candela/ies: line 1: no line begins with TILT="));
}

// ----- EXT_lights_ies

TEST(unit_io_gltf_ies_lights, from_a_uri_a_buffer_view_and_a_file) {
  const json use = {{"light", 0}, {"multiplier", 2}, {"color", {1, 0.5, 0}}};
  const Loaded from_uri = load(with_profile({{"uri", data_uri(tiny_ies())}, {"name", "downlight"}}, use));
  Builder b = with_profile({}, use);
  const std::string text = tiny_ies();
  b.root["extensions"]["EXT_lights_ies"]["lights"][0] = {
      {"bufferView", b.view(std::vector<char>(text.begin(), text.end()))}, {"mimeType", "application/x-ies-lm-63"}};
  const Loaded from_view = load(b);
  EXPECT_TRUE(from_view.warnings.empty());
  EXPECT_EQ(from_uri.scene.ies_profiles.at(0).candela, from_view.scene.ies_profiles.at(0).candela);
  const Light& light = from_uri.scene.lights.at(static_cast<std::size_t>(from_uri.scene.nodes[0].light));
  EXPECT_EQ(light.name, "downlight");
  EXPECT_EQ(light.intensity, 2.0f);
  EXPECT_EQ(light.color, vec3(1, 0.5f, 0));
  EXPECT_EQ(light.range, kInfinity);
  EXPECT_EQ(light.ies, 0);

  const candela::test::TempFolder folder;
  write_file(folder / "a.ies", text);
  write_file(folder / "scene.gltf", with_profile({{"uri", "a.ies"}}, use).gltf());
  Diagnostics diagnostics;
  EXPECT_EQ(load_gltf(folder / "scene.gltf", diagnostics).ies_profiles.at(0).candela,
            from_view.scene.ies_profiles[0].candela);
}

TEST(unit_io_gltf_ies_lights, profiles_are_read_once_and_only_where_used) {
  Builder b = with_profile({{"uri", data_uri(tiny_ies())}}, {{"light", 0}});
  b.root["extensions"]["EXT_lights_ies"]["lights"].push_back({{"uri", "absent.ies"}});
  b.root["nodes"].push_back({{"extensions", {{"EXT_lights_ies", {{"light", 0}, {"multiplier", 3}}}}}});
  const Loaded loaded = load(b);
  EXPECT_EQ(loaded.scene.ies_profiles.size(), 1u);
  ASSERT_EQ(loaded.scene.lights.size(), 2u);
  EXPECT_EQ(loaded.scene.lights[0].intensity, 1.0f);
  EXPECT_EQ(loaded.scene.lights[1].intensity, 3.0f);
}

TEST(unit_io_gltf_ies_lights, a_node_may_have_a_punctual_light_too) {
  Builder b = with_profile({{"uri", data_uri(tiny_ies())}}, {{"light", 0}});
  b.root["nodes"][0]["translation"] = {1, 2, 3};
  b.root["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  b.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  const Scene scene = load(b).scene;
  ASSERT_EQ(scene.nodes.size(), 2u);
  EXPECT_EQ(scene.lights.at(static_cast<std::size_t>(scene.nodes[0].light)).ies, -1);
  EXPECT_EQ(scene.lights.at(static_cast<std::size_t>(scene.nodes[1].light)).ies, 0);
  EXPECT_EQ(scene.nodes[1].world_from_node, scene.nodes[0].world_from_node);
}

TEST(unit_io_gltf_ies_lights, hidden_ones_do_not_shine) {
  Builder b = with_profile({{"uri", data_uri(tiny_ies())}}, {{"light", 0}});
  b.root["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = false;
  const Loaded loaded = load(b);
  EXPECT_TRUE(loaded.scene.lights.empty() && loaded.scene.ies_profiles.empty());
  EXPECT_EQ(loaded.scene.nodes.at(0).light, -1);
}

TEST(unit_io_gltf_ies_lights, oddities_are_told_and_nonsense_is_refused) {
  const json good = {{"uri", data_uri(tiny_ies())}};
  EXPECT_TRUE(load(with_profile(good, {{"light", 0}, {"multiplier", -1}})).warned("out of range and clamped"));
  const Loaded tinted = load(with_profile(good, {{"light", 0}, {"color", {2, 1, 1}}}));
  EXPECT_TRUE(tinted.warned("out of range and clamped"));
  EXPECT_EQ(tinted.scene.lights[0].color, vec3(1));
  EXPECT_THAT(error_of(with_profile(good, {{"light", 1}})), HasSubstr("light profile 1 does not exist (there are 1)"));
  EXPECT_THAT(error_of(with_profile(good, json::object())), HasSubstr("'light' is missing"));
  EXPECT_THAT(error_of(with_profile(json::object(), {{"light", 0}})), HasSubstr("'bufferView' is missing"));
  EXPECT_THAT(error_of(with_profile({{"uri", data_uri("TILT=NONE\n1 2 x")}}, {{"light", 0}})),
              HasSubstr("/extensions/EXT_lights_ies/lights/0/uri: line 2: the candela multiplier is 'x'"));
  Builder b = with_profile({}, {{"light", 0}});
  const std::string text = tiny_ies();
  b.root["extensions"]["EXT_lights_ies"]["lights"][0] = {
      {"bufferView", b.view(std::vector<char>(text.begin(), text.end()))}};
  EXPECT_TRUE(load(b).warned("mimeType"));
}

TEST(unit_io_gltf_ies_lights, many_names_of_one_large_profile_are_refused) {
  Builder b = with_profile({}, {{"light", 0}});
  std::string text = tiny_ies();
  text.resize(7 << 20, ' ');
  const int view = b.view(std::vector<char>(text.begin(), text.end()));
  for (std::size_t i = 0; i < 5; ++i) {
    b.root["extensions"]["EXT_lights_ies"]["lights"][i] = {{"bufferView", view},
                                                           {"mimeType", "application/x-ies-lm-63"}};
    b.root["nodes"][i] = {{"extensions", {{"EXT_lights_ies", {{"light", i}}}}}};
  }
  EXPECT_THAT(error_of(b), HasSubstr("larger than 32 MiB together"));
}

// ----- EXT_lights_area

/// A node that holds one area light, and stands as `place` says.
Builder with_area(const json& light, const json& place = json::object()) {
  Builder b;
  b.root["nodes"] = {place};
  b.root["nodes"][0]["extensions"]["EXT_lights_area"]["light"] = 0;
  b.root["extensionsUsed"] = b.root["extensionsRequired"] = {"EXT_lights_area"};
  b.root["extensions"]["EXT_lights_area"]["lights"] = {light};
  return b;
}

/// What the one lamp of a scene is.
struct AreaFound {
  double area = 0.0;
  vec3 facing{0.0f}, size{0.0f}, middle{0.0f}, radiance{0.0f};
};

AreaFound area_of(const Scene& scene) {
  AreaFound result;
  for (const Node& node : scene.nodes) {
    if (!is_lamp(scene, node)) continue;
    EXPECT_EQ(node.file_index, 0);
    const Primitive& p = scene.meshes.at(static_cast<std::size_t>(node.mesh)).primitives.at(0);
    Box3 box;
    dvec3 sum(0.0);
    for (const uvec3& t : p.triangles) {
      std::array<vec3, 3> c{};
      for (int i = 0; i < 3; ++i) {
        c[static_cast<std::size_t>(i)] = transform_point(node.world_from_node, p.positions[t[i]]);
        box.extend(c[static_cast<std::size_t>(i)]);
      }
      sum += 0.5 * glm::cross(dvec3(c[1]) - dvec3(c[0]), dvec3(c[2]) - dvec3(c[0]));
    }
    result = {glm::length(sum), vec3(glm::normalize(sum)), box.size(), box.center(),
              scene.materials.at(static_cast<std::size_t>(p.material)).emission};
  }
  return result;
}

TEST(unit_io_gltf_area_lights, rectangles_and_discs_have_their_size_and_shine_along_minus_z) {
  AreaFound found = area_of(load(with_area({{"type", "rect"}})).scene);
  EXPECT_NEAR(found.area, 1.0, 1e-6);
  EXPECT_EQ(found.radiance, vec3(1000)) << "cd/m2";
  EXPECT_LT(glm::length(found.facing - vec3(0, 0, -1)), 1e-6f);
  found = area_of(
      load(with_area(
               {{"type", "rect"}, {"size", 0.5}, {"rect", {{"aspect", 4}}}, {"intensity", 20}, {"color", {1, 0.5, 0}}}))
          .scene);
  EXPECT_LT(glm::length(found.size - vec3(2, 0.5f, 0)), 1e-6f) << "the aspect is that of width to height";
  EXPECT_EQ(found.radiance, vec3(20, 10, 0));
  found = area_of(load(with_area({{"type", "disk"}, {"size", 3}})).scene);
  EXPECT_NEAR(found.area, 2.25 * 3.14159265, 1e-4) << "the size is a diameter";
  EXPECT_LT(glm::length(found.facing - vec3(0, 0, -1)), 1e-6f);
}

TEST(unit_io_gltf_area_lights, they_grow_with_the_largest_scale_to_all_sides_alike) {
  const double half = std::sqrt(0.5);
  const json turned = {{"translation", {1, 2, 3}}, {"rotation", {half, 0, 0, half}}, {"scale", {2, 0.5, 3}}};
  const AreaFound found = area_of(load(with_area({{"type", "rect"}}, turned)).scene);
  EXPECT_NEAR(found.area, 9.0, 1e-5);
  EXPECT_LT(glm::length(found.facing - vec3(0, 1, 0)), 1e-5f);
  EXPECT_LT(glm::length(found.middle - vec3(1, 2, 3)), 1e-5f);
  EXPECT_LT(glm::length(found.size - vec3(3, 0, 3)), 1e-5f);
  const AreaFound mirrored = area_of(load(with_area({{"type", "rect"}}, {{"scale", {-1, 1, 1}}})).scene);
  EXPECT_LT(glm::length(mirrored.facing - vec3(0, 0, -1)), 1e-6f) << "still along its own -z";
  const AreaFound flat = area_of(load(with_area({{"type", "rect"}}, {{"scale", {1, 2, 0}}})).scene);
  EXPECT_LT(glm::length(flat.facing - vec3(0, 0, -1)), 1e-6f);
  EXPECT_EQ(area_of(load(with_area({{"type", "rect"}}, {{"scale", {0, 0, 0}}})).scene).area, 0.0);
}

TEST(unit_io_gltf_area_lights, they_are_no_part_of_the_subject_and_hide_with_their_node) {
  Builder b = triangle();
  b.root["nodes"].push_back({{"translation", {0, 9, 0}}, {"extensions", {{"EXT_lights_area", {{"light", 0}}}}}});
  b.root["scenes"][0]["nodes"] = {0, 1};
  b.root["extensions"]["EXT_lights_area"]["lights"] = {{{"type", "disk"}}};
  const Scene scene = load(b).scene;
  EXPECT_TRUE(is_lamp(scene, scene.nodes.back()));
  EXPECT_EQ(world_bounds(scene).upper, vec3(1, 1, 0));
  b.root["nodes"][1]["extensions"]["KHR_node_visibility"] = {{"visible", false}};
  for (const Node& node : load(b).scene.nodes) EXPECT_FALSE(is_lamp(load(b).scene, node));
}

TEST(unit_io_gltf_area_lights, what_is_out_of_range_is_told_and_nonsense_refused) {
  EXPECT_TRUE(load(with_area({{"type", "rect"}, {"size", -1}})).warned("size -1 becomes 0"));
  for (const json& none : {json{{"type", "rect"}, {"size", 0}}, json{{"type", "disk"}, {"size", 0}},
                           json{{"type", "rect"}, {"rect", {{"aspect", 0}}}}}) {
    EXPECT_EQ(area_of(load(with_area(none)).scene).area, 0.0) << none;
  }
  EXPECT_TRUE(load(with_area({{"type", "rect"}, {"intensity", -1}})).warned("intensity -1 becomes 0"));
  EXPECT_TRUE(load(with_area({{"type", "rect"}, {"color", {1, -1, 1}}})).warned("negative colour"));
  EXPECT_THAT(error_of(with_area({{"type", "sphere"}})), HasSubstr("must be rect or disk"));
  EXPECT_THAT(error_of(with_area(json::object())), HasSubstr("'type' is missing"));
  Builder b = with_area({{"type", "rect"}});
  b.root["nodes"][0]["extensions"]["EXT_lights_area"]["light"] = 1;
  EXPECT_THAT(error_of(b), HasSubstr("area light 1 does not exist"));
}

}  // namespace
}  // namespace candela::io::test
