#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "scene/scene.h"

namespace candela::check {

/// What rays find that start just inside of a body.
struct BodyRays {
  std::uint32_t count = 0;
  std::uint32_t lost = 0;        ///< met nothing of the body's place, or its front: they never learn that they left
  bool is_open = false;          ///< some edge has no face of the body on its other side, of whatever material or node
  std::vector<float> thickness;  ///< straight in along the normal to the far side, metres
  std::vector<float> authored;   ///< thicknessFactor × thicknessTexture × scale at the same points, metres
};

/// Casts rays from points spread by area over the bodies of each of `materials`, through the path tracer's own
/// geometry; nothing in a build without it.
std::optional<std::vector<BodyRays>> cast_into_bodies(const Scene& scene, const std::vector<int>& materials);

}  // namespace candela::check
