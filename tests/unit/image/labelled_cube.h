#pragma once

#include "image/cubemap.h"
#include "shade/cube.glsl.h"

namespace candela::test {

/// Direction to the middle of a texel, its largest component 1.
inline vec3 texel_direction(int face, int x, int y, int size) {
  const auto center = [&](int i) { return (2.0f * static_cast<float>(i) + 1.0f) / static_cast<float>(size) - 1.0f; };
  return shade::cube_direction(face, center(x), center(y));
}

/// Every texel holds the direction in which it lies in the world, plus 2: positive, and no two are alike.
inline CubeFaces labelled_faces(int size) {
  CubeFaces faces = make_cube_faces(size);
  for (int face = 0; face < 6; ++face)
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x)
        faces[static_cast<std::size_t>(face)].set_rgb(x, y, texel_direction(face, x, y, size) + 2.0f);
  return faces;
}

inline bool faces_are_equal(const CubeFaces& a, const CubeFaces& b) {
  for (std::size_t face = 0; face < 6; ++face)
    if (a[face].width != b[face].width || a[face].pixels != b[face].pixels) return false;
  return true;
}

}  // namespace candela::test
