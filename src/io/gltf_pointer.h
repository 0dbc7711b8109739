#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "io/gltf_warnings.h"
#include "io/json_view.h"

/// KHR_animation_pointer: what of a file an animation may move beside its nodes, by the glTF 2.0 Asset Object Model.
namespace candela::io {

/// Types of the object model, as properties that may move have them; rotations are its `float4` that turn evenly.
enum class PropertyType { boolean, number, numbers, vec2, vec3, vec4, rotation };

/// What one channel of an animation moves.
struct Target {
  std::vector<std::string> tokens;  ///< of its JSON pointer, without escapes
  PropertyType type = PropertyType::number;
  bool is_pointer = false;  ///< rather than a node and a path

  /// As RFC 6901 writes it: equal for equal properties.
  std::string pointer() const;
  /// Translation, rotation, scale and weights are the node's own: where it stands and how its mesh is shaped.
  bool is_of_node() const { return tokens[0] == "nodes" && tokens[2] != "extensions"; }
  /// An index among the tokens, which are known to be right.
  std::size_t index(std::size_t token) const;
};

/// The extension of a channel's target, where it has one.
std::optional<JsonView> pointer_extension(const JsonView& channel);

/// The property that the JSON string `pointer` names. Throws Error where it names nothing: what an element, an object
/// or a value without default is missing for. None, with a warning or note, for what stands in the file and is not
/// drawn, or may not be moved.
std::optional<Target> find_property(const nlohmann::json& root, const JsonView& pointer, Warnings& warnings);

/// A document some of whose properties stand as an animation has them, as long as this lives. What reads materials,
/// lights and cameras then reads a moment of them.
class MovedDocument {
 public:
  explicit MovedDocument(nlohmann::json& root);
  ~MovedDocument();
  MovedDocument(const MovedDocument&) = delete;
  MovedDocument& operator=(const MovedDocument&) = delete;

  /// `values`: as many as the target's type has. Of invalid ones, those that stand for another kind of thing rather
  /// than for a number out of range are refused with a warning.
  void set(const Target& target, const std::vector<float>& values, const JsonView& channel, Warnings& warnings);

  bool has_moved_material(std::size_t index) const { return materials_.contains(index); }

 private:
  struct Change;

  nlohmann::json& root_;
  std::vector<Change> changes_;  ///< in their order
  std::set<std::size_t> materials_;
};

}  // namespace candela::io
