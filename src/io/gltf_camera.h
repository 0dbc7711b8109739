#pragma once

#include "io/gltf_warnings.h"
#include "io/json_view.h"
#include "scene/scene.h"

namespace candela::io {

/// A camera of the file, with the lens of EXT_camera_physical. Planes and lenses that make no sense are left out with a
/// warning; throws Error for a projection that does not.
Camera read_camera(const JsonView& json, Warnings& warnings);

}  // namespace candela::io
