#include "path/direct_light.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "path/bodies.h"
#include "path/camera.h"
#include "path/pixel_filter.h"
#include "path/tracer_parts.h"
#include "path/vertex.h"
#include "path/walk.h"

namespace candela::path {

namespace {

constexpr int kMostPassed = 64;  // surfaces that a ray goes through

struct PartSample {
  vec3 arriving{0.0f};
  vec3 unhindered{0.0f};

  void add(vec3 light, vec3 passing) {
    arriving += light * passing;
    unhindered += light;
  }
};

struct DirectSample {
  vec3 seen{0.0f};
  PartSample far, lamps, areas;

  PartSample& of(const LightSample& light) {
    if (light.is_map) return far;
    return light.is_delta || light.is_environment() ? lamps : areas;
  }
};

/// A lamp chosen among all: of two ways to meet it the first.
void sample_lamp(const PathContext& context, const SurfacePoint& point, bool is_body, const LightSample& light,
                 vec3 throughput, RayCounts& counts, DirectSample& sample) {
  if (light.pdf <= 0.0f) return;
  const bool is_outside = point.is_outside(light.direction);
  if (!is_outside && (is_body || !shade::surface_scatters_through(point.surface))) return;
  const vec3 wi = point.frame.to_local(light.direction);
  if ((wi.z > 0.0f) != is_outside) return;
  const shade::SurfaceEval f = shade::surface_eval(point.surface, point.wo, wi);
  if (max_component(f.value) <= 0.0f) return;
  const float weight = light.is_delta ? 1.0f : mis_weight(light.pdf, f.pdf, light.mis_power);
  const std::optional<Ray> shadow = shadow_ray(point.ray_origin(light.direction), light);
  if (!shadow) return;
  ++counts.shadow;
  sample.of(light).add(throughput * f.value * context.lights.radiance(light) * (weight / light.pdf),
                       context.geometry.transmittance(*shadow));
}

/// Glowing surfaces along a ray that a surface's sample follows, those behind others too. `pdf` is that of its
/// direction, ≤ 0 where no lamp is looked for.
void meet_glowing(const PathContext& context, const Ray& from, vec3 throughput, float pdf, const LightChances& chances,
                  std::uint32_t seed, RayCounts& counts, DirectSample& sample) {
  Ray ray = from;
  vec3 passing(1.0f);
  for (int i = 0; i < kMostPassed; ++i) {
    ++counts.bounce;
    const Hit hit = context.geometry.intersect(ray, seed);
    if (!hit) return;
    const SurfacePoint point = make_surface_point(context.geometry, hit, ray.direction);
    if (max_component(point.emission) > 0.0f) {
      const float weight = point.is_unlit ? 1.0f : emission_weight(context, hit, point, ray, from.origin, pdf, chances);
      sample.areas.add(throughput * point.emission * weight, passing);
    }
    const bool is_clear = point.material->is_clear_sheet && !point.material->needs_opacity;
    passing *= is_clear ? context.geometry.transmittance(hit, ray.direction) : vec3(0.0f);
    ray.origin = origin_beyond(context.geometry, hit, ray.direction);
  }
}

DirectSample direct_sample(const PathContext& context, Ray ray, SobolSampler& sampler, RayCounts& counts) {
  DirectSample sample;
  ++counts.camera;
  Hit hit = first_visible_hit(context, ray, context.geometry.intersect(ray, sampler.next_hash()), counts);
  Walk walk = context.eye_is_wide ? Walk(bodies_around(context.geometry, ray.origin)) : Walk(context.start);
  const vec2 choices = sampler.next_2d();
  const vec2 u_light = sampler.next_2d();
  const vec2 u_direction = sampler.next_2d();
  Crossing crossing;
  vec3 start = ray.origin;
  for (int passed = 0; context.has_media; ++passed) {
    bool scattered = false;
    if (passed > kMostPassed || !walk.travel(context, start, ray, hit, sampler, counts, scattered) || scattered) {
      return sample;
    }
    if (!hit) break;
    crossing = walk.find_crossing(context, hit, ray.direction, 0.5f);
    if (!crossing.is_hidden) break;
    walk.cross(crossing);
    start = position_of(context.geometry, hit);
    ray = next_ray(ray, origin_beyond(context.geometry, hit, ray.direction), ray.direction, true);
    hit = first_visible_hit(context, ray, context.geometry.intersect(ray, sampler.next_hash()), counts);
  }
  if (!hit) {
    sample.seen = walk.throughput * context.lights.environment().background(ray.direction);
    return sample;
  }
  const SurfacePoint point = make_surface_point(context.geometry, hit, ray.direction, crossing.eta);
  sample.seen = walk.throughput * point.emission;
  if (point.is_unlit) return sample;

  // ----- lamps that are looked for
  LightChances chances;
  const bool looks = context.lights.can_sample() && !shade::surface_is_delta(point.surface);
  if (looks) {
    context.lights.find_chances(receiver_at(point), true, chances);
    for (int i = 0; i < chances.samples; ++i) {
      const LightSample light =
          context.lights.sample(chances, chances.choice(i, choices.x), LightChances::place(i, u_light));
      sample_lamp(context, point, crossing.body != 0, light, walk.throughput, counts, sample);
    }
  }

  // ----- lamps that are met
  const shade::SurfaceSample next =
      shade::surface_sample(point.surface, point.wo, {u_direction.x, u_direction.y, choices.y});
  const bool is_through = next.wi.z < 0.0f;
  if (max_component(next.weight) <= 0.0f || next.is_straight || (is_through && crossing.body != 0)) return sample;
  const vec3 direction = point.frame.to_world(next.wi);
  if (point.is_outside(direction) == is_through) return sample;
  const vec3 throughput = walk.throughput * next.weight;
  const Ray out{point.ray_origin(direction), direction};
  const EnvironmentLight& environment = context.lights.environment();
  const EnvironmentLight::Footprint sky = environment.locate(direction);
  const float pdf = looks && !next.is_delta ? next.pdf : 0.0f;
  const vec3 map = pdf > 0.0f ? context.lights.weighted_map(sky, pdf, chances) : environment.read(sky).radiance;
  const vec3 suns = pdf > 0.0f ? context.lights.weighted_suns(direction, pdf, chances)
                               : environment.radiance(direction, sky) - environment.read(sky).radiance;
  ++counts.shadow;
  const vec3 passing = context.geometry.transmittance(out);
  sample.far.add(throughput * map, passing);
  sample.lamps.add(throughput * suns, passing);
  if (context.lights.has_glowing()) {
    meet_glowing(context, out, throughput, pdf, chances, sampler.next_hash(), counts, sample);
  }
  return sample;
}

/// Sums of a pixel's samples; those that are not finite are left out, as a picture leaves them out.
struct PixelSums {
  std::array<vec3, 7> sums{};

  void add(const DirectSample& s, float weight) {
    const std::array<vec3, 7> values{
        s.seen,           s.far.arriving,    s.far.unhindered, s.lamps.arriving, s.lamps.unhindered,
        s.areas.arriving, s.areas.unhindered};
    float all = 0.0f;
    for (const vec3& v : values) all += v.x + v.y + v.z;
    if (!std::isfinite(all)) return;
    for (std::size_t i = 0; i < values.size(); ++i) sums[i] += weight * values[i];
  }
};

}  // namespace

DirectLight trace_direct_light(const Tracer& tracer, const View& view, const Settings& settings, const Job& job) {
  check(settings, view);
  const Tracer::Parts& parts = *tracer.parts_;
  const Camera camera(relative(view, parts.geometry.origin()), settings.width, settings.height);
  PathContext context{.geometry = parts.geometry, .lights = parts.lights, .has_media = parts.geometry.has_media()};
  find_start(camera, context);
  const PixelFilterSampler filter(settings.filter, settings.filter_radius);
  DirectLight light;
  const std::array<Image*, 7> images{&light.seen,
                                     &light.far.arriving,
                                     &light.far.unhindered,
                                     &light.lamps.arriving,
                                     &light.lamps.unhindered,
                                     &light.areas.arriving,
                                     &light.areas.unhindered};
  for (Image* image : images) *image = Image(settings.width, settings.height, 3);
  const float share = 1.0f / static_cast<float>(settings.samples);
  const auto trace_row = [&](int y) {
    RayCounts counts;
    for (int x = 0; x < settings.width; ++x) {
      PixelSums pixel;
      for (int s = 0; s < settings.samples; ++s) {
        SobolSampler sampler(pixel_seed(settings.seed, x, y), static_cast<std::uint32_t>(s));
        const vec2 film = vec2(x, y) + 0.5f + filter.sample(sampler.next_2d());
        const vec2 u_lens = camera.has_lens() ? sampler.next_2d() : vec2(0.5f);
        const Camera::Sample ray = camera.generate(film, u_lens);
        pixel.add(direct_sample(context, ray.ray, sampler, counts), ray.weight * share);
      }
      for (std::size_t i = 0; i < images.size(); ++i) images[i]->set_rgb(x, y, pixel.sums[i]);
    }
  };
  constexpr int kRows = 16;  // between two looks at the clock
  const Stopwatch watch;
  for (int begin = 0; begin < settings.height; begin += kRows) {
    if (job.is_stopped()) throw Interrupted("the direct light is not all traced");
    const int end = std::min(begin + kRows, settings.height);
    parallel_for(static_cast<std::size_t>(begin), static_cast<std::size_t>(end), 1,
                 [&](std::size_t first, std::size_t last) {
                   for (std::size_t y = first; y < last; ++y) trace_row(static_cast<int>(y));
                 });
    job.report({.fraction = static_cast<double>(end) / settings.height, .seconds = watch.seconds(), .what = "direct"});
  }
  return light;
}

}  // namespace candela::path
