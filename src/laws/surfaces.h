#pragma once

#include <string>
#include <vector>

#include "shade/surface.glsl.h"

namespace candela::laws {

/// What is promised of a surface; every measurement of laws/laws.h is judged by it.
struct Promise {
  bool is_reciprocal = true;
  /// Whether nothing in it absorbs, so that a white furnace must come back whole.
  bool is_white = true;
  /// Most that the white furnace may be short of 1 and above it; of coloured surfaces only the gain counts.
  double loss = 0.005;
  double gain = 0.005;
  /// Whether its text breaks a law: loss and gain are then what that text loses and gains, measured once.
  bool is_exempt = false;
};

struct NamedSurface {
  std::string name;   ///< unique: group, matter, roughness
  std::string group;  ///< lobes and matter that differ by roughness alone
  shade::SurfaceParams params;
  Promise promise;
  bool is_core = false;  ///< one lobe at a time or typical, for laws that take long
};

/// The one table that every law loops over: each lobe alone, each combination that a material can have, every shading
/// model, over roughness from 0 to 1. A new parameter or lobe is tested by appearing here.
std::vector<NamedSurface> law_surfaces();

}  // namespace candela::laws
