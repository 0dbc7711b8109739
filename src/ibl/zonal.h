#pragma once

#include <vector>

#include "ibl/harmonics.h"
#include "ibl/kernel.h"
#include "ibl/source.h"

namespace candela::ibl {

/// Points in blocks that are summed together, for kernels that are asked for one direction after another.
class PointSum {
 public:
  void add(const Point& point);
  bool empty() const { return count_ == 0; }
  /// Σ flux K(direction).
  dvec3 sum(const Kernel& kernel, dvec3 direction) const;

 private:
  static constexpr std::size_t kLanes = 4;
  using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));
  struct Block {
    Lanes x{}, y{}, z{};
    Lanes flux[3] = {};
  };
  std::vector<Block> blocks_;
  std::size_t count_ = 0;
};

/// A source split in two: at most `most` texels whose light stands out, which are summed one by one, and what is left,
/// of which no texel has more flux than the faintest of those.
struct BrightSplit {
  Image rest;
  std::vector<ivec2> texels;
  std::vector<dvec3> flux;  ///< what each of them has beyond what is left in `rest`
};
BrightSplit split_bright(const Source& source, int most);

/// Light and lobe as spherical harmonics: convolution multiplies each degree by the lobe's coefficient (Driscoll &
/// Healy 1994, "Computing Fourier Transforms and Convolutions on the 2-Sphere", theorem 1). What a series cannot hold,
/// the brightest texels under the kink at the lobe's horizon, is summed texel by texel.
class ZonalFilter {
 public:
  /// Harmonics up to `lmax`.
  ZonalFilter(const Source& source, int lmax, int exact_texels);

  int lmax() const { return harmonics_.lmax(); }
  std::vector<dvec3> at(const Kernel& kernel, int lmax, const std::vector<dvec3>& directions) const;

 private:
  const PointSum& points_for(const Kernel& kernel) const;

  ZonalFilter(const Source& source, const BrightSplit& split, int lmax);

  Harmonics harmonics_;
  double texel_ = 0.0;  ///< size of a texel at the equator, radians
  PointSum middles_;    ///< of the bright texels and the discs
  PointSum quarters_;   ///< four per texel, for lobes hardly wider than one
};

}  // namespace candela::ibl
