#pragma once

#include <gtest/gtest.h>

#include "raster/render.h"

namespace candela::test {

/// A picture by the rasterizer, without a pixel that is not finite. What it warns of is put into `told`.
inline Film draw(const Scene& scene, const Environment& environment, const View& view, const raster::Settings& settings,
                 Diagnostics& told, const shade::ShadingModel& shading = shade::shading_model_candela()) {
  raster::Statistics statistics;
  raster::Drawer drawer(borrowed(scene), environment, shading);
  Film film = drawer.render(view, settings, {.diagnostics = &told}, &statistics);
  EXPECT_EQ(statistics.non_finite_pixels, 0u);
  return film;
}

inline Film draw(const Scene& scene, const Environment& environment, const View& view,
                 const raster::Settings& settings) {
  Diagnostics ignored;
  return draw(scene, environment, view, settings, ignored);
}

}  // namespace candela::test
