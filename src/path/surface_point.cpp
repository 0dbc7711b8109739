#include "path/surface_point.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "scene/surface_params.h"
#include "shade/shading_normal.glsl.h"
#include "shade/workflow.glsl.h"

namespace candela::path {

namespace {

/// Where a point of a facet would lie on the curved surface that its vertex normals describe; rays that start there do
/// not see the facet's neighbours as a staircase. Hanika 2021, "Hacking the Shadow Terminator", Ray Tracing Gems II,
/// ch. 4.
vec3 lift_to_smooth_surface(vec3 p, const TrianglePositions& t, const std::array<vec3, 3>& normals, vec3 barycentric) {
  const auto lift = [](vec3 offset, vec3 n) { return offset - glm::min(0.0f, glm::dot(offset, n)) * n; };
  return p + barycentric.x * (lift(p - t.p0, normals[0]) - (p - t.p0)) +
         barycentric.y * (lift(p - t.p1, normals[1]) - (p - t.p1)) +
         barycentric.z * (lift(p - t.p2, normals[2]) - (p - t.p2));
}

/// How far it is into `direction` to a plane of normal `n` that `offset` leads to; at grazing angles, where rounding
/// decides, no more than a few times that.
float along_to_plane(vec3 n, vec3 offset, vec3 direction) {
  constexpr float kGrazing = 0.125f;
  const float cosine = glm::dot(n, direction);
  return glm::dot(n, offset) / std::copysign(std::max(std::abs(cosine), kGrazing), cosine);
}

/// The base's textures of a material at one point, located before the first is read.
struct BaseFootprints {
  std::array<TextureReader::Footprint, kBaseTextures.size()> at;

  BaseFootprints(const MeshData& mesh, const uvec3& t, vec3 b) {
    const MaterialData& m = *mesh.material;
    const vec2 uv0 = mesh.uv(t, b, 0);
    const TextureReader::Footprint* shared = nullptr;
    for (std::size_t i = 0; i < at.size(); ++i) {
      const TextureReader& texture = m.textures[kBaseTextures[i]];
      if (!texture) continue;
      if (shared != nullptr) {
        at[i] = *shared;
        texture.prefetch(at[i]);
        continue;
      }
      at[i] = texture.locate(texture.uv_set() == 0 ? uv0 : mesh.uv(t, b, texture.uv_set()));
      if (m.has_one_footprint) shared = &at[i];
    }
  }

  /// The texel of a slot that has a texture.
  template <TextureSlot Material::*kSlot>
  vec4 read(const MaterialData& m) const {
    constexpr std::size_t kIndex = texture_slot_index(kSlot);
    constexpr auto kAt = std::find(kBaseTextures.begin(), kBaseTextures.end(), kIndex) - kBaseTextures.begin();
    return m.textures[kIndex].read(at[kAt]);
  }
};

/// What a surface without layers reads of its parameters (shade/surface_base.glsl.h); the rest stays unset.
void copy_base(const shade::SurfaceParams& from, shade::SurfaceParams& to) {
  to.lobes = from.lobes;
  for_each_property([&](auto i) {
    constexpr const MaterialProperty& kRow = kMaterialProperties[i];
    if constexpr (kRow.param && kRow.lobe.bit == 0) {
      for (int k = 0; k < kRow.param.size(); ++k) kRow.param.at(to, k) = kRow.param.at(from, k);
    }
  });
}

/// Metallic-roughness of a material, or specular-glossiness brought to the same surface: ior is 0, so that
/// specular_color is F0 and F90 is 1. The base colour has been fetched before.
void fetch_base(const MaterialData& material, const BaseFootprints& at, vec3 base_color, shade::SurfaceParams& params) {
  params.base_color = base_color;
  for_each_texture([&](auto slot) {
    constexpr const TextureRow& kRow = kTextureRows[slot];
    constexpr bool kIsBase = std::find(kBaseTextures.begin() + 1, kBaseTextures.end(), slot) != kBaseTextures.end();
    if constexpr (kIsBase) {
      if (material.textures[slot]) apply_texel<slot>(at.read<kRow.slot>(material), material.factors, params);
    }
  });
}

/// KHR_materials_pbrSpecularGlossiness. Its diffuse colour is what the boundary leaves of the layer below; a
/// metallic-roughness base colour is the layer itself (shade/workflow.glsl.h).
void fetch_specular_glossiness(const MaterialData& material, const MeshData& mesh, const uvec3& t, vec3 b,
                               shade::SurfaceParams& params) {
  if (const auto& texture = material.texture<&Material::specular_glossiness_texture>()) {
    const vec4 texel = texture.sample(mesh.uv(t, b, texture.uv_set()));
    params.specular_color *= vec3(texel);
    params.roughness = shade::workflow_roughness(params.roughness, texel.w);
  }
  params.base_color = shade::workflow_base_color(params.base_color, params.specular_color);
}

/// The tangent and bitangent of the front, wherever the viewer is.
Frame front_frame(const Placement& placement, const MeshData& mesh, const uvec3& t, vec3 b, vec3 front, bool& flip) {
  const vec4 t0 = mesh.tangents[t.x];
  vec3 tangent = vec3(t0) * b.x + vec3(mesh.tangents[t.y]) * b.y + vec3(mesh.tangents[t.z]) * b.z;
  if (!placement.is_world) tangent = mat3(placement.world_from_object) * tangent;
  flip = (t0.w < 0.0f) != (!placement.is_world && placement.is_mirrored);
  return frame_from_tangent(front, tangent);
}

/// The directions that lobes follow, in the world: what is returned is that of the base, 0 where it has none.
vec3 fetch_directions(const MaterialData& material, const MeshData& mesh, const uvec3& t, vec3 b, const Frame& front,
                      shade::SurfaceParams& params) {
  vec3 base(0.0f);
  for_each_direction([&](auto i) {
    constexpr const DirectionRow& kRow = kDirectionRows[i];
    constexpr std::size_t kSlot = texture_slot_index(kRow.texture);
    if ((params.lobes & kRow.lobe) == 0) return;
    const float rotation = material.factors.*kRow.rotation;
    vec2 turn(std::cos(rotation), std::sin(rotation));
    if (const TextureReader& texture = material.textures[kSlot]) {
      const vec4 texel = texture.sample(mesh.uv(t, b, texture.uv_set()));
      turn = shade::normal_turned(turn, vec2(texel));
      apply_texel<kSlot>(texel, material.factors, params);
    }
    const vec3 direction = front.t * turn.x + front.b * turn.y;
    if constexpr (kRow.param != nullptr) {
      params.*kRow.param = direction;
    } else {
      base = direction;
    }
  });
  return base;
}

/// The other ones, from the world to the shading frame.
void turn_directions(const Frame& frame, shade::SurfaceParams& params) {
  for_each_direction([&](auto i) {
    constexpr const DirectionRow& kRow = kDirectionRows[i];
    if constexpr (kRow.param != nullptr) params.*kRow.param = frame.to_local(params.*kRow.param);
  });
}

/// Everything beyond metallic-roughness.
void fetch_layers(const MaterialData& material, const MeshData& mesh, const uvec3& t, vec3 b,
                  shade::SurfaceParams& params) {
  for_each_texture([&](auto slot) {
    // Those that say a direction too wait for the frame.
    if constexpr (is_layer_texture(slot) && !is_direction_texture(slot)) {
      const TextureReader& texture = material.textures[slot];
      if (texture) apply_texel<slot>(texture.sample(mesh.uv(t, b, texture.uv_set())), material.factors, params);
    }
  });
}

}  // namespace

vec3 facet_normal(const TrianglePositions& p) {
  const vec3 n = glm::cross(p.p1 - p.p0, p.p2 - p.p0);
  const float length = glm::length(n);
  return length > 0.0f ? n / length : vec3(0.0f);
}

float surface_clearance(const Placement& placement, const TrianglePositions& p, vec3 n) {
  // About 30 roundings of the numbers that go in: twice what tilted planes of any size need.
  constexpr float kRelative = 0x1p-18f;
  constexpr float kLeast = 0x1p-22f;
  const vec3 largest = glm::max(glm::abs(p.p0), glm::max(glm::abs(p.p1), glm::abs(p.p2)));
  // Into an instance rays are transformed, which mixes the errors of the axes and adds those of its place.
  if (!placement.is_world) {
    return kRelative * (max_component(largest) + max_component(glm::abs(vec3(placement.world_from_object[3]))));
  }
  return kRelative * glm::dot(glm::abs(n), largest) + kLeast * max_component(largest);
}

vec3 SurfacePoint::ray_origin(vec3 direction) const {
  return is_outside(direction) ? lifted + clearance * geometric_normal : position - clearance * geometric_normal;
}

vec3 emission_at(const MeshData& mesh, const uvec3& triangle, vec3 barycentric) {
  const MaterialData& material = *mesh.material;
  vec3 emission = material.factors.emission;
  if (const auto& texture = material.texture<&Material::emissive_texture>()) {
    emission *= vec3(texture.sample(mesh.uv(triangle, barycentric, texture.uv_set())));
  }
  return emission;
}

bool is_culled_back(const Geometry& geometry, const Hit& hit, vec3 direction) {
  const MaterialData& material = *geometry.placement(hit.placement).mesh->material;
  return !material.factors.double_sided && !material.has_medium && is_back_hit(geometry, hit, direction);
}

bool is_one_surface(const Geometry& geometry, const Hit& a, const Hit& b, vec3 direction) {
  if (a.placement == b.placement && a.triangle == b.triangle) return true;
  if (is_back_hit(geometry, a, direction) != is_back_hit(geometry, b, direction)) return false;
  const TrianglePositions p = triangle_positions(geometry.placement(a.placement), a.triangle);
  const TrianglePositions q = triangle_positions(geometry.placement(b.placement), b.triangle);
  const std::array<vec3, 3> ps{p.p0, p.p1, p.p2};
  const std::array<float, 3> weights{1.0f - a.u - a.v, a.u, a.v};
  const float longest = std::max(glm::distance(p.p0, p.p1), glm::distance(p.p0, p.p2));
  const float near = std::min(surface_clearance(geometry.placement(a.placement), p, facet_normal(p)), 1e-3f * longest);
  int shared = 0;
  float weight = 0.0f;
  for (std::size_t i = 0; i < 3; ++i) {
    for (const vec3& corner : {q.p0, q.p1, q.p2}) {
      if (glm::distance(ps[i], corner) > near) continue;
      ++shared;
      weight += weights[i];
      break;
    }
  }
  // On an edge the two ends have all the weight. Triangles that share all corners lie on each other.
  constexpr float kNearEdge = 1e-3f;
  return shared > 0 && shared < 3 && weight > 1.0f - kNearEdge;
}

bool are_in_one_plane(const Geometry& geometry, const Hit& a, const Hit& b) {
  constexpr float kRounding = 0.125f;  // of the clearance, which has room for those of rays as well
  const TrianglePositions p = triangle_positions(geometry.placement(a.placement), a.triangle);
  const TrianglePositions q = triangle_positions(geometry.placement(b.placement), b.triangle);
  const auto size2 = [](const TrianglePositions& t) {
    const vec3 x = t.p1 - t.p0, y = t.p2 - t.p0, z = t.p2 - t.p1;
    return std::max({glm::dot(x, x), glm::dot(y, y), glm::dot(z, z)});
  };
  // The plane of the larger one is the more exact.
  const bool is_swapped = size2(p) < size2(q);
  const TrianglePositions& large = is_swapped ? q : p;
  const TrianglePositions& small = is_swapped ? p : q;
  const dvec3 corner(large.p0);
  const dvec3 across = glm::cross(dvec3(large.p1) - corner, dvec3(large.p2) - corner);
  const double length = glm::length(across);
  if (!(length > 0.0)) return false;
  const vec3 n(across / length);
  const float limit = kRounding * std::max(surface_clearance(geometry.placement(a.placement), p, n),
                                           surface_clearance(geometry.placement(b.placement), q, n));
  const auto is_near = [&](vec3 point) { return std::abs(glm::dot(across, dvec3(point) - corner)) <= limit * length; };
  return is_near(small.p0) && is_near(small.p1) && is_near(small.p2);
}

float distance_passed(const Geometry& geometry, const Hit& hit, vec3 start, const Ray& ray) {
  if (start == ray.origin) return 0.0f;
  return along_to_plane(facet_normal(triangle_positions(geometry.placement(hit.placement), hit.triangle)),
                        ray.origin - start, ray.direction);
}

float distance_to(const Geometry& geometry, const Hit& hit, vec3 start, vec3 direction) {
  const TrianglePositions p = triangle_positions(geometry.placement(hit.placement), hit.triangle);
  return std::max(along_to_plane(facet_normal(p), p.at(hit.u, hit.v) - start, direction), 0.0f);
}

vec3 position_of(const Geometry& geometry, const Hit& hit) {
  return triangle_positions(geometry.placement(hit.placement), hit.triangle).at(hit.u, hit.v);
}

vec3 origin_beyond(const Geometry& geometry, const Hit& hit, vec3 direction) {
  const Placement& placement = geometry.placement(hit.placement);
  const TrianglePositions p = triangle_positions(placement, hit.triangle);
  const vec3 n = facet_normal(p);
  const float side = glm::dot(n, direction) < 0.0f ? -1.0f : 1.0f;
  return p.at(hit.u, hit.v) + side * surface_clearance(placement, p, n) * n;
}

bool is_back_hit(const Geometry& geometry, const Hit& hit, vec3 direction) {
  const Placement& placement = geometry.placement(hit.placement);
  const TrianglePositions p = triangle_positions(placement, hit.triangle);
  const float side = glm::dot(glm::cross(p.p1 - p.p0, p.p2 - p.p0), direction);
  return placement.is_mirrored ? side < 0.0f : side > 0.0f;
}

SurfacePoint make_surface_point(const Geometry& geometry, const Hit& hit, vec3 direction, float eta) {
  shade::SurfaceParams params;
  return make_surface_point(geometry, hit, direction, eta, params);
}

SurfacePoint make_surface_point(const Geometry& geometry, const Hit& hit, vec3 direction, float eta,
                                shade::SurfaceParams& params) {
  const Placement& placement = geometry.placement(hit.placement);
  const MeshData& mesh = *placement.mesh;
  const MaterialData& material = *mesh.material;
  const Material& m = material.factors;
  const uvec3 t = mesh.triangles[hit.triangle];
  const vec3 b(1.0f - hit.u - hit.v, hit.u, hit.v);
  const vec3 wo = -direction;
  const BaseFootprints at(mesh, t, b);

  // ----- the facet
  SurfacePoint point;
  point.material = &material;
  const TrianglePositions p = triangle_positions(placement, hit.triangle);
  point.position = p.p0 * b.x + p.p1 * b.y + p.p2 * b.z;
  vec3 ng = glm::cross(p.p1 - p.p0, p.p2 - p.p0);
  const float area2 = glm::dot(ng, ng);
  ng = area2 > 0.0f ? ng * glm::inversesqrt(area2) : wo;  // too small for single precision
  if (placement.is_mirrored) ng = -ng;
  point.is_back = glm::dot(ng, wo) < 0.0f;
  if (point.is_back) ng = -ng;
  point.geometric_normal = ng;
  point.clearance = surface_clearance(placement, p, ng);

  // ----- the smooth surface it stands for
  std::array<vec3, 3> normals{mesh.vertices[t.x].normal, mesh.vertices[t.y].normal, mesh.vertices[t.z].normal};
  if (!placement.is_world) {
    for (vec3& n : normals) {
      n = placement.world_from_normal * n;
      const float n2 = glm::dot(n, n);
      if (n2 > 0.0f) n *= glm::inversesqrt(n2);  // a flattening transform leaves none
    }
  }
  vec3 ns = normals[0] * b.x + normals[1] * b.y + normals[2] * b.z;
  const float length2 = glm::dot(ns, ns);
  ns = length2 > 1e-12f ? ns * glm::inversesqrt(length2) : ng;
  const float side = glm::dot(ns, ng) < 0.0f ? -1.0f : 1.0f;
  ns *= side;
  for (vec3& n : normals) n *= side;
  point.smooth_normal = ns;
  point.lifted = lift_to_smooth_surface(point.position, p, normals, b);

  // ----- normal maps; the frame belongs to the front: seen from behind its normals are flipped (glTF 2.0 §3.9.6)
  const bool has_tangents = material.needs_tangents && !mesh.tangents.empty();
  vec3 coat_normal = ns;
  Frame front;
  if (has_tangents) {
    bool flip = false;
    const vec3 side_normal = point.is_back ? -ns : ns;
    front = front_frame(placement, mesh, t, b, side_normal, flip);
    const mat3 front_matrix(front.t, front.b, front.n);
    const float front_side = point.is_back ? -1.0f : 1.0f;
    if (const auto& texture = material.texture<&Material::clearcoat_normal_texture>()) {
      const vec4 texel = texture.sample(mesh.uv(t, b, texture.uv_set()));
      coat_normal = shade::normal_mapped(vec3(texel), m.clearcoat_normal_scale, front_matrix, flip, ns, front_side);
    }
    if (material.texture<&Material::normal_texture>()) {
      const vec4 texel = at.read<&Material::normal_texture>(material);
      ns = shade::normal_mapped(vec3(texel), m.normal_scale, front_matrix, flip, ns, front_side);
    }
    // What an anisotropy texture turns counter-clockwise turns so in the map's own frame.
    if (flip) front.b = -front.b;
  }
  ns = shade::normal_kept_outside(ns, ng, wo);

  // ----- the material
  vec3 base_color = m.base_color * placement.color * vec3(mesh.color(t, b));
  if (material.texture<&Material::base_color_texture>()) {
    base_color *= vec3(at.read<&Material::base_color_texture>(material));
  }
  if (m.unlit) {
    point.frame = frame_from_normal(ns);
    point.wo = point.frame.to_local(wo);
    point.is_unlit = true;
    point.emission = base_color;
    return point;
  }
  if (material.params.lobes == 0) {
    copy_base(material.params, params);
  } else {
    params = material.params;
  }
  fetch_base(material, at, base_color, params);
  if (m.specular_glossiness) fetch_specular_glossiness(material, mesh, t, b, params);
  vec3 tangent(0.0f);
  if (params.lobes != 0) {
    fetch_layers(material, mesh, t, b, params);
    if (has_tangents) tangent = fetch_directions(material, mesh, t, b, front, params);
    if (material.has_medium) params.eta = eta;
  }
  point.frame = max_component(glm::abs(tangent)) > 0.0f ? frame_from_tangent(ns, tangent) : frame_from_normal(ns);
  point.wo = point.frame.to_local(wo);
  if (has_tangents && params.lobes != 0) turn_directions(point.frame, params);
  if ((params.lobes & shade::kLobeClearcoat) != 0) {
    params.clearcoat_normal = point.frame.to_local(shade::normal_kept_outside(coat_normal, ng, wo));
  }
  shade::surface_prepare_in(params, point.wo, point.surface);
  if (material.is_emissive && (!point.is_back || m.double_sided)) {
    point.emission = m.emission * shade::surface_emission_scale(point.surface);
    if (material.texture<&Material::emissive_texture>()) {
      point.emission *= vec3(at.read<&Material::emissive_texture>(material));
    }
  }
  return point;
}

}  // namespace candela::path
