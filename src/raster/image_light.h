#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "image/cubemap.h"
#include "scene/scene.h"

namespace candela::raster {

/// What of an environment lights a surface without shadows: prefiltered and irradiance cubes. Its suns are left out:
/// they are lights, with shadows.
struct BakedLight {
  Cubemap specular;        ///< level l filtered for α = 2^(l - levels + 1), level 0 the environment itself
  Cubemap sheen;           ///< the same for the sheen lobe; empty unless asked for
  CubeFaces irradiance;    ///< not divided by π
  bool is_cached = false;  ///< came from a file of an earlier run
};

/// Names the light of an environment without its suns; equal for equal light.
using LightKey = std::string;
LightKey light_key(const Environment& environment, bool wants_sheen);

/// Whether light has to be baked for the sheen lobe, too.
bool uses_sheen(const Scene& scene);

/// Whether an environment is more than its suns.
bool is_lit_from_far(const Environment& environment);

/// Bakes, or reads what an earlier run baked from the same light. `cache` is the folder of such files; empty = none is
/// read or written. A damaged or unwritable cache is no error.
BakedLight bake_light(const Environment& environment, bool wants_sheen, const std::filesystem::path& cache);

/// The same of a cube of radiance.
BakedLight bake_light(const CubeFaces& cube, bool wants_sheen);

/// What stands in for light from far away: all of it, or what older renderers made of it, for comparison.
enum class Ambient {
  baked,      ///< prefiltered for each roughness, irradiance
  harmonics,  ///< irradiance by nine spherical harmonics (Ramamoorthi & Hanrahan 2001), else as baked
  mips,       ///< the environment's own mips, chosen by roughness; the smallest is the irradiance
  constant,   ///< the mean of the environment from everywhere, on diffuse surfaces alone
  none
};

/// `light` as `ambient` has it.
BakedLight simplified(BakedLight light, Ambient ambient);

/// Light as it arrives at one place in a scene.
struct Probe {
  vec3 position{0.0f};
  Box3 box;  ///< whose walls the light is taken to come from
  BakedLight light;
};

}  // namespace candela::raster
