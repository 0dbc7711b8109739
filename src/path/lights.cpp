#include "path/lights.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "math/sobol.h"
#include "path/surface_point.h"
#include "scene/environment.h"

namespace candela::path {

namespace {

/// Keeps sums of absurdly bright lamps finite.
constexpr float kMostPower = 1e30f;

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
    sum += luminance(emission_at(mesh, t, shade::light_barycentric(sampler.next_2d())));
  }
  return sum / static_cast<float>(count);
}

/// The cone that holds all that a profile sends out, in the light's own space.
struct ProfileCone {
  vec3 axis;
  float reach;  ///< radians
};

ProfileCone profile_cone(const IesProfile& p) {
  // Between two entries of the table it is linear: dark where both are.
  const std::size_t count = p.vertical_deg.size();
  std::size_t first = count, last = 0;
  for (std::size_t i = 0; i < p.candela.size(); ++i) {
    if (!(p.candela[i] > 0.0f)) continue;
    first = std::min(first, i % count);
    last = std::max(last, i % count);
  }
  constexpr float kRoom = 1e-3f;  // for the rounding of angles near 180°
  const float lowest = first > 0 && first < count ? p.vertical_deg[first - 1] : p.vertical_deg.front();
  const float highest = p.vertical_deg[std::min(last + 1, count - 1)];
  const bool is_up = 180.0f - lowest < highest;
  const vec3 web_axis(0, 0, is_up ? 1 : -1);
  return {glm::transpose(p.web_from_light) * web_axis,
          std::min(radians(is_up ? 180.0f - lowest : highest) + kRoom, kPi)};
}

}  // namespace

Lights::Lights(const Scene& scene, std::shared_ptr<const PreparedEnvironment> environment, Geometry& geometry)
    : geometry_(geometry), prepared_(std::move(environment)), environment_(prepared_->light) {
  add_punctual(scene);
  add_triangles(geometry);
  make_sources();
  if (geometry.ground() != nullptr) from_above_ = irradiance_from_above(prepared_->environment);
}

Lights::PunctualLight Lights::place(const Scene& scene, const Node& node) const {
  const Light& light = scene.lights[static_cast<std::size_t>(node.light)];
  PunctualLight p{placed_lamp(scene, node, geometry_.origin())};
  float power = luminance(light.color) * light.intensity;
  if (light.type == LightType::spot) {
    power *= shade::light_spot_solid_angle(p.lamp.cos_inner, p.lamp.cos_outer);
  } else if (p.ies != nullptr) {
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
    // Of a geometry that another picture reads meanwhile it is the same number.
    const int first_light = static_cast<int>(triangles_.size());
    if (placement.first_light != first_light) placement.first_light = first_light;
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

Lights::Source Lights::triangle_source(std::size_t first, std::size_t count) const {
  Source source;
  source.first = first;
  Box3 box;
  double power = 0.0;
  const std::span<const float> powers(triangle_powers_.data() + first, count);
  for (std::size_t i = 0; i < count; ++i) {
    if (powers[i] <= 0.0f) continue;
    const TriangleLight& t = triangles_[first + i];
    const TrianglePositions p = triangle_positions(geometry_.placement(t.placement), t.triangle);
    box.extend(p.p0), box.extend(p.p1), box.extend(p.p2);
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

  // ----- what stands in the scene: one by one where they are few, else in a tree
  std::vector<std::size_t> starts;  // of the triangles of one placement
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    if (i == 0 || triangles_[i].placement != triangles_[i - 1].placement) starts.push_back(i);
  }
  const bool are_few = sources_.size() + punctual_.size() + starts.size() <= LightChances::kMost;
  if (!are_few || triangles_matter()) {
    make_directional_sources();
    make_tree();
    return;
  }
  for (std::size_t i = 0; i < punctual_.size(); ++i) {
    if (punctual_[i].power > 0.0f) sources_.push_back({.kind = SourceKind::punctual, .first = i});
  }
  starts.push_back(triangles_.size());
  for (std::size_t k = 0; k + 1 < starts.size(); ++k) {
    Source source = triangle_source(starts[k], starts[k + 1] - starts[k]);
    if (source.strength <= 0.0f) continue;
    for (std::size_t i = starts[k]; i < starts[k + 1]; ++i) {
      triangles_[i].source = static_cast<std::uint32_t>(sources_.size());
    }
    sources_.push_back(std::move(source));
  }
}

/// Whether so many triangles glow, and so brightly beside what is far away, that choosing among all of a primitive by
/// power would be the noise of the picture.
bool Lights::triangles_matter() const {
  constexpr std::ptrdiff_t kFew = 32;
  constexpr float kLeastShare = 0.1f;
  const auto glows = [](float power) { return power > 0.0f; };
  if (std::count_if(triangle_powers_.begin(), triangle_powers_.end(), glows) <= kFew) return false;
  double power = 0.0, distant = 0.0;
  for (const float p : triangle_powers_) power += static_cast<double>(p);
  for (const Source& source : sources_) distant += static_cast<double>(source.strength);
  for (const PunctualLight& light : punctual_) {
    if (light.lamp.kind == shade::kDirectionalLight) distant += static_cast<double>(light.power);
  }
  // At half the way from the middle of the scene to its corners.
  const auto distance = static_cast<double>(0.25f * glm::length(geometry_.bounds().size()));
  return power / (4.0 * static_cast<double>(kPi) * distance * distance) > static_cast<double>(kLeastShare) * distant;
}

/// Lamps without a place can be in no tree: each is a source, or all are one where they would leave too little of the
/// chances to the tree.
void Lights::make_directional_sources() {
  constexpr std::size_t kForTree = LightChances::kMost / 2;
  std::vector<float> illuminances(punctual_.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < punctual_.size(); ++i) {
    if (punctual_[i].lamp.kind != shade::kDirectionalLight || !(punctual_[i].power > 0.0f)) continue;
    illuminances[i] = punctual_[i].power;
    ++count;
  }
  if (count == 0) return;
  if (sources_.size() + count > LightChances::kMost - kForTree) {
    Source source{.kind = SourceKind::directional};
    source.choice = Distribution1D(illuminances);
    source.strength = static_cast<float>(std::min(source.choice.total(), static_cast<double>(kMostPower)));
    sources_.push_back(std::move(source));
    return;
  }
  for (std::size_t i = 0; i < punctual_.size(); ++i) {
    if (illuminances[i] > 0.0f) sources_.push_back({.kind = SourceKind::punctual, .first = i});
  }
}

LightBounds Lights::bounds_of(const PunctualLight& light) const {
  LightBounds bounds;
  if (light.lamp.kind == shade::kSpotLight) {
    bounds = cone_light_bounds(light.position, light.lamp.direction, std::acos(light.lamp.cos_inner),
                               std::acos(light.lamp.cos_outer), light.power);
  } else if (light.ies != nullptr) {
    const ProfileCone cone = profile_cone(*light.ies);
    const vec3 z = -light.lamp.direction;
    const vec3 y = glm::cross(z, light.lamp.across) * light.lamp.handedness;
    bounds =
        cone_light_bounds(light.position, mat3(light.lamp.across, y, z) * cone.axis, 0.0f, cone.reach, light.power);
  } else {
    bounds.box.extend(light.position);
    bounds.power = light.power;
    const bool is_endless = light.lamp.falloff == shade::kFalloffGltf && light.lamp.range == kInfinity;
    bounds.is_exact = is_endless || light.lamp.falloff == shade::kFalloffInverseSquare;
  }
  switch (light.lamp.falloff) {
    case shade::kFalloffGltf:
    case shade::kFalloffUe4:
      bounds.range = light.lamp.range;
      break;
    case shade::kFalloffPolynomial: {
      // The inverse square that agrees at a typical distance.
      const float distance = std::max(0.25f * glm::length(geometry_.bounds().size()), 1e-3f);
      bounds.power *= distance * distance * shade::light_falloff_polynomial(distance, light.lamp.polynomial);
      break;
    }
    default:
      break;
  }
  bounds.power = std::clamp(bounds.power, 1e-30f, kMostPower);
  return bounds;
}

LightBounds Lights::bounds_of(const TriangleLight& light, float power) const {
  const Placement& placement = geometry_.placement(light.placement);
  const TrianglePositions p = triangle_positions(placement, light.triangle);
  const vec3 normal = glm::normalize(glm::cross(p.p1 - p.p0, p.p2 - p.p0));
  if (!std::isfinite(normal.x + normal.y + normal.z)) {
    // Too small for a direction.
    LightBounds bounds = triangle_light_bounds(p.p0, p.p1, p.p2, vec3(0, 0, 1), false, power);
    bounds.cos_spread = -1.0f;
    return bounds;
  }
  return triangle_light_bounds(p.p0, p.p1, p.p2, placement.is_mirrored ? -normal : normal,
                               placement.mesh->material->factors.double_sided, power);
}

/// Of everything with a place.
void Lights::make_tree() {
  for (std::uint32_t i = 0; i < punctual_.size(); ++i) {
    const bool has_place = punctual_[i].lamp.kind != shade::kDirectionalLight;
    if (has_place && punctual_[i].power > 0.0f) tree_lights_.push_back(i);
  }
  const auto first = static_cast<std::uint32_t>(punctual_.size());
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
    if (triangle_powers_[i] > 0.0f) tree_lights_.push_back(first + i);
  }
  std::vector<LightBounds> bounds(tree_lights_.size());
  parallel_for(0, bounds.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t light = tree_lights_[i];
      bounds[i] = light < first ? bounds_of(punctual_[light])
                                : bounds_of(triangles_[light - first], triangle_powers_[light - first]);
    }
  });
  tree_ = LightTree(bounds);
  for (std::uint32_t i = 0; i < tree_lights_.size(); ++i) {
    if (tree_lights_[i] >= first) triangles_[tree_lights_[i] - first].source = tree_.rank(i);
  }
}

/// As sample_punctual() has it, times the cosine.
float Lights::irradiance(const PunctualLight& p, const LightReceiver& receiver) const {
  if (p.lamp.kind == shade::kDirectionalLight) {
    return luminance(p.intensity) * shade::light_facing(receiver.side, -glm::dot(receiver.normal, p.lamp.direction));
  }
  const vec3 to_light = p.position - receiver.position;
  const float distance = glm::length(to_light);
  if (!(distance > 0.0f)) return 0.0f;
  const vec3 direction = to_light / distance;
  const float facing = shade::light_facing(receiver.side, glm::dot(receiver.normal, direction));
  if (facing <= 0.0f) return 0.0f;
  float intensity = luminance(p.intensity) * shade::light_left(p.lamp, direction, distance);
  if (p.ies != nullptr && intensity > 0.0f) intensity *= ies_intensity(*p.ies, shade::light_local(p.lamp, direction));
  return intensity * facing;
}

vec3 Lights::unhindered_irradiance(vec3 position) const {
  constexpr vec3 kUp(0, 1, 0);
  vec3 sum = from_above_;
  for (const PunctualLight& light : punctual_) {
    const ArrivingLight arriving = arriving_light(light, position);
    sum += arriving.irradiance * std::max(glm::dot(kUp, arriving.direction), 0.0f);
  }
  return sum;
}

/// Estimate that steers the choice alone. It is 0 only where the source really gives nothing.
float Lights::irradiance(const Source& source, const LightReceiver& receiver) const {
  switch (source.kind) {
    case SourceKind::map:
    case SourceKind::directional:
      return source.strength;
    case SourceKind::sun: {
      const auto& sun = environment_.suns()[source.first];
      return source.strength * shade::light_sun_facing(receiver.side, glm::dot(receiver.normal, sun.frame.n),
                                                       sun.sin2_radius, sun.solid_angle);
    }
    case SourceKind::punctual:
      return irradiance(punctual_[source.first], receiver);
    case SourceKind::many: {
      const vec3 d = source.center - receiver.position;
      return source.strength / std::max(glm::dot(d, d), source.least_distance2);
    }
  }
  return 0.0f;
}

void Lights::find_chances(const LightReceiver& receiver, bool is_seen, LightChances& chances) const {
  chances.receiver = receiver;
  chances.samples = 1;
  chances.tree.size = 0;
  if (tree_.empty() && sources_.size() == 1) {
    chances.pmf[0] = 1.0f;
    return;
  }
  float sum = 0.0f;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    chances.pmf[i] = irradiance(sources_[i], receiver);
    sum += chances.pmf[i];
  }
  if (!tree_.empty()) {
    const auto exact = [this](std::uint32_t lamp, const LightReceiver& at) { return leaf_irradiance(lamp, at); };
    tree_.find_cut(receiver, is_seen ? shade::kLightCut : shade::kLightCut / 2, exact, chances.tree);
    float by_tree = 0.0f;
    for (int i = 0; i < chances.tree.size; ++i) by_tree += chances.tree.shares[i];
    sum += by_tree;
    if (is_seen && sum > 0.0f) chances.samples = shade::light_samples(by_tree / sum);
  }
  const float scale = sum > 0.0f ? 1.0f / sum : 0.0f;
  for (std::size_t i = 0; i < sources_.size(); ++i) chances.pmf[i] *= scale;
  for (int i = 0; i < chances.tree.size; ++i) chances.tree.shares[i] *= scale;
}

LightSample Lights::sample(const LightChances& chances, float u_choice, vec2 u) const {
  // ----- a source; what is left of u_choice chooses inside it
  const std::size_t count = sources_.size();
  std::size_t index = 0;
  while (index < count && u_choice >= chances.pmf[index]) u_choice -= chances.pmf[index++];
  if (index == count && chances.tree.size > 0) return sample_tree(chances, u_choice, u);
  if (count == 0) return {};
  index = std::min(index, count - 1);  // what rounding left of the chances is the last one's
  const float chance = chances.pmf[index];
  if (chance <= 0.0f) return {};
  LightSample s =
      sample_source(sources_[index], chances.receiver.position, std::min(u_choice / chance, shade::kLightAlmostOne), u);
  s.pdf *= chance * static_cast<float>(chances.samples);
  return s;
}

LightSample Lights::sample_source(const Source& source, vec3 position, float u_choice, vec2 u) const {
  switch (source.kind) {
    case SourceKind::map:
      return sample_environment(u);
    case SourceKind::sun:
      return sample_sun(environment_.suns()[source.first], u);
    case SourceKind::punctual:
      return sample_punctual(punctual_[source.first], position);
    case SourceKind::directional: {
      const Distribution1D::Sample choice = source.choice.sample(u_choice);
      LightSample s = sample_punctual(punctual_[static_cast<std::size_t>(choice.index)], position);
      s.pdf *= choice.pmf;
      return s;
    }
    case SourceKind::many: {
      const Distribution1D::Sample choice = source.choice.sample(u_choice);
      LightSample s = sample_triangle(triangles_[source.first + static_cast<std::size_t>(choice.index)], position, u);
      s.pdf *= choice.pmf;
      return s;
    }
  }
  return {};
}

LightSample Lights::sample_tree(const LightChances& chances, float u_choice, vec2 u) const {
  const shade::LightCut& cut = chances.tree;
  int index = 0;
  while (index + 1 < cut.size && u_choice >= cut.shares[index]) u_choice -= cut.shares[index++];
  const float chance = cut.shares[index];
  if (chance <= 0.0f) return {};
  const auto exact = [this](std::uint32_t lamp, const LightReceiver& at) { return leaf_irradiance(lamp, at); };
  const LightReceiver& receiver = chances.receiver;
  const LightTree::Choice choice =
      tree_.choose(cut.nodes[index], receiver, std::min(u_choice / chance, shade::kLightAlmostOne), exact);
  if (choice.pmf <= 0.0f) return {};
  const std::uint32_t light = tree_lights_[choice.lamp];
  LightSample s = light < punctual_.size()
                      ? sample_punctual(punctual_[light], receiver.position)
                      : sample_triangle(triangles_[light - punctual_.size()], receiver.position, u);
  s.pdf *= choice.pmf * chance * static_cast<float>(chances.samples);
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
  LightSample s;
  s.direction = sun.frame.to_world(shade::light_in_cone(sun.solid_angle, u));
  s.radiance = sun.radiance;
  s.pdf = 1.0f / sun.solid_angle;
  s.mis_power = kAreaMisPower;
  return s;
}

LightSample Lights::sample_punctual(const PunctualLight& p, vec3 position) const {
  const ArrivingLight light = arriving_light(p, position);
  if (!(light.distance > 0.0f)) return {};
  LightSample s;
  s.is_delta = true;
  s.pdf = 1.0f;
  s.direction = light.direction;
  s.distance = light.distance;
  s.target = p.position;
  s.radiance = light.irradiance;
  return s;
}

LightSample Lights::sample_triangle(const TriangleLight& light, vec3 position, vec2 u) const {
  const Placement& placement = geometry_.placement(light.placement);
  const MeshData& mesh = *placement.mesh;
  const TrianglePositions p = triangle_positions(placement, light.triangle);
  const vec3 b = shade::light_barycentric(u);
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
  if (placement.shares_plane) {
    Hit lamp;
    lamp.placement = light.placement;
    lamp.triangle = light.triangle;
    lamp.u = b.y;
    lamp.v = b.z;
    s.radiance *= geometry_.transmittance_over(lamp, normal, s.direction);
  }
  s.pdf = s.distance * s.distance / (light.area * cos_light);
  s.mis_power = kAreaMisPower;
  return s;
}

vec3 Lights::weighted_map(const EnvironmentLight::Footprint& footprint, float bsdf_pdf,
                          const LightChances& chances) const {
  const EnvironmentLight::Value value = environment_.read(footprint);
  if (!environment_.can_sample()) return value.radiance;
  const float chance = static_cast<float>(chances.samples) * chances.pmf[0];
  return value.radiance * mis_weight(bsdf_pdf, value.pdf * chance, kEnvironmentMisPower);
}

vec3 Lights::weighted_suns(vec3 direction, float bsdf_pdf, const LightChances& chances) const {
  vec3 radiance(0.0f);
  std::size_t source = environment_.can_sample() ? 1 : 0;
  for (const auto& sun : environment_.suns()) {
    const float chance = static_cast<float>(chances.samples) * chances.pmf[source++];
    if (!sun.contains(direction)) continue;
    radiance += sun.radiance * mis_weight(bsdf_pdf, chance / sun.solid_angle, kAreaMisPower);
  }
  return radiance;
}

float Lights::triangle_pdf(int light, const LightChances& chances, float distance, float cos_light) const {
  const TriangleLight& triangle = triangles_[static_cast<std::size_t>(light)];
  if (cos_light <= 0.0f || triangle.area <= 0.0f || triangle_powers_[static_cast<std::size_t>(light)] <= 0.0f)
    return 0.0f;
  const float density = static_cast<float>(chances.samples) * distance * distance / (triangle.area * cos_light);
  if (tree_.empty()) {
    const Source& source = sources_[triangle.source];
    const int index = light - static_cast<int>(source.first);
    return chances.pmf[triangle.source] * source.choice.pmf(index) * density;
  }
  const auto exact = [this](std::uint32_t lamp, const LightReceiver& at) { return leaf_irradiance(lamp, at); };
  const shade::LightCut& cut = chances.tree;
  for (int i = 0; i < cut.size; ++i) {
    if (!tree_.holds(cut.nodes[i], triangle.source)) continue;
    return cut.shares[i] * tree_.pmf(cut.nodes[i], chances.receiver, triangle.source, exact) * density;
  }
  return 0.0f;
}

}  // namespace candela::path
