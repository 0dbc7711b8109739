#pragma once

#include <cstdint>
#include <vector>

#include "path/render.h"

namespace candela::path {

enum class LightKind {
  sky,      ///< the environment's map, or what the camera sees in its place
  sun,      ///< of the environment
  lamp,     ///< punctual
  surface,  ///< one that glows
};

/// What a path ends at.
struct LightSource {
  LightKind kind = LightKind::sky;
  int index = -1;      ///< number of the sun; node of a lamp or surface
  int primitive = -1;  ///< of that node's mesh

  auto operator<=>(const LightSource&) const = default;
};

enum class PathEvent {
  reflected,
  let_through,
  passed,     ///< a sheet, without a turn
  scattered,  ///< in a body
  ended,      ///< the surface that glows
};

struct PathVertex {
  PathEvent event = PathEvent::ended;
  vec3 position{0.0f};  ///< world space, metres
  vec3 normal{0.0f};    ///< world space, of the surface as it is shaded; 0 in a body
  int node = -1;        ///< -1 in a body
  int primitive = -1;
};

/// A way by which light came to the pixel, from the eye to its source.
struct LightPath {
  std::vector<PathVertex> vertices;
  LightSource source;
  vec3 direction{0, 1, 0};     ///< towards a source that is not the last vertex, from there; world space
  vec3 radiance{0.0f};         ///< what it adds to the mean of all samples
  std::uint32_t sample = 0;    ///< its number
  bool is_looked_for = false;  ///< the source was chosen, not met by chance
};

/// What one source, or one number of turns, brings to a pixel.
struct SourceLight {
  LightSource source;
  vec3 straight{0.0f};  ///< seen by the eye itself, or after one turn
  vec3 indirect{0.0f};  ///< after more
};

/// What a path tracer finds of a pixel.
struct PixelEstimate {
  int samples = 0;
  vec3 mean{0.0f};   ///< radiance
  vec3 error{0.0f};  ///< standard error of the mean, as if samples were independent, which is on the safe side
  std::vector<SourceLight> sources;  ///< add up to the mean; the strongest first
  std::vector<vec3> turns;           ///< light by how often it was reflected, refracted or scattered; likewise
  std::vector<LightPath> brightest;  ///< the brightest first
  std::uint64_t non_finite = 0;      ///< samples that were left out; must be 0
};

struct PixelPathSettings {
  std::size_t paths = 3;  ///< how many of the brightest are kept
};

/// Follows the paths that a picture with these settings follows in that pixel, all of its samples. Noise targets, time
/// limits and clamping do not count. Throws Error as Tracer::render does, for a pixel outside the picture and for a
/// scene with a ground; Interrupted after a stop.
PixelEstimate trace_pixel(const Tracer& tracer, const View& view, const Settings& settings, ivec2 pixel,
                          const PixelPathSettings& kept = {}, const Job& job = {});

}  // namespace candela::path
