#pragma once

#include <memory>
#include <vector>

#include "candela/gap.h"
#include "path/direct_light.h"

/// What gap.cpp and gap_suspects.cpp share.
namespace candela {

/// A pixel's weight in squared errors, and whether causes of its material's kind are told apart in it.
struct GapPixel {
  double weight = 0.0;
  GapCause kind = GapCause::rest;  ///< glass or scattering: all its error is that; else rest
  bool is_plain() const { return kind == GapCause::rest; }
};

/// The means of many frames that show parts of the light.
struct DrawnParts {
  Image many;         ///< all light
  Image ambient;      ///< from far away, or of probes
  Image open;         ///< the same without occlusion; empty where there is none
  Image direct;       ///< from lamps and glowing surfaces
  Image unshadowed;   ///< the same without shadow maps
  Image lamps_alone;  ///< that without glowing surfaces; empty where only one of the two kinds is there

  const Image& without_occlusion() const { return open.empty() ? ambient : open; }
};

/// What a comparison is made of.
struct GapScene {
  std::shared_ptr<const Scene> scene;
  const Environment& environment;
  const Shot& shot;
  View view;
  const path::Tracer& tracer;
};

/// Makes a picture by the rasterizer of that scene with these settings.
using DrawFrames = std::function<Image(const raster::Settings& settings)>;

/// Mistakes that would explain what is wrong with light that comes straight from its source, were nothing in its way;
/// those alone that explain about as much as the best.
std::vector<GapSuspect> find_suspects(const GapScene& of, const std::vector<GapPixel>& pixels, const DrawnParts& drawn,
                                      const path::DirectLight& direct, const raster::Settings& settings,
                                      const DrawFrames& draw, const Job& job);

}  // namespace candela
