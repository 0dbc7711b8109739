#pragma once

#include <cstdint>
#include <vector>

#include "ibl/kernel.h"
#include "ibl/source.h"
#include "image/cubemap.h"

namespace candela::ibl {

/// Radiance of the texel or disc that a direction meets: nothing is interpolated.
dvec3 radiance_at(const Source& source, dvec3 direction);

/// Importance sampling of the lobe without its N·L, which is a weight (Karis 2013): the same Hammersley points turned
/// by a random angle per output. Noise falls with the root of `samples`, and small suns are found by luck.
class MonteCarloFilter {
 public:
  MonteCarloFilter(const Source& source, int samples, std::uint32_t seed)
      : source_(source), samples_(samples), seed_(seed) {}
  /// `index` numbers the output, so that each has its own turn.
  dvec3 sum(const Kernel& kernel, dvec3 direction, std::uint32_t index) const;

 private:
  const Source& source_;
  int samples_;
  std::uint32_t seed_;
};

/// Filtered importance sampling: every sample reads a mip whose texels have the solid angle that the sample stands for,
/// and one level coarser (Křivánek & Colbert 2008, "Real-time Shading with Filtered Importance Sampling"; Colbert &
/// Křivánek 2007, "GPU-Based Importance Sampling", GPU Gems 3, chapter 20). Differs from the common tools by mips that
/// are weighted by solid angle, which is in its favour.
class FilteredFilter {
 public:
  FilteredFilter(const Source& source, int size, int samples);
  dvec3 sum(const Kernel& kernel, dvec3 direction) const;

 private:
  dvec3 lookup(dvec3 direction, double lod) const;

  Cubemap cube_;
  int samples_;
};

/// The polar Riemann sum of irradiance / π: steps of azimuth × polar angle over the hemisphere, each with cos θ sin θ.
dvec3 riemann_sum(const Source& source, dvec3 direction, int around, int up);

}  // namespace candela::ibl
