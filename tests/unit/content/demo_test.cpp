#include "content/demo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "base/error.h"
#include "content/make_environment.h"
#include "content/patterns.h"
#include "content/shapes.h"
#include "scene/environment.h"
#include "scene/view.h"

namespace candela::content {
namespace {

/// Edges between positions, welded to a micrometre: how often each is walked one way minus the other, and how often at
/// all.
struct EdgeUse {
  int balance = 0;
  int count = 0;
};
using Key = std::tuple<long, long, long>;
Key weld(vec3 p) { return {std::lround(p.x * 1e6f), std::lround(p.y * 1e6f), std::lround(p.z * 1e6f)}; }

std::map<std::pair<Key, Key>, EdgeUse> edges(const Primitive& primitive) {
  std::map<std::pair<Key, Key>, EdgeUse> result;
  for (const uvec3 t : primitive.triangles) {
    for (int k = 0; k < 3; ++k) {
      const Key a = weld(primitive.positions[t[k]]), b = weld(primitive.positions[t[(k + 1) % 3]]);
      if (a == b) continue;
      EdgeUse& use = result[{std::min(a, b), std::max(a, b)}];
      use.balance += a < b ? 1 : -1;
      ++use.count;
    }
  }
  return result;
}

void expect_closed(const Primitive& primitive, const std::string& name) {
  std::size_t open = 0;
  for (const auto& [edge, use] : edges(primitive)) open += use.count != 2 || use.balance != 0 ? 1 : 0;
  EXPECT_EQ(open, 0u) << name << " has edges that are not shared by two triangles of the same orientation";
}

double volume(const Primitive& primitive) {
  double sum = 0.0;
  for (const uvec3 t : primitive.triangles)
    sum += static_cast<double>(
               glm::dot(primitive.positions[t.x], glm::cross(primitive.positions[t.y], primitive.positions[t.z]))) /
           6.0;
  return sum;
}

/// Normals are unit and on the side that the triangle's winding says; tangents are unit and at right angles to them.
void expect_good_frames(const Primitive& primitive, const std::string& name) {
  ASSERT_EQ(primitive.normals.size(), primitive.positions.size()) << name;
  ASSERT_EQ(primitive.uvs[0].size(), primitive.positions.size()) << name;
  for (const vec3 n : primitive.normals) ASSERT_NEAR(glm::length(n), 1.0f, 1e-5f) << name;
  for (std::size_t i = 0; i < primitive.tangents.size(); ++i) {
    ASSERT_NEAR(glm::length(vec3(primitive.tangents[i])), 1.0f, 1e-5f) << name;
    ASSERT_NEAR(glm::dot(vec3(primitive.tangents[i]), primitive.normals[i]), 0.0f, 1e-4f) << name;
    ASSERT_EQ(std::abs(primitive.tangents[i].w), 1.0f) << name;
  }
  for (const uvec3 t : primitive.triangles) {
    const vec3 face = glm::cross(primitive.positions[t.y] - primitive.positions[t.x],
                                 primitive.positions[t.z] - primitive.positions[t.x]);
    ASSERT_GT(glm::length(face), 0.0f) << name << ": a triangle without area";
    const vec3 mean = primitive.normals[t.x] + primitive.normals[t.y] + primitive.normals[t.z];
    ASSERT_GT(glm::dot(glm::normalize(face), glm::normalize(mean)), 0.9f) << name << ": winding against the normals";
  }
}

/// Where uv and positions vary, the tangent runs along u and cross(normal, tangent) * w against v, as glTF wants.
void expect_tangents_follow_uv(const Primitive& primitive, const std::string& name) {
  for (const uvec3 t : primitive.triangles) {
    const vec3 e1 = primitive.positions[t.y] - primitive.positions[t.x];
    const vec3 e2 = primitive.positions[t.z] - primitive.positions[t.x];
    const vec2 d1 = primitive.uvs[0][t.y] - primitive.uvs[0][t.x], d2 = primitive.uvs[0][t.z] - primitive.uvs[0][t.x];
    const float determinant = d1.x * d2.y - d1.y * d2.x;
    ASSERT_NE(determinant, 0.0f) << name;
    const vec3 along_u = (e1 * d2.y - e2 * d1.y) / determinant, along_v = (e2 * d1.x - e1 * d2.x) / determinant;
    const vec3 tangent(primitive.tangents[t.x]);
    const vec3 bitangent = glm::cross(primitive.normals[t.x], tangent) * primitive.tangents[t.x].w;
    ASSERT_GT(glm::dot(glm::normalize(along_u), tangent), 0.8f) << name;
    ASSERT_LT(glm::dot(glm::normalize(along_v), bitangent), -0.6f) << name;
  }
}

TEST(unit_content_shapes, solids_are_closed_and_turn_their_normals_outwards) {
  const std::array<OutlineCorner, 5> vase{
      {{{0.0f, 0.0f}}, {{0.5f, 0.0f}, 0.05f}, {{0.3f, 0.4f}, 0.1f}, {{0.45f, 0.8f}, 0.0f}, {{0.0f, 0.8f}}}};
  const std::vector<std::pair<std::string, Primitive>> solids{
      {"sphere", sphere(0.5f, 48)},
      {"vase", lathe(rounded_outline(vase), 64)},
      {"ring", lathe(shell_outline(0.87f, 1.0f, 0.6f, 1.3f, 0.026f, 24), 96)},
      {"cap", lathe(shell_outline(0.87f, 1.0f, 1.4f, kPi, 0.026f, 24), 96)},
      {"box", rounded_box(vec3(0.3f, 0.2f, 0.4f), 0.05f)},
      {"knot", torus_knot(2, 3, 0.34f, 0.15f, 0.08f, 300, 32)}};
  for (const auto& [name, shape] : solids) {
    expect_closed(shape, name);
    expect_good_frames(shape, name);
    expect_tangents_follow_uv(shape, name);
    EXPECT_GT(volume(shape), 0.0) << name << " is inside out";
  }
}

TEST(unit_content_shapes, solids_have_the_volume_of_their_formula) {
  const double pi = 3.14159265358979;
  EXPECT_NEAR(volume(sphere(0.5f, 96)), pi / 6.0, 2e-3 * pi / 6.0);
  const std::array<OutlineCorner, 4> drum{{{{0.0f, 0.0f}}, {{0.4f, 0.0f}}, {{0.4f, 0.3f}}, {{0.0f, 0.3f}}}};
  EXPECT_NEAR(volume(lathe(rounded_outline(drum), 256)), pi * 0.16 * 0.3, 1e-3 * pi * 0.16 * 0.3);
  // Steiner: inner box, slabs on its faces, quarter cylinders on its edges, one ball at its corners.
  const double a = 0.5, b = 0.3, c = 0.7, r = 0.05;
  const double steiner =
      a * b * c + 2 * r * (a * b + b * c + c * a) + pi * r * r * (a + b + c) + 4 * pi * r * r * r / 3;
  EXPECT_NEAR(volume(rounded_box(vec3(0.3f, 0.2f, 0.4f), 0.05f, 12)), steiner, 1e-3 * steiner);
  // A full shell without its rounded rims.
  const double shell = 2 * pi / 3 * (1.0 - 0.87 * 0.87 * 0.87) * (std::cos(0.6) - std::cos(1.3));
  EXPECT_NEAR(volume(lathe(shell_outline(0.87f, 1.0f, 0.6f, 1.3f, 0.004f, 64), 256)), shell, 4e-3 * shell);
}

TEST(unit_content_shapes, sphere_normals_point_away_from_its_middle) {
  const Primitive shape = sphere(0.25f, 32);
  for (std::size_t i = 0; i < shape.positions.size(); ++i) {
    EXPECT_NEAR(glm::length(shape.positions[i]), 0.25f, 1e-6f);
    EXPECT_NEAR(glm::dot(shape.positions[i] / 0.25f, shape.normals[i]), 1.0f, 1e-5f);
    EXPECT_GE(std::min(shape.uvs[0][i].x, shape.uvs[0][i].y), 0.0f);
    EXPECT_LE(std::max(shape.uvs[0][i].x, shape.uvs[0][i].y), 1.0f);
  }
}

TEST(unit_content_shapes, a_sweep_is_smooth_from_the_floor_to_the_wall) {
  const Primitive sweep = backdrop_sweep(1.0f, 0.5f, -1.5f, 0.4f, 0.9f, 32);
  expect_good_frames(sweep, "sweep");
  expect_tangents_follow_uv(sweep, "sweep");
  EXPECT_EQ(sweep.normals.front(), vec3(0, 1, 0));
  EXPECT_EQ(sweep.normals.back(), vec3(0, 0, 1));
  EXPECT_EQ(sweep.positions.back(), vec3(1.0f, 0.9f, -1.5f));
  float steepest = 0.0f;
  for (std::size_t i = 2; i < sweep.normals.size(); i += 2)
    steepest = std::max(steepest, std::acos(std::min(1.0f, glm::dot(sweep.normals[i], sweep.normals[i - 2]))));
  EXPECT_LT(degrees(steepest), 4.0f);
}

TEST(unit_content_patterns, noise_repeats_after_its_period) {
  for (const vec2 p : {vec2(0.3f, 0.8f), vec2(2.9f, 1.1f), vec2(4.5f, 6.2f)}) {
    const ivec2 period(5, 7);
    const vec2 next = p + vec2(5.0f, -7.0f);
    EXPECT_NEAR(tiling_noise(p, period, 3), tiling_noise(next, period, 3), 1e-4f);
    EXPECT_NEAR(tiling_fractal(p, period, 4, 0.5f, 3), tiling_fractal(next, period, 4, 0.5f, 3), 1e-3f);
    EXPECT_NEAR(tiling_cells(p, period, 3).nearest, tiling_cells(next, period, 3).nearest, 1e-4f);
    EXPECT_NEAR(tiling_dents(p, period, 9.0f, 3), tiling_dents(next, period, 9.0f, 3), 1e-3f);
    EXPECT_NE(tiling_noise(p, period, 3), tiling_noise(p, period, 4));
  }
}

TEST(unit_content_patterns, normals_lean_away_from_the_height) {
  // Height grows to the right and upwards (against v): the normal leans to the left and down.
  const auto waves = [](vec2 uv) { return 0.05f * std::sin(2.0f * kPi * uv.x) - 0.05f * std::sin(2.0f * kPi * uv.y); };
  const TexturePointer texture = normal_texture(64, waves);
  ASSERT_EQ(texture->bits, 16);
  const auto* texels = reinterpret_cast<const std::uint16_t*>(texture->pixels.data());
  const auto channel = [&](int k) { return static_cast<float>(texels[k]) / 65535.0f * 2.0f - 1.0f; };
  // At uv = 0: dh/du = 0.1π, dh/d(up) = 0.1π.
  const vec3 expected = glm::normalize(vec3(-0.1f * kPi, -0.1f * kPi, 1.0f));
  EXPECT_NEAR(channel(0), expected.x, 0.01f);
  EXPECT_NEAR(channel(1), expected.y, 0.01f);
  EXPECT_NEAR(channel(2), expected.z, 0.01f);
}

TEST(unit_content_patterns, colours_are_encoded_once) {
  const TexturePointer texture = color_texture(2, [](vec2) { return srgb(0x336699); });
  EXPECT_EQ(texture->pixels[0], 0x33);
  EXPECT_EQ(texture->pixels[1], 0x66);
  EXPECT_EQ(texture->pixels[2], 0x99);
  EXPECT_EQ(texture->pixels[3], 0xff);
}

/// Made once for all tests.
const Scene& demo(std::string_view name) {
  static std::map<std::string, Scene, std::less<>> scenes;
  const auto found = scenes.find(name);
  if (found != scenes.end()) return found->second;
  return scenes.emplace(name, make_demo(std::string(name))).first->second;
}

/// Has no camera of its own, as a product has none.
constexpr const char* kFramed = "product";

TEST(unit_content_demo, every_demo_is_valid_and_complete) {
  for (const DemoInfo& info : demos()) {
    SCOPED_TRACE(info.name);
    const Scene& scene = demo(info.name);
    EXPECT_NO_THROW(validate(scene));
    EXPECT_EQ(scene.name, info.name);
    EXPECT_FALSE(info.description.empty());
    ASSERT_TRUE(scene.preferred_environment && scene.preferred_exposure);
    EXPECT_NO_THROW(make_environment(*scene.preferred_environment));
    EXPECT_GT(*scene.preferred_exposure, 0.0f);
    ASSERT_EQ(scene.cameras.size(), info.name == kFramed ? 0u : 1u);
    for (const Mesh& mesh : scene.meshes) {
      for (const Primitive& primitive : mesh.primitives) {
        expect_good_frames(primitive, mesh.name);
        const Material& material = scene.materials[static_cast<std::size_t>(primitive.material)];
        const bool needs_tangents =
            material.normal_texture || material.anisotropy > 0.0f || material.clearcoat_anisotropy > 0.0f;
        EXPECT_EQ(primitive.tangents.empty(), !needs_tangents) << mesh.name;
      }
    }
  }
  EXPECT_THROW(make_demo("teapot"), Error);
  EXPECT_THROW(make_demo(""), Error);
}

/// Share of a mesh's vertices that lie in the camera's picture.
float visible_share(const Scene& scene, const View& view, float aspect, const Node& node) {
  const mat4 camera_from_node = glm::inverse(view.world_from_camera) * node.world_from_node;
  const float tan_y = std::tan(0.5f * std::get<PerspectiveCamera>(view.projection).yfov);
  std::size_t inside = 0, count = 0;
  for (const Primitive& primitive : scene.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
    for (const vec3 p : primitive.positions) {
      const vec3 c = transform_point(camera_from_node, p);
      const bool visible = c.z < 0.0f && std::abs(c.y) <= -c.z * tan_y && std::abs(c.x) <= -c.z * tan_y * aspect;
      inside += visible ? 1 : 0;
      ++count;
    }
  }
  return static_cast<float>(inside) / static_cast<float>(count);
}

TEST(unit_content_demo, cameras_show_the_whole_subject) {
  for (const DemoInfo& info : demos()) {
    if (info.name == kFramed) continue;
    const Scene& scene = demo(info.name);
    for (const float aspect : {info.name.starts_with("row-") ? 6.0f : 16.0f / 9.0f, 1.0f}) {
      const View view = scene_camera(scene, "0", aspect);
      for (const Node& node : scene.nodes) {
        if (node.mesh < 0 || node.name == "backdrop") continue;
        const float share = visible_share(scene, view, aspect, node);
        if (info.name == "cornell") {
          EXPECT_GT(share, 0.0f) << node.name;
        } else {
          EXPECT_EQ(share, 1.0f) << info.name << ": " << node.name;
        }
      }
    }
  }
}

TEST(unit_content_demo, cornell_box_has_the_published_proportions) {
  const Scene& scene = demo("cornell");
  const Box3 bounds = world_bounds(scene);
  EXPECT_NEAR(bounds.size().x, 0.556f, 1e-4f);
  EXPECT_NEAR(bounds.size().y, 0.5488f, 1e-4f);
  EXPECT_NEAR(bounds.size().z, 0.5592f, 1e-4f);
  const View view = scene_camera(scene, "0", 1.0f);
  EXPECT_NEAR(view.world_from_camera[3].y, 0.273f, 1e-5f);
  EXPECT_NEAR(view.world_from_camera[3].z - bounds.upper.z, 0.8f, 1e-4f);
  EXPECT_NEAR(degrees(std::get<PerspectiveCamera>(view.projection).yfov), 39.3077f, 1e-3f);
  // The red wall is on the left and the green one on the right.
  for (const Node& node : scene.nodes) {
    if (node.mesh < 0) continue;
    const Primitive& primitive = scene.meshes[static_cast<std::size_t>(node.mesh)].primitives[0];
    const std::string& material = scene.materials[static_cast<std::size_t>(primitive.material)].name;
    const vec3 corner = transform_point(node.world_from_node, primitive.positions[0]);
    if (material == "red") {
      EXPECT_LT(corner.x, -0.2f);
    } else if (material == "green") {
      EXPECT_GT(corner.x, 0.2f);
    } else if (material == "light") {
      EXPECT_LT(transform_vector(node.world_from_node, primitive.normals[0]).y, 0.0f) << "the lamp shines down";
    }
  }
}

/// The materials of a row's balls, from left to right.
std::vector<Material> row_of(const Scene& scene) {
  std::vector<Material> balls;
  for (int i = 0; i < 7; ++i) {
    const auto found = std::find_if(scene.materials.begin(), scene.materials.end(),
                                    [&](const Material& m) { return m.name == "ball " + std::to_string(i); });
    if (found != scene.materials.end()) balls.push_back(*found);
  }
  return balls;
}

/// What each row is about, and its least and greatest value.
struct RowLaw {
  std::function<float(const Material&)> parameter;
  float least;
  float most;
};
template <class T>
RowLaw law_of(T Material::*parameter, float least, float most) {
  return {[parameter](const Material& m) { return m.*parameter; }, least, most};
}

const std::map<std::string, RowLaw>& row_laws() {
  static const std::map<std::string, RowLaw> laws{
      {"row-metallic", law_of(&Material::metallic, 0.0f, 1.0f)},
      {"row-roughness", law_of(&Material::roughness, 0.0f, 1.0f)},
      {"row-roughness-metal", law_of(&Material::roughness, 0.0f, 1.0f)},
      {"row-ior", law_of(&Material::ior, 1.0f, 2.42f)},
      {"row-specular", law_of(&Material::specular, 0.0f, 1.0f)},
      {"row-clearcoat", law_of(&Material::clearcoat, 0.0f, 1.0f)},
      {"row-clearcoat-roughness", law_of(&Material::clearcoat_roughness, 0.0f, 1.0f)},
      {"row-sheen-color", {[](const Material& m) { return m.sheen_color.y; }, 0.0f, 1.0f}},
      {"row-sheen-roughness", law_of(&Material::sheen_roughness, 0.0f, 1.0f)},
      {"row-anisotropy", law_of(&Material::anisotropy, 0.0f, 1.0f)},
      {"row-anisotropy-rotation", law_of(&Material::anisotropy_rotation, 0.0f, kPi)},
      {"row-diffuse-roughness", law_of(&Material::diffuse_roughness, 0.0f, 1.0f)},
      {"row-retroreflection", law_of(&Material::retroreflection, 0.0f, 1.0f)},
      {"row-fuzz", law_of(&Material::fuzz, 0.0f, 1.0f)},
      {"row-fuzz-color", {[](const Material& m) { return m.fuzz_color.y; }, 0.0f, 1.0f}},
      {"row-edge-color", {[](const Material& m) { return -m.specular_color.y; }, -1.0f, -0.08f}},
      {"row-edge-color-metal", {[](const Material& m) { return -m.specular_color.y; }, -1.0f, -0.1f}},
      {"row-clearcoat-anisotropy", law_of(&Material::clearcoat_anisotropy, 0.0f, 1.0f)},
      {"row-iridescence-thickness", law_of(&Material::iridescence_thickness_max_nm, 0.0f, 900.0f)},
      {"row-iridescence-ior", law_of(&Material::iridescence_ior, 1.0f, 2.5f)},
      {"row-transmission", law_of(&Material::transmission, 0.0f, 1.0f)},
      {"row-transmission-ior", law_of(&Material::ior, 1.0f, 2.42f)},
      {"row-transmission-roughness", law_of(&Material::roughness, 0.0f, 1.0f)},
      {"row-thin-transmission", law_of(&Material::transmission, 0.0f, 1.0f)},
      {"row-attenuation", {[](const Material& m) { return -m.attenuation_distance; }, -0.8f, -0.0125f}},
      {"row-dispersion", law_of(&Material::dispersion, 0.0f, 8.0f)},
      {"row-diffuse-transmission", law_of(&Material::diffuse_transmission, 0.0f, 1.0f)},
      {"row-subsurface", {[](const Material& m) { return -m.attenuation_distance; }, -0.1f, -0.00075f}},
      {"row-scatter-anisotropy", law_of(&Material::scatter_anisotropy, -0.9f, 0.9f)},
      {"row-emission", {[](const Material& m) { return m.emission.x; }, 0.0f, 4.0f}},
      {"row-specular-glossiness", {[](const Material& m) { return m.specular_color.x; }, 0.04f, 1.0f}}};
  return laws;
}

TEST(unit_content_demo, every_row_goes_from_the_least_to_the_greatest) {
  // What shows kinds of matter rather than a parameter.
  const std::set<std::string> kinds{"row-lobes", "row-conductor"};
  std::size_t rows = 0;
  for (const DemoInfo& info : demos()) {
    if (!info.name.starts_with("row-")) continue;
    SCOPED_TRACE(info.name);
    ++rows;
    const std::vector<Material> balls = row_of(demo(info.name));
    ASSERT_EQ(balls.size(), 7u);
    if (kinds.contains(info.name)) continue;
    ASSERT_TRUE(row_laws().contains(info.name)) << "say above what it shows";
    const RowLaw& law = row_laws().at(info.name);
    EXPECT_NEAR(law.parameter(balls.front()), law.least, 1e-6f);
    EXPECT_NEAR(law.parameter(balls.back()), law.most, 1e-6f);
    for (std::size_t i = 1; i < balls.size(); ++i) EXPECT_GT(law.parameter(balls[i]), law.parameter(balls[i - 1])) << i;
  }
  EXPECT_EQ(rows, row_laws().size() + kinds.size());
}

TEST(unit_content_demo, rows_stand_on_the_ground_and_are_closed) {
  for (const DemoInfo& info : demos()) {
    if (!info.name.starts_with("row-")) continue;
    SCOPED_TRACE(info.name);
    const Scene& scene = demo(info.name);
    float lowest = kInfinity;
    std::set<int> balls;
    for (const Node& node : scene.nodes) {
      if (node.mesh < 0 || node.name == "backdrop") continue;
      const Primitive& primitive = scene.meshes[static_cast<std::size_t>(node.mesh)].primitives[0];
      for (const vec3 p : primitive.positions) lowest = std::min(lowest, transform_point(node.world_from_node, p).y);
      // Bodies of glass have to be closed; all rows are made of the same two shapes.
      if (node.name == "ball 0") {
        expect_closed(primitive, node.name);
        EXPECT_GT(volume(primitive), 0.0);
      }
      if (node.name.size() == std::string("ball 0").size()) balls.insert(node.mesh);
    }
    EXPECT_EQ(balls.size(), 7u);
    EXPECT_NEAR(lowest, 0.0f, 1e-6f);
  }
}

TEST(unit_content_demo, row_of_metals_is_measured) {
  std::set<float> reds;
  for (const Material& ball : row_of(demo("row-conductor"))) {
    EXPECT_TRUE(ball.is_conductor()) << ball.name;
    reds.insert(ball.conductor_k.x);
  }
  EXPECT_EQ(reds.size(), 7u);
}

TEST(unit_content_demo, an_unknown_name_is_told_the_known_ones) {
  try {
    make_demo("row-teapot");
    FAIL() << "there is no such row";
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("materials"), std::string::npos);
    EXPECT_NE(text.find("row-clearcoat-roughness"), std::string::npos);
  }
}

TEST(unit_content_demo, materials_stand_on_the_table) {
  const Scene& scene = demo("materials");
  EXPECT_GT(scene.cameras[0].f_number, 0.0f);
  EXPECT_GT(scene.cameras[0].focus_distance, 0.5f);
  bool mask = false, light = false, normals = false;
  for (const Material& material : scene.materials) {
    mask |= material.alpha_mode == AlphaMode::mask;
    light |= max_component(material.emission) > 1.0f;
    normals |= static_cast<bool>(material.normal_texture);
  }
  EXPECT_TRUE(mask && light && normals);
  for (const Node& node : scene.nodes) {
    if (node.mesh < 0) continue;
    float lowest = kInfinity;
    for (const vec3 p : scene.meshes[static_cast<std::size_t>(node.mesh)].primitives[0].positions)
      lowest = std::min(lowest, transform_point(node.world_from_node, p).y);
    EXPECT_GE(lowest, -1e-5f) << node.name << " sinks into the table";
    const bool stands = node.name.ends_with(" foot") || node.name.ends_with(" marble") || node.name == "plinth" ||
                        node.name == "lamp stand" || node.name == "terrazzo cube";
    if (stands) {
      EXPECT_LE(lowest, 1e-4f) << node.name << " floats";
    }
  }
}

}  // namespace
}  // namespace candela::content
