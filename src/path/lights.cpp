#include "path/lights.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "math/sobol.h"
#include "path/surface_point.h"
#include "shade/lights.glsl.h"

namespace candela::path {

namespace {

/// Heitz 2019, "A Low-Distortion Map Between Triangle and Square".
vec3 sample_barycentric(vec2 u) {
  if (u.y > u.x) {
    u.x *= 0.5f;
    u.y -= u.x;
  } else {
    u.y *= 0.5f;
    u.x -= u.y;
  }
  return {u.x, u.y, 1.0f - u.x - u.y};
}

/// Mean emitted luminance of a triangle. Textured: from so many points that every few texels are seen.
float mean_emission(const MeshData& mesh, std::uint32_t triangle) {
  const uvec3 t = mesh.triangles[triangle];
  const TextureReader& texture = mesh.material->emissive;
  if (!texture) return luminance(mesh.material->factors.emission);
  const vec2 size(texture.size());
  const vec2 a = mesh.uv(t, {1, 0, 0}, texture.uv_set()) * size;
  const vec2 e1 = mesh.uv(t, {0, 1, 0}, texture.uv_set()) * size - a;
  const vec2 e2 = mesh.uv(t, {0, 0, 1}, texture.uv_set()) * size - a;
  const float texels = 0.5f * std::abs(e1.x * e2.y - e1.y * e2.x);
  // A quarter of the texels, at least 4 points, at most 256: enough to choose by, and what is missed is still hit by
  // chance.
  const int count = static_cast<int>(std::clamp(0.25f * texels, 4.0f, 256.0f));
  float sum = 0.0f;
  for (int i = 0; i < count; ++i) {
    SobolSampler sampler(triangle, static_cast<std::uint32_t>(i));
    sum += luminance(emission_at(mesh, t, sample_barycentric(sampler.next_2d())));
  }
  return sum / static_cast<float>(count);
}

}  // namespace

Lights::Lights(const Scene& scene, const Environment& environment, Geometry& geometry)
    : geometry_(geometry), environment_(environment) {
  const Box3& bounds = geometry.bounds();
  const float radius = bounds.empty() ? 1.0f : std::max(0.5f * glm::length(bounds.size()), 1e-6f);
  const float disc = kPi * radius * radius;

  std::vector<float> powers;
  powers.push_back(environment_.can_sample() ? disc * environment_.flux() : 0.0f);
  for (const auto& sun : environment_.suns()) powers.push_back(disc * luminance(sun.radiance) * sun.solid_angle);
  add_punctual(scene, radius, powers);
  add_triangles(geometry, powers);
  double total = 0.0;
  for (const float p : powers) total += static_cast<double>(p);
  if (total > 0.0 && std::isfinite(total)) choice_ = Distribution1D(powers);
}

void Lights::add_punctual(const Scene& scene, float scene_radius, std::vector<float>& powers) {
  for (const Node& node : scene.nodes) {
    if (node.light < 0) continue;
    PunctualLight p;
    p.light = scene.lights[static_cast<std::size_t>(node.light)];
    p.position = vec3(node.world_from_node[3]);
    const vec3 axis = transform_vector(node.world_from_node, {0, 0, -1});
    const float length = glm::length(axis);
    p.direction = length > 0.0f ? axis / length : vec3(0, 0, -1);
    p.cos_inner = std::cos(p.light.inner_cone);
    p.cos_outer = std::cos(p.light.outer_cone);
    const float intensity = luminance(p.light.color) * p.light.intensity;
    switch (p.light.type) {
      case LightType::point:
        powers.push_back(4.0f * kPi * intensity);
        break;
      case LightType::spot:
        powers.push_back(2.0f * kPi * (1.0f - p.cos_outer) * intensity);
        break;
      case LightType::directional:
        powers.push_back(kPi * scene_radius * scene_radius * intensity);
        break;
    }
    punctual_.push_back(p);
  }
}

void Lights::add_triangles(Geometry& geometry, std::vector<float>& powers) {
  auto& placements = geometry.placements();
  for (std::size_t i = 0; i < placements.size(); ++i) {
    Placement& placement = placements[i];
    if (!placement.mesh->material->is_emissive) continue;
    placement.first_light = static_cast<int>(triangles_.size());
    const std::size_t first_power = powers.size();
    const std::size_t count = placement.mesh->triangles.size();
    triangles_.resize(triangles_.size() + count);
    powers.resize(powers.size() + count);
    const float sides = placement.mesh->material->factors.double_sided ? 2.0f : 1.0f;
    parallel_for(0, count, 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const auto triangle = static_cast<std::uint32_t>(k);
        const TrianglePositions p = triangle_positions(placement, triangle);
        TriangleLight& light = triangles_[static_cast<std::size_t>(placement.first_light) + k];
        light.placement = static_cast<std::int32_t>(i);
        light.triangle = triangle;
        light.area = 0.5f * glm::length(glm::cross(p.p1 - p.p0, p.p2 - p.p0));
        powers[first_power + k] = kPi * sides * light.area * mean_emission(*placement.mesh, triangle);
      }
    });
  }
}

LightSample Lights::sample(vec3 position, float u_choice, vec2 u) const {
  const Distribution1D::Sample choice = choice_.sample(u_choice);
  auto index = static_cast<std::size_t>(choice.index);
  LightSample s;
  if (index == 0) {
    s = sample_environment(u);
  } else if (--index < environment_.suns().size()) {
    s = sample_sun(environment_.suns()[index], u);
  } else if ((index -= environment_.suns().size()) < punctual_.size()) {
    s = sample_punctual(punctual_[index], position);
  } else {
    s = sample_triangle(triangles_[index - punctual_.size()], position, u);
  }
  s.pdf *= choice.pmf;
  return s;
}

LightSample Lights::sample_environment(vec2 u) const {
  const EnvironmentLight::Sample e = environment_.sample(u);
  LightSample s;
  s.direction = e.direction;
  s.pdf = e.pdf;
  s.is_map = true;
  s.footprint = e.footprint;
  s.mis_power = kEnvironmentMisPower;
  return s;
}

LightSample Lights::sample_sun(const EnvironmentLight::Sun& sun, vec2 u) const {
  // Uniform in the cone; 1 - cos is kept as it is, because 1 - (1 - x) would lose half the digits of a sun's width.
  const float one_minus_cos = u.x * sun.solid_angle / (2.0f * kPi);
  const float cos_theta = 1.0f - one_minus_cos;
  const float sin_theta = std::sqrt(one_minus_cos * (1.0f + cos_theta));
  const float phi = 2.0f * kPi * u.y;
  LightSample s;
  s.direction = sun.frame.to_world({sin_theta * std::cos(phi), sin_theta * std::sin(phi), cos_theta});
  s.radiance = sun.radiance;
  s.pdf = 1.0f / sun.solid_angle;
  s.mis_power = kAreaMisPower;
  return s;
}

LightSample Lights::sample_punctual(const PunctualLight& p, vec3 position) const {
  LightSample s;
  s.is_delta = true;
  s.pdf = 1.0f;
  s.radiance = p.light.color * p.light.intensity;
  if (p.light.type == LightType::directional) {
    s.direction = -p.direction;
    return s;
  }
  const vec3 to_light = p.position - position;
  s.distance = glm::length(to_light);
  if (!(s.distance > 0.0f)) return {};
  s.direction = to_light / s.distance;
  s.target = p.position;
  s.radiance *= shade::light_falloff_gltf(s.distance, p.light.range);
  if (p.light.type == LightType::spot) {
    s.radiance *= shade::light_spot_gltf(-glm::dot(s.direction, p.direction), p.cos_inner, p.cos_outer);
  }
  return s;
}

LightSample Lights::sample_triangle(const TriangleLight& light, vec3 position, vec2 u) const {
  const Placement& placement = geometry_.placement(light.placement);
  const MeshData& mesh = *placement.mesh;
  const TrianglePositions p = triangle_positions(placement, light.triangle);
  const vec3 b = sample_barycentric(u);
  const vec3 point = p.p0 * b.x + p.p1 * b.y + p.p2 * b.z;
  const vec3 to_light = point - position;
  LightSample s;
  s.distance = glm::length(to_light);
  if (!(s.distance > 0.0f)) return {};
  s.direction = to_light / s.distance;
  vec3 normal = glm::cross(p.p1 - p.p0, p.p2 - p.p0) / (2.0f * light.area);
  if (placement.is_mirrored) normal = -normal;
  if (mesh.material->factors.double_sided && glm::dot(normal, s.direction) > 0.0f) normal = -normal;
  const float cos_light = -glm::dot(normal, s.direction);
  if (cos_light <= 0.0f) return {};
  s.target = point + surface_clearance(placement, p, normal) * normal;
  const uvec3 t = mesh.triangles[light.triangle];
  // ----- the measure changes from area to solid angle
  s.radiance = emission_at(mesh, t, b) * mesh.opacity(t, b);
  s.pdf = s.distance * s.distance / (light.area * cos_light);
  s.mis_power = kAreaMisPower;
  return s;
}

vec3 Lights::escaped_radiance(vec3 direction, const EnvironmentLight::Footprint& footprint, float bsdf_pdf) const {
  const EnvironmentLight::Value value = environment_.read(footprint);
  const bool weighted = bsdf_pdf > 0.0f && can_sample();
  vec3 radiance = value.radiance;
  if (weighted) radiance *= mis_weight(bsdf_pdf, value.pdf * choice_.pmf(0), kEnvironmentMisPower);
  for (std::size_t i = 0; i < environment_.suns().size(); ++i) {
    const auto& sun = environment_.suns()[i];
    const vec3 local = sun.frame.to_local(direction);
    if (local.z <= 0.0f || local.x * local.x + local.y * local.y > sun.sin2_radius) continue;
    const float pdf = weighted ? choice_.pmf(static_cast<int>(1 + i)) / sun.solid_angle : 0.0f;
    radiance += sun.radiance * (weighted ? mis_weight(bsdf_pdf, pdf, kAreaMisPower) : 1.0f);
  }
  return radiance;
}

float Lights::triangle_pdf(int light, float distance, float cos_light) const {
  if (!can_sample() || cos_light <= 0.0f) return 0.0f;
  const int first = static_cast<int>(1 + environment_.suns().size() + punctual_.size());
  const float area = triangles_[static_cast<std::size_t>(light)].area;
  return area > 0.0f ? choice_.pmf(first + light) * distance * distance / (area * cos_light) : 0.0f;
}

}  // namespace candela::path
