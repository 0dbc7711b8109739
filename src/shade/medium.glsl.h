#ifndef CANDELA_SHADE_MEDIUM_GLSL_H
#define CANDELA_SHADE_MEDIUM_GLSL_H

#include "shade/shim.glsl.h"

SHADE_BEGIN

// A walk through a homogeneous body. Distances in metres, extinction in 1/m, one value for each channel.

SHADE_FN vec3 medium_transmittance(vec3 extinction, float distance) { return exp(-extinction * distance); }

/// How likely each channel leads a free flight, by what it would still carry.
SHADE_FN vec3 medium_chances(vec3 weights) {
  float sum = weights.x + weights.y + weights.z;
  return sum > 0.0f ? weights / sum : vec3(1.0f / 3.0f);
}

SHADE_FN int medium_channel(vec3 chances, float u) {
  if (u < chances.x) return 0;
  return u < chances.x + chances.y ? 1 : 2;
}

/// What a flight of any channel leaves a path that reaches the body's boundary, with this transmittance on the way:
/// each channel weighs by the mean of all three densities. Chiang, Kutz & Burley 2016, "Practical and Controllable
/// Subsurface Scattering for Production Path Tracing", §5.
SHADE_FN vec3 medium_passed(vec3 transmittance, vec3 chances) {
  float chance = dot(chances, transmittance);
  return chance > 0.0f ? transmittance / chance : vec3(0.0f);
}

/// The same for one that scatters after a flight with this transmittance.
SHADE_FN vec3 medium_scattered(vec3 extinction, vec3 albedo, vec3 transmittance, vec3 chances) {
  vec3 left = extinction * transmittance;
  float density = dot(chances, left);
  return density > 0.0f ? albedo * left / density : vec3(0.0f);
}

/// Cosine between the way before and after scattering, of density p(cos); g is its mean, within (-1, 1). Henyey &
/// Greenstein 1941, inverted.
SHADE_FN float phase_cosine(float g, float u) {
  if (abs(g) < 1e-3f) return 1.0f - 2.0f * u;
  float t = (1.0f - g * g) / (1.0f + g - 2.0f * g * u);
  return clamp((1.0f + g * g - t * t) / (2.0f * g), -1.0f, 1.0f);
}

SHADE_END

#endif
