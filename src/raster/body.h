#pragma once

#include "scene/scene.h"

namespace candela::raster {

/// Whether light that enters through the material goes on in a body.
bool bounds_a_body(const Material& material);

/// The material of the body that a point is in, the smallest of several; -1: it is in none. A body may have faces of
/// other materials, and of several nodes: what counts is how much of all directions they close (Jacobson, Kavan &
/// Sorkine-Hornung 2013, "Robust Inside-Outside Segmentation using Generalized Winding Numbers").
int body_around(const Scene& scene, vec3 point);

}  // namespace candela::raster
