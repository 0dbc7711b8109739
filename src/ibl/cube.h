#pragma once

#include <vector>

#include "ibl/source.h"
#include "image/cube_layout.h"
#include "image/cube_panorama.h"
#include "image/cubemap.h"

namespace candela::ibl {

/// Unit direction of the texel's middle.
dvec3 cube_texel_direction(int face, int x, int y, int size);
/// Those of all texels: by face, row, column.
std::vector<dvec3> cube_directions(int size);
/// Faces of values in that order.
CubeFaces cube_from_values(const std::vector<dvec3>& values, int size);

/// Area-exact: each texel gets the mean radiance over its solid angle, by integrals along its edges (Jones 1999,
/// "First- and Second-Order Conservative Remapping Schemes"), so that the energy is the panorama's up to rounding and a
/// constant stays that constant. Discs are added to the texels they cover.
CubeFaces cube_from_source(const Source& source, int size);

using candela::equirect_from_cube;  // the same the other way

/// Halves `faces` down to 1 × 1, weighted by solid angle; sizes must be even until they are 1. Level 0 is `faces`.
Cubemap cube_mips(CubeFaces faces);

/// ∫ radiance dω per channel.
dvec3 total_flux(const CubeFaces& faces);

/// Bilinear between texel middles, across edges too; at a corner the fourth texel is the mean of the three that there
/// are. What a GPU with seamless cube maps does (OpenGL 4.6 core profile, 8.14).
vec3 cube_lookup(const CubeFaces& faces, dvec3 direction);

/// The texel beside (x, y), of which at most one coordinate may be off the face by one, on the face where it lies.
struct CubeTexel {
  int face = 0;
  int x = 0;
  int y = 0;
};
CubeTexel cube_neighbour(int face, int x, int y, int size);

}  // namespace candela::ibl
