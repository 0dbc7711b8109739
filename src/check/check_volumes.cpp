#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "check/body_rays.h"
#include "check/check_parts.h"
#include "check/edges.h"

// Bodies that light can enter (KHR_materials_volume): whether they are closed, which way they face, and how thick they
// are.
namespace candela::check {

namespace {

// Rays that slip through closed meshes by rounding are far fewer.
constexpr double kLeak = 0.005;
// A body is not everywhere equally thick, and authors enter radius, diameter or mean.
constexpr double kThicknessFactor = 4.0;
constexpr float kClearestBody = 0.999f;
constexpr float kDarkestBody = 0.001f;

bool is_body(const Material& m) {
  return m.has_volume() && (m.transmission > 0.0f || m.diffuse_transmission > 0.0f) && !m.unlit;
}

/// The triangles of a mesh that wear one material.
EdgeReport inspect_mesh(const Mesh& mesh, int material) {
  std::vector<vec3> positions;
  std::vector<uvec3> triangles;
  for (const Primitive& p : mesh.primitives) {
    if (p.material != material) continue;
    const auto first = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), p.positions.begin(), p.positions.end());
    for (const uvec3& t : p.triangles) triangles.push_back(t + first);
  }
  return inspect_edges(positions, triangles, default_weld_distance(positions));
}

float median(std::vector<float> values) {
  if (values.empty()) return 0.0f;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// What the meshes in which a material bounds bodies look like, together.
struct Shape {
  std::size_t edges = 0, boundary = 0, inconsistent = 0, non_manifold = 0;
  std::size_t inside_out = 0;  ///< closed parts

  bool is_closed() const { return boundary + inconsistent + non_manifold == 0; }
};

Box3 world_box(const Node& node, const Primitive& primitive) {
  Box3 box;
  for (const vec3& p : primitive.positions) box.extend(transform_point(node.world_from_node, p));
  return box;
}

/// Whether what wears the material in a mesh lies, wherever the mesh stands, within another body: the wall of a hollow
/// in that, which may be a node, a primitive or a material of its own.
bool is_wall_of_hollow(const Scene& scene, const Mesh& mesh, int material) {
  struct Placed {
    Box3 box;
    bool is_wall = false;
  };
  std::vector<Placed> all;
  for (const Node& node : scene.nodes) {
    if (node.mesh < 0) continue;
    const Mesh& of_node = scene.meshes[static_cast<std::size_t>(node.mesh)];
    for (const Primitive& p : of_node.primitives) {
      if (!is_body(scene.materials[static_cast<std::size_t>(p.material)])) continue;
      all.push_back({world_box(node, p), &of_node == &mesh && p.material == material});
    }
  }
  const auto is_around = [](const Box3& outer, const Box3& inner) {
    return glm::all(glm::lessThanEqual(outer.lower, inner.lower)) &&
           glm::all(glm::greaterThanEqual(outer.upper, inner.upper));
  };
  return std::all_of(all.begin(), all.end(), [&](const Placed& wall) {
    return !wall.is_wall || std::any_of(all.begin(), all.end(), [&](const Placed& body) {
      return !body.is_wall && is_around(body.box, wall.box);
    });
  });
}

Shape inspect_material(const Scene& scene, int material) {
  Shape total;
  for (const Mesh& mesh : scene.meshes) {
    const bool wears = std::any_of(mesh.primitives.begin(), mesh.primitives.end(),
                                   [material](const Primitive& p) { return p.material == material; });
    if (!wears) continue;
    const EdgeReport report = inspect_mesh(mesh, material);
    total.edges += report.edges;
    total.boundary += report.boundary;
    total.inconsistent += report.inconsistent;
    total.non_manifold += report.non_manifold;
    if (report.inside_out() > 0 && !is_wall_of_hollow(scene, mesh, material)) total.inside_out += report.inside_out();
  }
  return total;
}

Finding body_finding(Severity severity, const char* code, int material, std::string message) {
  Finding f;
  f.severity = severity;
  f.code = code;
  f.material = material;
  f.message = std::move(message);
  return f;
}

/// Whether the triangles face inward, which is a finding.
bool judge_winding(int material, const Shape& shape, std::vector<Finding>& findings) {
  if (shape.inside_out == 0) return false;
  Finding f = body_finding(Severity::warning, "volume-inside-out", material,
                           fmt::format("{} closed part{} with negative volume: front faces look inward, so light is "
                                       "outside where it should be inside",
                                       shape.inside_out, shape.inside_out == 1 ? "" : "s"));
  f.fix = "reverse the winding of its triangles";
  f.measured.emplace_back("parts", static_cast<double>(shape.inside_out));
  findings.push_back(std::move(f));
  return true;
}

void judge_closure(int material, const Shape& shape, const BodyRays& rays, std::vector<Finding>& findings) {
  const double lost = rays.count > 0 ? static_cast<double>(rays.lost) / rays.count : 0.0;
  if (!rays.is_open || shape.is_closed() || lost <= kLeak) return;
  const bool is_winding = shape.inconsistent > shape.boundary;
  Finding f = body_finding(
      Severity::warning, is_winding ? "volume-inconsistent-winding" : "volume-open", material,
      fmt::format("rays that enter are lost: they find no far side. Of {} edges {} have one triangle only, {} two that "
                  "face opposite ways, {} an odd number",
                  shape.edges, shape.boundary, shape.inconsistent, shape.non_manifold));
  f.share = lost;
  f.share_of = "rays";
  f.fix = is_winding ? "make the winding consistent" : "close the mesh, or set thicknessFactor to 0 for a thin sheet";
  f.measured = {{"edges", static_cast<double>(shape.edges)},
                {"boundary_edges", static_cast<double>(shape.boundary)},
                {"inconsistent_edges", static_cast<double>(shape.inconsistent)},
                {"non_manifold_edges", static_cast<double>(shape.non_manifold)}};
  findings.push_back(std::move(f));
}

void judge_thickness(const Material& m, int material, const BodyRays& rays, std::vector<Finding>& findings) {
  // Too few far sides say nothing about a median.
  if (rays.thickness.size() < rays.count / 8) return;
  const double thickness = median(rays.thickness);
  const double authored = median(rays.authored);
  const double ratio = thickness > 0.0 ? authored / thickness : 1.0;
  if (ratio > kThicknessFactor || ratio < 1.0 / kThicknessFactor) {
    Finding f = body_finding(
        Severity::note, "thickness-mismatch", material,
        fmt::format("thickness {:.3g} m, but straight in along the normal it is {:.3g} m to the far side (medians); "
                    "rasterizers refract and absorb by the first, path tracers by the second",
                    authored, thickness));
    f.texture = m.thickness_texture.texture;
    f.measured = {{"authored_m", authored}, {"true_m", thickness}, {"ratio", ratio}};
    findings.push_back(std::move(f));
  }
  if (m.attenuation_distance < kInfinity && m.multiscatter_color == vec3(0.0f)) {
    const vec3 left = glm::pow(m.attenuation_color, vec3(static_cast<float>(thickness) / m.attenuation_distance));
    const bool is_tinted = m.attenuation_color != vec3(1.0f);
    if (max_component(left) < kDarkestBody ||
        (is_tinted && glm::min(left.x, glm::min(left.y, left.z)) > kClearestBody)) {
      Finding f = body_finding(
          Severity::note, "attenuation-out-of-scale", material,
          fmt::format("of white light ({:.2g}, {:.2g}, {:.2g}) is left on the way through ({:.3g} m, median) at an "
                      "attenuationDistance of {:.3g} m: {}",
                      left.x, left.y, left.z, thickness, m.attenuation_distance,
                      max_component(left) < kDarkestBody ? "the body is black" : "its colour cannot be seen"));
      f.measured = {{"true_m", thickness}, {"attenuation_distance_m", m.attenuation_distance}};
      findings.push_back(std::move(f));
    }
  }
}

/// Whether an instance of some mesh wears a material.
std::vector<bool> find_worn(const Scene& scene) {
  std::vector<bool> worn(scene.materials.size(), false);
  for (const Node& node : scene.nodes) {
    if (node.mesh < 0) continue;
    for (const Primitive& p : scene.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
      if (!p.triangles.empty()) worn[static_cast<std::size_t>(p.material)] = true;
    }
  }
  return worn;
}

Finding unmeasured(std::size_t bodies) {
  Finding f;
  f.severity = Severity::note;
  f.code = "volume-unmeasured";
  f.subject = fmt::format("{} {}", bodies, bodies == 1 ? "body" : "bodies");
  f.message =
      "whether they are closed, and how thick, is not measured: that takes rays, and this build is without the path "
      "tracer (CANDELA_WITH_PATH)";
  f.measured.emplace_back("bodies", static_cast<double>(bodies));
  return f;
}

}  // namespace

void check_volumes(const Scene& scene, std::vector<Finding>& findings) {
  const std::vector<bool> worn = find_worn(scene);
  std::vector<int> bodies;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    if (worn[i] && is_body(scene.materials[i])) bodies.push_back(static_cast<int>(i));
  }
  if (bodies.empty()) return;
  const std::optional<std::vector<BodyRays>> rays = cast_into_bodies(scene, bodies);
  if (!rays) findings.push_back(unmeasured(bodies.size()));
  std::vector<std::vector<Finding>> of_body(bodies.size());
  parallel_for(0, bodies.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      // Triangles without area are no surface.
      if (rays && (*rays)[i].count == 0) continue;
      const Shape shape = inspect_material(scene, bodies[i]);
      const bool is_inside_out = judge_winding(bodies[i], shape, of_body[i]);
      if (!rays) continue;
      if (!is_inside_out) judge_closure(bodies[i], shape, (*rays)[i], of_body[i]);
      judge_thickness(scene.materials[static_cast<std::size_t>(bodies[i])], bodies[i], (*rays)[i], of_body[i]);
    }
  });
  for (auto& list : of_body) {
    findings.insert(findings.end(), std::make_move_iterator(list.begin()), std::make_move_iterator(list.end()));
  }
}

}  // namespace candela::check
