#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "math/types.h"

namespace candela::check {

/// How the triangles of a mesh meet at their edges, once vertices at the same place are one.
struct EdgeReport {
  std::size_t edges = 0;
  std::size_t boundary = 0;      ///< of one triangle only
  std::size_t inconsistent = 0;  ///< of two triangles that run along it the same way: one looks in, one out
  std::size_t non_manifold = 0;  ///< of three and more that do not pair up, front to back

  /// Whether the mesh divides space into inside and outside.
  bool is_closed() const { return boundary + inconsistent + non_manifold == 0; }

  /// What hangs together by edges.
  struct Part {
    double volume = 0.0;  ///< signed, m³; positive where counter-clockwise faces look outward
    Box3 box;
    bool is_closed = true;
  };
  std::vector<Part> parts;

  /// Closed parts turned inside out that lie in no other part, as the wall of a hollow would.
  std::size_t inside_out() const;
};

/// Vertices closer than `weld_distance` (metres) are one; triangles that welding makes flat are left out.
EdgeReport inspect_edges(std::span<const vec3> positions, std::span<const uvec3> triangles, float weld_distance);

/// The distance at which rounding of exporters ends: a hundred-thousandth of the largest side.
float default_weld_distance(std::span<const vec3> positions);

}  // namespace candela::check
