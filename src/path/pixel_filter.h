#pragma once

#include <array>

#include "path/render.h"

namespace candela::path {

/// Draws positions in a pixel with the density of a reconstruction filter, so that every sample belongs to one pixel
/// and weighs the same. Ernst et al. 2006, "Filter Importance Sampling".
class PixelFilterSampler {
 public:
  PixelFilterSampler(PixelFilter filter, float radius);

  /// Offset from the pixel's centre, in pixels.
  vec2 sample(vec2 u) const { return {sample(u.x), sample(u.y)}; }
  float radius() const { return radius_; }

 private:
  float sample(float u) const;

  static constexpr int kSize = 256;
  PixelFilter filter_;
  float radius_;
  /// Distance from the middle with the share w² of the filter's integral beyond it, for w in [0, 1]: even steps in w
  /// make the thin tails as exact as the middle.
  std::array<float, kSize + 1> inverse_{};
};

}  // namespace candela::path
