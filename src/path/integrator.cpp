#include "path/integrator.h"

#include <algorithm>

#include "path/surface_point.h"

namespace candela::path {

namespace {

PathSample background_sample(const PathContext& context, vec3 direction) {
  PathSample sample;
  sample.albedo = vec3(1.0f);
  if (context.background == Background::environment) {
    sample.radiance = context.lights.environment().background(direction);
  } else {
    sample.alpha = 0.0f;
  }
  return sample;
}

void record_first_surface(const SurfacePoint& point, PathSample& sample) {
  sample.normal = point.frame.n;
  sample.albedo = point.is_unlit || max_component(point.emission) > 0.0f
                      ? vec3(1.0f)
                      : glm::min(shade::surface_albedo(point.surface, point.wo.z), vec3(1.0f));
}

/// Light from one lamp chosen among all, times the surface's response, weighted against meeting it by chance.
vec3 direct_light(const PathContext& context, const SurfacePoint& point, const LightChances& chances, float u_choice,
                  vec2 u, RayCounts& counts) {
  const LightSample light = context.lights.sample(point.position, chances, u_choice, u);
  if (light.pdf <= 0.0f || !point.is_outside(light.direction)) return vec3(0.0f);
  const shade::SurfaceEval f = shade::surface_eval(point.surface, point.wo, point.frame.to_local(light.direction));
  if (max_component(f.value) <= 0.0f) return vec3(0.0f);

  Ray shadow;
  shadow.origin = point.ray_origin(light.direction);
  shadow.direction = light.direction;
  if (light.distance < kInfinity) {
    const vec3 to_light = light.target - shadow.origin;
    const float distance = glm::length(to_light);
    if (!(distance > 0.0f)) return vec3(0.0f);
    shadow.direction = to_light / distance;
    shadow.t_max = distance * (1.0f - 1e-6f);
  }
  ++counts.shadow;
  const float transmittance = context.geometry.transmittance(shadow);
  const float weight = light.is_delta ? 1.0f : mis_weight(light.pdf, f.pdf, light.mis_power);
  return f.value * context.lights.radiance(light) * (transmittance * weight / light.pdf);
}

/// Weight of emission met by chance against having chosen that triangle as the lamp. `bsdf_pdf` ≤ 0: nothing else
/// could.
float emission_weight(const PathContext& context, const Hit& hit, const SurfacePoint& point, const Ray& ray,
                      float bsdf_pdf, const LightChances& chances) {
  const int first = context.geometry.placement(hit.placement).first_light;
  if (bsdf_pdf <= 0.0f || first < 0) return 1.0f;
  const float cos_light = -glm::dot(ray.direction, point.geometric_normal);
  const float distance = glm::length(point.position - ray.origin);
  const float pdf = context.lights.triangle_pdf(first + static_cast<int>(hit.triangle), chances, distance, cos_light);
  return mis_weight(bsdf_pdf, pdf, kAreaMisPower);
}

}  // namespace

Hit first_visible_hit(const PathContext& context, Ray& ray, Hit hit, SobolSampler& sampler, RayCounts& counts) {
  while (hit && is_culled_back(context.geometry, hit, ray.direction)) {
    // The same ray meets a triangle at the same distance each time, so that this ends; moving its origin might not.
    ray.t_min = std::max(hit.t * (1.0f + 0x1p-20f), 1e-30f);
    hit = context.geometry.intersect(ray, sampler.next_hash());
    ++counts.camera;
  }
  return hit;
}

PathSample trace_path(const PathContext& context, Ray ray, Hit hit, SobolSampler& sampler, RayCounts& counts) {
  hit = first_visible_hit(context, ray, hit, sampler, counts);
  if (!hit) return background_sample(context, ray.direction);

  PathSample sample;
  vec3 throughput(1.0f);
  float bsdf_pdf = 0.0f;            // of the direction that led here; 0 after the camera and after mirrors
  LightChances chances;             // of the lights at the vertex before
  EnvironmentLight::Footprint sky;  // what the current ray would see of the map
  for (int depth = 0;; ++depth) {
    // ----- the ray left the scene
    if (!hit) {
      sample.radiance += throughput * (bsdf_pdf > 0.0f && context.lights.can_sample()
                                           ? context.lights.escaped_radiance(ray.direction, sky, bsdf_pdf, chances)
                                           : context.lights.escaped_radiance(ray.direction, sky));
      break;
    }

    // ----- the numbers of this vertex, drawn early so that the light's tables arrive while the textures are read
    const vec2 choices = sampler.next_2d();
    const vec2 u_light = sampler.next_2d();
    const vec2 u_direction = sampler.next_2d();
    context.lights.prefetch(u_light);

    // ----- x_depth: emitted light
    const SurfacePoint point = make_surface_point(context.geometry, hit, ray.direction);
    if (depth == 0) record_first_surface(point, sample);
    if (max_component(point.emission) > 0.0f) {
      const float weight = point.is_unlit ? 1.0f : emission_weight(context, hit, point, ray, bsdf_pdf, chances);
      sample.radiance += throughput * point.emission * weight;
    }
    if (point.is_unlit || depth == context.bounces) break;

    // ----- next-event estimation: reflected light that comes straight from a lamp
    if (context.lights.can_sample() && !shade::surface_is_delta(point.surface)) {
      context.lights.find_chances(point.position, chances);
      sample.radiance += throughput * direct_light(context, point, chances, choices.x, u_light, counts);
    }

    // ----- the next direction, by the material
    const shade::SurfaceSample next =
        shade::surface_sample(point.surface, point.wo, {u_direction.x, u_direction.y, choices.y});
    const vec3 direction = point.frame.to_world(next.wi);
    if (max_component(next.weight) <= 0.0f || !point.is_outside(direction)) break;
    throughput *= next.weight;
    bsdf_pdf = next.is_delta ? 0.0f : next.pdf;

    // ----- Russian roulette: paths that carry little end early, the survivors stand for them
    if (depth >= 2) {
      const float survival = std::min(max_component(throughput), 0.95f);
      if (unit_float(sampler.next_hash()) >= survival) break;
      throughput /= survival;
    }

    ray = {};
    ray.origin = point.ray_origin(direction);
    ray.direction = direction;
    ++counts.bounce;
    sky = context.lights.environment().locate(direction);
    hit = context.geometry.intersect(ray, sampler.next_hash());
  }
  return sample;
}

PathSample trace_path_minimal(const PathContext& context, Ray ray, Hit hit, SobolSampler& sampler, RayCounts& counts) {
  hit = first_visible_hit(context, ray, hit, sampler, counts);
  if (!hit) return background_sample(context, ray.direction);

  PathSample sample;
  vec3 throughput(1.0f);
  for (int depth = 0; hit; ++depth) {
    const SurfacePoint point = make_surface_point(context.geometry, hit, ray.direction);
    if (depth == 0) record_first_surface(point, sample);
    sample.radiance += throughput * point.emission;
    if (point.is_unlit || depth == context.bounces) return sample;

    const vec3 u = sampler.next_3d();
    const shade::SurfaceSample next = shade::surface_sample(point.surface, point.wo, u);
    const vec3 direction = point.frame.to_world(next.wi);
    if (!point.is_outside(direction)) return sample;
    throughput *= next.weight;
    if (max_component(throughput) <= 0.0f) return sample;

    ray = {};
    ray.origin = point.ray_origin(direction);
    ray.direction = direction;
    ++counts.bounce;
    hit = context.geometry.intersect(ray, sampler.next_hash());
  }
  sample.radiance += throughput * context.lights.escaped_radiance(ray.direction);
  return sample;
}

}  // namespace candela::path
