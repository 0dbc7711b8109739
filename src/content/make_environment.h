#pragma once

#include <span>
#include <string>

#include "base/diagnostics.h"
#include "scene/environment.h"

namespace candela {

/// Built in: "studio", "studio:dark", "studio:three-point", "sky" or "sky:ELEVATION" (degrees of the sun above the
/// horizon, -5 to 90, default 35), "furnace" (1 everywhere), "none". Anything else is a file, or FILE:LAYER of an
/// OpenEXR file: an equirectangular .hdr or .exr (or .png/.jpg, sRGB decoded), or a cube map as read_environment_file
/// takes it, which becomes a panorama four times as wide as a face. Texels that are negative or not finite are put
/// right; that, and what of the file could not be followed, is told to `diagnostics`. Throws Error where it is no image
/// or covers no sphere.
///
/// The sky is a clear day over a plain of albedo 0.3; its unit is 10 000 cd/m²: around noon the sky is 0.3 to 0.8 and
/// the sun, a SunDisc, gives 10 to 11 (times 10 000 lx) on a surface that faces it. Seen from the default camera the
/// sun stands to the front right. The studio makes a white matt sphere about 1 on its lit side; key lamp front left of
/// the default camera.
Environment make_environment(const std::string& name_or_path, Diagnostics* diagnostics = nullptr);

/// What they are called, for people: "studio", "sky:DEG"…
std::span<const std::string> built_in_environments();

/// Throws Error, listing what is built in, where a name is neither built in nor that of a file: a word was mistyped.
void check_environment_name(const std::string& name);

/// Whether a name means one of the built-in environments, and no file.
bool is_built_in_environment(const std::string& name);

}  // namespace candela
