#pragma once

#include <vector>

#include "base/diagnostics.h"
#include "raster/gpu_scene.h"
#include "raster/lights.h"

namespace candela::raster {

/// Adds a scene's area lights with their shadows to `lights`, and says which draw is which, -1 for those that are none:
/// what glows evenly, and panels that glow by a texture, which counts by its mean. The strongest kMostAreas; others are
/// left out with a warning.
///
/// A flat primitive is a rectangle of its area (a single triangle itself); any other a square that always faces what it
/// lights, of a quarter of its surface: what a convex body shows from all around in the mean (Cauchy).
/// Their shadows are cast from `point` of each.
std::vector<int> collect_areas(const Scene& scene, const GpuScene& gpu, LightPoint point, SceneLights& lights,
                               Diagnostics& diagnostics);

}  // namespace candela::raster
