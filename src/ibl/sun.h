#pragma once

#include <vector>

#include "ibl/source.h"

namespace candela::ibl {

struct Sun {
  dvec3 direction{0.0, 1.0, 0.0};  ///< towards the centre of its light, unit
  double angular_radius = 0.0;     ///< radians, of a uniform disc with its second moment
  dvec3 illuminance{0.0};          ///< RGB, on a surface that faces it; × 1 lx where radiance is in cd/m²
};

struct SunSettings {
  int most = 1;               ///< how many, brightest first
  double contrast = 16.0;     ///< a sun's texels are that many times brighter than the mean of the environment
  double least_share = 0.05;  ///< of the whole flux; fainter ones are no suns
  double widest = 0.1;        ///< radians; larger patches are windows, not suns
};

struct SunExtraction {
  std::vector<Sun> suns;  ///< brightest first
  Source rest;            ///< what is left: their texels have the radiance of the ring around them
};

/// Bright connected patches of the map, and the discs that the source knows already.
SunExtraction extract_suns(const Source& source, const SunSettings& settings = {});

}  // namespace candela::ibl
