#include "path/bodies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <unordered_map>

#include "math/box.h"
#include "math/position_hash.h"
#include "path/surface_point.h"

namespace candela::path {

namespace {

constexpr float kWeld = 1e-5f;  // of a part's longest side: what exporters round, and no detail

/// The faces that a node has of one material.
struct Part {
  std::vector<int> placements;
  Box3 bounds;
  float weld = 0.0f;  ///< ends of edges nearer than this are one
};

/// An edge that faces of a part lie on one side of only. They are to the left of a → b, seen from the front.
struct OpenEdge {
  vec3 a, b;
};

std::vector<Part> find_parts(const std::vector<Placement>& placements) {
  std::vector<Part> parts;
  std::map<const MaterialData*, std::size_t> of_node;
  for (std::size_t i = 0; i < placements.size(); ++i) {
    if (i > 0 && placements[i].node != placements[i - 1].node) of_node.clear();
    const MaterialData* material = placements[i].mesh->material;
    if (!material->has_medium) continue;
    const auto [found, is_new] = of_node.try_emplace(material, parts.size());
    if (is_new) parts.emplace_back();
    parts[found->second].placements.push_back(static_cast<int>(i));
  }
  return parts;
}

/// The edges of a mesh, in its own space, whose faces on both sides do not make up for each other.
std::vector<OpenEdge> find_open_edges(const std::vector<const MeshData*>& meshes) {
  struct Edge {
    std::uint32_t low, high;
    int side;
  };
  std::unordered_map<vec3, std::uint32_t, PositionHash> index_of;
  std::vector<vec3> positions;
  std::vector<Edge> edges;
  for (const MeshData* mesh : meshes) {
    std::vector<std::uint32_t> index(mesh->vertices.size());
    for (std::size_t i = 0; i < index.size(); ++i) {
      const vec3 p = mesh->vertices[i].position + 0.0f;  // -0 is 0
      const auto [found, is_new] = index_of.try_emplace(p, static_cast<std::uint32_t>(positions.size()));
      if (is_new) positions.push_back(p);
      index[i] = found->second;
    }
    for (const uvec3& t : mesh->triangles) {
      const std::array<std::uint32_t, 3> v{index[t.x], index[t.y], index[t.z]};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = v[k];
        const std::uint32_t b = v[(k + 1) % 3];
        if (a != b) edges.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
      }
    }
  }
  std::sort(edges.begin(), edges.end(),
            [](const Edge& x, const Edge& y) { return x.low != y.low ? x.low < y.low : x.high < y.high; });
  std::vector<OpenEdge> open;
  for (std::size_t i = 0; i < edges.size();) {
    int balance = 0;
    std::size_t end = i;
    for (; end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high; ++end) {
      balance += edges[end].side;
    }
    const vec3 low = positions[edges[i].low];
    const vec3 high = positions[edges[i].high];
    for (int k = 0; k < std::abs(balance); ++k) open.push_back(balance > 0 ? OpenEdge{low, high} : OpenEdge{high, low});
    i = end;
  }
  return open;
}

/// Gives points one number when they are nearer than the smaller of their tolerances. Points wait in grids of cells
/// as large as their tolerance, to a power of two, so that a cell never holds many.
class Welder {
 public:
  std::uint32_t number(vec3 p, float tolerance) {
    const int level = std::ilogb(tolerance) + 1;
    for (auto& [l, cells] : levels_) {
      const float size = std::ldexp(1.0f, l);
      for (int k = 0; k < 27; ++k) {
        const auto found = cells.find(cell(p, size) + glm::vec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
        if (found == cells.end()) continue;
        for (const std::uint32_t i : found->second) {
          if (glm::distance(points_[i], p) <= std::min(tolerances_[i], tolerance)) return i;
        }
      }
    }
    const auto index = static_cast<std::uint32_t>(points_.size());
    points_.push_back(p);
    tolerances_.push_back(tolerance);
    levels_[level][cell(p, std::ldexp(1.0f, level))].push_back(index);
    return index;
  }

 private:
  static vec3 cell(vec3 p, float size) { return glm::floor(p / size) + 0.0f; }

  std::vector<vec3> points_;
  std::vector<float> tolerances_;
  std::map<int, std::unordered_map<vec3, std::vector<std::uint32_t>, PositionHash>> levels_;
};

using Boxes = std::unordered_map<const MeshData*, Box3>;

void measure(const std::vector<Placement>& placements, Boxes& boxes, Part& part) {
  for (const int i : part.placements) {
    const Placement& placement = placements[static_cast<std::size_t>(i)];
    const auto [found, is_new] = boxes.try_emplace(placement.mesh);
    Box3& box = found->second;
    if (is_new) {
      for (const ShadeVertex& v : placement.mesh->vertices) box.extend(v.position);
    }
    for (const vec3 p : corners(box)) {
      part.bounds.extend(placement.is_world ? p : transform_point(placement.world_from_object, p));
    }
  }
  // Not below what single precision tells apart there.
  constexpr float kRounding = 0x1p-21f;
  const float largest = max_component(glm::max(glm::abs(part.bounds.lower), glm::abs(part.bounds.upper)));
  part.weld = std::max({kWeld * max_component(part.bounds.size()), kRounding * largest, 1e-30f});
}

/// Sets of parts that hang together.
class Sets {
 public:
  explicit Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
  std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) {
    a = find(a), b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

/// Joins parts whose open edges meet; returns how many edges each part has left.
std::vector<std::size_t> join_parts(const std::vector<Placement>& placements, const std::vector<Part>& parts,
                                    Sets& sets) {
  std::unordered_map<const MeshData*, std::vector<OpenEdge>> open_of;   // by the first mesh of a part
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> waiting;  // parts, by edge
  std::vector<std::size_t> left(parts.size(), 0);
  Welder welder;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    std::vector<const MeshData*> meshes;
    for (const int k : parts[i].placements) meshes.push_back(placements[static_cast<std::size_t>(k)].mesh);
    const auto [open, is_new] = open_of.try_emplace(meshes.front());
    if (is_new) open->second = find_open_edges(meshes);
    const Placement& placement = placements[static_cast<std::size_t>(parts[i].placements.front())];
    for (const OpenEdge& edge : open->second) {
      const auto to_world = [&](vec3 p) {
        return welder.number(placement.is_world ? p : transform_point(placement.world_from_object, p), parts[i].weld);
      };
      std::uint64_t a = to_world(edge.a);
      std::uint64_t b = to_world(edge.b);
      if (a == b) continue;
      if (placement.is_mirrored) std::swap(a, b);
      const auto other = waiting.find(b << 32 | a);
      if (other != waiting.end() && !other->second.empty()) {
        sets.join(i, other->second.back());
        --left[other->second.back()];
        other->second.pop_back();
      } else {
        waiting[a << 32 | b].push_back(i);
        ++left[i];
      }
    }
  }
  return left;
}

/// The faces of a body.
class Shell {
 public:
  Shell(const std::vector<Placement>& placements, int body) {
    for (const Placement& p : placements) {
      if (p.body == body) placements_.push_back(&p);
    }
  }

  /// Negative where the faces look inwards.
  double volume() const {
    const dvec3 origin(vertex());
    double sum = 0.0;
    for_triangles([&](dvec3 a, dvec3 b, dvec3 c, double side) {
      sum += side * glm::dot(a - origin, glm::cross(b - origin, c - origin));
    });
    return sum / 6.0;
  }
  /// Some point of the faces.
  vec3 vertex() const { return triangle_positions(*placements_.front(), 0).p0; }
  /// By the solid angle that the faces cover around a point: van Oosterom & Strackee 1983, "The Solid Angle of a Plane
  /// Triangle".
  bool contains(vec3 point) const {
    const dvec3 eye(point);
    double sum = 0.0;
    for_triangles([&](dvec3 p, dvec3 q, dvec3 r, double side) {
      const dvec3 a = p - eye, b = q - eye, c = r - eye;
      const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
      sum += side * std::atan2(glm::dot(a, glm::cross(b, c)),
                               la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
    });
    return sum > kPi;  // half of 4π, of which atan2 gives half
  }

 private:
  template <class Visit>
  void for_triangles(Visit visit) const {
    for (const Placement* p : placements_) {
      for (std::uint32_t i = 0; i < p->mesh->triangles.size(); ++i) {
        const TrianglePositions t = triangle_positions(*p, i);
        visit(dvec3(t.p0), dvec3(t.p1), dvec3(t.p2), p->is_mirrored ? -1.0 : 1.0);
      }
    }
  }

  std::vector<const Placement*> placements_;
};

bool lies_within(const Box3& inner, const Box3& outer) {
  return glm::all(glm::greaterThanEqual(inner.lower, outer.lower)) &&
         glm::all(glm::lessThanEqual(inner.upper, outer.upper));
}

/// Gives the walls of hollows to the bodies that they are in.
void join_hollows(const std::vector<Body>& bodies, std::vector<Placement>& placements) {
  std::vector<bool> is_joined(bodies.size(), false);
  const auto may_contain = [&](std::size_t outer, std::size_t inner) {
    return outer != inner && !is_joined[outer] && !bodies[outer].is_open &&
           lies_within(bodies[inner].bounds, bodies[outer].bounds);
  };
  for (std::size_t inner = 1; inner < bodies.size(); ++inner) {
    std::vector<std::size_t> around;
    for (std::size_t outer = 1; outer < bodies.size(); ++outer) {
      if (may_contain(outer, inner)) around.push_back(outer);
    }
    if (bodies[inner].is_open || around.empty()) continue;
    const Shell wall(placements, static_cast<int>(inner));
    if (wall.volume() >= 0.0) continue;
    double smallest = std::numeric_limits<double>::infinity();
    int found = 0;
    for (const std::size_t outer : around) {
      const Shell shell(placements, static_cast<int>(outer));
      const double volume = shell.volume();
      if (volume <= 0.0 || volume >= smallest || !shell.contains(wall.vertex())) continue;
      smallest = volume;
      found = static_cast<int>(outer);
    }
    if (found == 0) continue;
    is_joined[inner] = true;
    for (Placement& p : placements) {
      if (p.body == static_cast<int>(inner)) p.body = found;
    }
  }
}

}  // namespace

std::vector<Body> find_bodies(std::vector<Placement>& placements) {
  std::vector<Body> bodies(1);
  std::vector<Part> parts = find_parts(placements);
  Boxes boxes;
  for (Part& part : parts) measure(placements, boxes, part);
  Sets sets(parts.size());
  const std::vector<std::size_t> left = join_parts(placements, parts, sets);
  std::vector<int> body_of(parts.size(), 0);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    int& body = body_of[sets.find(i)];
    if (body == 0) {
      body = static_cast<int>(bodies.size());
      bodies.emplace_back();
    }
    Body& target = bodies[static_cast<std::size_t>(body)];
    target.is_open = target.is_open || left[i] > 0;
    target.bounds.extend(parts[i].bounds);
    for (const int k : parts[i].placements) placements[static_cast<std::size_t>(k)].body = body;
  }
  join_hollows(bodies, placements);
  return bodies;
}

bool may_be_inside(const Geometry& geometry, const Box3& region) {
  const std::vector<Body>& bodies = geometry.bodies();
  return std::any_of(bodies.begin() + 1, bodies.end(), [&](const Body& body) {
    return glm::all(glm::lessThanEqual(region.lower, body.bounds.upper)) &&
           glm::all(glm::lessThanEqual(body.bounds.lower, region.upper));
  });
}

MediumStack bodies_around(const Geometry& geometry, vec3 point) {
  MediumStack stack;
  Box3 here;
  here.extend(point);
  if (!may_be_inside(geometry, here)) return stack;

  // Along no axis and no diagonal, on which edges like to lie.
  constexpr int kDirections = 7;
  constexpr float kGolden = 2.39996323f;  // the golden angle spreads them over the sphere
  struct Found {
    int votes = 0;
    float distance = 0.0f;  ///< sum of the ways out
    const Medium* medium = nullptr;
  };
  std::map<int, Found> found;
  for (int k = 0; k < kDirections; ++k) {
    const float z = 1.0f - (2.0f * static_cast<float>(k) + 1.0f) / static_cast<float>(kDirections);
    const float r = std::sqrt(1.0f - z * z);
    const float phi = kGolden * (static_cast<float>(k) + 0.37f);
    const vec3 direction = glm::normalize(vec3(r * std::cos(phi), z + 0.013f, r * std::sin(phi)));
    struct Along {
      int out = 0;
      float nearest = kInfinity;
      const Medium* medium = nullptr;
    };
    std::map<int, Along> along;
    for (const Hit& hit : geometry.find_boundaries({point, direction, 0.0f, kInfinity})) {
      Along& a = along[geometry.placement(hit.placement).body];
      const bool is_out = is_back_hit(geometry, hit, direction);
      a.out += is_out ? 1 : -1;
      if (is_out && hit.t < a.nearest) {
        a.nearest = hit.t;
        a.medium = &geometry.placement(hit.placement).mesh->material->medium;
      }
    }
    for (const auto& [body, a] : along) {
      if (a.out <= 0) continue;
      Found& f = found[body];
      ++f.votes;
      f.distance += a.nearest;
      f.medium = a.medium;
    }
  }

  // ----- outermost first: the way out of what lies within another body is shorter in every direction
  std::vector<std::pair<float, int>> order;
  for (const auto& [body, f] : found) {
    if (2 * f.votes > kDirections) order.emplace_back(-f.distance / static_cast<float>(f.votes), body);
  }
  std::sort(order.begin(), order.end());
  for (const auto& [distance, body] : order) stack.enter(body, found[body].medium);
  return stack;
}

}  // namespace candela::path
