#pragma once

#include <vector>

#include "image/film.h"
#include "path/camera.h"
#include "path/geometry.h"

namespace candela::path {

/// Through the middle of a pixel and of the lens.
Ray centre_ray(const Camera& camera, int x, int y);
/// Where a hit is, in terms of the scene.
SurfaceSample surface_sample_of(const Geometry& geometry, const Hit& hit);

/// What the centres of a picture's pixels see. The camera is without a lens.
SurfaceMap map_surfaces(const Geometry& geometry, const Camera& camera, ivec2 size);

/// Which pixels' centres each node would be at, were nothing before it.
std::vector<InstanceMask> find_masks(const Geometry& geometry, const Camera& camera, ivec2 size);

}  // namespace candela::path
