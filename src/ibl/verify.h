#pragma once

#include <cstdint>
#include <vector>

#include "ibl/kernel.h"
#include "ibl/source.h"
#include "image/cubemap.h"

namespace candela::ibl {

/// The integral of radiance × lobe by brute force: every texel of the panorama, by 2 × 2 Gauss points where the lobe is
/// less than 32 texels wide and by its middle otherwise, and every disc; double precision, no tree, no harmonics.
std::vector<dvec3> reference(const Source& source, const Kernel& kernel, const std::vector<dvec3>& directions);

/// Errors relative to the reference at the same direction: length of the difference over length of the reference, as
/// RGB vectors.
struct ErrorBound {
  double max = 0.0;
  double rms = 0.0;
  int directions = 0;
  dvec3 worst{0.0, 1.0, 0.0};  ///< where the maximum is
  /// With this confidence at most the share `exceeding` of all directions errs by more than `max`: of n directions
  /// drawn at random, (1 - exceeding)^n = 1 - confidence.
  double confidence = 0.95;
  double exceeding = 1.0;
};
ErrorBound compare(const std::vector<dvec3>& values, const std::vector<dvec3>& references,
                   const std::vector<dvec3>& directions);

/// `count` directions, uniform over the sphere.
std::vector<dvec3> random_directions(int count, std::uint32_t seed);

struct LevelProof {
  ErrorBound at_texels;  ///< stored values against the reference at the middles of randomly chosen texels
  ErrorBound between;    ///< bilinear lookups at random directions: what the texels' spacing adds
};
/// `scale` is what stored values were multiplied by (π for irradiance).
LevelProof verify_level(const Source& source, const Kernel& kernel, const CubeFaces& faces, int directions,
                        std::uint32_t seed, double scale = 1.0);

}  // namespace candela::ibl
