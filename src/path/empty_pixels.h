#pragma once

#include <cstdint>
#include <vector>

#include "path/camera.h"
#include "path/geometry.h"

namespace candela::path {

/// By pixel, row by row from the top: 1 where some ray of the pixel may meet a surface, 0 where none can. A pixel's
/// rays pass the film within `radius` pixels of its middle, along x and along y.
std::vector<std::uint8_t> find_covered_pixels(const Geometry& geometry, const Camera::Pinhole& camera, float radius);

}  // namespace candela::path
