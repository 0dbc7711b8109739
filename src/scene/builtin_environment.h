#pragma once

#include "scene/environment.h"

namespace candela::detail {

/// Clear sky with the sun `elevation_deg` above the horizon, in [-5, 90]; see make_environment.
Environment make_sky(float elevation_deg);

/// Softboxes in a light grey room; see make_environment.
Environment make_studio();

/// Direction that a map pixel's centre is seen in, and its solid angle.
vec3 map_direction(float x, float y, int width, int height);
float map_solid_angle(int row, int width, int height);

}  // namespace candela::detail
