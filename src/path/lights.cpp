#include "path/lights.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "math/sobol.h"
#include "path/surface_point.h"

namespace candela::path {

namespace {

static_assert(static_cast<int>(Falloff::inverse_square) == shade::kFalloffInverseSquare &&
              static_cast<int>(Falloff::gltf) == shade::kFalloffGltf &&
              static_cast<int>(Falloff::ue4) == shade::kFalloffUe4 &&
              static_cast<int>(Falloff::polynomial) == shade::kFalloffPolynomial);
static_assert(static_cast<int>(LightType::point) == shade::kPointLight &&
              static_cast<int>(LightType::spot) == shade::kSpotLight &&
              static_cast<int>(LightType::directional) == shade::kDirectionalLight);

/// Keeps sums of absurdly bright lamps finite.
constexpr float kMostPower = 1e30f;

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
  const TextureReader& texture = mesh.material->texture<&Material::emissive_texture>();
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
  add_punctual(scene);
  add_triangles(geometry);
  make_sources();
}

Lights::PunctualLight Lights::place(const Scene& scene, const Node& node) {
  const Light& light = scene.lights[static_cast<std::size_t>(node.light)];
  PunctualLight p;
  p.position = vec3(node.world_from_node[3]);
  p.intensity = light.color * light.intensity;
  const vec3 axis = transform_vector(node.world_from_node, {0, 0, -1});
  const float length = glm::length(axis);
  p.lamp.kind = static_cast<int>(light.type);
  p.lamp.direction = length > 0.0f ? axis / length : vec3(0, 0, -1);
  p.lamp.range = light.range;
  p.lamp.falloff = static_cast<int>(light.falloff);
  p.lamp.polynomial = light.polynomial;
  p.lamp.cos_inner = std::cos(light.inner_cone);
  p.lamp.cos_outer = std::cos(light.outer_cone);
  const float intensity = luminance(light.color) * light.intensity;
  float power = intensity;
  if (light.type == LightType::spot) {
    power *= shade::light_spot_solid_angle(p.lamp.cos_inner, p.lamp.cos_outer);
  } else if (light.ies >= 0) {
    p.ies = &scene.ies_profiles[static_cast<std::size_t>(light.ies)];
    const vec3 along = glm::normalize(transform_vector(node.world_from_node, {1, 0, 0}));
    p.lamp.across = frame_from_tangent(-p.lamp.direction, along).t;
    p.lamp.handedness = glm::determinant(mat3(node.world_from_node)) < 0.0f ? -1.0f : 1.0f;
    power *= static_cast<float>(ies_flux(*p.ies));
  } else if (light.type == LightType::point) {
    power *= 4.0f * kPi;
  }
  p.power = std::min(power, kMostPower);
  return p;
}

void Lights::add_punctual(const Scene& scene) {
  for (const Node& node : scene.nodes) {
    if (node.light >= 0) punctual_.push_back(place(scene, node));
  }
}

void Lights::add_triangles(Geometry& geometry) {
  auto& placements = geometry.placements();
  for (std::size_t i = 0; i < placements.size(); ++i) {
    Placement& placement = placements[i];
    if (!placement.mesh->material->is_emissive) continue;
    placement.first_light = static_cast<int>(triangles_.size());
    const std::size_t first = triangles_.size();
    const std::size_t count = placement.mesh->triangles.size();
    triangles_.resize(first + count);
    triangle_powers_.resize(first + count);
    const float sides = placement.mesh->material->factors.double_sided ? 2.0f : 1.0f;
    parallel_for(0, count, 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const auto triangle = static_cast<std::uint32_t>(k);
        const TrianglePositions p = triangle_positions(placement, triangle);
        TriangleLight& light = triangles_[first + k];
        light.placement = static_cast<std::int32_t>(i);
        light.triangle = triangle;
        light.area = 0.5f * glm::length(glm::cross(p.p1 - p.p0, p.p2 - p.p0));
        triangle_powers_[first + k] =
            std::min(kPi * sides * light.area * mean_emission(*placement.mesh, triangle), kMostPower);
      }
    });
  }
}

/// `first` and `count` in the order: punctual lights, triangles.
Lights::Source Lights::make_source(std::size_t first, std::size_t count) const {
  Source source;
  source.first = first;
  std::vector<float> powers(count);
  Box3 box;
  double power = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t light = first + i;
    if (light < punctual_.size()) {
      powers[i] = punctual_[light].power;
      box.extend(punctual_[light].position);
    } else {
      const std::size_t triangle = light - punctual_.size();
      powers[i] = triangle_powers_[triangle];
      if (powers[i] > 0.0f) {
        const TriangleLight& t = triangles_[triangle];
        const TrianglePositions p = triangle_positions(geometry_.placement(t.placement), t.triangle);
        box.extend(p.p0), box.extend(p.p1), box.extend(p.p2);
      }
    }
    power += static_cast<double>(powers[i]);
  }
  if (!(power > 0.0) || !std::isfinite(power)) return source;
  source.choice = Distribution1D(powers);
  source.strength = static_cast<float>(power / (4.0 * static_cast<double>(kPi)));
  source.center = box.center();
  // Inside the source its light comes from all around: nearer than half its size does not count as nearer.
  source.least_distance2 = std::max(0.0625f * glm::dot(box.size(), box.size()), 1e-12f);
  return source;
}

void Lights::make_sources() {
  if (environment_.can_sample()) {
    // Mean over all orientations of a surface: a quarter of the flux through the point.
    sources_.push_back({.kind = SourceKind::map, .strength = 0.25f * environment_.flux()});
  }
  for (std::size_t i = 0; i < environment_.suns().size(); ++i) {
    const auto& sun = environment_.suns()[i];
    sources_.push_back({.kind = SourceKind::sun, .first = i, .strength = luminance(sun.radiance) * sun.solid_angle});
  }
  if (sources_.size() >= LightChances::kMost) throw Error("an environment may have at most 30 suns");

  // ----- what stands in the scene: one by one where they are few, else all in one source by power
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < punctual_.size(); ++i) starts.push_back(i);
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    if (i == 0 || triangles_[i].placement != triangles_[i - 1].placement) starts.push_back(punctual_.size() + i);
  }
  if (starts.empty()) return;
  const bool are_few = sources_.size() + starts.size() <= LightChances::kMost;
  if (!are_few) starts.assign(1, 0);
  starts.push_back(punctual_.size() + triangles_.size());
  for (std::size_t k = 0; k + 1 < starts.size(); ++k) {
    Source source = make_source(starts[k], starts[k + 1] - starts[k]);
    if (source.strength <= 0.0f) continue;
    if (are_few && starts[k] < punctual_.size()) source.kind = SourceKind::punctual;
    for (std::size_t i = std::max(starts[k], punctual_.size()); i < starts[k + 1]; ++i) {
      triangles_[i - punctual_.size()].source = static_cast<std::uint32_t>(sources_.size());
    }
    sources_.push_back(std::move(source));
  }
}

/// Estimate that steers the choice alone. It is 0 only where the source really gives nothing.
float Lights::irradiance(const Source& source, vec3 position) const {
  switch (source.kind) {
    case SourceKind::map:
    case SourceKind::sun:
      return source.strength;
    case SourceKind::punctual: {
      const LightSample s = sample_punctual(punctual_[source.first], position);
      return luminance(s.radiance);
    }
    case SourceKind::many: {
      const vec3 d = source.center - position;
      return source.strength / std::max(glm::dot(d, d), source.least_distance2);
    }
  }
  return 0.0f;
}

void Lights::find_chances(vec3 position, LightChances& chances) const {
  if (sources_.size() == 1) {
    chances.pmf[0] = 1.0f;
    return;
  }
  float sum = 0.0f;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    chances.pmf[i] = irradiance(sources_[i], position);
    sum += chances.pmf[i];
  }
  const float scale = sum > 0.0f ? 1.0f / sum : 0.0f;
  for (std::size_t i = 0; i < sources_.size(); ++i) chances.pmf[i] *= scale;
}

LightSample Lights::sample(vec3 position, const LightChances& chances, float u_choice, vec2 u) const {
  // ----- a source; what is left of u_choice chooses inside it
  std::size_t index = 0;
  while (index + 1 < sources_.size() && u_choice >= chances.pmf[index]) u_choice -= chances.pmf[index++];
  const float chance = chances.pmf[index];
  if (chance <= 0.0f) return {};
  const Source& source = sources_[index];
  const float u_inside = std::min(u_choice / chance, 0x1.fffffep-1f);

  LightSample s;
  switch (source.kind) {
    case SourceKind::map:
      s = sample_environment(u);
      break;
    case SourceKind::sun:
      s = sample_sun(environment_.suns()[source.first], u);
      break;
    case SourceKind::punctual:
      s = sample_punctual(punctual_[source.first], position);
      break;
    case SourceKind::many: {
      const Distribution1D::Sample choice = source.choice.sample(u_inside);
      const std::size_t light = source.first + static_cast<std::size_t>(choice.index);
      s = light < punctual_.size() ? sample_punctual(punctual_[light], position)
                                   : sample_triangle(triangles_[light - punctual_.size()], position, u);
      s.pdf *= choice.pmf;
      break;
    }
  }
  s.pdf *= chance;
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
  s.radiance = p.intensity;
  if (p.lamp.kind == shade::kDirectionalLight) {
    s.direction = -p.lamp.direction;
    return s;
  }
  const vec3 to_light = p.position - position;
  s.distance = glm::length(to_light);
  if (!(s.distance > 0.0f)) return {};
  s.direction = to_light / s.distance;
  s.target = p.position;
  s.radiance *= shade::light_left(p.lamp, s.direction, s.distance);
  if (p.ies != nullptr) s.radiance *= ies_intensity(*p.ies, shade::light_local(p.lamp, s.direction));
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

vec3 Lights::escaped_radiance(vec3 direction, const EnvironmentLight::Footprint& footprint, float bsdf_pdf,
                              const LightChances& chances) const {
  const EnvironmentLight::Value value = environment_.read(footprint);
  vec3 radiance = value.radiance;
  std::size_t source = 0;
  if (environment_.can_sample()) {
    radiance *= mis_weight(bsdf_pdf, value.pdf * chances.pmf[source++], kEnvironmentMisPower);
  }
  for (const auto& sun : environment_.suns()) {
    const float chance = chances.pmf[source++];
    if (!sun.contains(direction)) continue;
    radiance += sun.radiance * mis_weight(bsdf_pdf, chance / sun.solid_angle, kAreaMisPower);
  }
  return radiance;
}

float Lights::triangle_pdf(int light, const LightChances& chances, float distance, float cos_light) const {
  const TriangleLight& triangle = triangles_[static_cast<std::size_t>(light)];
  if (cos_light <= 0.0f || triangle.area <= 0.0f || triangle_powers_[static_cast<std::size_t>(light)] <= 0.0f)
    return 0.0f;
  const Source& source = sources_[triangle.source];
  const int index = light + static_cast<int>(punctual_.size()) - static_cast<int>(source.first);
  return chances.pmf[triangle.source] * source.choice.pmf(index) * distance * distance / (triangle.area * cos_light);
}

}  // namespace candela::path
