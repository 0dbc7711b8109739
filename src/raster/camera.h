#pragma once

#include "math/types.h"
#include "scene/view.h"

namespace candela::raster {

/// Distances along the view of the nearest and the farthest thing in sight.
struct DepthRange {
  float near = 1.0f;
  float far = 2.0f;
  bool is_cut = false;  ///< nothing beyond `far` is seen, though it may be there
};

/// The view of one frame: a View as a rasterizer takes it. The far plane of a perspective one is infinitely far unless
/// the view has one.
struct FrameCamera {
  mat4 clip_from_world{1.0f};
  mat4 clip_from_camera{1.0f};
  mat4 world_from_camera{1.0f};
  vec3 eye{0.0f};
  vec3 back{0, 0, 1};  ///< unit, towards the viewer
  bool is_perspective = true;
  DepthRange range;

  /// Where a place of the picture (-1 … 1, up) is at a distance along the view, in camera space.
  vec3 at_depth(vec2 ndc, float depth) const;
};

/// `jitter` moves the picture by pixels (−½ … ½), `aperture` chooses a point of the lens in the unit disc.
FrameCamera frame_camera(const View& view, int width, int height, DepthRange range, vec2 jitter = vec2(0.0f),
                         vec2 aperture = vec2(0.0f));

/// Clip space of a camera that looks along -z. `low` and `high` are the window's corners: at distance `near`, or at any
/// of an orthographic one.
mat4 perspective_projection(vec2 low, vec2 high, float near, float far = kInfinity);
mat4 orthographic_projection(vec2 low, vec2 high, float near, float far);

/// Whether a box lies wholly outside one plane of what a camera sees.
bool is_outside(const mat4& clip_from_world, const Box3& box);
/// Whether it lies wholly beside a view, wherever along it.
bool is_beside(const mat4& clip_from_world, const Box3& box);

}  // namespace candela::raster
