#pragma once

#include "math/frame.h"
#include "path/geometry.h"
#include "shade/surface.glsl.h"

namespace candela::path {

/// A vertex of the path on a surface. Normals look to the side that `wo` is on.
struct SurfacePoint {
  vec3 position;
  vec3 lifted;  ///< where rays to the outside start, before the offset: off the facet, near the smooth surface it
                ///< stands for
  vec3 geometric_normal;
  Frame frame;  ///< around the shading normal
  vec3 wo;      ///< local, wo.z > 0
  shade::Surface surface;
  vec3 emission{0.0f};  ///< towards wo
  bool is_back = false;
  bool is_unlit = false;  ///< emits its base colour and reflects nothing

  /// Origin of a ray into `direction` that does not meet its own surface again.
  vec3 ray_origin(vec3 direction) const;
  /// Whether `direction` leaves on the outside for both the facet and the shading normal.
  bool is_outside(vec3 direction) const { return glm::dot(geometric_normal, direction) > 0.0f; }
};

/// Fetches textures and prepares the closure at a hit of a ray with `direction`.
SurfacePoint make_surface_point(const Geometry& geometry, const Hit& hit, vec3 direction);

/// Whether a hit shows the back of a single-sided material, which the camera looks through (glTF 2.0 §3.9.6).
bool is_culled_back(const Geometry& geometry, const Hit& hit, vec3 direction);

/// Emission of a material at a point of a triangle, before any question of sides. cd/m².
vec3 emission_at(const MeshData& mesh, const uvec3& triangle, vec3 barycentric);

/// `p` moved off a surface along unit `n` by a few hundred times the rounding error of its coordinates.
/// Wächter & Binder 2019, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems, ch. 6.
vec3 offset_from_surface(vec3 p, vec3 n);

}  // namespace candela::path
