#pragma once

#include <vector>

#include "ibl/irradiance.h"
#include "ibl/prefilter.h"
#include "ibl/sh.h"
#include "ibl/sun.h"
#include "ibl/verify.h"
#include "image/job.h"

namespace candela::ibl {

struct BakeSettings {
  int size = 256;                 ///< of the faces of level 0
  int levels = 6;                 ///< each half the size of the one before, down to at least 1
  std::vector<double> roughness;  ///< of each level; empty = level_roughness(mapping, levels)
  Mapping mapping = Mapping::balanced;
  PrefilterSettings specular;
  bool sheen = false;
  int irradiance_size = 32;
  IrradianceMethod irradiance_method = IrradianceMethod::exact;
  int irradiance_samples = 1024;
  int sh_order = 2;
  Window window = Window::none;
  int proof_directions = 16;  ///< per level; 0 = no proof
  double error = 0.0;         ///< relative, at the texels; above 0 each level is refined until it holds
};

struct Level {
  double roughness = 0.0;
  Method method = Method::automatic;
  LevelProof proof;
  int refinements = 0;  ///< how often it was made again to keep `error`
  bool holds = true;    ///< `error`, where it was asked for
};

/// What a bake gives. Radiance throughout is linear Rec.709 in the unit of the source.
struct Bake {
  Cubemap specular;      ///< level 0 is the environment itself where its roughness is 0
  Cubemap sheen;         ///< empty unless asked for
  CubeFaces irradiance;  ///< not divided by π
  Sh sh;                 ///< of irradiance, windowed
  Sh sh_radiance;        ///< what it is the cosine's convolution of
  double sh_window_width = 0.0;
  std::vector<Level> levels;
  std::vector<Level> sheen_levels;
  Level irradiance_level;
  ErrorBound sh_error;  ///< of `sh` against exact irradiance: what its order leaves out
  dvec3 flux_in{0.0};   ///< ∫ radiance dω of the source, and of the cube made of it
  dvec3 flux_out{0.0};
};

/// Throws Error for sizes and levels that make no sense, and Interrupted after a stop. Progress is of the steps, which
/// take unequal times.
Bake bake(const Source& source, const BakeSettings& settings, const Job& job = {});

}  // namespace candela::ibl
