#pragma once

#include "math/types.h"
#include "scene/view.h"

namespace candela::raster {

/// The view of one frame: a View as a rasterizer takes it.
struct FrameCamera {
  mat4 clip_from_world{1.0f};
  mat4 clip_from_camera{1.0f};
  vec3 eye{0.0f};
  vec3 back{0, 0, 1};  ///< unit, towards the viewer
  bool is_perspective = true;
};

/// `jitter` moves the picture by pixels (−½ … ½), `aperture` chooses a point of the lens in the unit disc. Near and far
/// planes hold `bounds`, what of it is before the camera.
FrameCamera frame_camera(const View& view, int width, int height, const Box3& bounds, vec2 jitter = vec2(0.0f),
                         vec2 aperture = vec2(0.0f));

/// OpenGL's projections of a camera that looks along -z. `low` and `high` are the window's corners: at distance `near`,
/// or at any of an orthographic one.
mat4 perspective_projection(vec2 low, vec2 high, float near, float far);
mat4 orthographic_projection(vec2 low, vec2 high, float near, float far);

/// Whether a box lies wholly outside one plane of what a camera sees.
bool is_outside(const mat4& clip_from_world, const Box3& box);

}  // namespace candela::raster
