#pragma once

#include "scene/scene.h"

/// Normals and tangents of a primitive: made where it has none, repaired where it has.
namespace candela::io {

/// Twice the area vector; exact enough in double that only truly flat triangles give 0.
dvec3 area_vector(const Primitive& primitive, const uvec3& t);

/// Vertices become one per corner, each with its triangle's normal (glTF 2.0 §3.7.2.1).
void make_flat(Primitive& primitive);

/// Unit normals; one without a direction becomes that of the triangles around it.
void normalize_normals(Primitive& primitive);

/// Tangents of a surface without uvs: along the circles of latitude about the mesh's y axis, as on the lathe.
void turn_tangents(Primitive& primitive);

/// MikkTSpace in the uv space that `slot`'s texture is looked up in: after KHR_texture_transform, so that a rotated or
/// mirrored texture keeps its bumps upright. Vertices where frames meet that must not be averaged are split.
void generate_tangents(const TextureSlot& slot, Primitive& primitive);

/// Unit tangents, w 1 or -1; one without a direction becomes any at right angles to the normal.
void normalize_tangents(Primitive& primitive);

}  // namespace candela::io
