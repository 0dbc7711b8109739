#pragma once

#include <optional>

#include "path/integrator.h"
#include "path/surface_point.h"

/// What everything asks at a vertex of a path that follows one.
namespace candela::path {

inline LightReceiver receiver_at(const SurfacePoint& point) {
  return {point.position, point.frame.n,
          shade::surface_scatters_through(point.surface) ? shade::kReceiverBoth : shade::kReceiverFront};
}

/// Weight of emission met by chance, in a direction drawn at `origin`, against having chosen that triangle as the lamp.
/// `bsdf_pdf` ≤ 0: nothing else could.
inline float emission_weight(const PathContext& context, const Hit& hit, const SurfacePoint& point, const Ray& ray,
                             vec3 origin, float bsdf_pdf, const LightChances& chances) {
  const int first = context.geometry.placement(hit.placement).first_light;
  if (bsdf_pdf <= 0.0f || first < 0) return 1.0f;
  const float cos_light = -glm::dot(ray.direction, point.geometric_normal);
  const float distance = glm::length(point.position - origin);
  const float pdf = context.lights.triangle_pdf(first + static_cast<int>(hit.triangle), chances, distance, cos_light);
  return mis_weight(bsdf_pdf, pdf, kAreaMisPower);
}

/// The way from `origin` to a lamp. Empty where they are at one place.
inline std::optional<Ray> shadow_ray(vec3 origin, const LightSample& light) {
  Ray shadow;
  shadow.origin = origin;
  shadow.direction = light.direction;
  if (light.distance == kInfinity) return shadow;
  const vec3 to_light = light.target - origin;
  const float distance = glm::length(to_light);
  if (!(distance > 0.0f)) return std::nullopt;
  shadow.direction = to_light / distance;
  shadow.t_max = distance * (1.0f - 1e-6f);
  return shadow;
}

/// What the eye looks along ends at its far plane; light has no end.
inline Ray next_ray(const Ray& last, vec3 origin, vec3 direction, bool is_eye) {
  Ray ray;
  ray.origin = origin;
  ray.direction = direction;
  if (is_eye && last.t_max < kInfinity) ray.t_max = last.t_max - glm::dot(origin - last.origin, direction);
  return ray;
}

}  // namespace candela::path
