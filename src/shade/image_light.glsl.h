#ifndef CANDELA_SHADE_IMAGE_LIGHT_GLSL_H
#define CANDELA_SHADE_IMAGE_LIGHT_GLSL_H

#include "shade/surface.glsl.h"

// What a surface makes of prefiltered light: the share of each lobe, seen from wo. With light that is the same from
// everywhere they add up to the surface's albedo, multiple scattering included, so that a white surface stays white.

SHADE_BEGIN

/// Directional albedos at wo, each as it is left by what lies above it.
struct SurfaceShares {
  vec3 specular;  ///< opaque facets
  vec3 diffuse;
  vec3 below;    ///< diffuse light from the other side
  vec3 glass;    ///< facets of the transparent part, reflected
  vec3 through;  ///< and let through, tint included: of one sheet, or of one boundary of a body
  vec3 sheen;
  vec3 coat;
};

SHADE_FN void layers_shares(SHADE_IN(Surface) s, vec3 wo, SHADE_INOUT(SurfaceShares) r) {
  float over = layers_through(s, s.coat_albedo_o, s.sheen_albedo_o);
  vec2 ab = layers_ggx(s, wo, s.curve);
  vec3 specular = s.specular_albedo_o;
  // The tables know a film at normal incidence; here it has the colour of this angle.
  if (s.iridescence > 0.0f) specular += terms_fresnel_opaque(s, wo.z) * (ab.x + ab.y) - s.single_albedo_o;
  r.specular = specular * over;
  r.diffuse = s.diffuse * s.film_below_o * s.transmission_o;
  r.below = s.diffuse_below * s.film_below_o * s.transmission_o;
  r.sheen = s.sheen * (s.sheen_albedo_o * (1.0f - s.coat * s.coat_albedo_o));
  r.coat = vec3(s.coat * s.coat_albedo_o);
  if (s.weight_glass <= 0.0f) return;
  // A smooth boundary, or a film, reflects by the exact curve; a rough one loses what the tables of glass say.
  vec2 ab_glass = layers_ggx(s, wo, table_curve(max(s.eta, 1.0f / s.eta)));
  vec3 reflected = s.glass_f0_tinted * ab_glass.x + vec3(s.f90_dielectric * ab_glass.y);
  if (s.is_glass_delta) reflected = terms_fresnel_glass(s, wo.z);
  if (s.iridescence > 0.0f) reflected = terms_fresnel_glass(s, wo.z) * (ab.x + ab.y);
  vec3 lost = vec3(s.glass_escape_o * s.glass_reflected);
  reflected = min(reflected + lost, vec3(1.0f));
  r.glass = reflected * (s.weight_glass * over);
  r.through = s.glass_tint * (vec3(1.0f) - reflected) * (s.weight_glass * over);
}

SHADE_FN SurfaceShares surface_shares(SHADE_IN(Surface) s, vec3 wo) {
  SurfaceShares r;
  r.specular = s.specular_albedo_o;
  r.diffuse = s.diffuse * s.transmission_o;
  r.below = vec3(0.0f);
  r.glass = vec3(0.0f);
  r.through = vec3(0.0f);
  r.sheen = vec3(0.0f);
  r.coat = vec3(0.0f);
  if (s.lobes != 0) layers_shares(s, wo, r);
  return r;
}

/// Level of a prefiltered cube whose α halves from one of its `levels` to the one before; level 0 is a mirror.
SHADE_FN float image_light_level(float alpha, float levels) {
  return clamp(levels - 1.0f + log2(max(alpha, 1e-8f)), 0.0f, levels - 1.0f);
}

/// Where a rough lobe has its middle: between the mirror direction and the normal. Lagarde & de Rousiers 2014, "Moving
/// Frostbite to Physically Based Rendering", §4.9.3.
SHADE_FN vec3 image_light_dominant(vec3 n, vec3 mirrored, float alpha) {
  float gloss = 1.0f - alpha;
  return normalize(mix(n, mirrored, gloss * (sqrt(max(gloss, 0.0f)) + alpha)));
}

/// How much of a lobe's light arrives where a share `visibility` of the hemisphere is open. Lagarde & de Rousiers 2014,
/// §4.10.2.
SHADE_FN float image_light_specular_occlusion(float mu, float visibility, float alpha) {
  return shade_saturate(pow(mu + visibility, exp2(-16.0f * alpha - 1.0f)) - 1.0f + visibility);
}

/// Share of the hemisphere's light that a diffuse surface of this albedo gets where `visibility` of it is open: what
/// occludes is as bright as the surface itself. Jiménez, Wu, Pesce & Jarabo 2016, "Practical Real-Time Strategies for
/// Accurate Indirect Occlusion", eq. 14 (their fit to ray tracing).
SHADE_FN vec3 image_light_multibounce(float visibility, vec3 albedo) {
  vec3 a = 2.0404f * albedo - vec3(0.3324f);
  vec3 b = vec3(0.6417f) - 4.7951f * albedo;
  vec3 c = 2.7552f * albedo + vec3(0.6903f);
  return max(vec3(visibility), ((a * visibility + b) * visibility + c) * visibility);
}

/// Fades a reflection that points into the surface, where only a normal map can send it. Filament's and others' horizon
/// term: (1 + R·N_geometric)².
SHADE_FN float image_light_horizon(vec3 mirrored, vec3 geometric_normal) {
  float h = min(1.0f + dot(mirrored, geometric_normal), 1.0f);
  return h * h;
}

SHADE_END

#endif
