#pragma once

#include <optional>
#include <string>

#include "base/diagnostics.h"
#include "image/cube_file.h"
#include "scene/scene.h"

namespace candela {

/// Built in: "studio", "sky" or "sky:ELEVATION" (degrees of the sun above the horizon, -5 to 90, default 35), "furnace"
/// (1 everywhere), "none". Anything else is a file, or FILE:LAYER of an OpenEXR file: an equirectangular .hdr or .exr
/// (or .png/.jpg, sRGB decoded), or a cube map as read_environment_file takes it, which becomes a panorama four times
/// as wide as a face. Texels that are negative or not finite are put right; that, and what of the file could not be
/// followed, is told to `diagnostics`. Throws Error where it is no image or covers no sphere.
///
/// The sky is a clear day over a plain of albedo 0.3; its unit is 10 000 cd/m²: around noon the sky is 0.3 to 0.8 and
/// the sun, a SunDisc, gives 10 to 11 (times 10 000 lx) on a surface that faces it. Seen from the default camera the
/// sun stands to the front right. The studio makes a white matt sphere about 1 on its lit side; key lamp front left of
/// the default camera.
Environment make_environment(const std::string& name_or_path, Diagnostics* diagnostics = nullptr);

/// Whether a name means one of the built-in environments, and no file.
bool is_built_in_environment(const std::string& name);

/// A panorama of the same energy, with four texels around for each of a face. Throws Error(…, where) where memory does
/// not suffice.
Image panorama_of_cube(const CubeFaces& faces, const std::string& where);

/// The panorama with everything in it turned about the origin.
Image turned_panorama(const Image& map, const quat& world_from_map);

/// Throws Error(…, where) unless `image` is about twice as wide as high, as an equirectangular environment is.
void check_panorama(const Image& image, const std::string& where);

/// Radiance from direction `d` (unit, world space), suns included when `d` is inside their disc. The renderers'
/// reference.
vec3 environment_radiance(const Environment& environment, vec3 d);

}  // namespace candela
