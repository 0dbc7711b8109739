#pragma once

#include "image/cubemap.h"
#include "path/render.h"

namespace candela::path {

/// The light that arrives at `position` (world space) from all sides, path traced: a cube map of one level and `size`
/// texels a side, each the mean over its area. What it looks past the scene at is the environment that lights it, suns
/// and a studio's lamps included, never a backdrop. Point and spot lights have no size and are not seen.
///
/// Of `settings` the picture's size, filter, layers and background do not count; a time limit is shared by the faces.
/// `statistics` adds up the faces. Throws Interrupted after a stop, Error as Tracer::render does. The result depends on
/// the arguments alone, never on the number of threads.
Cubemap capture_environment(const Tracer& tracer, vec3 position, int size, const Settings& settings,
                            const Job& job = {}, Statistics* statistics = nullptr);

}  // namespace candela::path
