#pragma once

#include <cstdint>
#include <vector>

#include "image/cubemap.h"

// How far two cube maps are apart, and how bright one is. Texels count by their solid angle; sums are double.
namespace candela {

/// Of one level, as luminance.
struct CubeLevelLight {
  int size = 0;
  double least = 0.0;
  double most = 0.0;
  double mean = 0.0;             ///< over the sphere
  std::uint64_t non_finite = 0;  ///< texels that are left out of the above
};
CubeLevelLight measure_light(const CubeFaces& level);

/// Differences of one level. Relative means: over the larger of the two values and a thousandth of the reference's
/// mean, channel by channel, so that black beside black is no difference and noise in the dark is no disaster.
struct CubeLevelDifference {
  int size = 0;
  double max_relative = 0.0;
  double rms_relative = 0.0;
  double mean_relative = 0.0;  ///< of the signs too: what is brighter and what is darker cancels
  double max_absolute = 0.0;
  int face = 0, x = 0, y = 0;    ///< where the largest relative difference is
  std::uint64_t non_finite = 0;  ///< texels that are not finite in either and are left out
};

/// Level by level, `reference` against `other`. Throws Error where sizes or the numbers of levels differ.
std::vector<CubeLevelDifference> diff_cubemaps(const Cubemap& other, const Cubemap& reference);

}  // namespace candela
