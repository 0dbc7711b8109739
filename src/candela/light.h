#pragma once

#include <optional>
#include <string>

#include "candela/candela.h"
#include "ibl/bake.h"
#include "ibl/source.h"
#include "image/cube_layout.h"

namespace candela {

/// Light to bake: an environment, or what a point of a scene sees. An Error about a member names the option of `candela
/// bake` that sets it.
struct LightChoice {
  std::string environment;         ///< a file or a name for make_environment(); empty = the scene's own
  std::optional<CubeAxes> axes{};  ///< of a cube map that is read
  float rotation = 0.0f;           ///< radians about +y
  float intensity = 1.0f;
  std::string scene{};  ///< a file, or "demo:NAME"; empty = the environment alone
  LoadOptions load{};
  vec3 position{0.0f};  ///< in the scene, metres
  int samples = 64;     ///< per texel of the cube traced there
};

/// The light to bake, and the cube that it was read from, if it was one.
struct LoadedLight {
  ibl::Source source;
  std::optional<CubeFaces> faces;
  bool is_panorama = false;  ///< the source is a file's own panorama
};

/// Reads the environment, or traces what the scene's point sees into a cube of `size` texels a side. Warnings go to the
/// job. Throws Error, and Interrupted after a stop.
LoadedLight load_light(const LightChoice& choice, int size, const Job& job = {});

/// What a point of a prepared scene sees, path traced into a cube of `size` texels a side with `samples` for each.
/// Throws Error, and Interrupted after a stop.
LoadedLight trace_light(const path::Tracer& tracer, vec3 position, int samples, int size, const Job& job = {});

/// ibl::bake(); level 0 has a cube's own texels if the sizes allow. Throws Error if BakeSettings::error cannot be
/// reached.
ibl::Bake bake_light(const LoadedLight& light, const ibl::BakeSettings& settings, const Job& job = {});

}  // namespace candela
