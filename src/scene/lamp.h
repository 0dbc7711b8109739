#pragma once

#include "scene/scene.h"
#include "shade/lights.glsl.h"

namespace candela {

/// A punctual light as it stands in the world. Refers to the scene's profiles.
struct PlacedLamp {
  vec3 position{0.0f};
  vec3 intensity{0.0f};  ///< candela; of a directional light lux
  shade::PunctualLamp lamp{};
  const IesProfile* ies = nullptr;
};

/// That of a node that has one, in coordinates that begin at `origin`.
PlacedLamp placed_lamp(const Scene& scene, const Node& node, vec3 origin = vec3(0.0f));

/// A lamp's light where nothing keeps it away.
struct ArrivingLight {
  vec3 direction{0, 1, 0};  ///< towards the lamp, unit
  float distance = kInfinity;
  vec3 irradiance{0.0f};  ///< on a surface that faces it, lux; 0 at the lamp itself
};
ArrivingLight arriving_light(const PlacedLamp& lamp, vec3 position);

}  // namespace candela
