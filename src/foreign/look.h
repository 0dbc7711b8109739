#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "math/types.h"

namespace candela::foreign {

/// A texture as a foreign material names it. uv' = scale * uv + offset, v upwards.
struct Map {
  std::string file;  ///< as written in the file; "*3" = the file's own fourth texture
  vec2 scale{1.0f};
  vec2 offset{0.0f};
  bool is_clamped = false;
  bool is_mirrored = false;
  int uv_set = 0;
  float strength = 1.0f;  ///< of normals and bumps

  explicit operator bool() const { return !file.empty(); }
  bool operator==(const Map&) const = default;
};

/// What a foreign file says of a surface, in the words of both worlds: Phong's where there is no better, and those of
/// physically based extensions where it has them. What it leaves out is empty.
struct Look {
  std::string name;
  vec3 color{0.8f};  ///< diffuse or base colour, linear
  float opacity = 1.0f;
  std::optional<vec3> specular;  ///< Phong's Ks; 0 = Lambert
  std::optional<float> shininess;
  std::optional<float> roughness, metallic;  ///< either makes it a metallic-roughness material
  std::optional<float> ior;
  vec3 emission{0.0f};
  float sheen = 0.0f;
  float clearcoat = 0.0f, clearcoat_roughness = 0.0f;
  float anisotropy = 0.0f, anisotropy_turns = 0.0f;
  float transmission = 0.0f;

  Map color_map, opacity_map, specular_map, emission_map;
  Map roughness_map, metallic_map, packed_map;  ///< `packed_map`: G roughness, B metallic, as glTF
  Map normal_map, bump_map, occlusion_map, sheen_map, clearcoat_map;
  std::vector<std::string> unused;  ///< what it says beside and nobody draws

  std::array<Map*, 12> maps() {
    return {&color_map,  &opacity_map, &specular_map, &emission_map,  &roughness_map, &metallic_map,
            &packed_map, &normal_map,  &bump_map,     &occlusion_map, &sheen_map,     &clearcoat_map};
  }

  bool is_physical() const { return roughness || metallic || roughness_map || metallic_map || packed_map; }
};

}  // namespace candela::foreign
