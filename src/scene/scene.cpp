#include "scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "math/box.h"
#include "scene/material_table.h"
#include "shade/units.glsl.h"

namespace candela {

namespace {

// Vertices times instances above which bounds come from the corners of each mesh's own box.
constexpr std::size_t kExactBoundsWork = 200'000'000;

bool finite(const mat4& m) {
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) {
      if (!std::isfinite(m[c][r])) return false;
    }
  }
  return true;
}

template <class V>
bool all_finite(const std::vector<V>& values) {
  for (const V& v : values) {
    for (int i = 0; i < V::length(); ++i) {
      if (!std::isfinite(v[i])) return false;
    }
  }
  return true;
}

std::string place(const char* list, std::size_t index) { return std::string(list) + '/' + std::to_string(index); }

void require(bool condition, const char* message, const std::string& where) {
  if (!condition) throw Error(message, where);
}

bool in_unit(float x) { return x >= 0.0f && x <= 1.0f; }
bool in_unit(vec3 v) { return in_unit(v.x) && in_unit(v.y) && in_unit(v.z); }
bool in_range(int index, std::size_t count) { return index >= 0 && static_cast<std::size_t>(index) < count; }
bool none_or_in_range(int index, std::size_t count) { return index == -1 || in_range(index, count); }

void validate_nodes(const Scene& scene) {
  const std::size_t count = scene.nodes.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Node& node = scene.nodes[i];
    const std::string where = place("nodes", i);
    require(none_or_in_range(node.parent, count), "the parent does not exist", where);
    require(none_or_in_range(node.mesh, scene.meshes.size()), "the mesh does not exist", where);
    require(none_or_in_range(node.camera, scene.cameras.size()), "the camera does not exist", where);
    require(none_or_in_range(node.light, scene.lights.size()), "the light does not exist", where);
    require(finite(node.parent_from_node) && finite(node.world_from_node), "the matrix is not finite", where);
    require(in_unit(vec3(node.color)) && in_unit(node.color.w), "the colour lies outside 0 to 1", where);
  }
}

void validate_ground(const Ground& ground) {
  const vec3 color = ground.color;
  const bool has_color = std::min({color.x, color.y, color.z}) >= 0.0f && max_component(color) <= 1.0f;
  if (!std::isfinite(ground.height) || !has_color || !(ground.mirror >= 0.0f && ground.mirror <= 1.0f))
    throw Error("number out of range", "/ground");
}

void validate_primitive(const Scene& scene, const Primitive& p, const std::string& where) {
  const std::size_t count = p.positions.size();
  require(p.normals.size() == count, "needs as many normals as positions", where);
  require(p.tangents.empty() || p.tangents.size() == count, "needs as many tangents as positions", where);
  for (const auto& [set, uvs] : p.uvs) {
    require(uvs.empty() || uvs.size() == count, "needs as many uvs as positions", where);
    require(all_finite(uvs), "a vertex is not finite", where);
  }
  require(p.colors.empty() || p.colors.size() == count, "needs as many colours as positions", where);
  require(in_range(p.material, scene.materials.size()), "the material does not exist", where);
  for (const uvec3& t : p.triangles) {
    require(t.x < count && t.y < count && t.z < count, "a triangle names a vertex that does not exist", where);
  }
  require(all_finite(p.positions) && all_finite(p.normals) && all_finite(p.tangents) && all_finite(p.colors),
          "a vertex is not finite", where);
}

void validate_material(const Scene& scene, const Material& m, const std::string& where) {
  for (const MaterialProperty& row : kMaterialProperties) {
    for (int i = 0; i < row.member.size(); ++i) {
      const float value = row.member.at(m, i);
      if (row.range.contains(value)) continue;
      throw Error(fmt::format("{} {} lies outside {:g} to {:g}", row.name, value, row.range.lower, row.range.upper),
                  where);
    }
  }
  const vec3 left = m.attenuation_color;
  require(left.x > 0.0f && left.y > 0.0f && left.z > 0.0f, "a volume lets nothing through at all", where);
  for (const TextureSlot* slot : texture_slots(m)) {
    require(none_or_in_range(slot->texture, scene.textures.size()), "the texture does not exist", where);
    require(slot->uv_set >= 0, "the uv set is negative", where);
    for (const vec2 column : slot->transform) {
      require(is_finite(column.x) && is_finite(column.y), "a texture transform is not finite", where);
    }
  }
}

void validate_images(const Scene& scene) {
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    require(in_range(scene.textures[i].image, scene.images.size()), "the image does not exist", place("textures", i));
  }
  for (std::size_t i = 0; i < scene.images.size(); ++i) {
    const std::string where = place("images", i);
    require(scene.images[i] != nullptr, "the image is missing", where);
    const TextureImage& image = *scene.images[i];
    require(image.width > 0 && image.height > 0, "the image is empty", where);
    require(image.bits == 8 || image.bits == 16, "the image has neither 8 nor 16 bits", where);
    const std::size_t bytes = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 4 *
                              static_cast<std::size_t>(image.bits / 8);
    require(image.pixels.size() == bytes, "the image has not as many pixels as its size says", where);
  }
}

void validate_cameras_and_lights(const Scene& scene) {
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    const std::string where = place("cameras", i);
    const Camera& camera = scene.cameras[i];
    require(camera.near_plane >= 0 && is_finite(camera.near_plane) && camera.far_plane > camera.near_plane,
            "the planes must be 0 <= near < far", where);
    if (const auto* p = std::get_if<PerspectiveCamera>(&scene.cameras[i].projection)) {
      require(p->yfov > 0 && p->yfov < kPi, "the field of view must lie between 0 and pi", where);
      require(!p->aspect_ratio || (*p->aspect_ratio > 0 && is_finite(*p->aspect_ratio)),
              "the aspect ratio is not positive", where);
    } else if (const auto* o = std::get_if<OrthographicCamera>(&scene.cameras[i].projection)) {
      require(o->xmag > 0 && o->ymag > 0 && is_finite(o->xmag) && is_finite(o->ymag), "the size is not positive",
              where);
    }
  }
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    const std::string where = place("lights", i);
    require(is_finite(light.color) && is_finite(light.intensity), "the light is not finite", where);
    require(light.range > 0, "the range is not positive", where);
    require(light.inner_cone >= 0 && light.inner_cone < light.outer_cone && light.outer_cone <= kPi / 2,
            "the cones must be 0 <= inner < outer <= pi/2", where);
    const vec3 a = light.polynomial;
    require(is_finite(a) && a.x >= 0 && a.y >= 0 && a.z >= 0 && max_component(a) > 0,
            "the polynomial must not be negative or 0", where);
    require(none_or_in_range(light.ies, scene.ies_profiles.size()), "the IES profile does not exist", where);
    require(light.ies < 0 || light.type == LightType::point, "only a point may have an IES profile", where);
  }
  for (std::size_t i = 0; i < scene.ies_profiles.size(); ++i) {
    require(is_valid(scene.ies_profiles[i]), "the IES profile is not well formed", place("ies_profiles", i));
  }
}

Box3 bounds(const Mesh& mesh) {
  Box3 box;
  for (const Primitive& primitive : mesh.primitives) {
    for (const vec3 p : primitive.positions) box.extend(p);
  }
  return box;
}

}  // namespace

void update_world_transforms(Scene& scene) {
  enum : char { unknown, pending, done };
  const std::size_t count = scene.nodes.size();
  std::vector<char> state(count, unknown);
  std::vector<std::size_t> chain;
  for (std::size_t i = 0; i < count; ++i) {
    // Up to a node that is known or has no parent, then down again.
    std::size_t at = i;
    while (state[at] == unknown) {
      state[at] = pending;
      chain.push_back(at);
      const int parent = scene.nodes[at].parent;
      if (parent == -1) break;
      require(in_range(parent, count), "the parent does not exist", place("nodes", at));
      at = static_cast<std::size_t>(parent);
      require(state[at] != pending, "the node is its own ancestor", place("nodes", at));
    }
    for (; !chain.empty(); chain.pop_back()) {
      Node& node = scene.nodes[chain.back()];
      node.world_from_node = node.parent == -1 ? node.parent_from_node
                                               : scene.nodes[static_cast<std::size_t>(node.parent)].world_from_node *
                                                     node.parent_from_node;
      state[chain.back()] = done;
    }
  }
}

bool is_lamp(const Scene& scene, const Node& node) {
  if (node.mesh < 0) return false;
  const std::vector<Primitive>& primitives = scene.meshes[static_cast<std::size_t>(node.mesh)].primitives;
  return !primitives.empty() && scene.materials[static_cast<std::size_t>(primitives[0].material)].is_lamp;
}

Box3 world_bounds(const Scene& scene) {
  std::size_t work = 0;
  for (const Node& node : scene.nodes) {
    if (node.mesh < 0 || is_lamp(scene, node)) continue;
    for (const Primitive& p : scene.meshes[static_cast<std::size_t>(node.mesh)].primitives) work += p.positions.size();
  }
  std::vector<Box3> mesh_boxes;
  if (work > kExactBoundsWork) {
    for (const Mesh& mesh : scene.meshes) mesh_boxes.push_back(bounds(mesh));
  }
  Box3 box;
  for (const Node& node : scene.nodes) {
    if (node.mesh < 0 || is_lamp(scene, node)) continue;
    const auto index = static_cast<std::size_t>(node.mesh);
    if (!mesh_boxes.empty()) {
      const Box3& local = mesh_boxes[index];
      if (local.empty()) continue;
      for (const vec3 p : corners(local)) box.extend(transform_point(node.world_from_node, p));
      continue;
    }
    for (const Primitive& primitive : scene.meshes[index].primitives) {
      for (const vec3 p : primitive.positions) box.extend(transform_point(node.world_from_node, p));
    }
  }
  return box;
}

float intensity_from_lumens(const Scene& scene, const Light& light, float lumens) {
  if (light.ies >= 0) {
    return lumens / static_cast<float>(ies_flux(scene.ies_profiles[static_cast<std::size_t>(light.ies)]));
  }
  if (light.type == LightType::point) return shade::units_candela_from_point_lumens(lumens);
  return shade::units_candela_from_spot_lumens(lumens, std::cos(light.inner_cone), std::cos(light.outer_cone));
}

void validate(const Scene& scene) {
  require(!scene.materials.empty(), "the scene has no material", "materials");
  validate_nodes(scene);
  if (scene.ground) validate_ground(*scene.ground);
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    for (std::size_t k = 0; k < scene.meshes[i].primitives.size(); ++k) {
      validate_primitive(scene, scene.meshes[i].primitives[k], place("meshes", i) + '/' + place("primitives", k));
    }
  }
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    validate_material(scene, scene.materials[i], place("materials", i));
  }
  validate_images(scene);
  validate_cameras_and_lights(scene);
}

}  // namespace candela
