#include "path/pixel_surface.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "path/bodies.h"
#include "path/camera.h"
#include "path/surface_map.h"
#include "path/tracer_parts.h"
#include "path/vertex.h"
#include "path/walk.h"
#include "scene/lamp.h"
#include "shade/image_light.glsl.h"

namespace candela::path {

namespace {

/// What reaches the surface of a lamp in that direction, and what it makes of it. A lamp at a place is `position`.
void light_surface(const Geometry& geometry, const SurfacePoint& point, vec3 position, LampTerms& lamp) {
  lamp.wi = point.frame.to_local(lamp.direction);
  const bool is_outside = point.is_outside(lamp.direction);
  if (!is_outside && !shade::surface_scatters_through(point.surface)) return;
  if ((lamp.wi.z > 0.0f) != is_outside) return;
  lamp.parts = shade::surface_parts(point.surface, point.wo, lamp.wi);
  if (lamp.wi.z > 0.0f) lamp.facets = facet_terms(point.surface, point.wo, lamp.wi).value_or(FacetTerms{});
  LightSample sample;
  sample.direction = lamp.direction;
  sample.distance = lamp.distance;
  sample.target = position;
  if (const auto shadow = shadow_ray(point.ray_origin(lamp.direction), sample)) {
    lamp.visible = geometry.transmittance(*shadow);
  }
  lamp.radiance = shade::surface_eval(point.surface, point.wo, lamp.wi).value * lamp.irradiance * lamp.visible;
}

std::vector<LampTerms> find_lamps(const Scene& scene, const Geometry& geometry, const Lights& lights,
                                  const SurfacePoint& point) {
  std::vector<LampTerms> lamps;
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    if (scene.nodes[i].light < 0) continue;
    const PlacedLamp placed = placed_lamp(scene, scene.nodes[i], geometry.origin());
    const ArrivingLight arriving = arriving_light(placed, point.position);
    LampTerms lamp;
    lamp.node = static_cast<int>(i);
    lamp.direction = arriving.direction;
    lamp.distance = arriving.distance;
    lamp.irradiance = arriving.irradiance;
    light_surface(geometry, point, placed.position, lamp);
    lamps.push_back(lamp);
  }
  const std::vector<EnvironmentLight::Sun>& suns = lights.environment().suns();
  for (std::size_t i = 0; i < suns.size(); ++i) {
    LampTerms lamp;
    lamp.sun = static_cast<int>(i);
    lamp.direction = suns[i].frame.n;
    lamp.distance = kInfinity;
    lamp.irradiance = suns[i].radiance * suns[i].solid_angle;
    light_surface(geometry, point, vec3(0.0f), lamp);
    lamps.push_back(lamp);
  }
  std::stable_sort(lamps.begin(), lamps.end(), [](const LampTerms& a, const LampTerms& b) {
    return luminance(a.radiance) > luminance(b.radiance);
  });
  return lamps;
}

}  // namespace

std::optional<FacetTerms> facet_terms(const shade::Surface& s, vec3 wo, vec3 wi) {
  if (s.is_mirror || (s.lobes & shade::kLobeModel) != 0 || wi.z <= 0.0f || wo.z <= 0.0f) return std::nullopt;
  FacetTerms terms;
  terms.half = glm::normalize(wo + wi);
  const bool is_wide = (s.lobes & shade::kLobeAnisotropy) != 0;
  terms.d = is_wide ? shade::ggx_d_aniso(terms.half, s.alpha_x, s.alpha_y) : shade::ggx_d(terms.half, s.alpha);
  const float v =
      is_wide ? shade::ggx_v_smith_aniso(wo, wi, s.alpha_x, s.alpha_y) : shade::ggx_v_smith(wo, wi, s.alpha);
  terms.g = v * 4.0f * wo.z * wi.z;
  terms.f = shade::terms_fresnel_opaque(s, glm::dot(wo, terms.half));
  return terms;
}

std::optional<PixelSurface> find_pixel_surface(const Tracer& tracer, const View& view, ivec2 size, ivec2 pixel) {
  Settings settings;
  settings.width = size.x;
  settings.height = size.y;
  check(settings, view);
  check_pixel(pixel, size);
  const Tracer::Parts& parts = *tracer.parts_;
  const Geometry& geometry = parts.geometry;
  const View here = relative(view, geometry.origin());
  const Camera camera(here, size.x, size.y);
  const Ray ray = centre_ray(camera, pixel.x, pixel.y);
  const Hit hit = geometry.first_surface(ray);
  if (!hit) return std::nullopt;
  const PathContext context{.geometry = geometry, .lights = parts.lights, .has_media = geometry.has_media()};
  Walk walk(bodies_around(geometry, ray.origin));
  const Crossing crossing = walk.find_crossing(context, hit, ray.direction, 0.5f);
  PixelSurface surface;
  surface.params = shade::surface_params_default();
  const SurfacePoint point = make_surface_point(geometry, hit, ray.direction, crossing.eta, surface.params);
  surface.where = surface_sample_of(geometry, hit);
  surface.distance = glm::distance(point.position, vec3(here.world_from_camera[3]));
  surface.is_back = point.is_back;
  surface.is_unlit = point.is_unlit;
  surface.geometric_normal = point.geometric_normal;
  surface.smooth_normal = point.smooth_normal;
  surface.frame = point.frame;
  surface.to_eye = -ray.direction;
  surface.wo = point.wo;
  surface.emission = point.emission;
  if (point.is_unlit) return surface;
  surface.surface = point.surface;
  surface.shares = shade::surface_shares(point.surface, point.wo);
  surface.mirror = facet_terms(point.surface, point.wo, {-point.wo.x, -point.wo.y, point.wo.z}).value_or(FacetTerms{});
  surface.lamps = find_lamps(*parts.scene, geometry, parts.lights, point);
  return surface;
}

void check_pixel(ivec2 pixel, ivec2 size) {
  if (pixel.x >= 0 && pixel.y >= 0 && pixel.x < size.x && pixel.y < size.y) return;
  throw Error(fmt::format("pixel {},{} is outside a picture of {}x{}", pixel.x, pixel.y, size.x, size.y), "--pixel");
}

}  // namespace candela::path
