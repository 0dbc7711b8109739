#pragma once

#include <filesystem>
#include <string>

#include "scene/scene.h"

namespace candela {

/// Built in: "studio", "sky" or "sky:ELEVATION" (degrees of the sun above the horizon, default 35), "furnace" (1 everywhere),
/// "none". Anything else is a file: equirectangular .hdr or .exr (or .png/.jpg, sRGB decoded). Throws Error where it is
/// no image, has a non-finite or negative pixel, or is not about twice as wide as high.
Environment make_environment(const std::string& name_or_path);

/// Radiance from direction `d` (unit, world space), suns included when `d` is inside their disc. The renderers' reference.
vec3 environment_radiance(const Environment& environment, vec3 d);

}  // namespace candela
