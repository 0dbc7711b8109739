#pragma once

#include "scene/scene.h"
#include "scene/view.h"

namespace candela::path {

/// What the coordinates of a scene are traced relative to, in whole metres: 0, unless most of it stands so far away
/// that single precision would be short of digits there.
vec3 tracing_origin(const Scene& scene);

/// A view in such coordinates.
View relative(View view, vec3 origin);

}  // namespace candela::path
