#pragma once

#include "scene/scene.h"

namespace candela {

/// What a ground is to the light that meets it: matte and single-sided.
Material ground_material(const Ground& ground);

/// The plane of a ground in world space, as rings around the subject: small triangles near it, where single precision
/// counts; the last ends a thousand of its sizes away.
Primitive ground_primitive(const Ground& ground, const Box3& subject);

}  // namespace candela
