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

/// How far the reflectance of a dielectric boundary has risen from that at normal incidence (0) to 1 at grazing: what
/// stands for Schlick's (1 - cos)^5 where the index is known. `eta` = n_t / n_i ≥ 1, `scale` = 1 / (1 - F0). Above 3.7
/// the true curve first falls a little; here it is held. From the transmittances of both polarisations, Born & Wolf,
/// "Principles of Optics", §1.5.2, eq. 21: 1 - F = 2 c g (1 / (g + c)² + η² / (g + η² c)²).
SHADE_FN float fresnel_rise(float cos_theta, float eta, float scale) {
  float c = shade_saturate(cos_theta);
  float eta2 = eta * eta;
  float g = sqrt(max(eta2 - 1.0f + c * c, 0.0f));
  float s = g + c;
  float p = g + eta2 * c;
  float through = 2.0f * c * g * (p * p + eta2 * s * s) / max(s * s * p * p, 1e-30f);
  return shade_saturate(1.0f - scale * through);
}

/// 1 / (1 - F0) of an index.
SHADE_FN float fresnel_rise_scale(float eta) { return shade_sqr(eta + 1.0f) / (4.0f * eta); }

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

/// fresnel_conductor of three channels, each with its own index.
SHADE_FN vec3 fresnel_conductor3(float cos_theta, vec3 n, vec3 k) {
  return vec3(fresnel_conductor(cos_theta, n.x, k.x), fresnel_conductor(cos_theta, n.y, k.y),
              fresnel_conductor(cos_theta, n.z, k.z));
}

/// Reflectance of a dielectric boundary for light whose electric field is perpendicular to the plane of incidence.
/// Born & Wolf, "Principles of Optics", §1.5.2, eq. 21.
SHADE_FN float fresnel_dielectric_s(float cos_theta, float eta) {
  float c = shade_saturate(cos_theta);
  float g2 = eta * eta - 1.0f + c * c;
  if (g2 <= 0.0f) return 1.0f;
  float g = sqrt(g2);
  return shade_sqr((c - g) / (c + g));
}

/// And parallel to it: zero at Brewster's angle, tan θ = eta.
SHADE_FN float fresnel_dielectric_p(float cos_theta, float eta) {
  float c = shade_saturate(cos_theta);
  float g2 = eta * eta - 1.0f + c * c;
  if (g2 <= 0.0f) return 1.0f;
  float g = sqrt(g2);
  return shade_sqr((eta * eta * c - g) / (eta * eta * c + g));
}

/// Schlick's curve with F90 = 1 as a power of two. Karis 2013, "Real Shading in Unreal Engine 4", eq. 5.
SHADE_FN vec3 fresnel_spherical_gaussian(vec3 f0, float cos_theta) {
  float c = shade_saturate(cos_theta);
  return f0 + (vec3(1.0f) - f0) * exp2((-5.55473f * c - 6.98316f) * c);
}

/// A metal by its colour at the normal and a tint of Schlick's curve near 82° (cos = 1/7), where metals dip; tint 1 is
/// Schlick. Kutz, Hasan & Edmondson 2021, "Novel Aspects of the Adobe Standard Material"; Hoffman 2019, "Fresnel
/// Equations Considered Harmful". Held at 0, which a tint near black undercuts beside 82°.
SHADE_FN vec3 fresnel_f82(vec3 f0, vec3 tint, float cos_theta) {
  float c = shade_saturate(cos_theta);
  float m = 1.0f - c;
  float bump = c * m * schlick_weight(c) * (823543.0f / 46656.0f);  // cos (1 - cos)⁶ over its value at 1/7, 6⁶ / 7⁷
  vec3 at_82 = f0 + (vec3(1.0f) - f0) * (7776.0f / 16807.0f);       // (6/7)⁵
  return max(f0 + (vec3(1.0f) - f0) * schlick_weight(c) - at_82 * (vec3(1.0f) - tint) * bump, vec3(0.0f));
}

/// Schlick's curve for both sides of a dielectric boundary. `cos_theta` ≥ 0 on the side the light comes from, `eta` =
/// n_t / n_i. The curve takes the angle on the optically thinner side, so for light that leaves the denser one (eta <
/// 1) the refracted angle, and is 1 at total internal reflection: both sides then reflect the same along a path.
/// KHR_materials_volume.
SHADE_FN vec3 schlick_dielectric(vec3 f0, float cos_theta, float eta) {
  float c = shade_saturate(cos_theta);
  if (eta < 1.0f) {
    float cos2_t = 1.0f - (1.0f - c * c) / (eta * eta);
    if (cos2_t <= 0.0f) return vec3(1.0f);
    c = sqrt(cos2_t);
  }
  return fresnel_schlick(f0, vec3(1.0f), c);
}

/// Cosine-weighted mean of Schlick's curve over the hemisphere, 2 ∫ F μ dμ.
SHADE_FN vec3 fresnel_average_schlick(vec3 f0, vec3 f90) { return f0 + (f90 - f0) * (1.0f / 21.0f); }

/// F0 of the `specular` slider of Burley 2012 and Karis 2013: 0.5 is glass of index 1.5.
SHADE_FN float f0_from_specular(float specular) { return 0.08f * specular; }

SHADE_END

#endif
