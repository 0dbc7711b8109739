#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "math/types.h"

namespace candela {

/// The surface that the eye sees at a place of a picture, by indices of the Scene.
struct SurfaceSample {
  int node = -1;      ///< -1 = there is none
  int primitive = 0;  ///< of the node's mesh
  std::uint32_t triangle = 0;
  vec2 barycentric{0.0f};  ///< weights of the triangle's second and third corner
  vec3 position{0.0f};     ///< world space, metres; of a surface with relief, on that
  vec2 uv{0.0f};           ///< first texture coordinates; 0 where the mesh has none
};

/// What is at the centre of every pixel, row 0 at the top: the first surface of opacity ½ or more that the eye sees,
/// without lens and filter. Both engines make one, and all layers that have no mean are read from it.
struct SurfaceMap {
  int width = 0;
  int height = 0;
  std::vector<SurfaceSample> pixels;

  SurfaceMap() = default;
  SurfaceMap(int w, int h) : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  SurfaceSample& at(int x, int y) { return pixels[index(x, y)]; }
  const SurfaceSample& at(int x, int y) const { return pixels[index(x, y)]; }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

}  // namespace candela
