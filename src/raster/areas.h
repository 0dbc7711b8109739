#pragma once

#include <cstdint>
#include <vector>

#include "base/diagnostics.h"
#include "raster/gpu_scene.h"
#include "raster/lights.h"

namespace candela::raster {

/// What of a draw is a lamp.
struct LampSurface {
  std::size_t draw = 0;
  std::vector<std::uint32_t> triangles;
};

/// A surface, or several near by, that lights others.
struct AreaLight {
  std::vector<LampSurface> surfaces;
  AreaEntry entry;         ///< relative to `base`, without shadows
  glm::dvec3 base{0.0};    ///< world
  float power = 0.0f;      ///< luminous, over π
  float seen_area = 0.0f;  ///< of it, from where it shines to
};

/// What glows in the scene, by parts that hang together (glowing_parts()): a flat part is a rectangle of its area (a
/// single triangle itself); any other a square that always faces what it lights, of a quarter of its surface: what a
/// convex body shows from all around in the mean (Cauchy). Those beyond kMostAreas join what is nearest, weak ones
/// first, with a warning; the power stays what it was.
///
/// What a texture paints on parts of a body is left out where all of it adds less than a fiftieth to `sky`, the mean
/// luminance from far away, at a distance of half the body's size.
std::vector<AreaLight> find_areas(const Scene& scene, const GpuScene& gpu, float sky, Diagnostics& diagnostics);

/// Shadow maps that area lights want.
int shadow_views(const std::vector<AreaLight>& areas);

/// Adds area lights to `lights`, relative to gpu.origin(), with their shadows as far as there is room, seen from
/// `point` of each.
void add_areas(const std::vector<AreaLight>& areas, const GpuScene& gpu, LightPoint point, SceneLights& lights,
               Diagnostics& diagnostics);

}  // namespace candela::raster
