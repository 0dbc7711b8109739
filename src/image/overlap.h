#pragma once

#include <functional>

#include "math/types.h"

// Where the texels of a cube and of a panorama meet on the sphere.
namespace candela::overlap {

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

/// Cosine of the polar angle (y) at the upper edge of row `row`, 0 to height.
double row_edge(int row, int height);
/// Solid angle of every texel of a row of a panorama.
double texel_solid_angle(int row, int width, int height);

/// A face in double precision: direction = centre + s · right + t · down.
struct FaceAxes {
  dvec3 centre, right, down;

  explicit FaceAxes(int face);
  dvec3 at(double s, double t) const { return centre + s * right + t * down; }
};

/// An edge of the grid of a face: right of vertex (x, y), or down from it.
struct Edge {
  int x = 0;
  int y = 0;
  bool down = false;
};

/// Both ends of an edge.
struct Ends {
  dvec3 a, b;
};
Ends edge_ends(const FaceAxes& axes, const Edge& e, int size);

/// Calls f(edge) for the edges of grid row `y` of a face, those to the right and then those down.
template <class F>
void edges_of_row(int y, int size, const F& f) {
  for (int x = 0; x < size; ++x) f(Edge{x, y, false});
  if (y == size) return;
  for (int x = 0; x <= size; ++x) f(Edge{x, y, true});
}

}  // namespace candela::overlap
