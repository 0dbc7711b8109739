#pragma once

#include <span>
#include <vector>

#include "math/types.h"

namespace candela::io {

/// Tangent frames as MikkTSpace makes them (Mikkelsen 2008, "Simulation of Wrinkled Surfaces Revisited", §3.3 and the
/// grouping rules of its reference implementation), which is what glTF 2.0 §3.7.2.1 prescribes and normal maps are
/// baked against: independent of index and triangle order, mirrored regions kept apart, corners weighted by their
/// angle.
///
/// Differences: groups are not split further by an angular threshold (the reference's default of 180° never does, up to
/// exactly opposite tangents), and a corner that no triangle with a uv area reaches gets a frame from its normal alone.
struct TangentFrames {
  /// One per corner, three per triangle: xyz unit and perpendicular to the corner's normal, w = ±1 so that
  /// bitangent = cross(normal, xyz) · w points to where the texture's image goes up (-v).
  std::vector<vec4> corners;
  /// Per corner: equal numbers at the same vertex share a tangent; a vertex with several has to be split.
  std::vector<std::uint32_t> groups;
};

/// All spans per vertex, of the same length; `normals` are unit, `triangles` index them and have some area.
TangentFrames make_tangents(std::span<const vec3> positions, std::span<const vec3> normals, std::span<const vec2> uvs,
                            std::span<const uvec3> triangles);

/// Any unit vector perpendicular to `normal`.
vec3 any_perpendicular(vec3 normal);

}  // namespace candela::io
