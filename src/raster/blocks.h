#pragma once

#include <array>

#include "math/types.h"
#include "scene/scene.h"

/// Uniform blocks as the shaders declare them (std140; shaders/frame.glsl, material.glsl, lights.glsl): vectors of four
/// and matrices only, so that C++ and GLSL lay them out alike.
namespace candela::raster {

inline constexpr int kMostLights = 32;
inline constexpr int kMostShadows = 32;
inline constexpr int kMostAreas = 8;
inline constexpr std::size_t kSlots = std::tuple_size_v<decltype(texture_slots(std::declval<Material&>()))>;

/// Places of texture_slots() that somebody asks for by name.
enum Slot : int { base_color_slot, metallic_roughness_slot, normal_slot, occlusion_slot, emissive_slot };

struct FrameBlock {
  mat4 clip_from_world{1.0f};
  vec4 eye{0.0f};
  vec4 back{0.0f};
  vec4 light{0.0f};
  vec4 target{0.0f};
  vec4 soft{0.0f};
  glm::ivec4 counts{0};
};

struct MaterialBlock {
  vec4 base_color{1.0f};
  vec4 emission{0.0f};
  vec4 metallic_roughness{0.0f};
  vec4 specular_color{0.0f};
  vec4 coat{0.0f};
  vec4 sheen{0.0f};
  vec4 anisotropy{0.0f};
  vec4 film{0.0f};
  vec4 transmission{0.0f};
  vec4 extinction{0.0f};
  vec4 below_color{0.0f};
  vec4 conductor_n{0.0f};
  vec4 conductor_k{0.0f};
  vec4 scatter{0.0f};
  vec4 scatter_color{0.0f};
  vec4 relief{0.0f};
  std::array<vec4, 2 * kSlots> uv_transform{};
};

struct LightEntry {
  vec4 position{0.0f};
  vec4 direction{0.0f};
  vec4 color{0.0f};
  vec4 cone{0.0f};
  vec4 polynomial{0.0f};
  vec4 across{0.0f};
};

struct AreaEntry {
  std::array<vec4, 4> corners{};
  vec4 color{0.0f};
  vec4 shape{0.0f};
};

struct LightsBlock {
  std::array<LightEntry, kMostLights> lights{};
  std::array<mat4, kMostShadows> shadow_from_world{};
  std::array<vec4, kMostShadows> shadow_texel{};
  std::array<AreaEntry, kMostAreas> areas{};
};

/// Binding points of the blocks, the same in every program.
enum Binding : unsigned { frame_binding, material_binding, lights_binding };

}  // namespace candela::raster
