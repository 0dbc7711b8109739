#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "foreign/surroundings.h"
#include "math/types.h"

namespace candela::foreign {

/// A glTF in the making: its JSON, its one buffer, and what is still to be done where threads may run.
struct Draft {
  nlohmann::json gltf = {{"asset", {{"version", "2.0"}}}};
  std::vector<std::byte> buffer;
  /// Pictures that materials are mixed from, as members of `images` are: {"uri"} or {"bufferView"}.
  nlohmann::json sources = nlohmann::json::array();
  /// How: {"image", "kind": "pack", "roughness", "metallic"} | {"kind": "cover", "color", "opacity"} |
  /// {"kind": "relief", "source", "strength"}; values are places in `sources`, or -1.
  nlohmann::json mixtures = nlohmann::json::array();
  std::vector<std::string> read;  ///< names of what was read beside the file
  Diagnostics diagnostics;

  std::size_t add_view(std::span<const std::byte> bytes);
  template <class T>
  std::size_t add_accessor(std::span<const T> values, const char* type, int component_type) {
    const std::size_t view = add_view(std::as_bytes(values));
    return add("accessors",
               {{"bufferView", view}, {"componentType", component_type}, {"count", values.size()}, {"type", type}});
  }
  std::size_t add_floats(std::span<const float> v) { return add_accessor(v, "SCALAR", kFloat); }
  /// Rising moments of an animation.
  std::size_t add_times(std::span<const float> v);
  std::size_t add_vectors(std::span<const vec2> v) { return add_accessor(v, "VEC2", kFloat); }
  std::size_t add_vectors(std::span<const vec3> v) { return add_accessor(v, "VEC3", kFloat); }
  std::size_t add_vectors(std::span<const vec4> v) { return add_accessor(v, "VEC4", kFloat); }
  /// Appends to a list of the document; the place there.
  std::size_t add(const char* list, nlohmann::json value);
  void use_extension(const std::string& name);

  static constexpr int kFloat = 5126, kUnsignedInt = 5125, kUnsignedShort = 5123;
};

/// The whole draft as bytes, to go from one process to another.
std::vector<std::byte> pack(const Draft& draft);
Draft unpack(std::span<const std::byte> bytes);

/// A name as a URI of glTF.
std::string uri_of(const std::string& name);

}  // namespace candela::foreign
