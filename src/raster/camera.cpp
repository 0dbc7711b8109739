#include "raster/camera.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace candela::raster {

namespace {

constexpr float kFarthest = 1.0f - 4.0f * 0x1p-24f;  // in clip space

}  // namespace

/// Columns of an off-axis projection; left, right, bottom, top at distance `near`. Infinitely far is a little before
/// depth 1, where the background is.
mat4 perspective_projection(vec2 low, vec2 high, float near, float far) {
  mat4 m(0.0f);
  m[0][0] = 2.0f * near / (high.x - low.x);
  m[1][1] = 2.0f * near / (high.y - low.y);
  m[2] = {(high.x + low.x) / (high.x - low.x), (high.y + low.y) / (high.y - low.y), -kFarthest, -1.0f};
  m[3][2] = -(1.0f + kFarthest) * near;
  if (far < kInfinity) {
    m[2][2] = -(far + near) / (far - near);
    m[3][2] = -2.0f * far * near / (far - near);
  }
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

vec3 FrameCamera::at_depth(vec2 ndc, float depth) const {
  const mat4& m = clip_from_camera;
  if (!is_perspective) return {(ndc.x - m[3].x) / m[0].x, (ndc.y - m[3].y) / m[1].y, -depth};
  return vec3((ndc.x + m[2].x) / m[0].x, (ndc.y + m[2].y) / m[1].y, -1.0f) * depth;
}

FrameCamera frame_camera(const View& view, int width, int height, DepthRange range, vec2 jitter, vec2 aperture) {
  const mat4& world = view.world_from_camera;
  const vec2 lens = aperture * view.lens.radius;
  FrameCamera camera;
  camera.range = range;
  camera.world_from_camera = world;
  camera.world_from_camera[3] = vec4(transform_point(world, vec3(lens, 0.0f)), 1.0f);
  camera.eye = vec3(camera.world_from_camera[3]);
  camera.back = glm::normalize(vec3(world[2]));
  // The picture moves by a pixel when the window moves by two over its width.
  const vec2 shift = jitter * vec2(2.0f, -2.0f) / vec2(width, height);
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  if (const auto* perspective = std::get_if<PerspectiveCamera>(&view.projection)) {
    const float half = std::tan(0.5f * perspective->yfov);
    const vec2 extent(half * aspect, half);
    // A lens moved by `lens` sees the plane in focus where it was: the frustum shears back.
    const vec2 middle = -lens / (view.lens.radius > 0.0f ? view.lens.focus_distance : 1.0f);
    const vec2 low = (middle - extent - shift * extent) * range.near;
    const vec2 high = (middle + extent - shift * extent) * range.near;
    camera.clip_from_camera = perspective_projection(low, high, range.near, range.is_cut ? range.far : kInfinity);
  } else {
    const auto& orthographic = std::get<OrthographicCamera>(view.projection);
    const vec2 extent(orthographic.xmag, orthographic.ymag);
    camera.is_perspective = false;
    const vec2 low = -extent - shift * extent, high = extent - shift * extent;
    camera.clip_from_camera = orthographic_projection(low, high, range.near, range.far);
  }
  camera.clip_from_world = camera.clip_from_camera * glm::inverse(camera.world_from_camera);
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

bool is_beside(const mat4& clip_from_world, const Box3& box) {
  mat4 endless = clip_from_world;
  for (int i = 0; i < 4; ++i) endless[i][2] = 0.0f;
  return is_outside(endless, box);
}

}  // namespace candela::raster
