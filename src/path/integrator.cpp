#include "path/integrator.h"

#include <algorithm>

#include "path/bodies.h"
#include "path/camera.h"
#include "path/place.h"
#include "path/surface_point.h"
#include "path/vertex.h"
#include "path/walk.h"

namespace candela::path {

namespace {

constexpr int kMostPassed = 64;  // surfaces in a row that do not turn light

void set_nothing(PathSample& sample) {
  for (const LayerInfo& info : kLayers) {
    if (info.has_mean) sample.of(info.layer) = vec3(info.nothing);
  }
}

/// Nobody listens.
struct Unheard {
  void meet(const Hit&, const SurfacePoint&) {}
  void turn(const shade::SurfaceSample&) {}
  void scatter(vec3) {}
  void look_for(const LightSample&) {}
  void find_lamp(vec3) {}
  void find_glow(vec3) {}
  void find_sky(vec3, vec3) {}
};

PathSample background_sample(const PathContext& context, vec3 direction) {
  PathSample sample;
  set_nothing(sample);
  const EnvironmentLight& environment = context.lights.environment();
  if (!context.sees_lamps) {
    sample.radiance = environment.read(environment.locate(direction)).radiance;
  } else if (!context.sees_backdrop) {
    sample.radiance = environment.radiance(direction, environment.locate(direction));
  } else if (context.background == Background::environment) {
    sample.radiance = environment.background(direction);
  } else {
    sample.alpha = 0.0f;
    sample.through = vec3(1.0f);
  }
  sample.seen = sample.radiance;
  return sample;
}

void record_first_surface(const SurfacePoint& point, PathSample& sample) {
  sample.of(Layer::normal) = point.frame.n;
  sample.of(Layer::base_color) = point.is_unlit ? point.emission : shade::surface_base_color(point.surface);
  sample.of(Layer::albedo) = point.is_unlit || max_component(point.emission) > 0.0f
                                 ? vec3(1.0f)
                                 : glm::min(shade::surface_albedo(point.surface), vec3(1.0f));
}

/// Whether all that a surface shows is what stands before or behind it: mirrors and clear glass, polished ones too.
bool shows_what_is_beyond(const shade::Surface& surface) {
  constexpr float kPolished = 0.02f;  // alpha: a lobe of about a degree
  return shade::surface_is_delta(surface) || (surface.alpha < kPolished && surface.chance_diffuse <= 0.0f);
}

/// Albedo and normal for the denoiser. False where it has to look beyond.
bool record_features(const SurfacePoint& point, vec3 throughput, PathSample& sample) {
  if (!point.is_unlit && shows_what_is_beyond(point.surface)) return false;
  const vec3 albedo = point.is_unlit ? vec3(1.0f) : shade::surface_albedo(point.surface);
  sample.feature_albedo = glm::clamp(throughput * albedo, 0.0f, 1.0f);
  sample.feature_normal = point.frame.n;
  return true;
}

/// What a path has met, and what else is there.
struct Meeting {
  const Ray& ray;
  const Hit& hit;
  Place& place;
};

/// Whether rough facets, through which one sees, or diffuse transmission, which shows nothing, lets most of the light
/// through a surface.
bool is_glass(const shade::Surface& surface) { return surface.weight_glass > max_component(surface.diffuse_below); }

/// Of light that a scene with a ground begins with: on the ground that the eye sees, only what the scene takes away and
/// adds is looked for.
float expected_share(const LightSample& light, bool is_seen_ground) {
  return is_seen_ground && (light.is_environment() || light.is_delta) ? 1.0f : 0.0f;
}

/// Light from one lamp chosen among all, times the surface's response, weighted against meeting it by chance. Where the
/// background is seen, the environment shines on the near side of glass only.
template <bool kHasMedia, class Listener>
vec3 direct_light(const PathContext& context, const Walk& walk, const Crossing& crossing, const SurfacePoint& point,
                  const Meeting& meeting, const LightChances& chances, bool sees_background, bool is_seen_ground,
                  float u_choice, vec2 u, RayCounts& counts, Listener& listener) {
  const LightSample light = context.lights.sample(chances, u_choice, u);
  listener.look_for(light);
  if (light.pdf <= 0.0f) return vec3(0.0f);
  const bool is_outside = point.is_outside(light.direction);
  if (!is_outside && !shade::surface_scatters_through(point.surface)) return vec3(0.0f);
  if (!is_outside && sees_background && light.is_environment() && is_glass(point.surface)) return vec3(0.0f);
  const vec3 wi = point.frame.to_local(light.direction);
  if ((wi.z > 0.0f) != is_outside) return vec3(0.0f);
  const shade::SurfaceEval f = shade::surface_eval(point.surface, point.wo, wi);
  if (max_component(f.value) <= 0.0f) return vec3(0.0f);

  vec3 origin = point.ray_origin(light.direction);
  vec3 transmittance(1.0f);
  if (!meeting.place.is_simple(!is_outside)) {
    transmittance =
        meeting.place.transmittance(context.geometry, meeting.ray, meeting.hit, !is_outside, light.direction, origin);
  }
  const std::optional<Ray> shadow = shadow_ray(origin, light);
  if (!shadow) return vec3(0.0f);
  if (max_component(transmittance) > 0.0f) {
    ++counts.shadow;
    transmittance *= context.geometry.transmittance(*shadow);
  }
  if constexpr (kHasMedia) transmittance *= walk.transmittance(crossing, !is_outside, light.distance);
  transmittance -= expected_share(light, is_seen_ground);
  const float weight = light.is_delta ? 1.0f : mis_weight(light.pdf, f.pdf, light.mis_power);
  return f.value * context.lights.radiance(light) * transmittance * (weight / light.pdf);
}

}  // namespace

void find_start(const Camera& camera, PathContext& context) {
  const Box3 eye = camera.origins();
  if (eye.lower == eye.upper) {
    context.start = bodies_around(context.geometry, eye.lower);
  } else {
    context.eye_is_wide = may_be_inside(context.geometry, eye);
  }
}

Hit first_visible_hit(const PathContext& context, const Ray& ray, const Hit& hit, RayCounts& counts) {
  if (!hit || !is_culled_back(context.geometry, hit, ray.direction)) return hit;
  ++counts.camera;
  return context.geometry.intersect_visible(ray, hit.seed);
}

float background_contrast(const PathContext& context, std::span<const vec3> corners) {
  using Sight = EnvironmentLight::Sight;
  const EnvironmentLight& environment = context.lights.environment();
  if (!context.sees_lamps) return environment.contrast(corners, Sight::map);
  if (!context.sees_backdrop) return environment.contrast(corners, Sight::lights);
  return context.background == Background::environment ? environment.contrast(corners, Sight::backdrop) : 0.0f;
}

namespace {

template <bool kHasMedia>
Walk start_walk(const PathContext& context, vec3 eye) {
  if constexpr (!kHasMedia) return Walk();
  return context.eye_is_wide ? Walk(bodies_around(context.geometry, eye)) : Walk(context.start);
}

/// To the next surface at the same place as `start`. The eye sees no backs there either.
bool step(const PathContext& context, Place& place, vec3 start, Ray& ray, Hit& hit, vec3 direction, bool is_through,
          bool is_eye) {
  bool is_here = place.step(context.geometry, ray, hit, is_through);
  while (is_here && is_eye && is_culled_back(context.geometry, hit, direction)) {
    is_here = place.step(context.geometry, ray, hit, true);
  }
  if (!is_here) return false;
  if (context.has_media) {
    // What rays would step over may yet be thick enough to absorb.
    ray = next_ray(ray, start, direction, is_eye);
    hit.t = distance_to(context.geometry, hit, start, direction);
  }
  ray.direction = direction;
  return true;
}

/// The ground as the eye sees it, see Ground.
struct SeenGround {
  bool is_looked_for;  ///< the path was never reflected or scattered
  bool is_met = false;
  bool is_left = false;  ///< the direction was just drawn there
  vec3 scale{0.0f};      ///< one over the radiance that the ground has without the scene
  vec3 behind{0.0f};     ///< what the background is there, where it is not transparent

  explicit SeenGround(const PathContext& context) : is_looked_for(context.sees_shadows) {}

  bool is_here(const PathContext& context, const Hit& hit) const {
    return is_looked_for && context.geometry.placement(hit.placement).is_ground;
  }
  /// `is_bare`: nothing is in front.
  void meet(const PathContext& context, const SurfacePoint& point, vec3 direction, vec3 throughput, bool is_bare,
            PathSample& sample) {
    is_looked_for = false;
    is_met = true;
    if (is_bare) sample.alpha = 0.0f;
    sample.through = throughput;
    const vec3 lit = point.material->params.base_color / kPi * context.lights.unhindered_irradiance(point.position);
    for (int c = 0; c < 3; ++c) scale[c] = lit[c] > 0.0f ? 1.0f / lit[c] : 0.0f;
    if (context.background == Background::environment) behind = context.lights.environment().background(direction);
  }
  void finish(const PathContext& context, PathSample& sample) const {
    if (!is_met || context.background == Background::transparent) return;
    sample.radiance += sample.through * behind;
    sample.alpha = 1.0f;
    sample.through = vec3(0.0f);
  }
};

/// Follows the mirror image in a polished ground, where there is one, or else what shows there; `throughput` becomes
/// that of the way. True with the ray and hit of the mirror image.
bool mirror_in_ground(const PathContext& context, const SurfacePoint& point, SobolSampler& sampler, vec3& throughput,
                      Ray& ray, Hit& hit, RayCounts& counts) {
  const float mirror = context.geometry.ground()->mirror;
  if (mirror <= 0.0f) return false;
  const vec3 direction = ray.direction * vec3(1, -1, 1);
  const Ray mirrored{point.ray_origin(direction), direction};
  ++counts.bounce;
  const Hit met = context.geometry.intersect(mirrored, sampler.next_hash());
  if (!met) return false;
  // A weak image is bright enough to be worth half of the samples.
  const float chance = std::max(mirror, 0.5f);
  const bool is_followed = unit_float(sampler.next_hash()) < chance;
  throughput *= is_followed ? mirror / chance : (1.0f - mirror) / (1.0f - chance);
  if (!is_followed) return false;
  ray = mirrored;
  hit = met;
  return true;
}

/// Of what layers call the first surface.
void find_first_surface(const PathContext& context, const Ray& ray, PathSample& sample) {
  const Hit hit = context.geometry.first_surface(ray);
  set_nothing(sample);
  if (!hit) return;
  Walk walk(context.start);
  const Crossing crossing = walk.find_crossing(context, hit, ray.direction, 0.5f);
  record_first_surface(make_surface_point(context.geometry, hit, ray.direction, crossing.eta), sample);
}

template <bool kHasMedia, class Listener>
PathSample trace(const PathContext& context, Ray ray, Hit hit, SobolSampler& sampler, RayCounts& counts,
                 Listener& listener) {
  PathSample sample;
  Walk walk = start_walk<kHasMedia>(context, ray.origin);
  Place place;
  // What the direction that led here was drawn with: 0 after the camera, after mirrors, and in scattering bodies.
  float bsdf_pdf = 0.0f;
  LightChances chances;             // of the lights at the vertex where it was drawn
  vec3 drawn_at = ray.origin;       // and where that was: sheets of glass passed on the way do not count
  EnvironmentLight::Footprint sky;  // what the current ray would see of the map
  float u_wavelength = 0.0f;
  if constexpr (kHasMedia) u_wavelength = sampler.next_1d();
  bool is_first = true;
  bool is_eye = true;                                  // the direction is the camera's still
  bool sees_background = context.background_in_glass;  // the path was never reflected or scattered
  SeenGround ground(context);
  bool wants_features = context.has_features;
  int passed = 0;
  int turns = 0;  // since and with the first rough surface
  const auto add = [&](vec3 light) {
    if (ground.is_met) {
      sample.through += light * ground.scale;
      return;
    }
    sample.radiance += light;
    if (turns > 1) sample.indirect += light;
    if (is_eye && passed == 0) sample.seen += light;
  };
  const auto escaped = [&](vec3 direction) {
    return bsdf_pdf > 0.0f && context.lights.can_sample()
               ? context.lights.escaped_radiance(direction, sky, bsdf_pdf, chances)
               : context.lights.escaped_radiance(direction, sky);
  };
  if constexpr (kHasMedia) {
    bool scattered = false;
    if (!walk.travel(context, ray.origin, ray, hit, sampler, counts, scattered)) return sample;
    if (scattered) listener.scatter(ray.origin);
    is_eye = !scattered;
    turns = scattered ? 1 : 0;
    sees_background = sees_background && !scattered;
    ground.is_looked_for = ground.is_looked_for && !scattered;
    sky = context.lights.environment().locate(ray.direction);
  }
  for (int depth = 0;; ++depth) {
    // ----- the ray left the scene
    if (!hit && sees_background) {
      sample.through = walk.throughput;
      break;
    }
    if (!hit) {
      const bool sees_map_alone = is_eye && !context.sees_lamps;
      const vec3 light =
          walk.throughput * (sees_map_alone ? context.lights.environment().read(sky).radiance : escaped(ray.direction));
      add(light);
      listener.find_sky(ray.direction, light);
      break;
    }

    // ----- the numbers of this vertex, drawn early so that the light's tables arrive while the textures are read
    const vec2 choices = sampler.next_2d();
    const vec2 u_light = sampler.next_2d();
    const vec2 u_direction = sampler.next_2d();
    context.lights.prefetch(u_light);

    // ----- the boundary of a body?
    Crossing crossing;
    if constexpr (kHasMedia) {
      if (context.geometry.placement(hit.placement).body != 0 && is_back_hit(context.geometry, hit, ray.direction)) {
        place.enter_before_leaving(context.geometry, ray, hit);
      }
      crossing = walk.find_crossing(context, hit, ray.direction, u_wavelength);
    }

    // ----- x_depth: emitted light
    const SurfacePoint point = make_surface_point(context.geometry, hit, ray.direction, crossing.eta);
    const bool is_seen_ground = ground.is_here(context, hit);
    if (is_seen_ground) {
      if (is_first) set_nothing(sample);
      is_first = false;
      if (place.is_simple(false) && mirror_in_ground(context, point, sampler, walk.throughput, ray, hit, counts)) {
        if (depth == context.bounces) break;
        is_eye = sees_background = ground.is_looked_for = false;
        bsdf_pdf = 0.0f;
        sky = context.lights.environment().locate(ray.direction);
        continue;
      }
      ground.meet(context, point, ray.direction, walk.throughput, is_eye && passed == 0, sample);
      if (wants_features) {
        sample.feature_albedo = glm::clamp(walk.throughput * ground.behind, 0.0f, 1.0f);
        sample.feature_normal = point.frame.n;
      }
      sees_background = wants_features = false;
    }
    if (is_first) record_first_surface(point, sample);
    is_first = false;
    if (wants_features && !crossing.is_hidden) wants_features = !record_features(point, walk.throughput, sample);
    vec3 direction = ray.direction;
    bool is_straight = crossing.is_hidden;
    bool is_through = true;
    if (!crossing.is_hidden) {
      listener.meet(hit, point);
      if (max_component(point.emission) > 0.0f && (!is_eye || context.sees_lamps)) {
        const float weight =
            point.is_unlit ? 1.0f : emission_weight(context, hit, point, ray, drawn_at, bsdf_pdf, chances);
        const vec3 light = walk.throughput * point.emission * weight;
        add(light);
        listener.find_glow(light);
      }
      if (point.is_unlit || depth == context.bounces) break;

      // ----- the next direction, by the material
      const shade::SurfaceSample next =
          shade::surface_sample(point.surface, point.wo, {u_direction.x, u_direction.y, choices.y});
      is_straight = next.is_straight;

      // ----- next-event estimation: reflected light that comes straight from a lamp. What goes straight through a
      // sheet belongs to the vertex before, whose shadow rays pass the sheet too.
      LightChances here;
      if (context.lights.can_sample() && !shade::surface_is_delta(point.surface)) {
        LightChances& target = is_straight ? here : chances;
        // What the eye sees straight or by mirrors is worth more lamps than what lights it.
        context.lights.find_chances(receiver_at(point), bsdf_pdf <= 0.0f, target);
        for (int i = 0; i < target.samples; ++i) {
          const vec3 light =
              walk.throughput * direct_light<kHasMedia>(context, walk, crossing, point, {ray, hit, place}, target,
                                                        sees_background, is_seen_ground, target.choice(i, choices.x),
                                                        target.place(i, u_light), counts, listener);
          listener.find_lamp(light);
          if (ground.is_met) {
            sample.through += light * ground.scale;
            continue;
          }
          sample.radiance += light;
          if (turns > 0) sample.indirect += light;
        }
      }
      if (max_component(next.weight) <= 0.0f) break;
      listener.turn(next);
      walk.throughput *= next.weight;
      if (!is_straight) {
        direction = point.frame.to_world(next.wi);
        is_through = next.wi.z < 0.0f;
        is_eye = false;
        if (point.is_outside(direction) == is_through) break;
        if constexpr (kHasMedia) {
          if (is_through) walk.cross(crossing);
        }
        sees_background = sees_background && is_through && (next.is_delta || is_glass(point.surface));
        bsdf_pdf = next.is_delta ? 0.0f : next.pdf;
        ground.is_looked_for = ground.is_looked_for && is_through && (next.is_delta || is_glass(point.surface));
        ground.is_left = is_seen_ground;
        drawn_at = point.ray_origin(direction);
        if (turns > 0 || !next.is_delta) ++turns;

        // ----- Russian roulette: paths that carry little end early, the survivors stand for them
        if (depth >= 2) {
          const float survival = std::min(max_component(walk.throughput) * walk.eta_scale, 0.95f);
          if (unit_float(sampler.next_hash()) >= survival) break;
          walk.throughput /= survival;
        }
      }
    }
    if (is_straight) {
      if constexpr (kHasMedia) {
        walk.cross(crossing);
      }
      // A surface passed without a turn is no vertex; but no path goes on forever.
      if (++passed > kMostPassed) break;
      --depth;
    }

    // ----- on to what else is at this place, or along a ray
    sky = context.lights.environment().locate(direction);
    const bool is_here =
        !place.is_simple(is_through) && step(context, place, point.position, ray, hit, direction, is_through, is_eye);
    if (!is_here) {
      ray = next_ray(ray, point.ray_origin(direction), direction, is_eye);
      ++counts.bounce;
      hit = context.geometry.intersect(ray, sampler.next_hash());
      if (is_eye) hit = first_visible_hit(context, ray, hit, counts);
    }
    if (ground.is_left) {
      // Light from there is counted already, unless the scene is in its way.
      if (!hit) break;
      add(-walk.throughput * escaped(direction));
      ground.is_left = false;
    }
    if constexpr (kHasMedia) {
      bool scattered = false;
      if (!walk.travel(context, point.position, ray, hit, sampler, counts, scattered)) break;
      if (scattered) {
        place.leave();
        listener.scatter(ray.origin);
        ++turns;
        is_eye = false;
        sees_background = ground.is_looked_for = false;
        bsdf_pdf = 0.0f;
        sky = context.lights.environment().locate(ray.direction);
      }
    }
  }
  // What mirrors and glass let through, where nothing stands behind.
  if (wants_features) sample.feature_albedo = glm::clamp(walk.throughput, 0.0f, 1.0f);
  ground.finish(context, sample);
  return sample;
}

}  // namespace

PathSample trace_path(const PathContext& context, Ray ray, Hit hit, SobolSampler& sampler, RayCounts& counts) {
  hit = first_visible_hit(context, ray, hit, counts);
  Unheard nobody;
  PathSample sample = !hit                ? background_sample(context, ray.direction)
                      : context.has_media ? trace<true>(context, ray, hit, sampler, counts, nobody)
                                          : trace<false>(context, ray, hit, sampler, counts, nobody);
  if (context.has_first_surface) find_first_surface(context, ray, sample);
  return sample;
}

PathSample trace_heard_path(const PathContext& context, Ray ray, Hit hit, SobolSampler& sampler, RayCounts& counts,
                            PathListener& listener) {
  hit = first_visible_hit(context, ray, hit, counts);
  if (hit) {
    return context.has_media ? trace<true>(context, ray, hit, sampler, counts, listener)
                             : trace<false>(context, ray, hit, sampler, counts, listener);
  }
  PathSample sample = background_sample(context, ray.direction);
  listener.find_sky(ray.direction, sample.radiance);
  return sample;
}

PathSample trace_path_surfaces(const PathContext& context, Ray ray, Hit hit, SobolSampler& sampler, RayCounts& counts) {
  hit = first_visible_hit(context, ray, hit, counts);
  if (!hit) return background_sample(context, ray.direction);
  PathSample sample;
  vec3 throughput(1.0f);
  for (int depth = 0; hit; ++depth) {
    const SurfacePoint point = make_surface_point(context.geometry, hit, ray.direction, Crossing{}.eta);
    if (depth == 0) record_first_surface(point, sample);
    sample.radiance += throughput * point.emission;
    if (point.is_unlit || depth == context.bounces) return sample;

    const shade::SurfaceSample next = shade::surface_sample(point.surface, point.wo, sampler.next_3d());
    throughput *= next.weight;
    const vec3 direction = point.frame.to_world(next.wi);
    // Where the shading normal leans over, a reflected direction may lie below the surface.
    const bool is_below = point.is_outside(direction) != (next.wi.z > 0.0f);
    if (is_below || max_component(throughput) <= 0.0f) return sample;

    ray = {.origin = point.ray_origin(direction), .direction = direction};
    ++counts.bounce;
    hit = context.geometry.intersect(ray, sampler.next_hash());
  }
  sample.radiance += throughput * context.lights.escaped_radiance(ray.direction);
  return sample;
}

namespace {

PathSample trace_minimal(const PathContext& context, Ray ray, Hit hit, SobolSampler& sampler, RayCounts& counts,
                         SeenGround& ground) {
  PathSample sample;
  if (context.has_first_surface) find_first_surface(context, ray, sample);
  hit = first_visible_hit(context, ray, hit, counts);
  if (!hit) return background_sample(context, ray.direction);

  Walk walk = start_walk<true>(context, ray.origin);
  Place place;
  bool is_eye = true;
  bool sees_background = context.background_in_glass;
  const auto add = [&](vec3 light) {
    (ground.is_met ? sample.through : sample.radiance) += ground.is_met ? light * ground.scale : light;
  };
  int passed = 0;
  bool scattered = false;
  if (!walk.travel(context, ray.origin, ray, hit, sampler, counts, scattered)) return sample;
  is_eye = !scattered;
  sees_background = sees_background && !scattered;
  ground.is_looked_for = ground.is_looked_for && !scattered;
  for (int depth = 0; hit; ++depth) {
    Crossing crossing;
    if (context.geometry.placement(hit.placement).body != 0 && is_back_hit(context.geometry, hit, ray.direction)) {
      place.enter_before_leaving(context.geometry, ray, hit);
    }
    if (context.has_media) crossing = walk.find_crossing(context, hit, ray.direction, unit_float(sampler.next_hash()));
    const SurfacePoint point = make_surface_point(context.geometry, hit, ray.direction, crossing.eta);
    const bool is_seen_ground = ground.is_here(context, hit);
    if (is_seen_ground) {
      if (place.is_simple(false) && mirror_in_ground(context, point, sampler, walk.throughput, ray, hit, counts)) {
        if (depth == context.bounces) return sample;
        is_eye = sees_background = ground.is_looked_for = false;
        continue;
      }
      ground.meet(context, point, ray.direction, walk.throughput, is_eye && passed == 0, sample);
      sees_background = false;
      if (depth == 0 && !context.has_first_surface) set_nothing(sample);
    } else if (depth == 0 && passed == 0 && !context.has_first_surface) {
      record_first_surface(point, sample);
    }
    vec3 direction = ray.direction;
    bool is_straight = crossing.is_hidden;
    bool is_through = true;
    if (!crossing.is_hidden) {
      add(walk.throughput * point.emission);
      if (point.is_unlit || depth == context.bounces) return sample;

      const vec3 u = sampler.next_3d();
      const shade::SurfaceSample next = shade::surface_sample(point.surface, point.wo, u);
      is_straight = next.is_straight;
      if (!is_straight) {
        direction = point.frame.to_world(next.wi);
        is_eye = false;
      }
      is_through = next.wi.z < 0.0f;
      const bool is_seen_through = is_through && (next.is_delta || is_glass(point.surface));
      sees_background = sees_background && is_seen_through;
      ground.is_looked_for = ground.is_looked_for && is_seen_through;
      ground.is_left = is_seen_ground;
      if (point.is_outside(direction) == is_through) return sample;
      walk.throughput *= next.weight;
      if (max_component(walk.throughput) <= 0.0f) return sample;
      if (is_through) walk.cross(crossing);
    } else {
      walk.cross(crossing);
    }
    if (is_straight) {
      if (++passed > kMostPassed) return sample;
      --depth;
    }

    const bool is_here =
        !place.is_simple(is_through) && step(context, place, point.position, ray, hit, direction, is_through, is_eye);
    if (!is_here) {
      ray = next_ray(ray, point.ray_origin(direction), direction, is_eye);
      ++counts.bounce;
      hit = context.geometry.intersect(ray, sampler.next_hash());
      if (is_eye) hit = first_visible_hit(context, ray, hit, counts);
    }
    if (ground.is_left) {
      // Light from there is counted already, unless the scene is in its way.
      if (!hit) return sample;
      add(-walk.throughput * context.lights.escaped_radiance(direction));
      ground.is_left = false;
    }
    if (!walk.travel(context, point.position, ray, hit, sampler, counts, scattered)) return sample;
    if (!scattered) continue;
    place.leave();
    is_eye = sees_background = ground.is_looked_for = false;
  }
  if (sees_background) {
    sample.through = walk.throughput;
    return sample;
  }
  add(walk.throughput * context.lights.escaped_radiance(ray.direction));
  return sample;
}

}  // namespace

PathSample trace_path_minimal(const PathContext& context, Ray ray, Hit hit, SobolSampler& sampler, RayCounts& counts) {
  SeenGround ground(context);
  PathSample sample = trace_minimal(context, ray, hit, sampler, counts, ground);
  ground.finish(context, sample);
  return sample;
}

}  // namespace candela::path
