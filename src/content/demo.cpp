#include "content/demo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "base/error.h"
#include "content/demo_scenes.h"
#include "scene/material_table.h"
#include "scene/view.h"

namespace candela::content {

int SceneBuilder::material(Material material) {
  scene_.materials.push_back(std::move(material));
  return static_cast<int>(scene_.materials.size()) - 1;
}

TextureSlot SceneBuilder::texture(const std::string& name, TexturePointer image, vec2 repeat) {
  scene_.images.push_back(std::move(image));
  scene_.textures.push_back({.name = name, .image = static_cast<int>(scene_.images.size()) - 1});
  TextureSlot slot;
  slot.texture = static_cast<int>(scene_.textures.size()) - 1;
  slot.transform = {vec2(repeat.x, 0.0f), vec2(0.0f, repeat.y), vec2(0.0f)};
  return slot;
}

int SceneBuilder::mesh(const std::string& name, Primitive primitive, int material) {
  primitive.material = material;
  const Material& wears = scene_.materials[static_cast<std::size_t>(material)];
  if (tangent_slot(wears) == nullptr) primitive.tangents.clear();
  scene_.meshes.push_back({.name = name, .primitives = {}});
  scene_.meshes.back().primitives.push_back(std::move(primitive));
  return static_cast<int>(scene_.meshes.size()) - 1;
}

int SceneBuilder::node(const std::string& name, int mesh, const mat4& parent_from_node, int parent) {
  Node node;
  node.name = name;
  node.parent = parent;
  node.parent_from_node = parent_from_node;
  node.mesh = mesh;
  scene_.nodes.push_back(std::move(node));
  return static_cast<int>(scene_.nodes.size()) - 1;
}

void SceneBuilder::camera(vec3 eye, vec3 target, float yfov_deg, float aspect, int parent, float f_number, vec3 focus) {
  const View view = look_at(eye, target, radians(yfov_deg));
  Camera camera;
  camera.name = "camera";
  camera.projection = PerspectiveCamera{.yfov = radians(yfov_deg), .aspect_ratio = aspect};
  camera.f_number = f_number;
  camera.focus_distance = -glm::dot(focus - eye, vec3(view.world_from_camera[2]));
  scene_.cameras.push_back(std::move(camera));
  const int index = node("camera", -1, view.world_from_camera, parent);
  scene_.nodes[static_cast<std::size_t>(index)].camera = static_cast<int>(scene_.cameras.size()) - 1;
}

Scene SceneBuilder::finish(const std::string& environment, float exposure) {
  scene_.preferred_environment = environment;
  scene_.preferred_exposure = exposure;
  update_world_transforms(scene_);
  validate(scene_);
  return std::move(scene_);
}

mat4 translation(vec3 offset) { return glm::translate(mat4(1.0f), offset); }
mat4 rotation_x(float angle_deg) { return glm::rotate(mat4(1.0f), radians(angle_deg), vec3(1, 0, 0)); }
mat4 rotation_y(float angle_deg) { return glm::rotate(mat4(1.0f), radians(angle_deg), vec3(0, 1, 0)); }
mat4 rotation_z(float angle_deg) { return glm::rotate(mat4(1.0f), radians(angle_deg), vec3(0, 0, 1)); }
mat4 scaling(float factor) { return glm::scale(mat4(1.0f), vec3(factor)); }

Scene make_spheres() {
  constexpr int kColumns = 7;
  constexpr float kSpacing = 0.115f;
  constexpr float kRadius = 0.05f;
  struct Row {
    const char* name;
    vec3 color;
    float metallic;
  };
  // Metals: F0 of Au and of Fe, linear Rec.709; gold's red is out of gamut and held at 1.
  const std::array<Row, 4> rows{{{"ivory", srgb(0xe9e2d4), 0.0f},
                                 {"cobalt", srgb(0x1f4fa8), 0.0f},
                                 {"gold", vec3(1.0f, 0.782f, 0.344f), 1.0f},
                                 {"iron", vec3(0.562f, 0.565f, 0.578f), 1.0f}}};
  SceneBuilder builder("spheres");
  // The studio's lamps stand around a camera at azimuth 35°.
  const int root = builder.node("grid", -1, rotation_y(35.0f));
  const Primitive shape = sphere(kRadius, 64);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (int column = 0; column < kColumns; ++column) {
      Material material;
      const float roughness = static_cast<float>(column) / static_cast<float>(kColumns - 1);
      material.name = std::string(rows[row].name) + " " + std::to_string(column);
      material.base_color = rows[row].color;
      material.metallic = rows[row].metallic;
      material.roughness = roughness;
      const int mesh = builder.mesh(material.name, shape, builder.material(material));
      const vec3 place(kSpacing * (static_cast<float>(column) - 0.5f * (kColumns - 1)),
                       kSpacing * (1.5f - static_cast<float>(row)), 0.0f);
      builder.node(material.name, mesh, translation(place), root);
    }
  }
  builder.camera(vec3(0.0f, 0.10f, 1.9f), vec3(0.0f), 15.5f, 16.0f / 9.0f, root);
  return builder.finish("studio", 1.0f);
}

Scene make_furnace() {
  SceneBuilder builder("furnace");
  Material diffuse;
  diffuse.name = "white diffuse";
  diffuse.metallic = 0.0f;
  diffuse.specular = 0.0f;
  Material mirror;
  mirror.name = "white mirror";
  mirror.roughness = 0.0f;
  const Primitive shape = sphere(0.05f);
  const std::array<int, 2> meshes{builder.mesh("diffuse sphere", shape, builder.material(diffuse)),
                                  builder.mesh("mirror sphere", shape, builder.material(mirror))};
  for (std::size_t i = 0; i < 4; ++i) {
    const vec3 place(0.15f * (static_cast<float>(i) - 1.5f), 0.0f, 0.0f);
    builder.node("sphere " + std::to_string(i), meshes[i % 2], translation(place));
  }
  builder.camera(vec3(0.0f, 0.0f, 1.3f), vec3(0.0f), 20.0f, 16.0f / 9.0f);
  return builder.finish("furnace", 0.5f);
}

namespace {

/// The five visible faces of a Cornell block, from its top's corners in the published order.
Primitive block(const std::array<vec3, 4>& top) {
  Primitive all;
  const auto add = [&all](vec3 a, vec3 b, vec3 c, vec3 d) {
    const auto first = static_cast<unsigned int>(all.positions.size());
    const vec3 normal = glm::normalize(glm::cross(b - a, c - a));
    const std::array<vec2, 4> uv{vec2(0, 1), vec2(1, 1), vec2(1, 0), vec2(0, 0)};
    std::size_t i = 0;
    for (const vec3 p : {a, b, c, d}) {
      all.positions.push_back(p);
      all.normals.push_back(normal);
      all.uvs[0].push_back(uv[i++]);
    }
    all.triangles.emplace_back(first, first + 1, first + 2);
    all.triangles.emplace_back(first, first + 2, first + 3);
  };
  add(top[0], top[1], top[2], top[3]);
  for (std::size_t i = 0; i < 4; ++i) {
    const vec3 a = top[i], b = top[(i + 1) % 4];
    add(b, a, vec3(a.x, 0.0f, a.z), vec3(b.x, 0.0f, b.z));
  }
  return all;
}

Primitive face(vec3 a, vec3 b, vec3 c, vec3 d) {
  Primitive primitive;
  primitive.positions = {a, b, c, d};
  primitive.normals.assign(4, glm::normalize(glm::cross(b - a, c - a)));
  primitive.uvs[0] = {vec2(0, 1), vec2(1, 1), vec2(1, 0), vec2(0, 0)};
  primitive.triangles = {uvec3(0, 1, 2), uvec3(0, 2, 3)};
  return primitive;
}

}  // namespace

// Geometry: Cornell University Program of Computer Graphics, "The Cornell Box" (measured data, millimetres). Colours:
// its reflectance and lamp spectra as linear Rec.709, after Mitsuba's scene of that name.
Scene make_cornell() {
  SceneBuilder builder("cornell");
  const auto paint = [&builder](const char* name, vec3 color) {
    Material material;
    material.name = name;
    material.base_color = color;
    material.metallic = 0.0f;
    material.specular = 0.0f;
    return builder.material(material);
  };
  const int white = paint("white", vec3(0.725f, 0.71f, 0.68f));
  const int red = paint("red", vec3(0.63f, 0.065f, 0.05f));
  const int green = paint("green", vec3(0.14f, 0.45f, 0.091f));
  const int lamp = paint("light", vec3(0.0f));
  builder.scene().materials[static_cast<std::size_t>(lamp)].emission = vec3(18.387f, 13.987f, 6.754f);

  // The data looks along +z with x to the left; half a turn makes it look along -z.
  constexpr float kMillimetre = 0.001f;
  const mat4 room = rotation_y(180.0f) * scaling(kMillimetre) * translation(vec3(-278.0f, 0.0f, -279.6f));
  const int root = builder.node("box", -1, room);
  const auto add = [&](const char* name, Primitive shape, int material) {
    builder.node(name, builder.mesh(name, std::move(shape), material), mat4(1.0f), root);
  };
  add("floor", face({552.8f, 0, 0}, {0, 0, 0}, {0, 0, 559.2f}, {549.6f, 0, 559.2f}), white);
  add("ceiling", face({556, 548.8f, 0}, {556, 548.8f, 559.2f}, {0, 548.8f, 559.2f}, {0, 548.8f, 0}), white);
  add("back wall", face({549.6f, 0, 559.2f}, {0, 0, 559.2f}, {0, 548.8f, 559.2f}, {556, 548.8f, 559.2f}), white);
  add("right wall", face({0, 0, 559.2f}, {0, 0, 0}, {0, 548.8f, 0}, {0, 548.8f, 559.2f}), green);
  add("left wall", face({552.8f, 0, 0}, {549.6f, 0, 559.2f}, {556, 548.8f, 559.2f}, {556, 548.8f, 0}), red);
  // The published lamp is a hole in the ceiling; here it hangs half a millimetre below it.
  add("light", face({343, 548.3f, 227}, {343, 548.3f, 332}, {213, 548.3f, 332}, {213, 548.3f, 227}), lamp);
  add("short block", block({vec3(130, 165, 65), vec3(82, 165, 225), vec3(240, 165, 272), vec3(290, 165, 114)}), white);
  add("tall block", block({vec3(423, 330, 247), vec3(265, 330, 296), vec3(314, 330, 456), vec3(472, 330, 406)}), white);
  // Focal length 35 mm on a 25 mm square.
  const vec3 eye = transform_point(room, vec3(278.0f, 273.0f, -800.0f));
  builder.camera(eye, eye - vec3(0.0f, 0.0f, 1.0f), degrees(2.0f * std::atan(12.5f / 35.0f)), 1.0f);
  return builder.finish("none", 2.4f);
}

Scene make_product() {
  SceneBuilder builder("product");
  const auto turned = [&](const char* name, std::vector<OutlineCorner> corners, Material material) {
    material.name = name;
    builder.node(name, builder.mesh(name, lathe(rounded_outline(corners), 128), builder.material(material)));
  };
  Material glaze;
  glaze.base_color = srgb(0x0f5f63);
  glaze.metallic = 0.0f;
  glaze.roughness = 0.45f;
  glaze.clearcoat = 1.0f;
  glaze.clearcoat_roughness = 0.04f;
  turned("jar",
         {{{0.0f, 0.0f}},
          {{0.029f, 0.0f}, 0.003f},
          {{0.047f, 0.036f}, 0.03f},
          {{0.040f, 0.076f}, 0.02f},
          {{0.026f, 0.087f}, 0.004f},
          {{0.027f, 0.093f}, 0.0015f},
          {{0.0f, 0.093f}}},
         glaze);
  Material gold;
  gold.base_color = vec3(1.0f, 0.782f, 0.344f);
  gold.roughness = 0.22f;
  turned("lid",
         {{{0.0f, 0.0935f}},
          {{0.030f, 0.0935f}, 0.001f},
          {{0.030f, 0.099f}, 0.002f},
          {{0.012f, 0.107f}, 0.006f},
          {{0.006f, 0.111f}, 0.002f},
          {{0.0f, 0.111f}}},
         gold);
  Material ruby;
  ruby.name = "knob";
  ruby.metallic = 0.0f;
  ruby.roughness = 0.0f;
  ruby.ior = 1.76f;
  ruby.transmission = 1.0f;
  ruby.thickness = 0.018f;
  ruby.attenuation_color = vec3(0.9f, 0.05f, 0.07f);
  ruby.attenuation_distance = 0.012f;
  builder.node("knob", builder.mesh("knob", sphere(0.0095f, 64), builder.material(ruby)),
               translation(vec3(0.0f, 0.1203f, 0.0f)));
  return builder.finish("studio", 1.0f);
}

Scene make_relief() {
  constexpr int kSize = 512;
  const ivec2 stones(7, 7);
  constexpr std::uint32_t kSeed = 11;
  // Cobbles with worn tops between joints of sand.
  const auto height = [stones](vec2 uv) {
    const vec2 p = uv * vec2(stones);
    const Cells cells = tiling_cells(p, stones, kSeed);
    const float edge = std::clamp((cells.second - cells.nearest - 0.06f) / 0.3f, 0.0f, 1.0f);
    const float dome = 1.0f - (1.0f - edge) * (1.0f - edge);
    const float rough = 0.06f * tiling_fractal(uv * 32.0f, ivec2(32), 4, 0.6f, kSeed + 1);
    return edge > 0.0f ? 0.25f + 0.65f * dome + rough : 0.2f + 0.5f * rough;
  };
  const auto color = [height, stones](vec2 uv) {
    const std::uint32_t cell = tiling_cells(uv * vec2(stones), stones, kSeed).cell;
    const float shade = 0.75f + 0.25f * static_cast<float>(cell % 97u) / 96.0f;
    const float stone = std::clamp((height(uv) - 0.22f) / 0.1f, 0.0f, 1.0f);
    return glm::mix(srgb(0x8a7a5c), shade * srgb(cell % 3u == 0 ? 0x8d8a86 : 0x77726d), stone);
  };
  SceneBuilder builder("relief");
  Material paving;
  paving.name = "cobbles";
  paving.metallic = 0.0f;
  paving.roughness = 0.75f;
  paving.base_color_texture = builder.texture("cobbles", color_texture(kSize, color), vec2(2.0f));
  paving.height_texture = builder.texture("cobbles' height", height_texture(kSize, height), vec2(2.0f));
  paving.height_scale = 0.05f;
  const int ground =
      builder.mesh("ground", face({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}), builder.material(paving));
  builder.node("ground", ground);
  Material ball;
  ball.name = "steel";
  ball.base_color = vec3(0.56f, 0.57f, 0.58f);
  ball.roughness = 0.15f;
  builder.node("ball", builder.mesh("ball", sphere(0.22f), builder.material(ball)), translation({-0.25f, 0.2f, -0.1f}));
  builder.camera({1.5f, 1.0f, 2.1f}, {0.0f, -0.03f, 0.0f}, 42.0f, 16.0f / 9.0f);
  return builder.finish("sky:22", 0.57f);
}

const std::vector<DemoInfo>& demos() {
  static const std::vector<DemoInfo> list = [] {
    std::vector<DemoInfo> all{
        {"materials", "a still life of shader balls: metals, ceramics, wood, textures, a lamp, depth of field"},
        {"spheres", "roughness from 0 to 1 by material: ivory, cobalt, gold, iron"},
        {"cornell", "the Cornell box, lit by its ceiling lamp alone"},
        {"relief", "cobbles from a height map and a steel ball in the evening sun"},
        {"product", "a glazed jar with a gilded lid, for --studio and --ground"},
        {"furnace", "white spheres in white light: a renderer that keeps energy shows nothing"}};
    for (DemoInfo& row : row_demos()) all.push_back(std::move(row));
    return all;
  }();
  return list;
}

Scene make_demo(const std::string& name) {
  if (name == "spheres") return make_spheres();
  if (name == "materials") return make_materials();
  if (name == "cornell") return make_cornell();
  if (name == "relief") return make_relief();
  if (name == "product") return make_product();
  if (name == "furnace") return make_furnace();
  if (std::optional<Scene> row = make_row(name)) return *std::move(row);
  std::string known;
  for (const DemoInfo& demo : demos()) known += (known.empty() ? "" : ", ") + demo.name;
  throw Error("no built-in scene \"" + name + "\"; there are " + known);
}

}  // namespace candela::content
