#include "check/body_rays.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/parallel.h"
#include "check/check_samples.h"
#include "math/sobol.h"
#include "path/geometry.h"
#include "path/surface_point.h"

namespace candela::check {

namespace {

// On each body; fewer where there are very many.
constexpr std::size_t kMostPoints = 2048;
constexpr std::size_t kLeastPoints = 256;
constexpr std::size_t kPointsInAll = std::size_t{1} << 21;

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

class BodyProbe {
 public:
  BodyProbe(const Scene& scene, const path::Geometry& geometry) : scene_(scene), geometry_(geometry) {}

  BodyRays probe(int material, const std::vector<int>& placements, std::size_t points) const;

 private:
  void cast(const Bodies::Site& site, const path::TextureReader& thickness, vec2 u, BodyRays& result) const;
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

void BodyProbe::cast(const Bodies::Site& site, const path::TextureReader& thickness, vec2 u, BodyRays& result) const {
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
  ++result.count;
  if (leave(site.placement, origin, direction, clearance) < 0.0f) ++result.lost;
}

BodyRays BodyProbe::probe(int material, const std::vector<int>& placements, std::size_t points) const {
  BodyRays result;
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

}  // namespace

std::optional<std::vector<BodyRays>> cast_into_bodies(const Scene& scene, const std::vector<int>& materials) {
  const path::Geometry geometry(scene);
  const std::vector<int> worn = materials_of_placements(scene);
  std::vector<std::vector<int>> placements(scene.materials.size());
  for (std::size_t i = 0; i < worn.size(); ++i) {
    placements[static_cast<std::size_t>(worn[i])].push_back(static_cast<int>(i));
  }
  const BodyProbe probe(scene, geometry);
  const std::size_t points = std::clamp(kPointsInAll / materials.size(), kLeastPoints, kMostPoints);
  std::vector<BodyRays> result(materials.size());
  parallel_for(0, materials.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      result[i] = probe.probe(materials[i], placements[static_cast<std::size_t>(materials[i])], points);
    }
  });
  return result;
}

}  // namespace candela::check
