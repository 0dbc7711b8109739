#include "path/walk.h"

#include <cmath>

#include "math/hash.h"
#include "shade/dispersion.glsl.h"

namespace candela::path {

namespace {

constexpr int kMostScatterings = 4096;  // a white body of a million mean free paths keeps light forever
constexpr int kScatteringsBeforeLoss = 16;

vec3 turn(vec3 direction, float cosine, float u) {
  const Frame frame = frame_from_normal(direction);
  const float sine = std::sqrt(std::max(1.0f - cosine * cosine, 0.0f));
  const float phi = 2.0f * kPi * u;
  return glm::normalize(frame.to_world({sine * std::cos(phi), sine * std::sin(phi), cosine}));
}

/// A body has a far side. Light that finds none was in no body, or has slipped out of one by rounding.
bool is_endless(float distance) { return !(distance < 1e15f); }

float opacity_at(const Placement& placement, const Hit& hit) {
  const MeshData& mesh = *placement.mesh;
  return mesh.opacity(mesh.triangles[hit.triangle], {1.0f - hit.u - hit.v, hit.u, hit.v});
}

/// How a medium scatters for light that enters it here.
vec3 albedo_at(const Placement& placement, const Hit& hit) {
  const MeshData& mesh = *placement.mesh;
  const MaterialData& material = *mesh.material;
  if (!material.medium.scatters || !material.has_scatter_texture()) return material.medium.albedo;
  const uvec3& t = mesh.triangles[hit.triangle];
  const vec3 b(1.0f - hit.u - hit.v, hit.u, hit.v);
  const auto read = [&](const TextureReader& texture) { return texture.sample(mesh.uv(t, b, texture.uv_set())); };
  vec3 color = material.factors.multiscatter_color;
  const TextureReader& strength = material.texture<&Material::scatter_strength_texture>();
  const TextureReader& colors = material.texture<&Material::multiscatter_color_texture>();
  if (strength) color *= read(strength).w;
  if (colors) color *= vec3(read(colors));
  return single_scatter_albedo(color, material.medium.anisotropy);
}

/// Whether a blended boundary that a path leaves a body by is there; the traversal did not ask (geometry.cpp).
bool is_there(const Placement& placement, const Hit& hit) {
  if (!placement.mesh->material->needs_opacity) return true;
  constexpr std::uint32_t kSalt = 0x6578'6974;
  const std::uint32_t chance =
      hash_combine(hash_combine(hit.seed ^ kSalt, hit.triangle), static_cast<std::uint32_t>(hit.placement));
  return unit_float(chance) < opacity_at(placement, hit);
}

/// Who is not in a body whose back he meets has come in through a hole, if it can have one.
bool is_whole(const Placement& placement) { return !placement.mesh->material->needs_opacity; }

}  // namespace

float Walk::index_of(const Medium* medium) const {
  if (medium == nullptr) return 1.0f;
  if (wavelength_nm_ <= 0.0f || medium->dispersion <= 0.0f) return medium->ior;
  return shade::dispersion_ior(medium->ior, medium->dispersion, wavelength_nm_);
}

Crossing Walk::find_crossing(const PathContext& context, const Hit& hit, vec3 direction, float u_wavelength) {
  const Placement& placement = context.geometry.placement(hit.placement);
  const std::vector<Body>& bodies = context.geometry.bodies();
  const auto is_open = [&](int body) { return bodies[static_cast<std::size_t>(body)].is_open; };
  Crossing crossing;
  if (placement.body == 0) {
    // A thin sheet may be the lid of a body that is open without it.
    const int top = media_.top();
    if (top == 0 || !is_open(top) || !is_back_hit(context.geometry, hit, direction)) return crossing;
    crossing.body = top;
    crossing.inside = media_.current();
    return crossing;
  }
  const MaterialData& material = *placement.mesh->material;
  crossing.body = placement.body;
  crossing.inside = &material.medium;
  crossing.is_entering = !is_back_hit(context.geometry, hit, direction);
  if (crossing.is_entering) crossing.albedo = albedo_at(placement, hit);
  bool is_within = false;
  if (!crossing.is_entering) {
    is_within = media_.holds(crossing.body);
    // Faces that no edge joins may yet bound one body: the way out of an open one ends the open one entered last.
    if (!is_within) {
      const int open = is_open(crossing.body) ? media_.last(is_open) : 0;
      if (open != 0) {
        crossing.body = open;
        is_within = true;
      }
    }
    const bool is_top = media_.is_top(crossing.body);
    crossing.is_hidden = is_within ? !is_top || !is_there(placement, hit) : !is_whole(placement);
    if (crossing.is_hidden) return crossing;
  }
  const Medium* before = crossing.is_entering || is_within ? media_.current() : crossing.inside;
  const Medium* beyond = crossing.is_entering ? crossing.inside : is_within ? media_.below_top() : media_.current();
  const auto disperses = [](const Medium* m) { return m != nullptr && m->dispersion > 0.0f; };
  if (wavelength_nm_ <= 0.0f && (disperses(before) || disperses(beyond))) {
    wavelength_nm_ = shade::wavelength_sample(u_wavelength);
    throughput *= shade::wavelength_weight(wavelength_nm_);
  }
  crossing.eta = index_of(beyond) / index_of(before);
  return crossing;
}

void Walk::cross(const Crossing& crossing) {
  if (crossing.body == 0) return;
  if (crossing.is_entering) {
    media_.enter(crossing.body, crossing.inside, crossing.albedo);
  } else {
    media_.leave(crossing.body);
  }
  if (!crossing.is_hidden) eta_scale *= crossing.eta * crossing.eta;
}

vec3 Walk::transmittance(const Crossing& crossing, bool is_beyond, float distance) const {
  MediumStack media = media_;
  if (is_beyond && crossing.body != 0) {
    if (crossing.is_entering) {
      media.enter(crossing.body, crossing.inside);
    } else {
      media.leave(crossing.body);
    }
  }
  const Medium* medium = media.current();
  if (medium == nullptr || !medium->absorbs) return vec3(1.0f);
  return is_endless(distance) ? vec3(1.0f) : medium->transmittance(distance);
}

bool Walk::travel(const PathContext& context, vec3 start, Ray& ray, Hit& hit, SobolSampler& sampler, RayCounts& counts,
                  bool& scattered) {
  scattered = false;
  const Medium* medium = media_.current();
  if (medium == nullptr || !medium->absorbs) return true;
  const vec3 albedo = media_.albedo();
  const auto next = [&sampler] { return unit_float(sampler.next_hash()); };
  for (int n = 0; n < kMostScatterings; ++n) {
    const float surface = hit ? std::max(hit.t + distance_passed(context.geometry, hit, start, ray), 0.0f) : kInfinity;
    if (is_endless(surface)) return true;
    if (!medium->scatters) {
      throughput *= medium->transmittance(surface);
      return max_component(throughput) > 0.0f;
    }
    // ----- free flight, as one of the channels
    const vec3 chances = shade::medium_chances(throughput * albedo);
    const float sigma = medium->extinction[shade::medium_channel(chances, next())];
    const float flight = sigma > 0.0f ? -std::log1p(-next()) / sigma : kInfinity;
    if (flight >= surface) {
      throughput *= shade::medium_passed(medium->transmittance(surface), chances);
      return max_component(throughput) > 0.0f;
    }
    throughput *= shade::medium_scattered(medium->extinction, albedo, medium->transmittance(flight), chances);
    if (n >= kScatteringsBeforeLoss) {
      const float survival = std::min(max_component(throughput) * eta_scale, 0.99f);
      if (next() >= survival) return false;
      throughput /= survival;
    }
    if (max_component(throughput) <= 0.0f) return false;
    // ----- a new direction, by the phase function
    const vec3 position = start + flight * ray.direction;
    const float cosine = shade::phase_cosine(medium->anisotropy, next());
    ray = {position, turn(ray.direction, cosine, next())};
    start = position;
    scattered = true;
    ++counts.bounce;
    hit = context.geometry.intersect(ray, sampler.next_hash());
  }
  return false;
}

}  // namespace candela::path
