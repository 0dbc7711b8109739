#include "content/shapes.h"

#include <algorithm>
#include <cmath>

namespace candela::content {
namespace {

unsigned int index(std::size_t i) { return static_cast<unsigned int>(i); }

/// Unit vector of an outline's plane at a polar angle from +y.
vec2 polar(float angle) { return {std::sin(angle), std::cos(angle)}; }

/// Points on an arc whose normal turns from one polar angle to another; `side` is -1 on the hollow side of the arc.
/// Where the outline already ends at the arc's beginning, smoothly, that point is not repeated: rounding would fold it.
void add_arc(Outline& outline, vec2 center, float radius, float from, float to, int segments, float side = 1.0f) {
  for (int i = 0; i <= segments; ++i) {
    const float angle = glm::mix(from, to, static_cast<float>(i) / static_cast<float>(segments));
    const OutlinePoint point{center + radius * polar(angle), side * polar(angle)};
    const bool repeats = i == 0 && !outline.empty() && glm::dot(outline.back().normal, point.normal) > 0.999f &&
                         glm::length(outline.back().position - point.position) < 1e-4f * radius;
    if (!repeats) outline.push_back(point);
  }
}

int arc_segments(float angle) { return std::max(2, static_cast<int>(std::ceil(std::abs(angle) / radians(9.0f)))); }

float angle_of(vec2 v) { return std::atan2(v.x, v.y); }

/// A grid of vertices, `columns` quads wide and `rows` high; quads without area (at poles) give no triangle.
void add_grid_triangles(Primitive& primitive, std::size_t first, int columns, int rows) {
  const std::size_t stride = static_cast<std::size_t>(columns) + 1;
  const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
    const vec3 pa = primitive.positions[a], pb = primitive.positions[b], pc = primitive.positions[c];
    if (pa != pb && pb != pc && pc != pa) primitive.triangles.emplace_back(index(a), index(b), index(c));
  };
  for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row) {
    for (std::size_t column = 0; column < static_cast<std::size_t>(columns); ++column) {
      const std::size_t a = first + row * stride + column;
      add(a, a + 1, a + stride + 1);
      add(a, a + stride + 1, a + stride);
    }
  }
}

void add_vertex(Primitive& primitive, vec3 position, vec3 normal, vec3 tangent, vec2 uv) {
  primitive.positions.push_back(position);
  primitive.normals.push_back(glm::normalize(normal));
  primitive.tangents.emplace_back(glm::normalize(tangent), 1.0f);
  primitive.uvs[0].push_back(uv);
}

}  // namespace

Outline rounded_outline(std::span<const OutlineCorner> corners) {
  Outline outline;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const vec2 here = corners[i].position;
    const bool first = i == 0, last = i + 1 == corners.size();
    const vec2 in = first ? vec2(0.0f) : glm::normalize(here - corners[i - 1].position);
    const vec2 out = last ? vec2(0.0f) : glm::normalize(corners[i + 1].position - here);
    const vec2 normal_in(in.y, -in.x), normal_out(out.y, -out.x);
    if (first || last) {
      outline.push_back({here, first ? normal_out : normal_in});
      continue;
    }
    const float fillet = corners[i].fillet;
    if (fillet <= 0.0f) {
      outline.push_back({here, normal_in});
      outline.push_back({here, normal_out});
      continue;
    }
    const float cross = in.x * out.y - in.y * out.x;
    const float turn = std::acos(std::clamp(glm::dot(in, out), -1.0f, 1.0f));
    const vec2 start = here - in * (fillet * std::tan(0.5f * turn));
    // A left turn bulges outwards, a right turn is a hollow whose centre lies outside the solid.
    const float side = cross >= 0.0f ? 1.0f : -1.0f;
    const float from = angle_of(side * normal_in);
    add_arc(outline, start - side * fillet * normal_in, fillet, from, from - side * turn, arc_segments(turn), side);
  }
  return outline;
}

Outline sphere_outline(float radius, int segments) {
  Outline outline;
  add_arc(outline, vec2(0.0f), radius, kPi, 0.0f, segments);
  outline.front().position.x = outline.back().position.x = 0.0f;
  return outline;
}

Outline shell_outline(float inner, float outer, float from, float to, float fillet, int segments) {
  constexpr int kFilletSegments = 10;
  const float half = 0.5f * kPi;
  const bool closed_below = to >= kPi;
  const float inset_outer = std::asin(fillet / (outer - fillet));
  const float inset_inner = std::asin(fillet / (inner + fillet));
  const float outer_from = from + inset_outer, inner_from = from + inset_inner;
  const float outer_to = closed_below ? kPi : to - inset_outer, inner_to = closed_below ? kPi : to - inset_inner;

  Outline outline;
  // Outside, upwards; round the rim at `from`; inside, downwards; round the rim at `to`.
  add_arc(outline, vec2(0.0f), outer, outer_to, outer_from, segments);
  add_arc(outline, (outer - fillet) * polar(outer_from), fillet, outer_from, from - half, kFilletSegments);
  add_arc(outline, (inner + fillet) * polar(inner_from), fillet, from - half, inner_from - kPi, kFilletSegments);
  add_arc(outline, vec2(0.0f), inner, inner_from, inner_to, segments, -1.0f);
  if (closed_below) {
    outline.front().position.x = outline.back().position.x = 0.0f;
  } else {
    add_arc(outline, (inner + fillet) * polar(inner_to), fillet, inner_to + kPi, to + half, kFilletSegments);
    add_arc(outline, (outer - fillet) * polar(outer_to), fillet, to + half, outer_to, kFilletSegments);
    outline.back().position = outline.front().position;
  }
  return outline;
}

Primitive lathe(const Outline& outline, int segments, vec2 uv_repeat) {
  std::vector<float> way(outline.size(), 0.0f);
  for (std::size_t i = 1; i < outline.size(); ++i)
    way[i] = way[i - 1] + glm::length(outline[i].position - outline[i - 1].position);

  Primitive primitive;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const auto [position, normal] = outline[i];
    const float v = (1.0f - way[i] / way.back()) * uv_repeat.y;
    for (int column = 0; column <= segments; ++column) {
      // The last column repeats the first, bit for bit, with another u.
      const float angle = 2.0f * kPi * static_cast<float>(column % segments) / static_cast<float>(segments);
      const float s = std::sin(angle), c = std::cos(angle);
      const float u = static_cast<float>(column) / static_cast<float>(segments) * uv_repeat.x;
      add_vertex(primitive, {position.x * s, position.y, position.x * c}, {normal.x * s, normal.y, normal.x * c},
                 {c, 0.0f, -s}, {u, v});
    }
  }
  add_grid_triangles(primitive, 0, segments, static_cast<int>(outline.size()) - 1);
  return primitive;
}

Primitive sphere(float radius, int segments) { return lathe(sphere_outline(radius, segments), 2 * segments); }

Primitive rounded_box(vec3 half_size, float bevel, int bevel_segments) {
  Primitive primitive;
  const int n = bevel_segments;
  // Along one side of a face: the inner box's corner and the tangent of the normal's angle, -45° … 0 and 0 … 45°.
  const auto corner = [n](int i) { return i <= n ? -1.0f : 1.0f; };
  const auto slope = [n](int i) {
    const int step = i <= n ? i - n : i - n - 1;
    return std::tan(radians(45.0f) * static_cast<float>(step) / static_cast<float>(n));
  };
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    vec3 normal(0.0f), across(0.0f);
    normal[axis] = face % 2 == 0 ? 1.0f : -1.0f;
    if (axis == 1) across.x = 1.0f;
    if (axis == 0) across.z = -normal.x;
    if (axis == 2) across.x = normal.z;
    const vec3 up = glm::cross(normal, across);
    const std::size_t first = primitive.positions.size();
    const vec3 inner = half_size - vec3(bevel);
    for (int j = 0; j <= 2 * n + 1; ++j) {
      for (int i = 0; i <= 2 * n + 1; ++i) {
        const vec3 direction = glm::normalize(normal + slope(i) * across + slope(j) * up);
        const vec3 position = inner * (normal + corner(i) * across + corner(j) * up) + bevel * direction;
        const vec3 unit = position / half_size;
        add_vertex(primitive, position, direction, across - direction * glm::dot(across, direction),
                   {0.5f + 0.5f * glm::dot(unit, across), 0.5f - 0.5f * glm::dot(unit, up)});
      }
    }
    add_grid_triangles(primitive, first, 2 * n + 1, 2 * n + 1);
  }
  return primitive;
}

Primitive torus_knot(int p, int q, float ring_radius, float knot_radius, float tube_radius, int segments, int sides,
                     vec2 uv_repeat) {
  const auto fp = static_cast<float>(p), fq = static_cast<float>(q);
  Primitive primitive;
  for (int i = 0; i <= segments; ++i) {
    const float t = 2.0f * kPi * static_cast<float>(i % segments) / static_cast<float>(segments);
    const float ring = ring_radius + knot_radius * std::cos(fq * t);
    const float ring_change = -fq * knot_radius * std::sin(fq * t);
    const float c = std::cos(fp * t), s = std::sin(fp * t);
    const vec3 center(ring * c, ring * s, knot_radius * std::sin(fq * t));
    const vec3 along = glm::normalize(
        vec3(ring_change * c - fp * ring * s, ring_change * s + fp * ring * c, fq * knot_radius * std::cos(fq * t)));
    // The torus' own normal turns smoothly and closes after one round.
    const vec3 torus_normal(std::cos(fq * t) * c, std::cos(fq * t) * s, std::sin(fq * t));
    const vec3 outward = glm::normalize(torus_normal - along * glm::dot(torus_normal, along));
    const vec3 sideways = glm::cross(along, outward);
    for (int j = 0; j <= sides; ++j) {
      const float angle = 2.0f * kPi * static_cast<float>(j % sides) / static_cast<float>(sides);
      const vec3 normal = std::cos(angle) * outward + std::sin(angle) * sideways;
      const vec2 uv(static_cast<float>(i) / static_cast<float>(segments),
                    static_cast<float>(j) / static_cast<float>(sides));
      add_vertex(primitive, center + tube_radius * normal, normal, along, uv * uv_repeat);
    }
  }
  add_grid_triangles(primitive, 0, sides, segments);
  return primitive;
}

Primitive quad(vec3 corner, vec3 edge_u, vec3 edge_v) {
  Primitive primitive;
  const vec3 normal = glm::cross(edge_u, edge_v);
  add_vertex(primitive, corner, normal, edge_u, {0.0f, 1.0f});
  add_vertex(primitive, corner + edge_u, normal, edge_u, {1.0f, 1.0f});
  add_vertex(primitive, corner + edge_v, normal, edge_u, {0.0f, 0.0f});
  add_vertex(primitive, corner + edge_u + edge_v, normal, edge_u, {1.0f, 0.0f});
  add_grid_triangles(primitive, 0, 1, 1);
  return primitive;
}

Primitive backdrop_sweep(float half_width, float front, float back, float radius, float height, int segments) {
  struct Step {
    vec2 position;  // (z, y)
    vec2 normal;
    float way;
  };
  std::vector<Step> steps{{{front, 0.0f}, {0.0f, 1.0f}, 0.0f}};
  for (int i = 0; i <= segments; ++i) {
    const float angle = 0.5f * kPi * static_cast<float>(i) / static_cast<float>(segments);
    const vec2 normal(std::sin(angle), std::cos(angle));
    steps.push_back({vec2(back + radius, radius) - radius * normal, normal, front - back - radius + radius * angle});
  }
  steps.push_back({{back, height}, {1.0f, 0.0f}, steps.back().way + height - radius});

  Primitive primitive;
  for (const Step& step : steps)
    for (const float x : {-half_width, half_width})
      add_vertex(primitive, {x, step.position.y, step.position.x}, {0.0f, step.normal.y, step.normal.x},
                 {1.0f, 0.0f, 0.0f}, {x, -step.way});
  add_grid_triangles(primitive, 0, 1, static_cast<int>(steps.size()) - 1);
  return primitive;
}

}  // namespace candela::content
