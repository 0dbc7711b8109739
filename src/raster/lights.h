#pragma once

#include <array>

#include "base/diagnostics.h"
#include "gl/gl.h"
#include "raster/blocks.h"
#include "raster/camera.h"
#include "raster/gpu_scene.h"
#include "scene/scene.h"

namespace candela::raster {

/// Every light that is a direction or a point: punctual lights and the suns of the environment, with the views that
/// their shadow maps are drawn from.
struct SceneLights {
  LightsBlock block;
  int count = 0;
  int area_count = 0;
  int shadow_count = 0;   ///< layers of the shadow maps
  int shadow_size = 0;    ///< texels a side
  bool has_suns = false;  ///< discs, which even a mirror must show
  std::array<int, kMostShadows>
      shadow_owner{};  ///< the area whose light a layer is of, which casts no shadow in it; -1
};

/// Where on a light with an extent its shadows are seen from: numbers in [0, 1)³, ½ the middle. Over many frames the
/// shadow becomes that of the whole.
using LightPoint = vec3;

/// `gpu` is what casts and receives shadows, whose origin positions are relative to, `camera` decides where the
/// cascades of directional lights lie, `point` where within suns, and in balls of `radius` about points and spots,
/// shadows are cast from. The strongest lights come first; those beyond kMostLights are left out with a warning,
/// shadows beyond kMostShadows likewise. Others will want `more_views` of them.
SceneLights collect_lights(const Scene& scene, const Environment& environment, const GpuScene& gpu,
                           const FrameCamera& camera, LightPoint point, float radius, int more_views,
                           Diagnostics& diagnostics);

/// A point of the unit ball whose distribution looks from everywhere like an even disc; 0 for the middle.
vec3 point_of_ball(LightPoint point);

/// How many shadow maps an area light wants.
int shadow_views(const AreaEntry& area);

/// Shadow maps of an area light, seen from a point of it: from a body to all sides, from a panel to its front or to
/// both sides. False where there is no room for them.
bool add_area_shadows(SceneLights& lights, AreaEntry& area, vec3 from, const Box3& bounds);

/// Takes all shadow maps away: nothing stands in the light's way.
void remove_shadows(SceneLights& lights);

/// The IES profiles of a scene as layers of one texture: horizontal angle by vertical angle, candela.
gl::Texture upload_profiles(const Scene& scene);

}  // namespace candela::raster
