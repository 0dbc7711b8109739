#pragma once

#include <vector>

#include "base/diagnostics.h"
#include "raster/gpu_scene.h"
#include "raster/lights.h"

namespace candela::raster {

/// A draw that lights others.
struct AreaLight {
  std::size_t draw = 0;
  AreaEntry entry;     ///< without shadows
  float power = 0.0f;  ///< luminance times what is seen of its surface
};

/// What glows evenly, and panels that glow by a texture, which counts by its mean: the strongest kMostAreas, others are
/// left out with a warning.
///
/// A flat primitive is a rectangle of its area (a single triangle itself); any other a square that always faces what it
/// lights, of a quarter of its surface: what a convex body shows from all around in the mean (Cauchy).
std::vector<AreaLight> find_areas(const Scene& scene, const GpuScene& gpu, Diagnostics& diagnostics);

/// Adds area lights to `lights`, with their shadows as far as there is room, seen from `point` of each.
void add_areas(const std::vector<AreaLight>& areas, const Box3& bounds, LightPoint point, SceneLights& lights);

}  // namespace candela::raster
