#pragma once

#include "math/types.h"

namespace candela {

/// Orthonormal right-handed frame with n as its +z.
struct Frame {
  vec3 t{1, 0, 0};
  vec3 b{0, 1, 0};
  vec3 n{0, 0, 1};

  vec3 to_local(vec3 v) const { return {glm::dot(v, t), glm::dot(v, b), glm::dot(v, n)}; }
  vec3 to_world(vec3 v) const { return t * v.x + b * v.y + n * v.z; }
};

/// Any frame around unit `n`. Duff et al. 2017, "Building an Orthonormal Basis, Revisited", listing 3.
inline Frame frame_from_normal(vec3 n) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z);
  const float b = n.x * n.y * a;
  return {{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

/// Frame around unit `n` whose t is as near to `tangent` as can be; falls back to any frame where that is undefined.
inline Frame frame_from_tangent(vec3 n, vec3 tangent) {
  const vec3 t = tangent - n * glm::dot(n, tangent);
  const float length2 = glm::dot(t, t);
  if (!(length2 > 1e-16f)) return frame_from_normal(n);
  const vec3 unit = t * glm::inversesqrt(length2);
  return {unit, glm::cross(n, unit), n};
}

}  // namespace candela
