#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "image/image.h"

/// Textures made by code. All tile, and none depends on anything but its arguments.
namespace candela::content {

using TexturePointer = std::shared_ptr<const TextureImage>;

/// Smooth noise in about [-1, 1] that repeats after `period` lattice cells. Perlin 2002 "Improving Noise".
float tiling_noise(vec2 p, ivec2 period, std::uint32_t seed);
/// Octaves of it, each of half the size and `gain` of the strength.
float tiling_fractal(vec2 p, ivec2 period, int octaves, float gain, std::uint32_t seed);

/// Distances to the nearest and second nearest of the points scattered one per cell. Worley 1996 "A Cellular Texture
/// Basis Function". `cell` names the nearest.
struct Cells {
  float nearest = 0.0f;
  float second = 0.0f;
  std::uint32_t cell = 0;
};
Cells tiling_cells(vec2 p, ivec2 period, std::uint32_t seed);
/// Squared distance to the nearest such point, with the creases between cells rounded; larger `sharpness` rounds less.
float tiling_dents(vec2 p, ivec2 period, float sharpness, std::uint32_t seed);

/// 8 bits, RGB encoded as sRGB from linear colour, alpha opaque.
TexturePointer color_texture(int size, const std::function<vec3(vec2 uv)>& color);
/// The same with alpha.
TexturePointer cutout_texture(int size, const std::function<vec4(vec2 uv)>& color);
/// 8 bits for the metallic-roughness slot: G roughness, B metallic.
TexturePointer roughness_texture(int size, const std::function<vec2(vec2 uv)>& roughness_metallic);
/// 16 bits grey for the height slot, 0 black to 1 white.
TexturePointer height_texture(int size, const std::function<float(vec2 uv)>& height);
/// 16 bits tangent-space normals of a height field; `height` is in units of the texture's width.
TexturePointer normal_texture(int size, const std::function<float(vec2 uv)>& height);

/// Linear colour of "#rrggbb".
vec3 srgb(std::uint32_t hex);

}  // namespace candela::content
