#pragma once

#include <vector>

#include "base/diagnostics.h"
#include "gl/gl.h"
#include "raster/blocks.h"
#include "raster/camera.h"
#include "scene/scene.h"

namespace candela::raster {

/// Every light that is a direction or a point: punctual lights and the suns of the environment, with the views that
/// their shadow maps are drawn from.
struct SceneLights {
  LightsBlock block;
  int count = 0;
  int shadow_count = 0;   ///< layers of the shadow maps
  int shadow_size = 0;    ///< texels a side
  bool has_suns = false;  ///< discs, which even a mirror must show
};

/// `bounds` is what casts and receives shadows, `camera` decides where the cascades of directional lights lie. The
/// strongest lights come first; those beyond kMostLights are left out with a warning, shadows beyond kMostShadows
/// likewise.
SceneLights collect_lights(const Scene& scene, const Environment& environment, const Box3& bounds,
                           const FrameCamera& camera, Diagnostics& diagnostics);

/// The IES profiles of a scene as layers of one texture: horizontal angle by vertical angle, candela.
gl::Texture upload_profiles(const Scene& scene);

}  // namespace candela::raster
