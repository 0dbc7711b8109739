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
  float clearance = 0.0f;  ///< see surface_clearance
  vec3 geometric_normal;
  vec3 smooth_normal;  ///< of the vertices, interpolated
  Frame frame;         ///< around the shading normal
  vec3 wo;             ///< local, wo.z > 0
  shade::Surface surface;
  vec3 emission{0.0f};  ///< towards wo
  bool is_back = false;
  bool is_unlit = false;  ///< emits its base colour and reflects nothing
  const MaterialData* material = nullptr;

  /// Origin of a ray into `direction` that does not meet its own surface again.
  vec3 ray_origin(vec3 direction) const;
  /// Whether `direction` leaves on the outside of the smooth surface: were it the facet, those that look away from a
  /// lamp would be black triangles among lit ones.
  bool is_outside(vec3 direction) const { return glm::dot(smooth_normal, direction) > 0.0f; }
};

/// Fetches textures and prepares the closure at a hit of a ray with `direction`. `eta` is the index on the far side
/// over that on the near side, of materials with a medium.
SurfacePoint make_surface_point(const Geometry& geometry, const Hit& hit, vec3 direction, float eta = 1.0f);
/// The same, with what the closure was prepared from; of a surface without layers only what the base reads, of an unlit
/// one nothing.
SurfacePoint make_surface_point(const Geometry& geometry, const Hit& hit, vec3 direction, float eta,
                                shade::SurfaceParams& params);

/// Whether a ray with `direction` meets the back of the facet.
bool is_back_hit(const Geometry& geometry, const Hit& hit, vec3 direction);

/// Whether a hit shows the back of a single-sided material, which the camera looks through (glTF 2.0 §3.9.6). The
/// boundary of a body has no back: doubleSided does not count there (KHR_materials_volume).
bool is_culled_back(const Geometry& geometry, const Hit& hit, vec3 direction);

/// Emission of a material at a point of a triangle, before any question of sides. cd/m².
vec3 emission_at(const MeshData& mesh, const uvec3& triangle, vec3 barycentric);

/// Unit; 0 where the facet has no area.
vec3 facet_normal(const TrianglePositions& p);

/// How far along its unit normal `n` a ray must start from a triangle so that no rounding puts it on the other side: a
/// bound of the error of a point computed from the corners, and of Embree's own. Pharr, Jakob & Humphreys 2016,
/// "Physically Based Rendering", 3rd ed., §3.9.5, with one factor for all operations. Grows with the coordinates of the
/// corners, not of the point: large triangles near the origin are the ones that go wrong.
float surface_clearance(const Placement& placement, const TrianglePositions& p, vec3 n);

/// Whether two hits of one ray near the same place are of one surface: the same triangle, or neighbours that meet at an
/// edge or corner there and face the ray alike.
bool is_one_surface(const Geometry& geometry, const Hit& a, const Hit& b, vec3 direction);

/// Whether two hits are of triangles in one plane, as far as single precision can tell.
bool are_in_one_plane(const Geometry& geometry, const Hit& a, const Hit& b);

/// How much longer the way along a ray to a hit is from `start` than from the ray's origin beside it: what lies between
/// the two does not shorten the way through a medium.
float distance_passed(const Geometry& geometry, const Hit& hit, vec3 start, const Ray& ray);

/// How far a hit is from `start` into `direction`, along which no ray has found it.
float distance_to(const Geometry& geometry, const Hit& hit, vec3 start, vec3 direction);

/// The place of a hit.
vec3 position_of(const Geometry& geometry, const Hit& hit);

/// Where a ray starts that leaves a surface to the side that `direction` looks to.
vec3 origin_beyond(const Geometry& geometry, const Hit& hit, vec3 direction);

}  // namespace candela::path
