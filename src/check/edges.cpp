#include "check/edges.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "math/hash.h"

namespace candela::check {

namespace {

using Cell = glm::i64vec3;

struct CellHash {
  std::size_t operator()(const Cell& c) const {
    const auto mix = [](std::uint32_t seed, std::int64_t v) {
      return hash_combine(hash_combine(seed, static_cast<std::uint32_t>(v)), static_cast<std::uint32_t>(v >> 32));
    };
    return mix(mix(mix(0, c.x), c.y), c.z);
  }
};

/// For each vertex the first one within `distance` of it. Cells are twice as wide, so that what is near lies in at most
/// eight of them.
std::vector<std::uint32_t> weld(std::span<const vec3> positions, float distance) {
  std::vector<std::uint32_t> result(positions.size());
  // Each cell knows its last vertex, each vertex the one before it in its cell.
  constexpr std::uint32_t kNone = 0xFFFFFFFF;
  std::unordered_map<Cell, std::uint32_t, CellHash> last;
  std::vector<std::uint32_t> before(positions.size(), kNone);
  const double width = std::max(2.0 * static_cast<double>(distance), 1e-30);
  const auto cell_of = [width](const dvec3& p) { return Cell(glm::floor(p / width)); };
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const dvec3 p(positions[i]);
    const Cell low = cell_of(p - static_cast<double>(distance));
    const Cell high = cell_of(p + static_cast<double>(distance));
    std::uint32_t found = static_cast<std::uint32_t>(i);
    for (std::int64_t z = low.z; z <= high.z; ++z) {
      for (std::int64_t y = low.y; y <= high.y; ++y) {
        for (std::int64_t x = low.x; x <= high.x; ++x) {
          const auto near = last.find(Cell(x, y, z));
          if (near == last.end()) continue;
          for (std::uint32_t other = near->second; other != kNone; other = before[other]) {
            if (glm::length(dvec3(positions[other]) - p) <= distance) found = std::min(found, other);
          }
        }
      }
    }
    result[i] = found;
    if (found != i) continue;
    const auto [own, is_new] = last.try_emplace(cell_of(p), found);
    if (!is_new) before[i] = std::exchange(own->second, found);
  }
  return result;
}

struct Edge {
  std::uint32_t low, high;
  std::uint32_t triangle;
  bool is_forward;  ///< from low to high
};

/// Disjoint sets of triangles. Tarjan 1975, by path halving.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace

std::size_t EdgeReport::inside_out() const {
  const auto lies_in = [](const Part& inner, const Part& outer) {
    return outer.volume > 0.0 && glm::all(glm::lessThanEqual(outer.box.lower, inner.box.lower)) &&
           glm::all(glm::greaterThanEqual(outer.box.upper, inner.box.upper));
  };
  return static_cast<std::size_t>(std::count_if(parts.begin(), parts.end(), [&](const Part& part) {
    return part.is_closed && part.volume < 0.0 &&
           std::none_of(parts.begin(), parts.end(), [&](const Part& other) { return lies_in(part, other); });
  }));
}

EdgeReport inspect_edges(std::span<const vec3> positions, std::span<const uvec3> triangles, float weld_distance) {
  const std::vector<std::uint32_t> welded = weld(positions, weld_distance);
  std::vector<uvec3> faces;
  std::vector<Edge> edges;
  for (const uvec3& t : triangles) {
    const uvec3 f(welded[t.x], welded[t.y], welded[t.z]);
    if (f.x == f.y || f.y == f.z || f.z == f.x) continue;
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = f[i], b = f[(i + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(faces.size()), a < b});
    }
    faces.push_back(f);
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });

  EdgeReport report;
  Sets sets(faces.size());
  std::vector<bool> is_open(faces.size(), false);
  for (std::size_t first = 0; first < edges.size();) {
    std::size_t end = first;
    std::size_t forward = 0;
    for (; end < edges.size() && edges[end].low == edges[first].low && edges[end].high == edges[first].high; ++end) {
      forward += edges[end].is_forward ? 1 : 0;
      sets.join(edges[first].triangle, edges[end].triangle);
    }
    const std::size_t count = end - first;
    ++report.edges;
    if (count != 2 * forward) {
      ++(count == 1 ? report.boundary : count == 2 ? report.inconsistent : report.non_manifold);
      is_open[edges[first].triangle] = true;
    }
    first = end;
  }

  std::unordered_map<std::uint32_t, std::size_t> part_of_root;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto [found, is_new] =
        part_of_root.try_emplace(sets.find(static_cast<std::uint32_t>(i)), report.parts.size());
    if (is_new) report.parts.emplace_back();
    EdgeReport::Part& part = report.parts[found->second];
    const vec3 a = positions[faces[i].x], b = positions[faces[i].y], c = positions[faces[i].z];
    if (is_new) part.box = Box3{a, a};
    for (const vec3 p : {a, b, c}) part.box.extend(p);
    // Seen from a point near by, so that far from the origin no digits are lost.
    const dvec3 origin(positions[faces[0].x]);
    part.volume += glm::dot(dvec3(a) - origin, glm::cross(dvec3(b) - origin, dvec3(c) - origin)) / 6.0;
    if (is_open[i]) part.is_closed = false;
  }
  return report;
}

float default_weld_distance(std::span<const vec3> positions) {
  Box3 box;
  for (const vec3 p : positions) box.extend(p);
  constexpr float kRelative = 1e-5f;
  return box.empty() ? 0.0f : kRelative * max_component(box.size());
}

}  // namespace candela::check
