#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "image/image_file.h"
#include "image/rgbd.h"
#include "image/texture_file.h"
#include "scene/environment.h"
#include "unit/io/gltf_builder.h"

namespace candela::io::test {
namespace {

using ::testing::HasSubstr;

constexpr int kSize = 16;

std::vector<std::byte> face_png(const std::function<vec3(int, int)>& light, int size = kSize) {
  Image face(size, size, 3);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) face.set_rgb(x, y, light(x, y));
  EncodingLoss loss;
  return encode_png(rgbd_from_image(face, loss));
}

json& light_of(Builder& b) { return b.root["extensions"]["EXT_lights_image_based"]["lights"][0]; }

/// A triangle lit by six such faces.
Builder lit_by(const std::array<std::vector<std::byte>, 6>& faces) {
  Builder b = triangle();
  b.root["images"] = json::array();
  for (const auto& face : faces) b.root["images"].push_back({{"bufferView", b.view(face)}, {"mimeType", "image/png"}});
  b.root["extensionsUsed"] = {"EXT_lights_image_based"};
  const json light = {{"name", "sky"},
                      {"irradianceCoefficients", std::vector(9, std::vector<float>{1, 1, 1})},
                      {"specularImageSize", kSize},
                      {"specularImages", json::array({{0, 1, 2, 3, 4, 5}})}};
  b.root["extensions"]["EXT_lights_image_based"]["lights"] = json::array({light});
  b.root["scenes"][0]["extensions"]["EXT_lights_image_based"] = {{"light", 0}};
  return b;
}

constexpr std::array<vec3, 6> kAxes{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
constexpr std::array<vec3, 6> kColors{
    {{0.5f, 0, 0}, {0, 0.5f, 0}, {0, 0, 0.5f}, {0.5f, 0.5f, 0}, {9, 0, 9}, {0, 40, 40}}};

Builder colored() {
  std::array<std::vector<std::byte>, 6> faces;
  for (std::size_t i = 0; i < 6; ++i) faces[i] = face_png([&](int, int) { return kColors[i]; });
  return lit_by(faces);
}

vec3 seen(const Loaded& loaded, vec3 d) {
  return environment_radiance(loaded.scene.image_light.value().environment, glm::normalize(d));
}

void expect_color(vec3 actual, vec3 expected, const std::string& what) {
  EXPECT_LT(max_component(glm::abs(actual - expected)), 0.006f * std::max(1.0f, max_component(expected))) << what;
}

TEST(unit_io_image_light, faces_are_where_their_names_say_and_alpha_divides) {
  const Loaded loaded = load(colored());
  EXPECT_TRUE(loaded.warnings.empty());
  ASSERT_TRUE(loaded.scene.image_light);
  EXPECT_EQ(loaded.scene.image_light->size, kSize);
  EXPECT_EQ(loaded.scene.image_light->levels, 1);
  EXPECT_EQ(loaded.scene.image_light->environment.name, "sky");
  for (std::size_t i = 0; i < 6; ++i) expect_color(seen(loaded, kAxes[i]), kColors[i], std::to_string(i));
}

TEST(unit_io_image_light, faces_are_pictures_as_seen_from_inside) {
  // Where an observer inside has the right of a picture, and its top.
  constexpr std::array<vec3, 6> right{{{0, 0, 1}, {0, 0, -1}, {-1, 0, 0}, {-1, 0, 0}, {-1, 0, 0}, {1, 0, 0}}};
  constexpr std::array<vec3, 6> up{{{0, 1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}, {0, 1, 0}, {0, 1, 0}}};
  std::array<std::vector<std::byte>, 6> faces;
  faces.fill(face_png([](int x, int y) { return vec3(x < kSize / 2 ? 0.2f : 0.8f, y < kSize / 2 ? 0.2f : 0.8f, 0); }));
  const Loaded loaded = load(lit_by(faces));
  for (std::size_t i = 0; i < 6; ++i) {
    for (const vec2 at : {vec2(0.5f, 0.5f), vec2(-0.5f, 0.5f), vec2(0.5f, -0.5f), vec2(-0.5f, -0.5f)}) {
      const vec3 expected(at.x < 0 ? 0.2f : 0.8f, at.y > 0 ? 0.2f : 0.8f, 0);
      expect_color(seen(loaded, kAxes[i] + at.x * right[i] + at.y * up[i]), expected, std::to_string(i));
    }
  }
}

TEST(unit_io_image_light, rotation_turns_the_light_and_intensity_multiplies_it) {
  const float s = std::sqrt(0.5f);
  Builder b = colored();
  light_of(b)["intensity"] = 2.5;
  light_of(b)["rotation"] = {0, s, 0, s};  // +z goes to +x
  Loaded loaded = load(b);
  expect_color(seen(loaded, kAxes[0]), 2.5f * kColors[4], "about y");
  expect_color(seen(loaded, kAxes[2]), 2.5f * kColors[2], "about y");
  light_of(b)["rotation"] = {s, 0, 0, s};  // +y goes to +z
  loaded = load(b);
  expect_color(seen(loaded, kAxes[4]), 2.5f * kColors[2], "about x");
  expect_color(seen(loaded, kAxes[3]), 2.5f * kColors[4], "about x");
  expect_color(seen(loaded, kAxes[0]), 2.5f * kColors[0], "about x");
  light_of(b)["intensity"] = -1;
  EXPECT_TRUE(load(b).warned("intensity is out of range"));
}

TEST(unit_io_image_light, textures_of_floats_are_light_as_it_stands) {
  Image face(kSize, kSize, 3);
  for (float& v : face.pixels) v = 700.0f;
  EncodingLoss loss;
  Builder b = colored();
  b.root["images"][2] = {{"bufferView", b.view(encode_texture(face, {}, loss, "face"))}, {"mimeType", "image/ktx2"}};
  expect_color(seen(load(b), kAxes[2]), vec3(700), "KTX 2");
}

TEST(unit_io_image_light, each_scene_has_its_own_or_none) {
  Builder b = colored();
  b.root["scenes"].push_back({{"nodes", json::array({0})}});
  json second = light_of(b);
  second["name"] = "other";
  b.root["extensions"]["EXT_lights_image_based"]["lights"].push_back(second);
  b.root["scenes"].push_back(
      {{"nodes", json::array({0})}, {"extensions", {{"EXT_lights_image_based", {{"light", 1}}}}}});
  EXPECT_EQ(load(b).scene.image_light->file_index, 0);
  EXPECT_FALSE(load(b, {.scene = "1"}).scene.image_light);
  EXPECT_EQ(load(b, {.scene = "2"}).scene.image_light->environment.name, "other");
  EXPECT_EQ(load(b, {.scene = "2"}).scene.image_light->file_index, 1);
  const Loaded measured = load(b, {.decode_images = false});
  EXPECT_EQ(measured.scene.image_light->environment.map, nullptr);
  EXPECT_EQ(measured.scene.image_light->size, kSize);
}

TEST(unit_io_image_light, an_animation_moves_it) {
  Builder b = colored();
  const int times = b.floats({0, 1}, "SCALAR", 1);
  const int values = b.floats({1, 3}, "SCALAR", 1);
  b.root["extensionsUsed"].push_back("KHR_animation_pointer");
  b.root["animations"] = json::array(
      {{{"samplers", json::array({{{"input", times}, {"output", values}}})},
        {"channels",
         json::array({{{"sampler", 0},
                       {"target",
                        {{"path", "pointer"},
                         {"extensions",
                          {{"KHR_animation_pointer",
                            {{"pointer", "/extensions/EXT_lights_image_based/lights/0/intensity"}}}}}}}}})}}});
  light_of(b)["intensity"] = 1;
  Diagnostics diagnostics;
  GltfFile file(b.glb(), {}, "moving", diagnostics);
  const Scene at_rest = file.scene(diagnostics);
  const Scene later = file.scene(diagnostics, Pose{"", 0.5});
  EXPECT_FLOAT_EQ(at_rest.image_light->environment.intensity, 1.0f);
  EXPECT_FLOAT_EQ(later.image_light->environment.intensity, 2.0f);
  EXPECT_EQ(at_rest.image_light->environment.map, later.image_light->environment.map);  // decoded once
  EXPECT_TRUE(diagnostics.warnings().empty());
}

TEST(unit_io_image_light, bad_ones_are_one_line) {
  const auto fails = [](const std::function<void(Builder&)>& change) {
    Builder b = colored();
    change(b);
    const std::string error = error_of(b);
    EXPECT_EQ(error.find('\n'), std::string::npos);
    return error;
  };
  const auto images = [](Builder& b) -> json& { return light_of(b)["specularImages"]; };
  EXPECT_THAT(fails([&](Builder& b) { images(b)[0].erase(5); }), HasSubstr("6 faces, this one 5"));
  EXPECT_THAT(fails([&](Builder& b) { images(b).push_back({0, 1}); }), HasSubstr("6 faces, this one 2"));
  EXPECT_THAT(fails([&](Builder& b) { images(b) = json::array(); }), HasSubstr("no images"));
  EXPECT_THAT(fails([&](Builder& b) { images(b)[0][3] = 6; }), HasSubstr("specularImages/0/3"));
  EXPECT_THAT(fails([](Builder& b) { b.root["scenes"][0]["extensions"]["EXT_lights_image_based"]["light"] = 1; }),
              HasSubstr("scenes/0/extensions/EXT_lights_image_based/light"));
  EXPECT_THAT(fails([](Builder& b) { b.root.erase("extensions"); }), HasSubstr("image-based light"));
  EXPECT_THAT(fails([](Builder& b) { light_of(b)["specularImageSize"] = 8; }),
              HasSubstr("16 x 16, but specularImageSize is 8"));
  EXPECT_THAT(fails([](Builder& b) { light_of(b)["specularImageSize"] = 0; }), HasSubstr("must be 1 to"));
  EXPECT_THAT(fails([](Builder& b) { b.root["images"][4] = {{"uri", "absent.png"}}; }), HasSubstr("absent.png"));
  EXPECT_THAT(fails([](Builder& b) {
                b.root["images"][4] = {{"bufferView", b.view(face_png([](int, int) { return vec3(1); }, 8))}};
              }),
              HasSubstr("8 x 8, but specularImageSize is 16"));
  EXPECT_THAT(fails([](Builder& b) { light_of(b)["irradianceCoefficients"].erase(8); }), HasSubstr("8 coefficients"));
  Builder b = colored();
  light_of(b).erase("irradianceCoefficients");
  EXPECT_TRUE(load(b).warned("no irradianceCoefficients"));
}

TEST(unit_io_image_light, rgbd_is_within_what_it_promises) {
  float worst = 0.0f;
  for (float largest = 0.001f; largest < kBrightestRgbd; largest *= 1.003f) {
    Image image(1, 1, 3);
    const vec3 color = largest * vec3(1.0f, 0.6f, 0.05f);
    image.set_rgb(0, 0, color);
    EncodingLoss loss;
    const vec3 back = image_from_rgbd(rgbd_from_image(image, loss)).rgb(0, 0);
    worst = std::max(worst, max_component(glm::abs(back - color)) / std::max(largest, 1.0f));
    EXPECT_FALSE(loss.any());
  }
  EXPECT_LT(worst, 0.006f);
  EXPECT_GT(worst, 0.003f);
  Image sun(1, 1, 3);
  sun.set_rgb(0, 0, vec3(1000.0f, 1, 1));
  EncodingLoss loss;
  EXPECT_FLOAT_EQ(image_from_rgbd(rgbd_from_image(sun, loss)).rgb(0, 0).x, kBrightestRgbd);
  EXPECT_EQ(loss.clamped, 1u);
  EXPECT_EQ(loss.largest, 1000.0f);
}

}  // namespace
}  // namespace candela::io::test
