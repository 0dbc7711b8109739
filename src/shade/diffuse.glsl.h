#ifndef CANDELA_SHADE_DIFFUSE_GLSL_H
#define CANDELA_SHADE_DIFFUSE_GLSL_H

#include "shade/shim.glsl.h"

SHADE_BEGIN

/// Lambert 1760: the same radiance in every direction, f = ρ / π.
SHADE_FN vec3 lambert_f(vec3 albedo) { return albedo * (1.0f / kShadePi); }

/// Direction with density cos θ / π. Malley's method over the concentric map of Shirley & Chiu 1997.
SHADE_FN vec3 cosine_sample(vec2 u) {
  float a = 2.0f * u.x - 1.0f;
  float b = 2.0f * u.y - 1.0f;
  float r = 0.0f;
  float phi = 0.0f;
  if (abs(a) > abs(b)) {
    r = a;
    phi = (kShadePi / 4.0f) * (b / a);
  } else if (b != 0.0f) {
    r = b;
    phi = (kShadePi / 2.0f) - (kShadePi / 4.0f) * (a / b);
  }
  return vec3(r * cos(phi), r * sin(phi), sqrt(max(1.0f - r * r, 0.0f)));
}

SHADE_FN float cosine_pdf(float cos_theta) { return max(cos_theta, 0.0f) * (1.0f / kShadePi); }

SHADE_END

#endif
