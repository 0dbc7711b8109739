#pragma once

#include "image/cubemap.h"
#include "image/image.h"

// A cube of light as a panorama, and OpenEXR's own environments as ours.
namespace candela {

/// A panorama of `width` × width / 2 texels (docs/conventions.md). Area-exact: each texel gets the mean radiance over
/// its solid angle, by integrals along the edges of the cube's texels (Jones 1999, "First- and Second-Order
/// Conservative Remapping Schemes"), so that the energy is the cube's up to rounding and a constant stays that
/// constant.
Image equirect_from_cube(const CubeFaces& faces, int width);

// OpenEXR (ImfEnvmap.h) has the middles of the outermost pixels on the edge of a face, and on the poles and the
// meridian where a panorama is cut; radiance between is along straight lines. Ours is constant over texels of equal
// size: each gets the mean of that curve over its rectangle, so that what a bright pixel adds up to stays.

/// OpenEXR's panorama, which looks along +z in the middle and has +x to the left of it, of the same size.
Image panorama_from_openexr(const Image& latlong);

/// OpenEXR's faces, one below the other, as seen from inside: +x with +z to its right, -x, +y with +x right and +z up,
/// -y, +z with -x right, -z. `image` is six times as high as wide. The faces keep their size.
CubeFaces cube_from_openexr(const Image& image);

}  // namespace candela
