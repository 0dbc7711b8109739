#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "io/gltf_accessor.h"
#include "io/gltf_warnings.h"
#include "math/types.h"

namespace candela::io {

/// EXT_lights_ies of a node: a profile of the file, brighter or dimmer and tinted.
struct IesUse {
  std::size_t profile = 0;
  float multiplier = 1.0f;
  vec3 color{1.0f};
};

struct FileNode {
  std::string name;
  bool has_matrix = false;  ///< in place of the three that an animation can move
  vec3 translation{0.0f};
  quat rotation{1, 0, 0, 0};
  vec3 scale{1.0f};
  std::optional<std::vector<float>> weights;  ///< of morph targets, where an animation sets them
  mat4 parent_from_node{1.0f};
  mat4 world_from_node{1.0f};
  std::optional<std::size_t> parent;
  std::vector<std::size_t> children;
  std::optional<std::size_t> mesh;
  std::optional<std::size_t> skin;
  std::optional<std::size_t> camera;
  std::optional<std::size_t> light;
  std::optional<IesUse> ies;
  std::optional<std::size_t> area_light;  ///< of EXT_lights_area
  bool is_visible = true;                 ///< KHR_node_visibility, as the moment has it; false hides all below, too
  bool in_scene = false;
  bool is_shown = false;  ///< in the scene, and neither hidden nor below what is
  /// Whether what it holds is part of the scene: shown, or in a file whose animations may show it at another moment.
  bool is_used = false;
};

struct FileScene {
  std::string name;
  std::vector<FileNode> nodes;  ///< all of the file, in its order
};

/// A quaternion of the file, of unit length; none is no rotation, with a warning.
quat read_rotation(const JsonView& json, Warnings& warnings);

/// Names of the file's scenes, empty where one has none.
std::vector<std::string> read_scene_names(const JsonView& root);

/// The index of the scene of that name, else of that number; of an empty name the file's default scene, else 0. Throws
/// Error where there is none such.
std::size_t find_scene(const JsonView& root, const std::string& name);

/// Reads the node hierarchy, checks that it is a forest, and marks what the scene (find_scene) reaches and shows, of a
/// file without scenes all that it has. `pose` may move, hide and show nodes before anything is derived from where they
/// are.
FileScene read_nodes(const JsonView& root, std::size_t scene, Warnings& warnings,
                     const std::function<void(std::vector<FileNode>&)>& pose = {});

/// Weights of morph targets as a node or a mesh has them at rest; empty where it says none.
std::vector<float> read_weights(const JsonView& owner);

struct Instances {
  std::vector<mat4> node_from_instance;
  std::vector<vec4> colors;  ///< _COLOR_0, which three.js and Babylon.js write and read; as many, or none
};

/// EXT_mesh_gpu_instancing of a node.
Instances read_instances(const JsonView& extension, AccessorReader& reader, Warnings& warnings);

}  // namespace candela::io
