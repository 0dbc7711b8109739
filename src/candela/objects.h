#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.h"

/// What the numbers of layers, masks and data sets mean.
namespace candela {

/// What of a scene data sets call an object.
enum class InstanceKind {
  node,  ///< every node with a mesh, by the name of its mesh
  scene  ///< the whole scene
};

struct Instance {
  std::uint32_t number = 0;  ///< as Layer::instance has it; 1 of a whole scene
  std::string name;          ///< unique in its scene
  std::string category;
  std::vector<int> nodes;  ///< of the scene
};
/// By ascending number. `scene_name` is the name and the category of the scene as a whole.
std::vector<Instance> instances_of(const Scene& scene, InstanceKind kind, const std::string& scene_name);

/// JSON: "instances" (instance, id, name, mesh), "meshes" (mesh, name) and "materials" (material, name), each under the
/// number that the layer of that name has.
std::string objects_json(const Scene& scene);

}  // namespace candela
