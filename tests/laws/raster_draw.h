#pragma once

#include <gtest/gtest.h>

#include "raster/render.h"

namespace candela::test {

/// A picture by the rasterizer, without a pixel that is not finite. What it warns of is put into `told`.
inline Film draw(const Scene& scene, const Environment& environment, const View& view, const raster::Settings& settings,
                 Diagnostics& told) {
  raster::Statistics statistics;
  Film film = raster::render(scene, environment, view, settings, told, &statistics);
  EXPECT_EQ(statistics.non_finite_pixels, 0u);
  return film;
}

inline Film draw(const Scene& scene, const Environment& environment, const View& view,
                 const raster::Settings& settings) {
  Diagnostics ignored;
  return draw(scene, environment, view, settings, ignored);
}

}  // namespace candela::test
