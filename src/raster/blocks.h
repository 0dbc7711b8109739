#pragma once

#include <array>
#include <cstddef>

#include "math/types.h"

/// Uniform blocks as the shaders declare them (std140; shaders/frame.glsl, lights.glsl; of materials,
/// material_block.h). A vector of three and the number after it share sixteen bytes in both languages;
/// tests/unit/raster/blocks_test.cpp asks the driver for every offset.
namespace candela::raster {

inline constexpr int kMostLights = 32;
inline constexpr int kMostShadows = 64;
inline constexpr int kMostAreas = 8;

/// Positions of the frame, of lights and of shadows are relative to the scene's origin (GpuScene::origin).
struct FrameBlock {
  mat4 clip_from_world{1.0f};
  vec3 eye{0.0f};
  float is_perspective = 1.0f;
  vec3 back{0.0f};  ///< unit, from the scene towards an orthographic viewer
  float light_levels = 1.0f;
  float least_roughness = 0.0f;
  float sample_area = 0.0f;  ///< of a pixel's area, what one sample stands for
  float picture_height = 0.0f;
  float picture_levels = 1.0f;
  float light_radius = 0.0f;  ///< of points and spots, metres
  float noise_turn = 0.0f;    ///< changes from frame to frame
  float shadow_share = 1.0f;  ///< of a light's radius that this frame's shadows have
  int light_count = 0;
  int shown_parts = 0;   ///< bits of Part
  int shown_light = -1;  ///< the only one, or -1
  int area_count = 0;
  int padding = 0;
  vec3 light_turn{1.0f, 0.0f, 1.0f};  ///< cosine and sine of how far light from far away has turned; its factor
  int more_padding = 0;
};
static_assert(offsetof(FrameBlock, eye) == 64 && offsetof(FrameBlock, back) == 80 &&
              offsetof(FrameBlock, least_roughness) == 96 && offsetof(FrameBlock, light_radius) == 112 &&
              offsetof(FrameBlock, shown_parts) == 128 && offsetof(FrameBlock, light_turn) == 144 &&
              sizeof(FrameBlock) == 160);

struct LightEntry {
  vec3 position{0.0f};
  int kind = 0;              ///< LightType
  vec3 direction{0, 0, -1};  ///< unit, it shines along
  float range = kInfinity;
  vec3 color{0.0f};  ///< times intensity
  int falloff = 0;
  vec3 polynomial{0.0f};
  int profile = -1;
  vec3 across{1, 0, 0};     ///< the light's own +x
  float handedness = 1.0f;  ///< +1 or -1, the side of its +y
  float cos_inner = 1.0f;   ///< of a spot's cone
  float cos_outer = 0.0f;
  float sun_radius = 0.0f;  ///< tangent of the angular radius of a directional light
  int first_shadow = -1;    ///< -1 none
  int shadow_count = 0;
  std::array<int, 3> padding{};
};
static_assert(offsetof(LightEntry, direction) == 16 && offsetof(LightEntry, color) == 32 &&
              offsetof(LightEntry, polynomial) == 48 && offsetof(LightEntry, across) == 64 &&
              offsetof(LightEntry, cos_inner) == 80 && offsetof(LightEntry, shadow_count) == 96 &&
              sizeof(LightEntry) == 112);

/// A rectangle or a triangle (whose first and last corner are one), or a square about corner_0 that faces what it
/// lights.
struct AreaEntry {
  vec3 corner_0{0.0f};  ///< counter-clockwise from the front
  float radius = 0.0f;  ///< of a disc as large
  vec3 corner_1{0.0f};
  float half_side = 0.0f;  ///< of the square
  vec3 corner_2{0.0f};
  float extent = 0.0f;  ///< how far from its middle the surface reaches that it stands for
  vec3 corner_3{0.0f};
  int is_body = 0;   ///< the square
  vec3 color{0.0f};  ///< radiance
  int has_two_sides = 0;
  int first_shadow = -1;  ///< -1 none
  int shadow_count = 0;
  std::array<int, 2> padding{};

  vec3 middle() const { return is_body != 0 ? corner_0 : 0.25f * (corner_0 + corner_1 + corner_2 + corner_3); }
};
static_assert(offsetof(AreaEntry, corner_1) == 16 && offsetof(AreaEntry, corner_2) == 32 &&
              offsetof(AreaEntry, corner_3) == 48 && offsetof(AreaEntry, color) == 64 &&
              offsetof(AreaEntry, first_shadow) == 80 && sizeof(AreaEntry) == 96);

/// A view that a shadow map is drawn from. Depth is 1 near the light and falls to 0 (of a perspective one near /
/// distance, which floats hold as well at any distance).
struct ShadowEntry {
  mat4 from_world{1.0f};  ///< the third row gives depth times the fourth
  float texel = 0.0f;     ///< metres; of a perspective one at distance 1
  int is_perspective = 0;
  float near = 0.0f;  ///< distance of depth 1
  float far = 0.0f;   ///< of depth 0, of an orthographic one
};
static_assert(offsetof(ShadowEntry, texel) == 64 && sizeof(ShadowEntry) == 80);

struct LightsBlock {
  std::array<LightEntry, kMostLights> lights{};
  std::array<ShadowEntry, kMostShadows> shadows{};
  std::array<AreaEntry, kMostAreas> areas{};
};
static_assert(sizeof(LightsBlock) <= 16384, "the least that OpenGL ES 3.0 promises");

/// Binding points of the blocks, the same in every program.
enum Binding : unsigned { frame_binding, material_binding, lights_binding };

}  // namespace candela::raster
