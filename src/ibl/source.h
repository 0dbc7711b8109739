#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "image/cubemap.h"
#include "image/image.h"
#include "image/overlap.h"
#include "math/types.h"
#include "scene/scene.h"

namespace candela::ibl {

/// Light from one direction: radiance × solid angle, that is, the irradiance of a surface that faces it.
struct Point {
  dvec3 direction{0.0, 1.0, 0.0};  ///< towards it, unit
  dvec3 flux{0.0};
};

/// Light from infinitely far away as everything in this folder takes it: a panorama whose texels are constant over the
/// rectangle of azimuth and height that they cover, and discs. `map` has 3 channels, all finite and not negative, laid
/// out as Environment's; column 0 begins at azimuth -π - rotation. The discs' directions are in the world already.
struct Source {
  Image map;
  double rotation = 0.0;  ///< about +y, counter-clockwise seen from above
  std::vector<SunDisc> suns;
};

/// `environment` with its constant and intensity multiplied in. One without a map becomes a small one. Throws Error
/// where there is no light at all.
Source make_source(const Environment& environment);

/// A panorama four times as wide as a face, of the same energy.
Source make_source(const CubeFaces& faces);

/// Exact: ∫ radiance dω per channel over map and discs.
dvec3 total_flux(const Source& source);

// ----- the geometry of a panorama's texels

using overlap::row_edge;
using overlap::texel_solid_angle;
/// Azimuth atan2(z, x) of the left edge of column `column`, 0 to width.
double column_edge(const Source& source, int column);
/// Middle in azimuth and polar angle.
dvec3 texel_direction(const Source& source, int column, int row);

/// `map` with each texel repeated until rows are at most `step` radians high.
Image subdivided(const Image& map, double step);

/// A texel's `flux` as `side` × `side` points: its middle, or Gauss's points of each of its two angles.
std::vector<Point> texel_points(const Source& source, int column, int row, dvec3 flux, int side);

/// A disc as a few points with its flux and moments to the fifth degree (7 points in the plane).
std::vector<Point> disc_points(const SunDisc& sun);
double disc_solid_angle(const SunDisc& sun);

}  // namespace candela::ibl
