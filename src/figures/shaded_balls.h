#pragma once

#include <functional>
#include <vector>

#include "image/image.h"
#include "scene/material.h"
#include "shade/surface.glsl.h"

namespace candela::figures {

/// A point of a ball, with its directions in the world.
struct BallPoint {
  std::size_t ball;
  shade::Surface surface;  ///< as seen
  vec3 wo;                 ///< in its own frame; wo.z = n·v
  vec3 normal;
  vec3 mirrored;
  vec3 to_eye;
};
using ShadePoint = std::function<vec3(const BallPoint&)>;

/// Balls as trace_balls() has them, in squares of `side` pixels beside each other, shaded point by point by a formula
/// of one's own; premultiplied RGBA.
Image shaded_balls(const std::vector<Material>& materials, int side, const ShadePoint& shade_point);

/// From the middle of a ball to what is there as the camera sees it: right, up, towards it; unit, world space.
vec3 ball_direction(vec3 seen);

}  // namespace candela::figures
