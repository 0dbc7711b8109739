#include "raster/body.h"

#include <algorithm>
#include <cmath>

namespace candela::raster {

namespace {

constexpr double kInside = 0.5;     // of all directions that are closed
constexpr double kLeastOwn = 0.25;  // of them by the body's own material: a room with windows is no body of glass

/// Share of all directions that triangles take up from a point, positive where they look away from it.
double winding(const Primitive& primitive, const mat4& world_from_node, vec3 point) {
  // Van Oosterom & Strackee 1983, "The Solid Angle of a Plane Triangle", eq. 8.
  std::vector<dvec3> corners;
  corners.reserve(primitive.positions.size());
  for (const vec3& p : primitive.positions)
    corners.push_back(dvec3(transform_point(world_from_node, p)) - dvec3(point));
  double sum = 0.0;
  for (const uvec3& t : primitive.triangles) {
    const dvec3 &a = corners[t.x], &b = corners[t.y], &c = corners[t.z];
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    const double above = glm::dot(a, glm::cross(b, c));
    const double below = la * lb * lc + glm::dot(a, b) * lc + glm::dot(a, c) * lb + glm::dot(b, c) * la;
    sum += std::atan2(above, below);
  }
  const double side = glm::determinant(mat3(world_from_node)) < 0.0f ? -1.0 : 1.0;
  return side * sum / (2.0 * glm::pi<double>());
}

struct Part {
  double own = 0.0, all = 0.0;
  double most = 0.0;  ///< by one primitive of a body's material
  int material = -1;
  Box3 bounds;

  float size() const { return glm::length(bounds.size()); }
};

Part make_part(const Scene& scene, const Node& node, vec3 point) {
  Part part;
  for (const Primitive& p : scene.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
    const double w = winding(p, node.world_from_node, point);
    part.all += w;
    for (const vec3& at : p.positions) part.bounds.extend(transform_point(node.world_from_node, at));
    if (!bounds_a_body(scene.materials[static_cast<std::size_t>(p.material)])) continue;
    part.own += w;
    if (part.material >= 0 && w <= part.most) continue;
    part.material = p.material, part.most = w;
  }
  return part;
}

bool has_body(const Scene& scene, const Node& node) {
  if (node.mesh < 0) return false;
  const auto& primitives = scene.meshes[static_cast<std::size_t>(node.mesh)].primitives;
  return std::any_of(primitives.begin(), primitives.end(), [&](const Primitive& p) {
    return bounds_a_body(scene.materials[static_cast<std::size_t>(p.material)]);
  });
}

}  // namespace

bool bounds_a_body(const Material& material) {
  return material.transmission > 0.0f && material.has_volume() && !material.unlit;
}

std::optional<Body> body_around(const Scene& scene, vec3 point) {
  if (std::none_of(scene.materials.begin(), scene.materials.end(), bounds_a_body)) return std::nullopt;
  std::vector<const Node*> nodes;
  Box3 bounds;
  for (const Node& node : scene.nodes) {
    if (!has_body(scene, node)) continue;
    nodes.push_back(&node);
    for (const Primitive& p : scene.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
      for (const vec3& at : p.positions) bounds.extend(transform_point(node.world_from_node, at));
    }
  }
  const bool is_near = !bounds.empty() && glm::all(glm::greaterThanEqual(point, bounds.lower)) &&
                       glm::all(glm::lessThanEqual(point, bounds.upper));
  if (!is_near) return std::nullopt;

  double own = 0.0, all = 0.0;
  std::vector<Part> parts;
  for (const Node* node : nodes) {
    const Part& part = parts.emplace_back(make_part(scene, *node, point));
    own += part.own, all += part.all;
  }
  if (own < kLeastOwn || all < kInside) return std::nullopt;
  // The innermost of those that are closed by themselves, else what closes most.
  const Part* best = nullptr;
  for (const Part& part : parts) {
    const bool is_closed = part.all >= kInside && part.own >= kLeastOwn;
    if (is_closed && (best == nullptr || part.size() < best->size())) best = &part;
  }
  if (best != nullptr) return Body{best->material, best->bounds};
  best = &*std::max_element(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.own < b.own; });
  return Body{best->material, bounds};
}

}  // namespace candela::raster
