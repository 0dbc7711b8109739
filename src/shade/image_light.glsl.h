#ifndef CANDELA_SHADE_IMAGE_LIGHT_GLSL_H
#define CANDELA_SHADE_IMAGE_LIGHT_GLSL_H

#include "shade/surface.glsl.h"

// What a surface makes of prefiltered light: the share of each lobe, seen from wo. With light that is the same from
// everywhere they add up to the surface's albedo, multiple scattering included, so that a white surface stays white.

SHADE_BEGIN

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

/// The normal by which a lobe of this anisotropy mirrors prefiltered light: it is wide along its direction, so that the
/// normal leans towards the viewer in the plane across it. All are unit and of one space.
SHADE_FN vec3 image_light_leaning(vec3 n, vec3 wo, vec3 across, float anisotropy) {
  vec3 along_view = cross(across, wo);
  vec3 anisotropic = normalize(cross(along_view, across));
  vec3 bent = normalize(mix(n, anisotropic, shade_saturate(anisotropy * anisotropy)));
  return dot(bent, n) < 0.0f ? n : bent;
}

SHADE_END

#endif
