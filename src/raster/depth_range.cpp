#include "raster/depth_range.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "math/box.h"

namespace candela::raster {

namespace {

/// What a view can see: |x| <= spread.x * depth + size.x, likewise y, a little more than the picture, between its
/// planes.
struct Window {
  vec2 spread{0.0f};
  vec2 size{0.0f};
  float near = 0.0f;
  float far = kInfinity;
};

Window window_of(const View& view, float aspect) {
  constexpr float kMargin = 1.05f;  // for pixels that are moved
  Window w;
  w.near = view.near_plane, w.far = view.far_plane;
  if (const auto* perspective = std::get_if<PerspectiveCamera>(&view.projection)) {
    const float half = kMargin * std::tan(0.5f * perspective->yfov);
    const float lens = view.lens.radius;
    w.spread = vec2(half * aspect, half) + (lens > 0.0f ? lens / view.lens.focus_distance : 0.0f);
    w.size = vec2(lens);
  } else {
    const auto& orthographic = std::get<OrthographicCamera>(view.projection);
    w.size = kMargin * vec2(orthographic.xmag, orthographic.ymag);
  }
  return w;
}

/// Extends `range` by the part of a polygon that is within the window and between its planes. Sutherland & Hodgman
/// 1974, "Reentrant Polygon Clipping".
void extend_seen(const Window& window, const std::array<vec3, 3>& triangle, vec2& range) {
  std::array<vec3, 9> polygon{triangle[0], triangle[1], triangle[2]}, next{};
  std::size_t count = 3;
  const int planes = window.far < kInfinity ? 6 : 5;
  for (int plane = 0; plane < planes && count > 0; ++plane) {
    const auto inside = [&](vec3 p) {
      const float depth = -p.z;
      if (plane == 4) return depth - window.near;
      if (plane == 5) return window.far - depth;
      const int axis = plane / 2;
      return window.spread[axis] * depth + window.size[axis] + (plane % 2 == 0 ? p[axis] : -p[axis]);
    };
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const vec3 a = polygon[i], b = polygon[(i + 1) % count];
      const float da = inside(a), db = inside(b);
      if (da >= 0.0f) next[kept++] = a;
      if ((da >= 0.0f) != (db >= 0.0f)) next[kept++] = a + (b - a) * (da / (da - db));
    }
    polygon = next;
    count = kept;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const float depth = std::clamp(-polygon[i].z, window.near, window.far);
    range = {std::min(range.x, depth), std::max(range.y, depth)};
  }
}

std::array<vec3, 8> corners(const mat4& camera_from_world, const Box3& b) {
  std::array<vec3, 8> all = corners(b);
  for (vec3& p : all) p = transform_point(camera_from_world, p);
  return all;
}

/// A draw whose box is in sight.
struct Seen {
  std::size_t draw = 0;
  vec2 range{0.0f};
};

std::vector<Seen> boxes_in_sight(const GpuScene& gpu, const mat4& camera_from_world, const Window& window) {
  std::vector<Seen> all;
  for (std::size_t i = 0; i < gpu.draws().size(); ++i) {
    vec2 range(kInfinity, -kInfinity);
    std::array<int, 4> outside{};
    for (const vec3& c : corners(camera_from_world, gpu.draws()[i].bounds)) {
      const float depth = -c.z;
      range = {std::min(range.x, depth), std::max(range.y, depth)};
      for (int k = 0; k < 4; ++k) {
        const float side = k % 2 == 0 ? c[k / 2] : -c[k / 2];
        outside[static_cast<std::size_t>(k)] += window.spread[k / 2] * depth + window.size[k / 2] + side < 0.0f ? 1 : 0;
      }
    }
    if (range.y < window.near || range.x > window.far ||
        std::any_of(outside.begin(), outside.end(), [](int n) { return n == 8; }))
      continue;
    all.push_back({i, glm::clamp(range, window.near, window.far)});
  }
  return all;
}

void extend_by_triangles(const Scene& scene, const GpuScene& gpu, const Draw& draw, const mat4& camera_from_world,
                         const Window& window, vec2& range) {
  const Node& node = scene.nodes[static_cast<std::size_t>(draw.node)];
  const Primitive& primitive = scene.meshes[static_cast<std::size_t>(node.mesh)].primitives[draw.part];
  const mat4 camera_from_node = camera_from_world * gpu.relative(node.world_from_node);
  std::vector<vec3> positions;
  positions.reserve(primitive.positions.size());
  for (const vec3& p : primitive.positions) positions.push_back(transform_point(camera_from_node, p));
  for (const uvec3& t : primitive.triangles) {
    const std::array<vec3, 3> triangle = {positions[t.x], positions[t.y], positions[t.z]};
    const float nearest = -std::max({triangle[0].z, triangle[1].z, triangle[2].z});
    const float farthest = -std::min({triangle[0].z, triangle[1].z, triangle[2].z});
    if (farthest < window.near || nearest > window.far || (nearest >= range.x && farthest <= range.y)) continue;
    extend_seen(window, triangle, range);
  }
}

/// A range in which nothing is, where nothing is in sight.
DepthRange range_of_nothing(const Window& window) {
  const bool is_cut = window.far < kInfinity;
  const float near = window.near > 0.0f ? window.near : is_cut ? 0.5f * window.far : 1.0f;
  return {near, is_cut ? window.far : 2.0f * near, is_cut};
}

/// Planes of the view are where it has them, to the last bit.
DepthRange within(const Window& window, float near, float far) {
  return {std::max(near, window.near), std::min(far, window.far), window.far < kInfinity};
}

}  // namespace

DepthRange seen_range(const Scene& scene, const GpuScene& gpu, const View& view, float aspect) {
  const mat4 camera_from_world = glm::inverse(view.world_from_camera);
  const Window window = window_of(view, aspect);
  const bool is_perspective = std::holds_alternative<PerspectiveCamera>(view.projection);
  std::vector<Seen> seen = boxes_in_sight(gpu, camera_from_world, window);
  if (seen.empty()) return range_of_nothing(window);
  vec2 range(kInfinity, 0.0f);
  for (const Seen& s : seen) range = {std::min(range.x, s.range.x), std::max(range.y, s.range.y)};

  // Floats of depth tell apart a millionth of it along an orthographic view, and of the near plane's multiples along a
  // perspective one: the boxes do where that is small.
  const bool is_fine =
      is_perspective ? range.x >= 1e-3f * range.y : range.y - range.x <= 1e2f * std::max(window.size.x, window.size.y);
  if (!is_fine) {
    std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) { return a.range.x < b.range.x; });
    vec2 found(kInfinity, is_perspective ? range.y : 0.0f);
    for (const Seen& s : seen) {
      if (s.range.x >= found.x && s.range.y <= found.y) continue;
      extend_by_triangles(scene, gpu, gpu.draws()[s.draw], camera_from_world, window, found);
    }
    if (found.x > found.y) return range_of_nothing(window);
    range = found;
  }
  if (is_perspective) {
    // As far as rounding goes, a surface is at the eye.
    const bool is_touched = range.x < 2e-8f * range.y;
    return within(window, is_touched ? 1e-4f * range.y : 0.95f * range.x,
                  window.far < kInfinity ? window.far : range.y);
  }
  const float margin = std::max(1e-3f * (range.y - range.x), 1e-5f * std::max(window.size.x, window.size.y));
  return within(window, std::max(range.x - margin, 0.0f), range.y + margin);
}

}  // namespace candela::raster
