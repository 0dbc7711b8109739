#pragma once

#include <map>
#include <string>

#include "io/gltf_document.h"
#include "io/gltf_nodes.h"
#include "scene/scene.h"

namespace candela::io {

/// Reads KHR_lights_punctual with `extras.candela`, and EXT_lights_ies, into `scene`. A profile is read once however
/// many lights use it.
///
/// extras.candela of a punctual light: `temperature_k` multiplies the colour by a black body's, `falloff` and
/// `polynomial` say how it fades, `ies` is the URI of a profile that the intensity then multiplies, `lumens` replaces
/// the intensity by that of this flux. Numbers out of range are clamped, unknown names ignored, each with a warning.
class LightReader {
 public:
  LightReader(const JsonView& root, GltfBuffers& buffers, const UriReader& uris, Warnings& warnings, Scene& scene)
      : root_(root), buffers_(buffers), uris_(uris), warnings_(warnings), scene_(scene) {}

  /// Both return an index into Scene::lights.
  int add_punctual(std::size_t file_index);
  int add_ies(const IesUse& use);

 private:
  void read_candela(const JsonView& extras, const std::string& title, Light& light);
  void read_falloff(const JsonView& extras, const std::string& title, Light& light);
  void set_lumens(const JsonView& json, const std::string& title, Light& light);
  int profile_of_file(std::size_t index);
  int profile_at(const JsonView& uri);
  int add_profile(std::span<const std::byte> bytes, const JsonView& place, std::string name);

  JsonView root_;
  GltfBuffers& buffers_;
  const UriReader& uris_;
  Warnings& warnings_;
  Scene& scene_;
  std::map<std::size_t, int> profile_of_file_;
  std::map<std::string, int> profile_of_uri_;
  std::size_t profile_bytes_ = 0;
};

}  // namespace candela::io
