#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.h"

namespace candela::raster {

/// Triangles of a primitive that glow and hang together.
struct GlowingPart {
  std::vector<std::uint32_t> triangles;
  vec3 emission{0.0f};  ///< mean radiance of what is there of them
  float share = 1.0f;   ///< of their area that is there: masks cut out, veils let through
};

/// The lamps of a primitive: its triangles that glow at least a hundredth as much as its brightest, parted where they
/// share no corner (corners at one place are one), and where what hangs together is long, bent or full of holes.
/// Textures, their transforms, sets of coordinates and wrapping count, and so does alpha. None where nothing glows.
std::vector<GlowingPart> glowing_parts(const Scene& scene, const Primitive& primitive, const Material& material);

}  // namespace candela::raster
