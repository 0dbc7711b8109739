#pragma once

#include <array>

#include "math/types.h"

namespace candela {

/// Corner `i` of 0 … 7: its bits choose the upper side along x, y and z.
inline vec3 corner(const Box3& box, std::size_t i) {
  return {(i & 1) != 0 ? box.upper.x : box.lower.x, (i & 2) != 0 ? box.upper.y : box.lower.y,
          (i & 4) != 0 ? box.upper.z : box.lower.z};
}

inline std::array<vec3, 8> corners(const Box3& box) {
  std::array<vec3, 8> all;
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = corner(box, i);
  return all;
}

}  // namespace candela
