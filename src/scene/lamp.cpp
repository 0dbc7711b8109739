#include "scene/lamp.h"

#include <cmath>

#include "math/frame.h"

namespace candela {

static_assert(static_cast<int>(Falloff::inverse_square) == shade::kFalloffInverseSquare &&
              static_cast<int>(Falloff::gltf) == shade::kFalloffGltf &&
              static_cast<int>(Falloff::ue4) == shade::kFalloffUe4 &&
              static_cast<int>(Falloff::polynomial) == shade::kFalloffPolynomial);
static_assert(static_cast<int>(LightType::point) == shade::kPointLight &&
              static_cast<int>(LightType::spot) == shade::kSpotLight &&
              static_cast<int>(LightType::directional) == shade::kDirectionalLight);

PlacedLamp placed_lamp(const Scene& scene, const Node& node, vec3 origin) {
  const Light& light = scene.lights[static_cast<std::size_t>(node.light)];
  PlacedLamp p;
  p.position = vec3(node.world_from_node[3]) - origin;
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
  if (light.ies >= 0 && light.type != LightType::spot) {
    p.ies = &scene.ies_profiles[static_cast<std::size_t>(light.ies)];
    const vec3 along = glm::normalize(transform_vector(node.world_from_node, {1, 0, 0}));
    p.lamp.across = frame_from_tangent(-p.lamp.direction, along).t;
    p.lamp.handedness = glm::determinant(mat3(node.world_from_node)) < 0.0f ? -1.0f : 1.0f;
  }
  return p;
}

ArrivingLight arriving_light(const PlacedLamp& p, vec3 position) {
  ArrivingLight light;
  if (p.lamp.kind == shade::kDirectionalLight) {
    light.direction = -p.lamp.direction;
    light.irradiance = p.intensity;
    return light;
  }
  const vec3 to_light = p.position - position;
  light.distance = glm::length(to_light);
  if (!(light.distance > 0.0f)) return light;
  light.direction = to_light / light.distance;
  light.irradiance = p.intensity;
  light.irradiance *= shade::light_left(p.lamp, light.direction, light.distance);
  if (p.ies != nullptr) light.irradiance *= ies_intensity(*p.ies, shade::light_local(p.lamp, light.direction));
  return light;
}

}  // namespace candela
