#include "raster/camera.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace candela::raster {

/// Columns of an off-axis projection; left, right, bottom, top at distance `near`.
mat4 perspective_projection(vec2 low, vec2 high, float near, float far) {
  mat4 m(0.0f);
  m[0][0] = 2.0f * near / (high.x - low.x);
  m[1][1] = 2.0f * near / (high.y - low.y);
  m[2] = {(high.x + low.x) / (high.x - low.x), (high.y + low.y) / (high.y - low.y), -(far + near) / (far - near),
          -1.0f};
  m[3][2] = -2.0f * far * near / (far - near);
  return m;
}

mat4 orthographic_projection(vec2 low, vec2 high, float near, float far) {
  mat4 m(1.0f);
  m[0][0] = 2.0f / (high.x - low.x);
  m[1][1] = 2.0f / (high.y - low.y);
  m[2][2] = -2.0f / (far - near);
  m[3] = {-(high.x + low.x) / (high.x - low.x), -(high.y + low.y) / (high.y - low.y), -(far + near) / (far - near),
          1.0f};
  return m;
}

namespace {

/// Distances along -z of the nearest and farthest corner of a box.
vec2 depth_range(const mat4& camera_from_world, const Box3& bounds) {
  vec2 range(kInfinity, -kInfinity);
  for (int i = 0; i < 8; ++i) {
    const vec3 corner((i & 1) != 0 ? bounds.upper.x : bounds.lower.x, (i & 2) != 0 ? bounds.upper.y : bounds.lower.y,
                      (i & 4) != 0 ? bounds.upper.z : bounds.lower.z);
    const float depth = -transform_point(camera_from_world, corner).z;
    range = {std::min(range.x, depth), std::max(range.y, depth)};
  }
  return range;
}

}  // namespace

FrameCamera frame_camera(const View& view, int width, int height, const Box3& bounds, vec2 jitter, vec2 aperture) {
  const mat4& world = view.world_from_camera;
  const vec2 lens = aperture * view.lens.radius;
  mat4 world_from_lens = world;
  world_from_lens[3] = vec4(transform_point(world, vec3(lens, 0.0f)), 1.0f);
  const mat4 lens_from_world = glm::inverse(world_from_lens);

  vec2 range = bounds.empty() ? vec2(0.1f, 10.0f) : depth_range(lens_from_world, bounds);
  const float size = bounds.empty() ? 1.0f : glm::length(bounds.size());
  const float margin = std::max(1e-3f * size, 1e-6f);
  range += vec2(-margin, margin);

  FrameCamera camera;
  camera.eye = vec3(world_from_lens[3]);
  camera.back = glm::normalize(vec3(world[2]));
  // The picture moves by a pixel when the window moves by two over its width.
  const vec2 shift = jitter * vec2(2.0f, -2.0f) / vec2(width, height);
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  if (const auto* perspective = std::get_if<PerspectiveCamera>(&view.projection)) {
    // Behind the camera there is nothing to see; a near plane far below the far one would cost depth precision.
    const float far = std::max(range.y, 1e-4f);
    const float near = std::max(range.x, 1e-4f * far);
    const float half = std::tan(0.5f * perspective->yfov);
    const vec2 extent(half * aspect, half);
    // A lens moved by `lens` sees the plane in focus where it was: the frustum shears back.
    const vec2 middle = -lens / (view.lens.radius > 0.0f ? view.lens.focus_distance : 1.0f);
    const vec2 low = (middle - extent - shift * extent) * near;
    const vec2 high = (middle + extent - shift * extent) * near;
    camera.clip_from_camera = perspective_projection(low, high, near, far);
  } else {
    const auto& orthographic = std::get<OrthographicCamera>(view.projection);
    const vec2 extent(orthographic.xmag, orthographic.ymag);
    camera.is_perspective = false;
    const vec2 low = -extent - shift * extent, high = extent - shift * extent;
    camera.clip_from_camera = orthographic_projection(low, high, range.x, range.y);
  }
  camera.clip_from_world = camera.clip_from_camera * lens_from_world;
  return camera;
}

bool is_outside(const mat4& clip_from_world, const Box3& box) {
  std::array<int, 6> outside{};
  for (int i = 0; i < 8; ++i) {
    const vec4 c =
        clip_from_world * vec4((i & 1) != 0 ? box.upper.x : box.lower.x, (i & 2) != 0 ? box.upper.y : box.lower.y,
                               (i & 4) != 0 ? box.upper.z : box.lower.z, 1.0f);
    for (int axis = 0; axis < 3; ++axis) {
      outside[static_cast<std::size_t>(2 * axis)] += c[axis] < -c.w ? 1 : 0;
      outside[static_cast<std::size_t>(2 * axis + 1)] += c[axis] > c.w ? 1 : 0;
    }
  }
  return std::any_of(outside.begin(), outside.end(), [](int n) { return n == 8; });
}

}  // namespace candela::raster
