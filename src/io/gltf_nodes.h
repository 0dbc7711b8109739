#pragma once

#include <optional>
#include <string>
#include <vector>

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
  mat4 parent_from_node{1.0f};
  mat4 world_from_node{1.0f};
  std::optional<std::size_t> parent;
  std::vector<std::size_t> children;
  std::optional<std::size_t> mesh;
  std::optional<std::size_t> skin;
  std::optional<std::size_t> camera;
  std::optional<std::size_t> light;
  std::optional<IesUse> ies;
  bool in_scene = false;
};

struct FileScene {
  std::string name;
  std::vector<FileNode> nodes;  ///< all of the file, in its order
};

/// Reads the node hierarchy, checks that it is a forest, and marks what the default scene reaches.
FileScene read_nodes(const JsonView& root, Warnings& warnings);

}  // namespace candela::io
