#include "io/gltf_nodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "io/gltf_pointer.h"

namespace candela::io {

quat read_rotation(const JsonView& json, Warnings& warnings) {
  const auto numbers = json.reals(4);
  double length = 0;
  for (const float x : numbers) length += double{x} * x;
  length = std::sqrt(length);
  if (length == 0) {
    warnings.warn("a rotation is the zero quaternion; taken as no rotation", json);
    return quat(1, 0, 0, 0);
  }
  // Quantised animations are a little off; beyond a percent it is a mistake worth telling.
  if (std::fabs(length - 1) > 0.01) warnings.warn("a rotation is no unit quaternion and is normalised", json);
  const auto unit = [&](std::size_t i) { return static_cast<float>(numbers[i] / length); };
  return quat(unit(3), unit(0), unit(1), unit(2));
}

namespace {

bool is_finite(const mat4& m) {
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) {
      if (!std::isfinite(m[c][r])) return false;
    }
  }
  return true;
}

mat4 read_matrix(const JsonView& json, Warnings& warnings) {
  mat4 result(1.0f);
  const auto numbers = json.reals(16);
  for (int i = 0; i < 16; ++i) result[i / 4][i % 4] = numbers[static_cast<std::size_t>(i)];
  for (int c = 0; c < 4; ++c) {
    const float affine = c == 3 ? 1.0f : 0.0f;
    // Exporters that multiply matrices in floats leave a few ulp here.
    if (std::fabs(result[c][3] - affine) > 1e-4f)
      warnings.warn("the last row of a matrix must be 0 0 0 1; taken as that", json);
    result[c][3] = affine;
  }
  return result;
}

void read_transform(const JsonView& json, Warnings& warnings, FileNode& node) {
  if (const auto matrix = json.find("matrix")) {
    for (const char* key : {"translation", "rotation", "scale"}) {
      if (json.find(key))
        warnings.warn("a node has both a matrix and a translation, rotation or scale; the matrix counts", json);
    }
    node.has_matrix = true;
    node.parent_from_node = read_matrix(*matrix, warnings);
    return;
  }
  node.scale = json.vector_or("scale", vec3(1));
  if (const auto rotation = json.find("rotation")) node.rotation = read_rotation(*rotation, warnings);
  node.translation = json.vector_or("translation", vec3(0));
}

mat4 compose(vec3 translation, quat rotation, vec3 scale) {
  mat4 result = glm::mat4_cast(rotation);
  for (int i = 0; i < 3; ++i) result[i] *= scale[i];
  result[3] = vec4(translation, 1);
  return result;
}

/// How many of each a node may refer to.
struct Counts {
  std::size_t meshes, skins, cameras, lights, profiles, areas;
};

IesUse read_ies_use(const JsonView& json, std::size_t profiles, Warnings& warnings) {
  IesUse use;
  use.profile = json.at("light").index(profiles, "light profile");
  const float multiplier = json.real_or("multiplier", 1.0f);
  const vec3 color = json.vector_or("color", vec3(1));
  use.multiplier = std::max(multiplier, 0.0f);
  use.color = glm::clamp(color, vec3(0), vec3(1));
  if (use.multiplier != multiplier || use.color != color) {
    warnings.warn("an IES light's multiplier or colour is out of range and clamped", json);
  }
  return use;
}

FileNode read_node(const JsonView& json, const Counts& counts, Warnings& warnings) {
  FileNode node;
  node.name = json.string_or("name");
  read_transform(json, warnings, node);
  node.mesh = json.index_of("mesh", counts.meshes, "mesh");
  node.skin = json.index_of("skin", counts.skins, "skin");
  node.camera = json.index_of("camera", counts.cameras, "camera");
  if (const auto visibility = json.extension("KHR_node_visibility")) {
    node.is_visible = visibility->boolean_or("visible", true);
  }
  if (const auto light = json.extension("KHR_lights_punctual")) {
    node.light = light->at("light").index(counts.lights, "light");
  }
  if (const auto area = json.extension("EXT_lights_area")) {
    node.area_light = area->at("light").index(counts.areas, "area light");
  }
  if (const auto ies = json.extension("EXT_lights_ies")) node.ies = read_ies_use(*ies, counts.profiles, warnings);
  return node;
}

void link_children(const JsonView& nodes_json, std::vector<FileNode>& nodes) {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto children = nodes_json[i].find("children");
    for (std::size_t k = 0; children && k < children->size(); ++k) {
      const JsonView reference = (*children)[k];
      const std::size_t child = reference.index(nodes.size(), "node");
      auto& parent = nodes[child].parent;
      if (parent) throw reference.error(fmt::format("node {} has two parents ({} and {})", child, *parent, i));
      parent = i;
      nodes[i].children.push_back(child);
    }
  }
}

/// Everything is reached from nodes without a parent, or stands in a cycle, because nobody has two parents.
void compute_world(const JsonView& nodes_json, std::vector<FileNode>& nodes) {
  std::vector<std::size_t> stack;
  std::vector<bool> visited(nodes.size(), false);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!nodes[i].parent) stack.push_back(i);
  }
  while (!stack.empty()) {
    FileNode& node = nodes[stack.back()];
    const std::size_t index = stack.back();
    visited[index] = true;
    stack.pop_back();
    node.world_from_node =
        node.parent ? nodes[*node.parent].world_from_node * node.parent_from_node : node.parent_from_node;
    if (!is_finite(node.world_from_node)) throw nodes_json[index].error("the node's world matrix is not finite");
    stack.insert(stack.end(), node.children.begin(), node.children.end());
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!visited[i]) throw nodes_json[i].error(fmt::format("node {} is its own ancestor", i));
  }
}

/// Whether some animation of the file hides or shows nodes (KHR_animation_pointer).
bool is_visibility_animated(const JsonView& root) {
  for (std::size_t i = 0; i < count_of(root, "animations"); ++i) {
    const auto channels = root.at("animations")[i].find("channels");
    for (std::size_t k = 0; channels && k < channels->size(); ++k) {
      const auto moved = pointer_extension((*channels)[k]);
      if (moved && moved->string_or("pointer").ends_with("/extensions/KHR_node_visibility/visible")) return true;
    }
  }
  return false;
}

/// Marks what hangs on the roots of a scene, from parents to children.
void mark_scene(const std::vector<std::size_t>& roots, bool uses_hidden, std::vector<FileNode>& nodes) {
  std::vector<std::size_t> stack = roots;
  while (!stack.empty()) {
    FileNode& node = nodes[stack.back()];
    stack.pop_back();
    if (node.in_scene) continue;
    node.in_scene = true;
    node.is_shown = node.is_visible && (!node.parent || nodes[*node.parent].is_shown);
    node.is_used = node.is_shown || uses_hidden;
    stack.insert(stack.end(), node.children.begin(), node.children.end());
  }
}

/// Roots of a scene, or of the whole file where it has none.
std::vector<std::size_t> scene_roots(const JsonView& root, std::size_t chosen, FileScene& scene) {
  std::vector<std::size_t> roots;
  if (count_of(root, "scenes") == 0) {
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
      if (!scene.nodes[i].parent) roots.push_back(i);
    }
    return roots;
  }
  const JsonView json = root.at("scenes")[chosen];
  scene.name = json.string_or("name");
  const auto list = json.find("nodes");
  for (std::size_t k = 0; list && k < list->size(); ++k) {
    const JsonView reference = (*list)[k];
    const std::size_t index = reference.index(scene.nodes.size(), "node");
    const auto parent = scene.nodes[index].parent;
    if (parent) throw reference.error(fmt::format("node {} is no root: it is a child of node {}", index, *parent));
    roots.push_back(index);
  }
  return roots;
}

}  // namespace

std::vector<std::string> read_scene_names(const JsonView& root) {
  const std::size_t count = count_of(root, "scenes");
  std::vector<std::string> names;
  names.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    names.push_back(root.at("scenes")[i].string_or("name"));
  }
  return names;
}

std::size_t find_scene(const JsonView& root, const std::string& name) {
  const std::size_t count = count_of(root, "scenes");
  if (name.empty()) return root.index_of("scene", count, "scene").value_or(0);
  const std::vector<std::string> names = read_scene_names(root);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  std::size_t index = count;
  const auto [end, code] = std::from_chars(name.data(), name.data() + name.size(), index);
  if (code == std::errc() && end == name.data() + name.size() && index < count) return index;
  constexpr std::size_t kMostNames = 20;
  std::string all;
  for (std::size_t i = 0; i < std::min(count, kMostNames); ++i) {
    all += fmt::format("{}{}{}", i == 0 ? "" : ", ", i, names[i].empty() ? "" : fmt::format(" '{}'", names[i]));
  }
  if (count > kMostNames) all += fmt::format(" and {} more", count - kMostNames);
  throw root.error(fmt::format("there is no scene '{}'; the file has: {}", name, count == 0 ? "none" : all));
}

FileScene read_nodes(const JsonView& root, std::size_t scene_index, Warnings& warnings,
                     const std::function<void(std::vector<FileNode>&)>& pose) {
  FileScene scene;
  const auto lights = root.extension("KHR_lights_punctual");
  const auto profiles = root.extension("EXT_lights_ies");
  const auto areas = root.extension("EXT_lights_area");
  const Counts counts{count_of(root, "meshes"),
                      count_of(root, "skins"),
                      count_of(root, "cameras"),
                      lights ? count_of(*lights, "lights") : 0,
                      profiles ? count_of(*profiles, "lights") : 0,
                      areas ? count_of(*areas, "lights") : 0};
  if (const auto nodes_json = root.find("nodes")) {
    const std::size_t count = nodes_json->size();
    for (std::size_t i = 0; i < count; ++i) scene.nodes.push_back(read_node((*nodes_json)[i], counts, warnings));
    link_children(*nodes_json, scene.nodes);
    if (pose) pose(scene.nodes);
    for (FileNode& node : scene.nodes) {
      if (!node.has_matrix) node.parent_from_node = compose(node.translation, node.rotation, node.scale);
    }
    compute_world(*nodes_json, scene.nodes);
  }
  mark_scene(scene_roots(root, scene_index, scene), is_visibility_animated(root), scene.nodes);
  return scene;
}

namespace {

std::vector<vec4> read_colors(const Accessor& accessor, const JsonView& attributes, AccessorReader& reader,
                              Warnings& warnings) {
  std::vector<vec4> colors;
  if (accessor.components == 4) {
    colors = reader.read_as<vec4>(accessor);
  } else {
    for (const vec3 c : reader.read_as<vec3>(accessor)) colors.emplace_back(c, 1.0f);
  }
  bool is_out_of_range = false;
  for (vec4& c : colors) {
    const vec4 clamped = glm::clamp(c, vec4(0), vec4(1));
    is_out_of_range |= clamped != c;
    c = clamped;
  }
  if (is_out_of_range) warnings.warn("colours of instances outside 0 to 1 are clamped", attributes.at("_COLOR_0"));
  return colors;
}

}  // namespace

std::vector<float> read_weights(const JsonView& owner) {
  const auto weights = owner.find("weights");
  return weights ? weights->reals(weights->size()) : std::vector<float>();
}

Instances read_instances(const JsonView& extension, AccessorReader& reader, Warnings& warnings) {
  const JsonView attributes = extension.at("attributes");
  std::optional<std::size_t> count;
  const auto open = [&](const char* name, std::initializer_list<const char*> types) -> std::optional<Accessor> {
    const auto reference = attributes.find(name);
    if (!reference) return std::nullopt;
    Accessor accessor = reader.open(*reference, types);
    if (count.value_or(accessor.count) != accessor.count) {
      throw reference->error(fmt::format("has {} elements, but others have {}", accessor.count, *count));
    }
    count = accessor.count;
    return accessor;
  };
  const auto translations = open("TRANSLATION", {"VEC3"}), rotations = open("ROTATION", {"VEC4"}),
             scales = open("SCALE", {"VEC3"});
  if (!count) throw attributes.error("none of TRANSLATION, ROTATION and SCALE is there");
  // Beside the matrix the node of the scene.
  reader.charge(std::uint64_t{*count} * 4 * sizeof(mat4), extension);
  std::vector<vec3> t(*count, vec3(0)), s(*count, vec3(1));
  std::vector<vec4> r(*count, vec4(0, 0, 0, 1));
  if (translations) t = reader.read_as<vec3>(*translations);
  if (rotations) r = reader.read_as<vec4>(*rotations);
  if (scales) s = reader.read_as<vec3>(*scales);
  Instances result;
  if (const auto colors = open("_COLOR_0", {"VEC3", "VEC4"})) {
    result.colors = read_colors(*colors, attributes, reader, warnings);
  }
  result.node_from_instance.resize(*count);
  for (std::size_t i = 0; i < *count; ++i) {
    const float length = glm::length(r[i]);
    const vec4 q = length > 0 ? r[i] / length : vec4(0, 0, 0, 1);
    result.node_from_instance[i] = compose(t[i], quat(q.w, q.x, q.y, q.z), s[i]);
  }
  return result;
}

}  // namespace candela::io
