#pragma once

#include "path/texture.h"
#include "scene/scene.h"

namespace candela::path {

/// The primitive with the relief of its material's height texture as geometry: every triangle divided as finely as the
/// texture has texels along its longest side, as far as two million triangles go, and moved along the normals of the
/// vertices. Without a normal map the normals follow the relief; with one, the map tells of it already.
Primitive displaced(const Primitive& primitive, const Material& material, const TextureReader& height);

/// How many parts each side of a triangle was divided into, by the numbers of triangles before and after.
int divisions_of(std::size_t before, std::size_t after);

/// A place of a primitive: weights are those of the triangle's second and third corner.
struct UndividedPlace {
  std::uint32_t triangle = 0;
  vec2 barycentric{0.0f};
};
/// Where a place of the divided primitive was before.
UndividedPlace undivided(const UndividedPlace& divided, int divisions);

}  // namespace candela::path
