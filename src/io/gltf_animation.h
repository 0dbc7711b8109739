#pragma once

#include <string>
#include <vector>

#include "io/gltf.h"
#include "io/gltf_accessor.h"
#include "io/gltf_nodes.h"
#include "io/gltf_pointer.h"

namespace candela::io {

/// What the file's animations are called and how long they last, from the bounds that it states of their times.
std::vector<AnimationInfo> read_animation_list(const JsonView& root);

/// The animations that `name` means: one by name or index, the first for an empty name, every one for "all". Throws
/// Error that lists those there are; empty where the file has none and no name is given.
std::vector<std::size_t> find_animations(const JsonView& root, const std::string& name);

/// Throws Error where a pointer of some animation leads to nothing, and warns of animations that move one property by
/// two channels: the last counts.
void check_channels(const JsonView& root, const nlohmann::json& document, Warnings& warnings);

/// An animation `time` seconds after its start; before the first and after the last key: there. glTF 2.0 §3.11,
/// interpolation as in its appendix C, KHR_animation_pointer.
class AnimatedMoment {
 public:
  /// `document` is what `root` shows.
  AnimatedMoment(const JsonView& root, const nlohmann::json& document, std::size_t animation, double time,
                 AccessorReader& reader, Warnings& warnings);

  /// Moves what readers take from the document.
  void move_properties(MovedDocument& document) const;
  /// Moves nodes, and sets the weights of their morph targets.
  void pose_nodes(std::vector<FileNode>& nodes) const;

 private:
  struct Value {
    Target target;
    std::vector<float> numbers;
    JsonView place;
  };

  std::vector<float> rest_weights(const FileNode& node, std::size_t index) const;

  JsonView root_;
  Warnings& warnings_;
  std::vector<Value> values_;  ///< of each channel that moves something, in the file's order
};

}  // namespace candela::io
