#pragma once

#include <array>

#include "path/geometry.h"

namespace candela::path {

/// Surfaces at one place: those that a path meets so near behind each other that a ray, which starts off the surface it
/// leaves (surface_clearance), would step over them. A sheet on a floor, a label on glass, touching bodies. The path
/// goes from one to the next by their order along the ray that came here, and never loses one.
class Place {
 public:
  Place() {}  // NOLINT(modernize-use-equals-default): hits_ is left as it is, for the sake of paths that need none

  /// Whether a path that leaves the surface, through it or back, has no other to ask for here.
  bool is_simple(bool is_through) const { return count_ == 0 && !is_through; }

  /// From the surface `hit`, that `ray` has met, through it or back. True with the next surface at this place in `hit`;
  /// false when there is none, and a ray has to find it.
  bool step(const Geometry& geometry, const Ray& ray, Hit& hit, bool is_through);

  /// The path has turned before it came to the next surface here.
  void leave() { count_ = 0; }

  /// When the path leaves a body by `hit` and enters another at the same place, the entry comes first: bodies that
  /// touch have no air between them.
  void enter_before_leaving(const Geometry& geometry, const Ray& ray, Hit& hit);

  /// What the other surfaces at this place leave of light from `direction`, through `hit` or not. `origin` is moved to
  /// where a ray to the light begins beyond them.
  vec3 transmittance(const Geometry& geometry, const Ray& ray, const Hit& hit, bool is_through, vec3 direction,
                     vec3& origin);

 private:
  static constexpr int kMost = 16;

  void begin(const Ray& ray, const Hit& hit);
  /// Index of the neighbour in the sense of travel, or -1.
  int neighbour(const Geometry& geometry, int sense);
  bool extend(const Geometry& geometry);

  int count_ = 0;  ///< 0 = only the surface that the ray met
  int index_ = 0;
  int sense_ = 1;  ///< 1 on the way that the ray came, -1 back
  union {
    Ray arrival_;  // NOLINT(readability-identifier-naming): private, but not to a tool that sees the union alone
  };
  union {
    std::array<Hit, kMost> hits_;  ///< the first count_ hold something  NOLINT(readability-identifier-naming)
  };
};

}  // namespace candela::path
