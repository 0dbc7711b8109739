#pragma once

#include <string>
#include <vector>

#include "shade/surface.glsl.h"

namespace candela::laws {

struct NamedSurface {
  std::string name;
  shade::SurfaceParams params;
};

/// The one table that every law of the surface loops over. A parameter or lobe is tested by appearing here.
std::vector<NamedSurface> surfaces();

}  // namespace candela::laws
