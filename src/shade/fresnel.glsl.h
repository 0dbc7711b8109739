#ifndef CANDELA_SHADE_FRESNEL_GLSL_H
#define CANDELA_SHADE_FRESNEL_GLSL_H

#include "shade/shim.glsl.h"

SHADE_BEGIN

/// (1 - cos)^5, the shape of Schlick's curve. `cos_theta` in [0, 1].
SHADE_FN float schlick_weight(float cos_theta) {
  float m = shade_saturate(1.0f - cos_theta);
  float m2 = m * m;
  return m2 * m2 * m;
}

/// Reflectance between F0 at normal incidence and F90 at grazing. Schlick 1994, "An Inexpensive BRDF Model", eq. 15.
SHADE_FN vec3 fresnel_schlick(vec3 f0, vec3 f90, float cos_theta) {
  return f0 + (f90 - f0) * schlick_weight(cos_theta);
}

/// Reflectance at normal incidence of a plane boundary; `eta` = n_transmitted / n_incident > 0.
SHADE_FN float f0_from_eta(float eta) { return shade_sqr((eta - 1.0f) / (eta + 1.0f)); }

/// Unpolarised reflectance of a dielectric boundary. `cos_theta` ≥ 0 on the incident side, `eta` = n_t / n_i; 1 at
/// total internal reflection. Cook & Torrance 1982, "A Reflectance Model for Computer Graphics", p. 11 (Fresnel in g
/// and c).
SHADE_FN float fresnel_dielectric(float cos_theta, float eta) {
  float c = shade_saturate(cos_theta);
  float g2 = eta * eta - 1.0f + c * c;
  if (g2 <= 0.0f) return 1.0f;
  float g = sqrt(g2);
  float a = (g - c) / (g + c);
  float b = (c * (g + c) - 1.0f) / (c * (g - c) + 1.0f);
  return 0.5f * a * a * (1.0f + b * b);
}

/// Unpolarised reflectance of a conductor in air with complex index n + ik (per channel).
/// Born & Wolf, "Principles of Optics", §14.2 (in the closed form of Lagarde's "Memo on Fresnel equations").
SHADE_FN float fresnel_conductor(float cos_theta, float n, float k) {
  float c2 = shade_sqr(shade_saturate(cos_theta));
  float s2 = 1.0f - c2;
  float t0 = n * n - k * k - s2;
  float a2plusb2 = sqrt(t0 * t0 + 4.0f * n * n * k * k);
  float t1 = a2plusb2 + c2;
  float a = sqrt(max(0.5f * (a2plusb2 + t0), 0.0f));
  float t2 = 2.0f * a * sqrt(c2);
  float rs = (t1 - t2) / (t1 + t2);
  float t3 = c2 * a2plusb2 + s2 * s2;
  float t4 = t2 * s2;
  float rp = rs * (t3 - t4) / (t3 + t4);
  return 0.5f * (rs + rp);
}

SHADE_END

#endif
