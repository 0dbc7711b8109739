#pragma once

#include "raster/camera.h"
#include "raster/gpu_scene.h"

namespace candela::raster {

/// What of a scene a view sees, by the boxes of its draws; where one of them surrounds the eye, or is so large that
/// depth would lose what is near, by triangles. `view` is relative to gpu.origin(). Without anything in sight, any
/// range.
///
/// A perspective range begins a little before the nearest thing; where a surface goes through the eye (as near as 2e-8
/// of the farthest distance), at 1e-4 of that.
DepthRange seen_range(const Scene& scene, const GpuScene& gpu, const View& view, float aspect);

}  // namespace candela::raster
