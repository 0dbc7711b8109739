#pragma once

#include <optional>

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

  /// The other way round: a pinhole's picture of points, in double precision.
  struct Pinhole {
    dvec3 eye;
    glm::dmat3 camera_from_world;  ///< of directions; it looks along -z
    dvec2 film_size;               ///< pixels
    dvec2 half_extent;             ///< of the film at distance 1

    dvec3 from_world(vec3 p) const { return camera_from_world * (dvec3(p) - eye); }
    /// Pixels from the top left corner. `p` is in front of the eye.
    dvec2 film(dvec3 p) const {
      const dvec2 ndc = dvec2(p) / (-p.z * half_extent);
      return 0.5 * film_size * dvec2(1.0 + ndc.x, 1.0 - ndc.y);
    }
  };
  /// None for orthographic cameras, lenses, and axes that lie in a plane.
  std::optional<Pinhole> pinhole() const;

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
