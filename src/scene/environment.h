#pragma once

#include <string>
#include <vector>

#include "image/cube_file.h"
#include "scene/scene.h"

namespace candela {

/// A panorama of the same energy, with four texels around for each of a face. Throws Error(…, where) where memory does
/// not suffice.
Image panorama_of_cube(const CubeFaces& faces, const std::string& where);

/// Direction that the point (x, y) of a panorama is seen in, pixels from its upper left corner.
vec3 map_direction(float x, float y, int width, int height);
/// Solid angle of one texel of a row, sr.
float map_solid_angle(int row, int width, int height);

/// The panorama with everything in it turned about the origin.
Image turned_panorama(const Image& map, const quat& world_from_map);

/// Throws Error(…, where) unless `image` is about twice as wide as high, as an equirectangular environment is.
void check_panorama(const Image& image, const std::string& where);

/// Irradiance of an upward surface that nothing is above, suns included.
vec3 irradiance_from_above(const Environment& environment);

/// Its suns as the world sees them: turned by the rotation, times the intensity.
std::vector<SunDisc> world_suns(const Environment& environment);

/// Radiance from direction `d` (unit, world space), suns included when `d` is inside their disc. The renderers'
/// reference.
vec3 environment_radiance(const Environment& environment, vec3 d);

}  // namespace candela
