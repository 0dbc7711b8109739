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
/// Normals with Spherical Caps", listing 3, isotropic; without its differences of numbers near 1, which a narrow lobe
/// makes large errors of.
SHADE_FN vec3 ggx_sample_visible(vec3 wo, float alpha, vec2 u) {
  vec3 w = normalize(vec3(alpha * wo.x, alpha * wo.y, wo.z));
  float phi = 2.0f * kShadePi * u.x;
  float up = (1.0f - u.y) * (1.0f + w.z);  // height above the rim of the cap, which lies at -w.z
  float r = sqrt(u.y * (1.0f + w.z) * (up + (w.x * w.x + w.y * w.y) / (1.0f + w.z)));
  vec3 c = vec3(r * cos(phi) + w.x, r * sin(phi) + w.y, up);
  return normalize(vec3(alpha * c.x, alpha * c.y, max(c.z, 1e-7f)));
}

/// Density of wi = reflect(wo, wm) per solid angle for wm from ggx_sample_visible: D(wm) G1(wo) / (4 wo.z).
SHADE_FN float ggx_pdf_visible(vec3 wo, vec3 wm, float alpha) {
  float t = sqrt(wo.z * wo.z + alpha * alpha * (wo.x * wo.x + wo.y * wo.y));
  return ggx_d(wm, alpha) / (2.0f * (wo.z + t));
}

/// Mirror direction of `wo` about `wm`.
SHADE_FN vec3 microfacet_reflect(vec3 wo, vec3 wm) { return 2.0f * dot(wo, wm) * wm - wo; }

// ----- anisotropic GGX: width `ax` along the tangent x, `ay` along the bitangent y

/// GGX with two widths. Heitz 2018, "Sampling the GGX Distribution of Visible Normals", eq. 1.
SHADE_FN float ggx_d_aniso(vec3 wm, float ax, float ay) {
  float t = shade_sqr(wm.x / ax) + shade_sqr(wm.y / ay) + wm.z * wm.z;
  return 1.0f / (kShadePi * ax * ay * t * t);
}

/// Smith's Λ. Heitz 2018, eq. 2.
SHADE_FN float ggx_lambda_aniso(vec3 w, float ax, float ay) {
  float a2tan2 = (shade_sqr(ax * w.x) + shade_sqr(ay * w.y)) / max(w.z * w.z, 1e-20f);
  return 0.5f * (sqrt(1.0f + a2tan2) - 1.0f);
}

/// Height-correlated masking and shadowing over 4 NoL NoV. Heitz 2014, eq. 99.
SHADE_FN float ggx_v_smith_aniso(vec3 wo, vec3 wi, float ax, float ay) {
  float lo = wi.z * length(vec3(ax * wo.x, ay * wo.y, wo.z));
  float li = wo.z * length(vec3(ax * wi.x, ay * wi.y, wi.z));
  return 0.5f / max(lo + li, 1e-30f);
}

/// A microfacet normal visible from `wo` (wo.z > 0) for u in [0,1)². Dupuy & Benyoub 2023, listing 3, as above.
SHADE_FN vec3 ggx_sample_visible_aniso(vec3 wo, float ax, float ay, vec2 u) {
  vec3 w = normalize(vec3(ax * wo.x, ay * wo.y, wo.z));
  float phi = 2.0f * kShadePi * u.x;
  float up = (1.0f - u.y) * (1.0f + w.z);  // height above the rim of the cap, which lies at -w.z
  float r = sqrt(u.y * (1.0f + w.z) * (up + (w.x * w.x + w.y * w.y) / (1.0f + w.z)));
  vec3 c = vec3(r * cos(phi) + w.x, r * sin(phi) + w.y, up);
  return normalize(vec3(ax * c.x, ay * c.y, max(c.z, 1e-7f)));
}

/// Density of wi = reflect(wo, wm) per solid angle for wm from ggx_sample_visible_aniso: D(wm) G1(wo) / (4 wo.z).
SHADE_FN float ggx_pdf_visible_aniso(vec3 wo, vec3 wm, float ax, float ay) {
  float t = length(vec3(ax * wo.x, ay * wo.y, wo.z));
  return ggx_d_aniso(wm, ax, ay) / (2.0f * (wo.z + t));
}

// ----- refraction; `eta` = n of the far side / n of wo's side, wi on the far side (wi.z < 0)

/// Direction that continues behind a facet, for light travelling from wo's side to the other: Snell's law. `wm` faces
/// wo. The zero vector at total internal reflection. Walter et al. 2007, eq. 40.
SHADE_FN vec3 microfacet_refract(vec3 wo, vec3 wm, float eta) {
  float c = dot(wo, wm);
  float sin2_t = max(1.0f - c * c, 0.0f) / (eta * eta);
  if (sin2_t >= 1.0f) return vec3(0.0f);
  return (c / eta - sqrt(1.0f - sin2_t)) * wm - wo * (1.0f / eta);
}

/// The facet (wm.z ≥ 0) that refracts wo into wi; the zero vector where there is none (eta = 1 and wi = -wo). Walter et
/// al. 2007, eq. 16.
SHADE_FN vec3 microfacet_half_refract(vec3 wo, vec3 wi, float eta) {
  vec3 h = wo + eta * wi;
  float l2 = dot(h, h);
  if (l2 < 1e-12f) return vec3(0.0f);
  return h * ((h.z < 0.0f ? -1.0f : 1.0f) / sqrt(l2));
}

/// Solid angle of facets per solid angle of refracted directions, dωm / dωi at fixed wo. `cos_o` = wo·wm > 0, `cos_i` =
/// wi·wm < 0. Walter et al. 2007, eq. 17.
SHADE_FN float microfacet_refract_jacobian(float cos_o, float cos_i, float eta) {
  float d = cos_o + eta * cos_i;
  return eta * eta * abs(cos_i) / max(d * d, 1e-12f);
}

/// Density of the visible facet wm itself: D(wm) G1(wo) (wo·wm) / wo.z. Heitz 2018, eq. 3.
SHADE_FN float ggx_pdf_normal_aniso(vec3 wo, vec3 wm, float ax, float ay) {
  return 4.0f * max(dot(wo, wm), 0.0f) * ggx_pdf_visible_aniso(wo, wm, ax, ay);
}

/// Density of wi = refract(wo, wm) per solid angle for wm from ggx_sample_visible_aniso; 0 where wm does not refract wo
/// into the side of wi. The BTDF of Walter et al. 2007, eq. 21, times |wi.z| is D (wo·wm) G / wo.z times the same
/// Jacobian, times 1 - F.
SHADE_FN float ggx_pdf_refract_aniso(vec3 wo, vec3 wi, vec3 wm, float ax, float ay, float eta) {
  float cos_o = dot(wo, wm);
  float cos_i = dot(wi, wm);
  if (cos_o <= 0.0f || cos_i >= 0.0f) return 0.0f;
  return ggx_pdf_normal_aniso(wo, wm, ax, ay) * microfacet_refract_jacobian(cos_o, cos_i, eta);
}

/// The same for ggx_sample_visible.
SHADE_FN float ggx_pdf_refract(vec3 wo, vec3 wi, vec3 wm, float alpha, float eta) {
  float cos_o = dot(wo, wm);
  float cos_i = dot(wi, wm);
  if (cos_o <= 0.0f || cos_i >= 0.0f) return 0.0f;
  return 4.0f * cos_o * ggx_pdf_visible(wo, wm, alpha) * microfacet_refract_jacobian(cos_o, cos_i, eta);
}

// ----- other distributions of facets, for comparison; each has ∫ D cos = 1

/// Facets whose slopes are normally distributed. Walter et al. 2007, eq. 25.
SHADE_FN float beckmann_d(vec3 wm, float alpha) {
  float z2 = max(wm.z * wm.z, 1e-12f);
  float a2 = alpha * alpha;
  return exp(-(wm.x * wm.x + wm.y * wm.y) / (a2 * z2)) / (kShadePi * a2 * z2 * z2);
}

/// Exponent of the cosine lobe that is as wide as Beckmann's: n = 2/α² - 2. Walter et al. 2007, §5.2.
SHADE_FN float blinn_phong_exponent(float alpha) { return 2.0f / (alpha * alpha) - 2.0f; }

/// Blinn–Phong as a distribution of facets, (n + 2) / 2π cosⁿ with n = blinn_phong_exponent(α), so that n + 2 = 2/α².
/// Blinn 1977, "Models of Light Reflection for Computer Synthesized Pictures"; normalised by Walter et al. 2007,
/// eq. 30. From the sine, because cosⁿ with n in the millions has no digit of the cosine left.
SHADE_FN float blinn_phong_d(vec3 wm, float alpha) {
  float s2 = min(wm.x * wm.x + wm.y * wm.y, 1.0f);
  float n = blinn_phong_exponent(alpha);
  float log_cos2 = s2 < 0.01f ? -s2 * (1.0f + s2 * (0.5f + s2 * (1.0f / 3.0f))) : log(max(wm.z * wm.z, 1e-30f));
  return exp(0.5f * n * log_cos2) / (kShadePi * alpha * alpha);
}

/// Fibres that stand up from the surface: (2 + 1/α) sin^(1/α) / 2π. Estevez & Kulla 2017, "Production Friendly
/// Microfacet Sheen BRDF", eq. 2; α = roughness² is KHR_materials_sheen's.
SHADE_FN float charlie_d(vec3 wm, float alpha) {
  float inverse = 1.0f / max(alpha, 1e-4f);
  float s2 = min(wm.x * wm.x + wm.y * wm.y, 1.0f);
  return (2.0f + inverse) * pow(s2, 0.5f * inverse) * (0.5f / kShadePi);
}

// ----- other masking terms, each V = G / (4 NoL NoV), for wo.z and wi.z > 0

/// Masking and shadowing as if they were independent, G1(wo) G1(wi). Walter et al. 2007, eq. 23 and 34.
SHADE_FN float v_smith_separable(vec3 wo, vec3 wi, float alpha) {
  float to = sqrt(wo.z * wo.z + alpha * alpha * (wo.x * wo.x + wo.y * wo.y));
  float ti = sqrt(wi.z * wi.z + alpha * alpha * (wi.x * wi.x + wi.y * wi.y));
  return 1.0f / max((wo.z + to) * (wi.z + ti), 1e-30f);
}

/// Schlick's rational G1 = c / (c (1 - k) + k). Karis 2013, "Real Shading in Unreal Engine 4", eq. 4.
SHADE_FN float v_schlick_ggx(vec3 wo, vec3 wi, float k) {
  return 0.25f / max((wo.z * (1.0f - k) + k) * (wi.z * (1.0f - k) + k), 1e-30f);
}

/// Karis 2013: k = (r + 1)² / 8 for lights, of the authored roughness.
SHADE_FN float schlick_k_direct(float roughness) { return shade_sqr(roughness + 1.0f) * 0.125f; }

/// Karis 2013: k = r² / 2 for image-based light, close to Smith's.
SHADE_FN float schlick_k_ibl(float roughness) { return 0.5f * roughness * roughness; }

/// G1 / (w·n) of Beckmann facets by the rational fit of Walter et al. 2007, eq. 27, whose pole at the horizon is
/// divided out. The fit exceeds 1 by 6e-5 where it meets the constant; it is held.
SHADE_FN float beckmann_g1_over_cos(vec3 w, float alpha) {
  float c = max(w.z, 1e-15f);
  float b = alpha * sqrt(w.x * w.x + w.y * w.y);
  if (c >= 1.6f * b) return 1.0f / c;
  float a = c / b;
  return min((3.535f + 2.181f * a) / ((1.0f + a * (2.276f + 2.577f * a)) * b), 1.0f / c);
}

/// Beckmann masking of both directions, as Cook–Torrance renderers have it.
SHADE_FN float v_beckmann_rational(vec3 wo, vec3 wi, float alpha) {
  return 0.25f * beckmann_g1_over_cos(wo, alpha) * beckmann_g1_over_cos(wi, alpha);
}

/// Λ of charlie_d, fitted. Estevez & Kulla 2017, eq. 3 and table 1, without the softened terminator of its eq. 4, which
/// is not reciprocal.
SHADE_FN float charlie_lambda(float cos_theta, float alpha) {
  float t = shade_sqr(1.0f - alpha);
  float a = mix(21.5473f, 25.3245f, t);
  float b = mix(3.82987f, 3.32435f, t);
  float c = mix(0.19823f, 0.16801f, t);
  float d = mix(-1.97760f, -1.27393f, t);
  float e = mix(-4.32054f, -4.85967f, t);
  float x = shade_saturate(cos_theta);
  float l_half = a / (1.0f + b * pow(0.5f, c)) + d * 0.5f + e;
  float y = min(x, 1.0f - x);  // the curve is antisymmetric about 60°
  float l = a / (1.0f + b * pow(y, c)) + d * y + e;
  return exp(x < 0.5f ? l : 2.0f * l_half - l);
}

/// Height-correlated masking of charlie_d.
SHADE_FN float charlie_v(vec3 wo, vec3 wi, float alpha) {
  float g = 1.0f / (1.0f + charlie_lambda(wo.z, alpha) + charlie_lambda(wi.z, alpha));
  return g / max(4.0f * wo.z * wi.z, 1e-15f);
}

/// Smooth stand-in for it. Neubelt & Pettineo 2013, "Crafting a Next-Gen Material Pipeline for The Order: 1886".
SHADE_FN float neubelt_v(vec3 wo, vec3 wi) { return 0.25f / max(wo.z + wi.z - wo.z * wi.z, 1e-15f); }

SHADE_END

#endif
