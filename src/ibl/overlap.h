#pragma once

#include <functional>

#include "math/types.h"

namespace candela::ibl {

/// The lattice of a panorama on the sphere: columns of equal azimuth from `azimuth`, rows of equal polar angle.
struct Lattice {
  int width = 0;
  int height = 0;
  double azimuth = 0.0;  ///< atan2(z, x) of column 0's left edge
};

/// A piece of an arc that lies in one cell: `turn` = ∫ dφ (signed), `area` = ∫ y dφ along it.
struct Piece {
  int column = 0;
  int row = 0;
  double turn = 0.0;
  double area = 0.0;
};

/// Calls `visit` for every piece of the great circle's arc from `a` to `b` (unit, less than half a turn apart). Arcs
/// along a meridian have none, because they turn nowhere.
///
/// By Green's theorem the flux through a region is the integral of C dφ along its edge, where C(φ, y) is the radiance
/// integrated over y from a pole: with these pieces it is exact for radiance that is constant in each cell.
void walk_arc(const Lattice& lattice, dvec3 a, dvec3 b, const std::function<void(const Piece&)>& visit);

}  // namespace candela::ibl
