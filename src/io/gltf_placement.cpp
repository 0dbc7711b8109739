#include <fmt/format.h>

#include <cmath>

#include "io/gltf_areas.h"
#include "io/gltf_camera.h"
#include "io/gltf_lights.h"
#include "io/gltf_loader.h"

// What stands where: cameras, lamps and meshes in the nodes of a scene.
namespace candela::io {

void Loader::read_cameras_and_lights() {
  for (const FileNode& node : file_.nodes) {
    if (node.in_scene && node.camera) camera_of_file_[*node.camera] = 0;
    if (node.is_used && node.light) light_of_file_[*node.light] = 0;
  }
  for (auto& [file_index, index] : camera_of_file_) {
    index = static_cast<int>(scene_.cameras.size());
    scene_.cameras.push_back(read_camera(root_.at("cameras")[file_index], warnings_));
    scene_.cameras.back().file_index = static_cast<int>(file_index);
  }
  LightReader lights(root_, buffers_, uris_, warnings_, scene_);
  for (auto& [file_index, index] : light_of_file_) index = lights.add_punctual(file_index);
  for (std::size_t i = 0; i < file_.nodes.size(); ++i) {
    const FileNode& node = file_.nodes[i];
    if (node.is_used && node.ies) ies_light_of_node_[i] = lights.add_ies(*node.ies);
  }
}

/// World coordinates obey the limit of a mesh's own.
void Loader::check_extent(const mat4& world_from_mesh, std::size_t file_index, const Box3& box) const {
  for (int corner = 0; corner < 8; ++corner) {
    const vec3 p((corner & 1) != 0 ? box.upper.x : box.lower.x, (corner & 2) != 0 ? box.upper.y : box.lower.y,
                 (corner & 4) != 0 ? box.upper.z : box.lower.z);
    const vec3 world = glm::abs(transform_point(world_from_mesh, p));
    if (!(max_component(world) <= kLargestCoordinate)) {
      throw root_.at("nodes")[file_index].error(
          fmt::format("the mesh reaches beyond {:g} metres from the origin", kLargestCoordinate));
    }
  }
}

/// A mesh that is flat because of a scale of 0, its node's own or one above it, and that nobody hides on purpose.
void Loader::check_scale(const mat4& world_from_mesh, std::size_t file_index) {
  if (is_posed_) return;
  glm::dmat3 linear(world_from_mesh);
  bool is_flat = false;
  for (int i = 0; i < 3; ++i) {
    const double length = glm::length(linear[i]);
    is_flat |= !(length > 0.0);
    if (length > 0.0) linear[i] /= length;
  }
  // Below what rounding leaves of three axes in one plane.
  if (!is_flat && std::fabs(glm::determinant(linear)) > 1e-9) return;
  const std::string& name = file_.nodes[file_index].name;
  warnings_.warn(fmt::format("node {}{}: a scale of 0 flattens its mesh", file_index,
                             name.empty() ? "" : fmt::format(" '{}'", name)),
                 root_.at("nodes")[file_index]);
}

/// Puts a mesh into its node, or where it hangs on other transforms than the node's into nodes of its own.
void Loader::place_mesh(std::size_t file_index, int mesh, const Box3& box, int scene_node, Node& node,
                        std::vector<Node>& appended) {
  const FileNode& source = file_.nodes[file_index];
  const JsonView json = root_.at("nodes")[file_index];
  if (const auto instancing = json.extension("EXT_mesh_gpu_instancing")) {
    const Instances instances = read_instances(*instancing, reader_, warnings_);
    for (std::size_t i = 0; i < instances.node_from_instance.size(); ++i) {
      Node instance;
      instance.name = source.name;
      instance.parent = scene_node;
      instance.parent_from_node = instances.node_from_instance[i];
      instance.mesh = mesh;
      instance.file_index = static_cast<int>(file_index);
      if (!instances.colors.empty()) instance.color = instances.colors[i];
      const mat4 world_from_mesh = source.world_from_node * instance.parent_from_node;
      check_extent(world_from_mesh, file_index, box);
      check_scale(world_from_mesh, file_index);
      appended.push_back(std::move(instance));
    }
  } else if (source.skin) {
    Node posed;
    posed.name = source.name;
    posed.mesh = mesh;
    posed.file_index = static_cast<int>(file_index);
    appended.push_back(std::move(posed));
  } else {
    check_extent(source.world_from_node, file_index, box);
    check_scale(source.world_from_node, file_index);
    node.mesh = mesh;
  }
}

/// As a mesh that glows, of a node of its own: it grows with its node to all sides alike.
void Loader::place_area_light(std::size_t file_index, std::vector<Node>& appended) {
  const FileNode& source = file_.nodes[file_index];
  const auto place = place_of_area_light(source.world_from_node);
  if (!place) return;
  const std::size_t light = *source.area_light;
  const auto [found, is_new] = mesh_of_area_light_.try_emplace(light, -1);
  if (is_new) {
    found->second = add_area_light(root_.extension("EXT_lights_area")->at("lights")[light], scene_, warnings_);
  }
  const Mesh& mesh = scene_.meshes[static_cast<std::size_t>(found->second)];
  if (mesh.primitives.empty()) return;
  Box3 box;
  for (const vec3 p : mesh.primitives[0].positions) box.extend(p);
  check_extent(*place, file_index, box);
  Node lamp;
  lamp.name = source.name;
  lamp.parent_from_node = *place;
  lamp.mesh = found->second;
  lamp.file_index = static_cast<int>(file_index);
  appended.push_back(std::move(lamp));
}

void Loader::place_nodes() {
  std::vector<int> node_of_file(file_.nodes.size(), -1);
  int count = 0;
  for (std::size_t i = 0; i < file_.nodes.size(); ++i) {
    if (file_.nodes[i].in_scene) node_of_file[i] = count++;
  }
  std::vector<Box3> boxes(scene_.meshes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (const Primitive& primitive : scene_.meshes[i].primitives) {
      for (const vec3 p : primitive.positions) boxes[i].extend(p);
    }
  }
  std::vector<Node> appended;
  for (std::size_t i = 0; i < file_.nodes.size(); ++i) {
    const FileNode& source = file_.nodes[i];
    if (!source.in_scene) continue;
    Node node;
    node.name = source.name;
    node.parent = source.parent ? node_of_file[*source.parent] : -1;
    node.parent_from_node = source.parent_from_node;
    node.file_index = static_cast<int>(i);
    if (source.camera) node.camera = camera_of_file_.at(*source.camera);
    node.is_hidden = !source.is_shown;
    if (!source.is_shown) {
      scene_.nodes.push_back(std::move(node));
      continue;
    }
    if (source.light) node.light = light_of_file_.at(*source.light);
    if (source.area_light) place_area_light(i, appended);
    const auto mesh = mesh_of_node_[i];
    if (mesh && !scene_.meshes[*mesh].primitives.empty()) {
      place_mesh(i, static_cast<int>(*mesh), boxes[*mesh], node_of_file[i], node, appended);
    }
    if (source.ies && node.light < 0) {
      node.light = ies_light_of_node_.at(i);
    } else if (source.ies) {
      Node second;
      second.name = source.name;
      second.parent = node_of_file[i];
      second.file_index = static_cast<int>(i);
      second.light = ies_light_of_node_.at(i);
      appended.push_back(second);
    }
    scene_.nodes.push_back(std::move(node));
  }
  scene_.nodes.insert(scene_.nodes.end(), appended.begin(), appended.end());
}

}  // namespace candela::io
