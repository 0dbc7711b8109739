#ifndef CANDELA_SHADE_DIFFUSE_GLSL_H
#define CANDELA_SHADE_DIFFUSE_GLSL_H

#include "shade/fresnel.glsl.h"
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

// ----- rough diffuse layers. Each returns f, symmetric in the two directions, with both cosines > 0.

/// Retroreflection at grazing angles when rough, darkening when smooth. `cos_d` is the cosine between a direction and
/// the half vector. Burley 2012, "Physically Based Shading at Disney", §5.3. A rough white one reflects up to 1.55
/// times what arrives at grazing angles.
SHADE_FN vec3 burley_f(vec3 albedo, float roughness, float cos_i, float cos_o, float cos_d) {
  float rise = 2.0f * roughness * cos_d * cos_d - 0.5f;  // F_D90 - 1
  float i = 1.0f + rise * schlick_weight(cos_i);
  float o = 1.0f + rise * schlick_weight(cos_o);
  return albedo * (i * o * (1.0f / kShadePi));
}

/// Burley's, scaled so that it reflects no more than arrives (but for 2.5 % at the horizon). Lagarde & de Rousiers
/// 2014, "Moving Frostbite to Physically Based Rendering", §3.1.
SHADE_FN vec3 burley_renormalised_f(vec3 albedo, float roughness, float cos_i, float cos_o, float cos_d) {
  float rise = 0.5f * roughness + 2.0f * roughness * cos_d * cos_d - 1.0f;
  float i = 1.0f + rise * schlick_weight(cos_i);
  float o = 1.0f + rise * schlick_weight(cos_o);
  return albedo * (i * o * mix(1.0f, 1.0f / 1.51f, roughness) * (1.0f / kShadePi));
}

/// V-shaped grooves of Lambertian walls whose slope angle has the standard deviation `sigma` (radians). Oren & Nayar
/// 1994, "Generalization of Lambert's Reflectance Model", the qualitative model, eq. 30; sin α tan β cos Δφ written
/// with cosines. Loses a third of the light when rough.
SHADE_FN vec3 oren_nayar_f(vec3 albedo, float sigma, vec3 wo, vec3 wi) {
  float s2 = sigma * sigma;
  float a = 1.0f - 0.5f * s2 / (s2 + 0.33f);
  float b = 0.45f * s2 / (s2 + 0.09f);
  float s = max(wo.x * wi.x + wo.y * wi.y, 0.0f);
  return albedo * ((a + b * s / max(max(wo.z, wi.z), 1e-7f)) * (1.0f / kShadePi));
}

// The energy-preserving Oren–Nayar model: Fujii's with the light of further bounces. Portsmouth, Kutz & Hill 2025,
// "EON: A Practical Energy-Preserving Rough Diffuse BRDF". `r` in [0, 1]; its single-scattering albedo is A (1 + r G(μ)
// / π) with G(0) / π = kEonEdge and 2 ∫ G μ dμ / π = kEonMean.
SHADE_CONST float kEonEdge = 0.287793409f;  // 1/2 - 2 / 3π
SHADE_CONST float kEonMean = 0.072488212f;  // 2/3 - 28 / 15π

/// G(μ) / π, exact: the paper's closed form with (1 - sin³) / cos written so that nothing is divided by the cosine.
SHADE_FN float eon_rise(float mu) {
  float c = shade_saturate(mu);
  float s = sqrt(1.0f - c * c);
  float g = s * (acos(c) - s * c) + (2.0f / 3.0f) * s * (c * (1.0f + s + s * s) / (1.0f + s) - 1.0f);
  return g * (1.0f / kShadePi);
}

/// The paper's polynomial for it, within 7e-4.
SHADE_FN float eon_rise_fit(float mu) {
  float m = 1.0f - shade_saturate(mu);
  return m * (0.0571085289f + m * (0.491881867f + m * (-0.332181442f + m * 0.0714429953f)));
}

/// Directional albedo of single scattering for white walls: what is missing from 1 is EON's share of further bounces.
SHADE_FN float eon_albedo(float mu, float r) { return (1.0f + r * eon_rise(mu)) / (1.0f + kEonEdge * r); }
SHADE_FN float eon_albedo_fit(float mu, float r) { return (1.0f + r * eon_rise_fit(mu)) / (1.0f + kEonEdge * r); }

/// EON with the exact albedos, so that white reflects all of a white furnace. (OpenPBR 1.1.1 prints one 1/π too many in
/// the second term.) Differences from 1 are formed before they are rounded: at r = 0 it is Lambert's.
SHADE_FN vec3 eon_f(vec3 albedo, float r, vec3 wo, vec3 wi) {
  float a = 1.0f / (1.0f + kEonEdge * r);
  float s = wo.x * wi.x + wo.y * wi.y;
  if (s > 0.0f) s = s / max(max(wo.z, wi.z), 1e-7f);
  float average = a * (1.0f + kEonMean * r);
  float loss_o = max(kEonEdge - eon_rise(wo.z), 0.0f);
  float loss_i = max(kEonEdge - eon_rise(wi.z), 0.0f);
  float multiple = a * r * loss_o * loss_i / (kEonEdge - kEonMean);  // (1 - E(o)) (1 - E(i)) / (1 - average)
  vec3 tint = albedo * albedo * average / (vec3(1.0f) - albedo * (1.0f - average));
  return (albedo * (a * (1.0f + r * s)) + tint * multiple) * (1.0f / kShadePi);
}

SHADE_END

#endif
