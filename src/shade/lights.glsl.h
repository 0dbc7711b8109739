#ifndef CANDELA_SHADE_LIGHTS_GLSL_H
#define CANDELA_SHADE_LIGHTS_GLSL_H

#include "shade/shim.glsl.h"

SHADE_BEGIN

/// Inverse square with the window of KHR_lights_punctual: max(min(1 - (d/range)⁴, 1), 0) / d². `range` may be infinite.
SHADE_FN float light_falloff_gltf(float distance, float range) {
  float q = distance / range;
  float q2 = q * q;
  return shade_saturate(1.0f - q2 * q2) / max(distance * distance, 1e-12f);
}

/// Cone of a spot: 1 inside `cos_inner`, 0 outside `cos_outer`, KHR_lights_punctual's smooth square between them. Its
/// sample code divides by at least 0.001, which dims the centre of beams narrower than 2.6° (to 2 % at 1°); 1e-6 only
/// avoids 1/0.
SHADE_FN float light_spot_gltf(float cos_angle, float cos_inner, float cos_outer) {
  float scale = 1.0f / max(1e-6f, cos_inner - cos_outer);
  float t = shade_saturate((cos_angle - cos_outer) * scale);
  return t * t;
}

SHADE_END

#endif
