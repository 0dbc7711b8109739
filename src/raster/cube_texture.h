#pragma once

#include "gl/gl.h"
#include "image/cubemap.h"

namespace candela::raster {

/// A cube in a texture of half floats, its levels as they are.
gl::Texture upload_cube(const Cubemap& cube);

}  // namespace candela::raster
