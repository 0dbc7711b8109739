#ifndef CANDELA_SHADE_MICROFACET_GLSL_H
#define CANDELA_SHADE_MICROFACET_GLSL_H

#include "shade/shim.glsl.h"

// Everything here is in the local shading frame, n = +z; directions are unit and point away from the surface.

SHADE_BEGIN

/// Below this width GGX is treated as a mirror: single precision cannot hold the lobe any more, and nobody can see it.
SHADE_CONST float kGgxMirrorAlpha = 1e-3f;

/// The only converter from what an artist authors to the GGX width: α = r² (Burley 2012; glTF 2.0 Appendix B).
SHADE_FN float roughness_to_alpha(float roughness) { return roughness * roughness; }

/// GGX normal distribution. Walter et al. 2007, "Microfacet Models for Refraction", eq. 33, written with the tangent
/// components of h, because 1 - NoH² cancels in single precision for small α.
SHADE_FN float ggx_d(vec3 wm, float alpha) {
  float t = (wm.x * wm.x + wm.y * wm.y) / (alpha * alpha) + wm.z * wm.z;
  return 1.0f / (kShadePi * alpha * alpha * t * t);
}

/// Smith's Λ for GGX: (√(1 + α² tan²θ) - 1) / 2. Heitz 2014, "Understanding the Masking-Shadowing Function", eq. 72.
SHADE_FN float ggx_lambda(vec3 w, float alpha) {
  float a2tan2 = alpha * alpha * (w.x * w.x + w.y * w.y) / (w.z * w.z);
  return 0.5f * (sqrt(1.0f + a2tan2) - 1.0f);
}

SHADE_FN float ggx_g1(vec3 w, float alpha) { return 1.0f / (1.0f + ggx_lambda(w, alpha)); }

/// Height-correlated masking and shadowing over 4 NoL NoV. Heitz 2014, eq. 99.
SHADE_FN float ggx_v_smith(vec3 wo, vec3 wi, float alpha) {
  float a2 = alpha * alpha;
  float lo = wi.z * sqrt(wo.z * wo.z + a2 * (wo.x * wo.x + wo.y * wo.y));
  float li = wo.z * sqrt(wi.z * wi.z + a2 * (wi.x * wi.x + wi.y * wi.y));
  return 0.5f / max(lo + li, 1e-30f);
}

/// A microfacet normal visible from `wo` (wo.z > 0) for u in [0,1)². Dupuy & Benyoub 2023, "Sampling Visible GGX
/// Normals with Spherical Caps", listing 3, isotropic.
SHADE_FN vec3 ggx_sample_visible(vec3 wo, float alpha, vec2 u) {
  vec3 w = normalize(vec3(alpha * wo.x, alpha * wo.y, wo.z));
  float phi = 2.0f * kShadePi * u.x;
  float z = 1.0f - u.y * (1.0f + w.z);
  float r = sqrt(max(1.0f - z * z, 0.0f));
  vec3 c = vec3(r * cos(phi), r * sin(phi), z) + w;
  return normalize(vec3(alpha * c.x, alpha * c.y, max(c.z, 1e-7f)));
}

/// Density of wi = reflect(wo, wm) per solid angle for wm from ggx_sample_visible: D(wm) G1(wo) / (4 wo.z).
SHADE_FN float ggx_pdf_visible(vec3 wo, vec3 wm, float alpha) {
  float t = sqrt(wo.z * wo.z + alpha * alpha * (wo.x * wo.x + wo.y * wo.y));
  return ggx_d(wm, alpha) / (2.0f * (wo.z + t));
}

/// Mirror direction of `wo` about `wm`.
SHADE_FN vec3 microfacet_reflect(vec3 wo, vec3 wm) { return 2.0f * dot(wo, wm) * wm - wo; }

SHADE_END

#endif
