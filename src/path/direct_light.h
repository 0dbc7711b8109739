#pragma once

#include "image/image.h"
#include "path/render.h"

namespace candela::path {

/// What comes straight from one kind of source: as it arrives, and as if nothing stood in its way.
struct DirectPart {
  Image arriving;
  Image unhindered;
};

/// What a picture shows before light has passed from one surface to another, by its source. The parts that arrive, and
/// what is seen, add up to the picture of one bounce, but for what is seen through bodies and sheets of glass, which is
/// in none. 3 channels, linear radiance.
struct DirectLight {
  Image seen;        ///< the background, and what surfaces send out themselves
  DirectPart far;    ///< from the environment's map
  DirectPart lamps;  ///< from punctual lights and the environment's suns
  DirectPart areas;  ///< from surfaces that glow

  /// All that arrives at the surfaces.
  vec3 arriving(int x, int y) const {
    return far.arriving.rgb(x, y) + lamps.arriving.rgb(x, y) + areas.arriving.rgb(x, y);
  }
};

/// Size, samples, seed and filter are those of the settings; noise targets and time limits do not count. Throws Error
/// as Tracer::render does, Interrupted after a stop.
DirectLight trace_direct_light(const Tracer& tracer, const View& view, const Settings& settings, const Job& job = {});

}  // namespace candela::path
