#ifndef CANDELA_SHADE_IMAGE_LIGHT_GLSL_H
#define CANDELA_SHADE_IMAGE_LIGHT_GLSL_H

#include "shade/surface.glsl.h"

// What a surface makes of prefiltered light: the share of each lobe, seen from wo. With light that is the same from
// everywhere they add up to the surface's albedo, multiple scattering included, so that a white surface stays white.

SHADE_BEGIN

SHADE_FN SurfaceShares surface_shares(SHADE_IN(Surface) s, vec3 wo) {
  SurfaceShares r;
  r.specular = s.single_albedo_o;
  r.spread = s.multiscatter * (kShadePi * s.escape_mean * s.escape_o);
  r.diffuse = s.diffuse * s.transmission_o;
  r.below = vec3(0.0f);
  r.glass = vec3(0.0f);
  r.through = vec3(0.0f);
  r.sheen = vec3(0.0f);
  r.coat = vec3(0.0f);
  float f0 = shade_max3(s.weight_dielectric * s.f0_dielectric + s.weight_metal * s.f0_metal);
  r.rise = base_share_of_rise(f0 * (1.0f - s.escape_o), shade_max3(s.single_albedo_o));
  r.coat_rise = 0.0f;
  if (SHADE_LOBES(s) != 0) layers_shares(s, wo, r);
  return r;
}

/// Level of a prefiltered cube whose α halves from one of its `levels` to the one before; level 0 is a mirror.
SHADE_FN float image_light_level(float alpha, float levels) {
  return clamp(levels - 1.0f + log2(max(alpha, 1e-8f)), 0.0f, levels - 1.0f);
}

/// What a lobe reads of prefiltered light.
struct ImageLightLookup {
  vec3 direction;
  float alpha;
  float weight;  ///< among the lookups of one lobe
};

/// Where a lobe of round facets is best read, single scattering alone. Prefiltered light is that of a lobe seen along
/// its normal; seen from the side its middle lies between the normal and the mirror direction, and it is narrower.
/// From the first is Lagarde & de Rousiers 2014, "Moving Frostbite to Physically Based Rendering", §4.9.3; the rest is
/// fitted to lobes summed up over four photographed environments, for F0 of 0.04, 0.3 and 1, but that no lobe is more
/// than three tenths narrower: few bright panels are missed then.
SHADE_FN ImageLightLookup image_light_lookup(vec3 n, vec3 mirrored, float alpha, float rise) {
  ImageLightLookup r;
  float mu = clamp(dot(n, mirrored), 0.0f, 1.0f);
  float aside = shade_sqr(1.0f - mu * mu);
  float gloss = 1.0f - alpha;
  float bend = gloss * (sqrt(max(gloss, 0.0f)) + alpha);
  bend *= 1.0f - (0.31f + 0.53f * alpha) * aside * alpha / max(alpha + 1.16f * mu, 1e-6f);
  bend += 0.89f * rise * alpha;
  r.direction = normalize(mix(n, mirrored, bend));
  r.alpha = alpha * (1.0f - aside * clamp(0.82f - 1.69f * alpha + 1.46f * rise, 0.0f, 0.3f));
  r.weight = 1.0f;
  return r;
}

/// Lookups of a lobe that is wide along x and narrow along y.
SHADE_CONST int kStreakLookups = 8;

/// How wide each is, over the half distance to its neighbours: fitted as above.
SHADE_CONST float kStreakOverlap = 0.35f;

/// Those of facets of the widths `alpha` (x ≥ y) in their own frame: as if they were round ones of the narrow width
/// that lean along x as widely as is missing. Their weights have no sum; 0 = nothing arrives there.
SHADE_FN ImageLightLookup image_light_streak(vec3 wo, vec2 alpha, float rise, int i) {
  float along = sqrt(max(alpha.x * alpha.x - alpha.y * alpha.y, 0.0f));
  float u = float(2 * i + 1 - kStreakLookups) / float(kStreakLookups);  // evenly through what facets lean, -1 to 1
  float scale = 1.0f / sqrt(1.0f - u * u);
  float slope = along * u * scale;
  vec3 n = normalize(vec3(-slope, 0.0f, 1.0f));
  float mu = dot(n, wo);
  vec3 wi = 2.0f * mu * n - wo;
  ImageLightLookup r;
  if (mu <= 0.0f || wi.z <= 0.0f) {
    r.direction = vec3(0.0f, 0.0f, 1.0f);
    r.alpha = alpha.y;
    r.weight = 0.0f;
    return r;
  }
  r = image_light_lookup(n, wi, alpha.y, rise);
  r.weight = mu / n.z * ggx_v_smith_aniso(wo, wi, alpha.x, alpha.y) * wi.z;
  // A lean out of the plane of incidence turns light by less: by its cosine.
  float x2 = wo.x * wo.x / max(wo.x * wo.x + wo.y * wo.y, 1e-12f);
  float near = kStreakOverlap * along * scale * scale * scale / (float(kStreakLookups) * (1.0f + slope * slope));
  float narrow2 = r.alpha * r.alpha * mix(1.0f, mu * mu, x2);
  r.alpha = min(sqrt(narrow2 + near * near * mix(mu * mu, 1.0f, x2)), 1.0f);
  return r;
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
