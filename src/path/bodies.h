#pragma once

#include "path/geometry.h"

namespace candela::path {

/// Finds what bounds what, and sets Placement::body. The faces that a node has of one material are a body if each of
/// their edges has a face on either side, and where some have not, they are one body with all whose edges complete
/// them: other materials, primitives, nodes. Edges meet when their ends are nearer than 10⁻⁵ of the smaller part's
/// longest side. A body with edges left over is open. A closed body whose faces all look inwards is the wall of a
/// hollow: it is of the smallest body around it. Returns the bodies, after one that stands for none.
std::vector<Body> find_bodies(std::vector<Placement>& placements);

/// The bodies that `point` is in, outermost first: those that rays from it leave more often than they enter, in most of
/// a few directions.
MediumStack bodies_around(const Geometry& geometry, vec3 point);

/// Whether a point of `region` may be in some body.
bool may_be_inside(const Geometry& geometry, const Box3& region);

}  // namespace candela::path
