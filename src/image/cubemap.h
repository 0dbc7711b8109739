#pragma once

#include <array>
#include <utility>
#include <vector>

#include "image/image.h"

namespace candela {

/// Six square faces in the order +x -x +y -y +z -z, of linear Rec.709 radiance (3 channels), addressed as OpenGL, KTX
/// and `shade/cube.glsl.h` do: row 0 of a face is t = -1, column 0 is s = -1.
using CubeFaces = std::array<Image, 6>;

/// A cube and its smaller levels; level 0 is the largest. Whether a level halves the one before or is filtered for a
/// roughness is its maker's word.
struct Cubemap {
  std::vector<CubeFaces> levels;

  bool empty() const { return levels.empty(); }
  int size(std::size_t level = 0) const { return levels[level][0].width; }
};

inline Cubemap cube_of_one_level(CubeFaces faces) {
  Cubemap cube;
  cube.levels.push_back(std::move(faces));
  return cube;
}

/// Black faces of `size` by `size` texels.
inline CubeFaces make_cube_faces(int size) {
  CubeFaces faces;
  faces.fill(Image(size, size, 3));
  return faces;
}

}  // namespace candela
