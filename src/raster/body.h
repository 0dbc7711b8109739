#pragma once

#include <optional>

#include "scene/scene.h"

namespace candela::raster {

/// Whether light that enters through the material goes on in a body.
bool bounds_a_body(const Material& material);

struct Body {
  int material = -1;
  Box3 bounds;  ///< of all that closes it
};

/// The body that a point is in, the smallest of several. A body may have faces of other materials, and of several
/// nodes: what counts is how much of all directions they close (Jacobson, Kavan & Sorkine-Hornung 2013, "Robust
/// Inside-Outside Segmentation using Generalized Winding Numbers").
std::optional<Body> body_around(const Scene& scene, vec3 point);

}  // namespace candela::raster
