#include "path/empty_pixels.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace candela::path {

namespace {

/// A triangle on the film, without what is nearer than some depth: a convex polygon.
struct FilmPolygon {
  std::array<dvec2, 4> corners;
  std::size_t size = 0;
};

FilmPolygon project(const Camera::Pinhole& camera, const std::array<dvec3, 3>& triangle, double nearest) {
  FilmPolygon polygon;
  for (std::size_t i = 0; i < 3; ++i) {
    const dvec3& p = triangle[i];
    const dvec3& q = triangle[(i + 1) % 3];
    const bool is_in_front = -p.z >= nearest;
    if (is_in_front) polygon.corners[polygon.size++] = camera.film(p);
    if (is_in_front == (-q.z >= nearest)) continue;
    dvec3 on_plane = glm::mix(p, q, (nearest + p.z) / (p.z - q.z));
    on_plane.z = -nearest;
    polygon.corners[polygon.size++] = camera.film(on_plane);
  }
  return polygon;
}

/// Whether the plane of a triangle passes the eye within `distance`, as far as anybody knows.
bool is_plane_near(const std::array<dvec3, 3>& triangle, double distance) {
  const dvec3 normal = glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
  return !(std::abs(glm::dot(normal, triangle[0])) > distance * glm::length(normal));
}

struct Interval {
  double lower = std::numeric_limits<double>::infinity();
  double upper = -std::numeric_limits<double>::infinity();
  void extend(double v) {
    lower = std::min(lower, v);
    upper = std::max(upper, v);
  }
};

/// What a convex polygon covers along x between two heights.
Interval across(const FilmPolygon& polygon, double top, double bottom) {
  Interval x;
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const dvec2 p = polygon.corners[i];
    const dvec2 q = polygon.corners[(i + 1) % polygon.size];
    if (std::max(p.y, q.y) < top || std::min(p.y, q.y) > bottom) continue;
    const double slope = p.y == q.y ? 0.0 : (q.x - p.x) / (q.y - p.y);
    for (const dvec2 end : {p, q}) x.extend(end.x + slope * (std::clamp(end.y, top, bottom) - end.y));
  }
  return x;
}

/// Pixels of a row or column, first and one past the last, that numbers of the film reach.
ivec2 pixels_of(Interval on_film, double reach, int count) {
  const auto pixel = [&](double v) { return static_cast<int>(std::clamp(std::floor(v), 0.0, double(count))); };
  // Pixel i is met where |i + ½ - v| ≤ reach.
  return {pixel(on_film.lower - reach + 0.5), std::min(pixel(on_film.upper + reach - 0.5) + 1, count)};
}

void cover(const FilmPolygon& polygon, double reach, ivec2 size, std::vector<std::uint8_t>& covered) {
  Interval y;
  for (std::size_t i = 0; i < polygon.size; ++i) y.extend(polygon.corners[i].y);
  const ivec2 rows = pixels_of(y, reach, size.y);
  for (int row = rows[0]; row < rows[1]; ++row) {
    const ivec2 columns = pixels_of(across(polygon, row + 0.5 - reach, row + 0.5 + reach), reach, size.x);
    for (int column = columns[0]; column < columns[1]; ++column) {
      std::uint8_t& pixel =
          covered[static_cast<std::size_t>(row) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(column)];
      // Triangles are projected by several threads.
      std::atomic_ref(pixel).store(1, std::memory_order_relaxed);
    }
  }
}

double largest_coordinate(vec3 p) { return static_cast<double>(max_component(glm::abs(p))); }

}  // namespace

std::vector<std::uint8_t> find_covered_pixels(const Geometry& geometry, const Camera::Pinhole& camera, float radius) {
  // Rays meet what is this share of the coordinates beside them: sixteen roundings.
  constexpr double kRoundings = 16.0 * 0x1p-24;
  constexpr double kSlack = 0.25;       // pixels that this may come to on the film
  constexpr std::size_t kGrain = 4096;  // triangles
  const ivec2 size(camera.film_size);
  std::vector<std::uint8_t> covered(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y), 0);
  const dvec2 scale = 0.5 * camera.film_size / camera.half_extent;
  const double longest = glm::length(dvec3(camera.half_extent, 1.0));  // of the directions whose depth is 1
  const glm::dmat3& m = camera.camera_from_world;
  const double units = std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
  std::atomic<bool> is_vague = false;
  for (const Placement& placement : geometry.placements()) {
    const double offset =
        largest_coordinate(vec3(camera.eye)) + largest_coordinate(vec3(placement.world_from_object[3]));
    parallel_for(0, placement.mesh->triangles.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end && !is_vague; ++i) {
        const TrianglePositions p = triangle_positions(placement, static_cast<std::uint32_t>(i));
        const std::array<dvec3, 3> seen = {camera.from_world(p.p0), camera.from_world(p.p1), camera.from_world(p.p2)};
        const double farthest =
            std::max({largest_coordinate(p.p0), largest_coordinate(p.p1), largest_coordinate(p.p2)});
        // What is nearer than this may be seen further beside than the slack.
        const double nearest = units * kRoundings * (offset + farthest) * std::max(scale.x, scale.y) / kSlack;
        const auto [back, front] = std::minmax({seen[0].z, seen[1].z, seen[2].z});
        if (!(front < -nearest) && !(back > nearest) && is_plane_near(seen, nearest * longest)) {
          is_vague = true;
        } else {
          cover(project(camera, seen, nearest), static_cast<double>(radius) + kSlack, size, covered);
        }
      }
    });
  }
  if (is_vague) covered.assign(covered.size(), 1);
  return covered;
}

}  // namespace candela::path
