#pragma once

#include <cstddef>
#include <optional>

#include "io/gltf_document.h"
#include "scene/scene.h"

namespace candela::io {

/// What the accessors of a packed primitive say of it.
struct Outline {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  Box3 box;  ///< of POSITION's min and max
};

/// The outline of a list of triangles all of which Draco or meshopt packs, without unpacking it. Empty where it is
/// something else, and where its accessors do not say what unpacking would show: POSITION without min and max, counts
/// that differ from each other or from the Draco data's own, sparse accessors. Throws Error where the packed data is
/// not there or too short for what it claims.
std::optional<Outline> outline_of(const JsonView& root, const JsonView& primitive, GltfBuffers& buffers);

/// Whether a transform keeps boxes along the axes, but for rounding.
bool is_along_axes(const mat4& m);

/// A primitive to be counted and measured: so many vertices and triangles, of which the first are that box's own.
Primitive make_stand_in(const Outline& outline);

}  // namespace candela::io
