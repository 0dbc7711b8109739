#ifndef CANDELA_SHADE_LIGHTS_GLSL_H
#define CANDELA_SHADE_LIGHTS_GLSL_H

#include "shade/shim.glsl.h"

// Punctual lights: what of their intensity arrives at a distance and inside a cone. docs/theory/lights.md plots them.

SHADE_BEGIN

// What kinds there are.
SHADE_CONST int kPointLight = 0;
SHADE_CONST int kSpotLight = 1;
SHADE_CONST int kDirectionalLight = 2;

// How the light of a point or spot falls off. Only the first two have the units of a lamp; the others are an artist's.
SHADE_CONST int kFalloffInverseSquare = 0;
SHADE_CONST int kFalloffGltf = 1;
SHADE_CONST int kFalloffUe4 = 2;
SHADE_CONST int kFalloffPolynomial = 3;

/// 1 / d², without end; finite at the light.
SHADE_FN float light_falloff_inverse_square(float distance) { return 1.0f / max(distance * distance, 1e-12f); }

/// 1 - (distance/range)⁴ between 0 and 1. `range` may be infinite.
SHADE_FN float light_window(float distance, float range) {
  float q = distance / range;
  float q2 = q * q;
  return shade_saturate(1.0f - q2 * q2);
}

/// Inverse square with the window of KHR_lights_punctual: max(min(1 - (d/range)⁴, 1), 0) / d². `range` may be infinite.
SHADE_FN float light_falloff_gltf(float distance, float range) {
  return light_window(distance, range) * light_falloff_inverse_square(distance);
}

/// Karis 2013, "Real Shading in Unreal Engine 4", eq. 9: saturate(1 - (d/range)⁴)² / (d² + 1), d in metres as all
/// lengths here. It is 1 at the light and half an inverse square one metre away.
SHADE_FN float light_falloff_ue4(float distance, float range) {
  float window = light_window(distance, range);
  return window * window / (distance * distance + 1.0f);
}

/// 1 / (a0 d² + a1 d + a2) with (a0, a1, a2) ≥ 0, the fixed-function attenuation of OpenGL 1.x (Segal & Akeley,
/// "The OpenGL Graphics System", lighting); (1, 0, 0) is the inverse square.
SHADE_FN float light_falloff_polynomial(float distance, vec3 polynomial) {
  float sum = (polynomial.x * distance + polynomial.y) * distance + polynomial.z;
  return 1.0f / max(sum, 1e-12f);
}

/// What is left of an intensity at `distance`, by one of the kFalloff constants; each reads what it needs.
SHADE_FN float light_falloff(int kind, float distance, float range, vec3 polynomial) {
  if (kind == kFalloffInverseSquare) return light_falloff_inverse_square(distance);
  if (kind == kFalloffUe4) return light_falloff_ue4(distance, range);
  if (kind == kFalloffPolynomial) return light_falloff_polynomial(distance, polynomial);
  return light_falloff_gltf(distance, range);
}

/// Cone of a spot: 1 inside `cos_inner`, 0 outside `cos_outer`, KHR_lights_punctual's smooth square between them. Its
/// sample code divides by at least 0.001, which dims the centre of beams narrower than 2.6° (to 2 % at 1°); 1e-6 only
/// avoids 1/0.
SHADE_FN float light_spot_gltf(float cos_angle, float cos_inner, float cos_outer) {
  float scale = 1.0f / max(1e-6f, cos_inner - cos_outer);
  float t = shade_saturate((cos_angle - cos_outer) * scale);
  return t * t;
}

/// ∫ light_spot_gltf over all directions, sr: 2π ((1 - cos inner) + (cos inner - cos outer) / 3), for the square of a
/// ramp has a third of its length as its integral.
SHADE_FN float light_spot_solid_angle(float cos_inner, float cos_outer) {
  return 2.0f * kShadePi * ((1.0f - cos_inner) + (cos_inner - cos_outer) / 3.0f);
}

/// A lamp that stands somewhere, as either engine has it. One with a profile is a point.
struct PunctualLamp {
  int kind;
  vec3 direction;  ///< it shines along
  float range;
  int falloff;      ///< kFalloff…
  vec3 polynomial;  ///< of that
  float cos_inner;
  float cos_outer;
  vec3 across;       ///< a lamp's own +x, at right angles to `direction`
  float handedness;  ///< -1: its node mirrors
};

/// What is left of the intensity of a point or spot at a distance, where `wi` is the way to it.
SHADE_FN float light_left(SHADE_IN(PunctualLamp) lamp, vec3 wi, float distance) {
  float left = light_falloff(lamp.falloff, distance, lamp.range, lamp.polynomial);
  if (lamp.kind == kSpotLight) left *= light_spot_gltf(-dot(wi, lamp.direction), lamp.cos_inner, lamp.cos_outer);
  return left;
}

/// The direction in a lamp's own space in which it shines towards a point that sees it along `wi`.
SHADE_FN vec3 light_local(SHADE_IN(PunctualLamp) lamp, vec3 wi) {
  vec3 z = -lamp.direction;
  vec3 y = cross(z, lamp.across) * lamp.handedness;
  return vec3(dot(-wi, lamp.across), dot(-wi, y), dot(-wi, z));
}

/// Angles of a lamp's photometric web (ANSI/IES LM-63, type C) in which it shines along `d`, radians: x horizontal from
/// +x to +y, -π to π; y vertical from -z. Two-argument arc tangents keep the digits that acos loses near the axis,
/// where lamps are aimed at.
SHADE_FN vec2 light_profile_angles(vec3 d) { return vec2(atan(d.y, d.x), atan(sqrt(d.x * d.x + d.y * d.y), -d.z)); }

/// Radiance of a surface under a punctual light in the white-Lambertian convention: `color` is what a white Lambertian
/// surface (f = 1/π) facing the light shows, Lo = π f ⊗ c NoL. Akenine-Möller, Haines & Hoffman, "Real-Time
/// Rendering", 3rd ed. 2008, §7.5. An irradiance E of the light is c = E / π.
SHADE_FN vec3 light_white_lambertian(vec3 f, vec3 color, float n_dot_l) {
  return f * color * (kShadePi * max(n_dot_l, 0.0f));
}

SHADE_END

#endif
