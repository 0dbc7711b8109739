#pragma once

#include "math/frame.h"
#include "path/geometry.h"
#include "scene/view.h"

namespace candela::path {

/// Turns film positions into rays. A thin lens: Kolb et al. 1995, "A Realistic Camera Model", §3.1.
class Camera {
 public:
  Camera(const View& view, int width, int height);

  bool has_lens() const { return lens_.radius > 0.0f; }

  /// Where rays start.
  Box3 origins() const;

  struct Sample {
    Ray ray;              ///< from the near plane to the far one
    float start = 0.0f;   ///< how far its origin is from the lens, along it
    float weight = 1.0f;  ///< vignetting
  };
  /// `film` in pixels from the top left corner, `u` in [0,1)² on the aperture.
  Sample generate(vec2 film, vec2 u) const;

 private:
  Frame axes_;  ///< right, up and backwards in world space, scale included
  vec3 eye_;
  Lens lens_;
  vec2 film_size_;
  vec2 half_extent_;  ///< of the film at distance 1, or in metres when orthographic
  bool is_orthographic_ = false;
  float near_, far_;  ///< planes, in units of axes_
  bool is_clipped_;
};

}  // namespace candela::path
