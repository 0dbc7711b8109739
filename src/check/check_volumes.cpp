#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/parallel.h"
#include "check/check_parts.h"
#include "check/edges.h"
#include "math/sobol.h"
#include "path/geometry.h"
#include "path/surface_point.h"

// Bodies that light can enter (KHR_materials_volume): whether they are closed, which way they face, and how thick they
// are.
namespace candela::check {

namespace {

// On each body; fewer where there are very many.
constexpr std::size_t kMostPoints = 2048;
constexpr std::size_t kLeastPoints = 256;
constexpr std::size_t kPointsInAll = std::size_t{1} << 21;
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

/// What the path tracer holds of one material: meshes, a displaced one with the triangles of its relief, and where they
/// stand.
class Bodies {
 public:
  struct Site {
    int placement = -1;
    std::uint32_t triangle = 0;
    vec3 barycentric{0.0f};
  };

  /// `placements` of this material.
  Bodies(const path::Geometry& geometry, const std::vector<int>& placements);

  bool empty() const { return meshes_.empty(); }
  /// A point spread by area over all of it, for three uniform numbers.
  Site sample(vec3 u) const;

 private:
  struct Stored {
    std::vector<int> placements;
    std::vector<float> scales;  ///< of areas
    Distribution1D by_scale, by_area;
  };
  std::vector<Stored> meshes_;
  Distribution1D by_area_;
};

Bodies::Bodies(const path::Geometry& geometry, const std::vector<int>& placements) {
  std::unordered_map<const path::MeshData*, std::size_t> index_of;
  std::vector<float> areas;
  for (const int i : placements) {
    const path::Placement& placement = geometry.placement(i);
    const path::MeshData& mesh = *placement.mesh;
    const auto [found, is_new] = index_of.try_emplace(&mesh, meshes_.size());
    if (is_new) {
      std::vector<float> of_triangles;
      of_triangles.reserve(mesh.triangles.size());
      for (const uvec3& t : mesh.triangles) {
        const vec3 a = mesh.vertices[t.x].position;
        of_triangles.push_back(
            glm::length(glm::cross(mesh.vertices[t.y].position - a, mesh.vertices[t.z].position - a)));
      }
      meshes_.emplace_back().by_area = Distribution1D(of_triangles);
      areas.push_back(0.0f);
    }
    Stored& stored = meshes_[found->second];
    const float scale = placement.is_world ? 1.0f : static_cast<float>(area_scale(placement.world_from_object));
    stored.placements.push_back(i);
    stored.scales.push_back(scale);
    areas[found->second] += scale * static_cast<float>(stored.by_area.total());
  }
  for (Stored& stored : meshes_) stored.by_scale = Distribution1D(stored.scales);
  if (!areas.empty()) by_area_ = Distribution1D(areas);
}

Bodies::Site Bodies::sample(vec3 u) const {
  const Distribution1D::Sample mesh = by_area_.sample(u.x);
  const Stored& stored = meshes_[static_cast<std::size_t>(mesh.index)];
  const Distribution1D::Sample triangle = stored.by_area.sample(mesh.u);
  const float s = std::sqrt(triangle.u);
  return {stored.placements[static_cast<std::size_t>(stored.by_scale.sample(u.z).index)],
          static_cast<std::uint32_t>(triangle.index),
          {1.0f - s, s * (1.0f - u.y), s * u.y}};
}

/// The material of each placement: they follow nodes and their primitives that have triangles, in order
/// (path/geometry.cpp).
std::vector<int> materials_of_placements(const Scene& scene) {
  std::vector<int> result;
  for (const Node& node : scene.nodes) {
    if (node.mesh < 0) continue;
    for (const Primitive& p : scene.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
      if (!p.triangles.empty()) result.push_back(p.material);
    }
  }
  return result;
}

/// What rays find that start just inside of a body.
struct Crossing {
  std::uint32_t rays = 0;
  std::uint32_t lost = 0;        ///< met nothing of the body's place, or its front: they never learn that they left
  bool is_open = false;          ///< some edge has no face of the body on its other side, of whatever material or node
  std::vector<float> thickness;  ///< straight in along the normal to the far side, metres
  std::vector<float> authored;   ///< thicknessFactor × thicknessTexture × scale at the same points, metres
};

float median(std::vector<float> values) {
  if (values.empty()) return 0.0f;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

class BodyProbe {
 public:
  BodyProbe(const Scene& scene, const path::Geometry& geometry) : scene_(scene), geometry_(geometry) {}

  Crossing probe(int material, const std::vector<int>& placements, std::size_t points) const;

 private:
  void cast(const Bodies::Site& site, const path::TextureReader& thickness, vec2 u, Crossing& result) const;
  /// The body's far side in this direction; 0 where another thing lies before it, negative where the ray is lost.
  float leave(int own, vec3 origin, vec3 direction, float clearance) const;

  const Scene& scene_;
  const path::Geometry& geometry_;
};

float BodyProbe::leave(int own, vec3 origin, vec3 direction, float clearance) const {
  const path::Hit hit = geometry_.intersect({origin, direction, 0.0f, kInfinity}, 0);
  if (!hit) return -1.0f;
  const int body = geometry_.placement(own).body;
  // What lies beyond the body's own box does not close it: a room around it.
  const Box3& bounds = geometry_.bodies()[static_cast<std::size_t>(body)].bounds;
  const vec3 p = origin + hit.t * direction;
  const vec3 slack(1e-3f * max_component(bounds.size()));
  if (glm::any(glm::lessThan(p, bounds.lower - slack)) || glm::any(glm::greaterThan(p, bounds.upper + slack))) {
    return -1.0f;
  }
  const int met = geometry_.placement(hit.placement).body;
  if (met == 0) return 0.0f;
  if (path::is_back_hit(geometry_, hit, direction)) return hit.t + clearance;
  return met == body ? -1.0f : 0.0f;
}

void BodyProbe::cast(const Bodies::Site& site, const path::TextureReader& thickness, vec2 u, Crossing& result) const {
  const vec3 b = site.barycentric;
  const path::Placement& placement = geometry_.placement(site.placement);
  const path::TrianglePositions p = path::triangle_positions(placement, site.triangle);
  vec3 n = glm::cross(p.p1 - p.p0, p.p2 - p.p0);
  const float length = glm::length(n);
  if (!(length > 0.0f)) return;
  n *= (placement.is_mirrored ? -1.0f : 1.0f) / length;
  const float clearance = path::surface_clearance(placement, p, n);
  const vec3 origin = p.p0 * b.x + p.p1 * b.y + p.p2 * b.z - clearance * n;

  const float straight = leave(site.placement, origin, -n, clearance);
  if (straight > 0.0f) {
    const Material& m = placement.mesh->material->factors;
    float share = 1.0f;
    if (thickness) {
      share = thickness.sample(placement.mesh->uv(placement.mesh->triangles[site.triangle], b, thickness.uv_set())).y;
    }
    const float scale = std::cbrt(std::fabs(glm::determinant(mat3(placement.world_from_object))));
    result.thickness.push_back(straight);
    result.authored.push_back(m.thickness * share * scale);
  }

  // Cosine-distributed into the body.
  const float r = std::sqrt(u.x), phi = 2.0f * kPi * u.y;
  const Frame frame = frame_from_normal(-n);
  const vec3 direction = frame.to_world({r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(0.0f, 1.0f - u.x))});
  ++result.rays;
  if (leave(site.placement, origin, direction, clearance) < 0.0f) ++result.lost;
}

Crossing BodyProbe::probe(int material, const std::vector<int>& placements, std::size_t points) const {
  Crossing result;
  const Bodies bodies(geometry_, placements);
  if (bodies.empty()) return result;
  const path::TextureReader thickness(scene_, scene_.materials[static_cast<std::size_t>(material)].thickness_texture,
                                      path::Encoding::data);
  result.is_open = std::any_of(placements.begin(), placements.end(), [&](int i) {
    return geometry_.bodies()[static_cast<std::size_t>(geometry_.placement(i).body)].is_open;
  });
  constexpr std::uint32_t kSeed = 0x626f6479;
  for (std::uint32_t i = 0; i < points; ++i) {
    SobolSampler sampler(kSeed, i);
    const vec3 u = sampler.next_3d();
    cast(bodies.sample(u), thickness, sampler.next_2d(), result);
  }
  return result;
}

/// What the meshes in which a material bounds bodies look like, together.
struct Shape {
  std::size_t edges = 0, boundary = 0, inconsistent = 0, non_manifold = 0;
  std::size_t inside_out = 0;  ///< closed parts

  bool is_closed() const { return boundary + inconsistent + non_manifold == 0; }
};

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
    total.inside_out += report.inside_out();
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

void judge_shape(int material, const Shape& shape, const Crossing& rays, std::vector<Finding>& findings) {
  if (shape.inside_out > 0) {
    Finding f = body_finding(Severity::warning, "volume-inside-out", material,
                             fmt::format("{} closed part{} with negative volume: front faces look inward, so light is "
                                         "outside where it should be inside",
                                         shape.inside_out, shape.inside_out == 1 ? "" : "s"));
    f.fix = "reverse the winding of its triangles";
    f.measured.emplace_back("parts", static_cast<double>(shape.inside_out));
    findings.push_back(std::move(f));
    return;
  }
  const double lost = rays.rays > 0 ? static_cast<double>(rays.lost) / rays.rays : 0.0;
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

void judge_thickness(const Material& m, int material, const Crossing& rays, std::vector<Finding>& findings) {
  // Too few far sides say nothing about a median.
  if (rays.thickness.size() < rays.rays / 8) return;
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

}  // namespace

void check_volumes(const Scene& scene, std::vector<Finding>& findings) {
  std::vector<int> bodies;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    if (is_body(scene.materials[i])) bodies.push_back(static_cast<int>(i));
  }
  if (bodies.empty()) return;
  const path::Geometry geometry(scene);
  const std::vector<int> materials = materials_of_placements(scene);
  std::vector<std::vector<int>> placements(scene.materials.size());
  for (std::size_t i = 0; i < materials.size(); ++i) {
    placements[static_cast<std::size_t>(materials[i])].push_back(static_cast<int>(i));
  }
  const BodyProbe probe(scene, geometry);
  const std::size_t points = std::clamp(kPointsInAll / bodies.size(), kLeastPoints, kMostPoints);
  std::vector<std::vector<Finding>> of_body(bodies.size());
  parallel_for(0, bodies.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Crossing rays = probe.probe(bodies[i], placements[static_cast<std::size_t>(bodies[i])], points);
      if (rays.rays == 0) continue;
      judge_shape(bodies[i], inspect_material(scene, bodies[i]), rays, of_body[i]);
      judge_thickness(scene.materials[static_cast<std::size_t>(bodies[i])], bodies[i], rays, of_body[i]);
    }
  });
  for (auto& list : of_body) {
    findings.insert(findings.end(), std::make_move_iterator(list.begin()), std::make_move_iterator(list.end()));
  }
}

}  // namespace candela::check
