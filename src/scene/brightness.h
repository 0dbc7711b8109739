#pragma once

#include "scene/scene.h"

namespace candela {

/// Whether the scene's own lamps, punctual ones and what glows, outshine the environment, so that an exposure made for
/// its light would show them white: on a tenth of all surface they give more than twice the light that the environment
/// gives on average. Of what does not glow no primitive, such as a ground, counts for more than the others together.
/// Estimated from points spread by area, without shadows; the same scene gives the same answer.
bool outshines(const Scene& scene, const Environment& environment);

}  // namespace candela
