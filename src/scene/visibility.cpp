#include "scene/visibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "math/box.h"

namespace candela {

namespace {

using glm::dmat4;
using Plane = glm::dvec4;  ///< inside where dot(plane, (p, 1)) >= 0

Box3 bounds_of(const Mesh& mesh) {
  Box3 box;
  for (const Primitive& primitive : mesh.primitives) {
    for (const vec3 p : primitive.positions) box.extend(p);
  }
  return box;
}

/// The sides of what the picture shows, its near and its far plane, in the camera's space.
std::vector<Plane> sides_of(const View& view) {
  const Plane near(0, 0, -1, -static_cast<double>(view.near_plane));
  std::vector<Plane> planes = {near};
  if (view.far_plane < kInfinity) planes.emplace_back(0, 0, 1, view.far_plane);
  if (const auto* o = std::get_if<OrthographicCamera>(&view.projection)) {
    planes.insert(planes.end(), {{1, 0, 0, o->xmag}, {-1, 0, 0, o->xmag}, {0, 1, 0, o->ymag}, {0, -1, 0, o->ymag}});
    return planes;
  }
  const auto& p = std::get<PerspectiveCamera>(view.projection);
  const double y = std::tan(0.5 * static_cast<double>(p.yfov));
  const double x = y * static_cast<double>(p.aspect_ratio.value_or(1.0f));
  planes.insert(planes.end(), {{1, 0, -x, 0}, {-1, 0, -x, 0}, {0, 1, -y, 0}, {0, -1, -y, 0}});
  return planes;
}

double above(const Plane& plane, const dvec3& p) { return glm::dot(dvec3(plane), p) + plane.w; }

/// Sutherland and Hodgman 1974: cut by one plane after another until nothing is left.
bool is_cut_away(const std::array<dvec3, 3>& triangle, const std::vector<Plane>& planes) {
  std::vector<dvec3> polygon(triangle.begin(), triangle.end()), left;
  for (const Plane& plane : planes) {
    left.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double over_a = above(plane, a), over_b = above(plane, b);
      if (over_a > 0.0) left.push_back(a);
      if ((over_a > 0.0) != (over_b > 0.0)) left.push_back(a + (b - a) * (over_a / (over_a - over_b)));
    }
    if (left.size() < 3) return true;
    std::swap(polygon, left);
  }
  return false;
}

bool sees_mesh(const Mesh& mesh, const Box3& box, const dmat4& camera_from_mesh, const std::vector<Plane>& planes) {
  const auto seen = [&](const dvec3& p) { return dvec3(camera_from_mesh * glm::dvec4(p, 1.0)); };
  for (const Plane& plane : planes) {
    bool is_outside = true;
    for (const vec3 p : corners(box)) is_outside &= above(plane, seen(p)) <= 0.0;
    if (is_outside) return false;
  }
  for (const Primitive& primitive : mesh.primitives) {
    for (const uvec3& t : primitive.triangles) {
      const std::array corners = {seen(dvec3(primitive.positions[t.x])), seen(dvec3(primitive.positions[t.y])),
                                  seen(dvec3(primitive.positions[t.z]))};
      const bool is_outside = std::any_of(planes.begin(), planes.end(), [&](const Plane& plane) {
        return above(plane, corners[0]) <= 0.0 && above(plane, corners[1]) <= 0.0 && above(plane, corners[2]) <= 0.0;
      });
      if (!is_outside && !is_cut_away(corners, planes)) return true;
    }
  }
  return false;
}

float component_quantile(std::vector<float>& values, double share) {
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

/// Calls `f(node, world_from_node, primitive)` for everything that is placed.
template <class F>
void for_each_placed(const Scene& scene, const F& f) {
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    if (scene.nodes[n].mesh < 0) continue;
    for (const Primitive& p : scene.meshes[static_cast<std::size_t>(scene.nodes[n].mesh)].primitives) {
      f(n, scene.nodes[n].world_from_node, p);
    }
  }
}

/// Whether all surfaces together have so much area.
bool has_area(const Scene& scene, double least) {
  double area = 0.0;
  for_each_placed(scene, [&](std::size_t, const mat4& world, const Primitive& p) {
    for (const uvec3& t : p.triangles) {
      if (area >= least) return;
      const dvec3 a(transform_point(world, p.positions[t.x])), b(transform_point(world, p.positions[t.y])),
          c(transform_point(world, p.positions[t.z]));
      area += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
  });
  return area >= least;
}

/// The vertex that is farthest from a point, and its node.
struct FarVertex {
  vec3 position{0.0f};
  float distance = -1.0f;
  std::size_t node = 0;
};

FarVertex farthest_from(const Scene& scene, vec3 point) {
  FarVertex far;
  for_each_placed(scene, [&](std::size_t node, const mat4& world, const Primitive& p) {
    for (const vec3 local : p.positions) {
      const vec3 position = transform_point(world, local);
      const float distance = glm::length(position - point);
      if (distance > far.distance) far = {position, distance, node};
    }
  });
  return far;
}

std::string node_text(const Scene& scene, std::size_t node) {
  const std::string& name = scene.nodes[node].name;
  return fmt::format("node {}{}", number_of(scene.nodes, node), name.empty() ? "" : fmt::format(" '{}'", name));
}

/// Vertices, one in so many where there are very many.
std::vector<vec3> sample_vertices(const Scene& scene) {
  constexpr std::size_t kMost = 1 << 20;
  std::size_t count = 0;
  for_each_placed(scene, [&](std::size_t, const mat4&, const Primitive& p) { count += p.positions.size(); });
  const std::size_t stride = count / kMost + 1;
  std::vector<vec3> points;
  std::size_t next = 0;
  for_each_placed(scene, [&](std::size_t, const mat4& world, const Primitive& p) {
    for (; next < p.positions.size(); next += stride) points.push_back(transform_point(world, p.positions[next]));
    next -= p.positions.size();
  });
  return points;
}

/// A few vertices far from nearly all others.
std::optional<Diagnostic> find_far_vertex(const Scene& scene, float whole) {
  // Framed, nine tenths of the vertices are less than a hundredth of the picture wide, and all surfaces together less
  // than a two-hundredth part of it: a dot with a hairline to the stray. A floor as wide as that is something to see.
  constexpr float kSmall = 0.01f;
  constexpr double kLeastShare = 5e-3;
  std::vector<vec3> points = sample_vertices(scene);
  if (points.empty()) return std::nullopt;
  vec3 middle;
  std::vector<float> values(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i][axis];
    middle[axis] = component_quantile(values, 0.5);
  }
  for (std::size_t i = 0; i < points.size(); ++i) values[i] = glm::length(points[i] - middle);
  const float most = component_quantile(values, 0.9);
  if (2.0f * most >= kSmall * whole) return std::nullopt;
  if (has_area(scene, kLeastShare * static_cast<double>(whole) * static_cast<double>(whole))) return std::nullopt;

  const FarVertex far = farthest_from(scene, middle);
  return Diagnostic{fmt::format("{} has a vertex {:.3g} m from the rest, nine tenths of which lie within {:.3g} m: "
                                "framed as a whole, the scene shows next to nothing",
                                node_text(scene, far.node), far.distance, most),
                    {}};
}

/// Things so far apart that each is a dot, whichever of them are more.
std::optional<Diagnostic> find_far_things(const Scene& scene, vec3 middle, float whole, int picture_size) {
  constexpr int kLeastSize = 240;  // a thumbnail shows no wires either, which are no oddity
  const double pixel = static_cast<double>(whole) / static_cast<double>(std::max(picture_size, kLeastSize));
  if (has_area(scene, pixel * pixel)) return std::nullopt;
  const FarVertex one = farthest_from(scene, middle);
  const FarVertex other = farthest_from(scene, one.position);
  const std::string who = one.node == other.node ? "vertices of " + node_text(scene, one.node)
                                                 : node_text(scene, std::min(one.node, other.node)) + " and " +
                                                       node_text(scene, std::max(one.node, other.node));
  return Diagnostic{fmt::format("{} lie {:.3g} m apart, beside which all surfaces together are smaller than a pixel: "
                                "framed as a whole, the scene shows nothing",
                                who, other.distance),
                    {}};
}

}  // namespace

bool sees_something(const Scene& scene, const View& view) {
  const std::vector<Plane> planes = sides_of(view);
  const dmat4 camera_from_world = glm::inverse(dmat4(view.world_from_camera));
  std::vector<Box3> boxes;
  boxes.reserve(scene.meshes.size());
  for (const Mesh& mesh : scene.meshes) boxes.push_back(bounds_of(mesh));
  return std::any_of(scene.nodes.begin(), scene.nodes.end(), [&](const Node& node) {
    if (node.mesh < 0) return false;
    const auto mesh = static_cast<std::size_t>(node.mesh);
    return !boxes[mesh].empty() &&
           sees_mesh(scene.meshes[mesh], boxes[mesh], camera_from_world * dmat4(node.world_from_node), planes);
  });
}

std::optional<Diagnostic> find_emptiness(const Scene& scene, int picture_size) {
  const Box3 bounds = world_bounds(scene);
  if (!bounds.empty()) {
    const float whole = glm::length(bounds.size());
    if (!(whole > 0.0f)) return std::nullopt;
    const auto far = find_far_vertex(scene, whole);
    return far ? far : find_far_things(scene, bounds.center(), whole, picture_size);
  }
  const bool is_hidden =
      std::any_of(scene.nodes.begin(), scene.nodes.end(), [](const Node& node) { return node.is_hidden; });
  if (is_hidden) return Diagnostic{"nothing in the scene that is not hidden has a mesh", {}};
  return Diagnostic{scene.meshes.empty() ? "nothing in the scene has a mesh" : "no mesh of the scene has a triangle",
                    {}};
}

}  // namespace candela
