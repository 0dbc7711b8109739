#ifndef CANDELA_SHADE_LOBE_SHEEN_GLSL_H
#define CANDELA_SHADE_LOBE_SHEEN_GLSL_H

#include "shade/surface_terms.glsl.h"

// KHR_materials_sheen: fibres that stand up between the base and the coat.

SHADE_BEGIN

SHADE_FN void sheen_matter(SHADE_INOUT(Surface) s) {
  s.sheen_weight = 0.0f;
  s.sheen = vec3(0.0f);
  s.is_sheen_on_top = false;
  s.sheen_normal = vec3(0.0f, 0.0f, 1.0f);
  s.sheen_over_coat_o = 1.0f;
}

SHADE_FN void sheen_prepare(SHADE_IN(SurfaceParams) p, SHADE_INOUT(Surface) s) {
  s.sheen = p.sheen_color;
  s.sheen_roughness = max(p.sheen_roughness, kSheenLeastRoughness);
  s.sheen_alpha = sheen_alpha(p.sheen_roughness);
  s.sheen_weight = shade_max3(p.sheen_color);
}

SHADE_FN float sheen_cosine(SHADE_IN(Surface) s, vec3 w) {
  return s.is_sheen_on_top ? abs(dot(s.sheen_normal, w)) : abs(w.z);
}

/// At cosines to the fibres' normal and to the base's, above a base of this roughness.
SHADE_FN LayerAt sheen_at(SHADE_IN(Surface) s, float sheen_mu, float mu, float roughness) {
  LayerAt at = layer_absent();
  if ((SHADE_LOBES(s) & kLobesOfFibres) == 0) return at;
  at.albedo = table_sheen(sheen_mu, s.sheen_roughness);
  at.over = table_sheen_over(mu, roughness, s.sheen_roughness, at.albedo);
  return at;
}

/// Factor of the fibres at a cosine that brings their albedo to that of the table.
SHADE_FN float sheen_scale(SHADE_IN(Surface) s, float mu) {
  if ((SHADE_LOBES(s) & kLobesOfFibres) == 0 || s.model.literal_layers) return 1.0f;
  return table_sheen_scale(mu, s.sheen_roughness);
}

/// What it is estimated to reflect to wo.
SHADE_FN float sheen_estimate(SHADE_IN(Surface) s) {
  float sheen = s.sheen_weight * s.sheen_albedo_o;
  return sheen < 1e-6f ? 0.0f : sheen;  // rounding: straight down between narrow fibres there is nothing
}

SHADE_FN bool sheen_is_delta(SHADE_IN(Surface) s) { return s.chance_sheen <= 0.0f; }

/// Below a coat, which lets `coat_share` through on both ways; at wi it is `scale` of the fibres alone.
SHADE_FN vec3 sheen_eval(SHADE_IN(Surface) s, vec3 wo, vec3 wi, float coat_share, float scale) {
  if ((SHADE_LOBES(s) & kLobesOfFibres) == 0) return vec3(0.0f);
  vec3 wm = normalize(wo + wi);
  float share = coat_share * (s.sheen_scale_o * scale);
  return s.sheen * (share * charlie_d(wm, s.sheen_alpha) * charlie_v(wo, wi, s.sheen_alpha) * wi.z);
}

/// Density of its samples, which are uniform over the hemisphere.
SHADE_CONST float kSheenPdf = 0.5f / kShadePi;

SHADE_FN vec3 uniform_hemisphere_sample(vec2 u) {
  float r = sqrt(max(1.0f - u.x * u.x, 0.0f));
  float phi = 2.0f * kShadePi * u.y;
  return vec3(r * cos(phi), r * sin(phi), u.x);
}

/// Fibres on top of all, in the frame of their normal.
SHADE_FN vec3 sheen_eval_on_top(SHADE_IN(Surface) s, vec3 wo, vec3 wi, float scale) {
  if ((SHADE_LOBES(s) & kLobeFuzz) == 0) return vec3(0.0f);
  vec3 t = shade_tangent(s.sheen_normal);
  vec3 o = shade_to_local(s.sheen_normal, t, wo);
  vec3 i = shade_to_local(s.sheen_normal, t, wi);
  return o.z > 0.0f && i.z > 0.0f ? sheen_eval(s, o, i, 1.0f, scale) : vec3(0.0f);
}

/// What fibres on top leave of the coat: a factor of each direction, here of w.
SHADE_FN float sheen_over_coat(SHADE_IN(Surface) s, vec3 w) {
  if ((SHADE_LOBES(s) & kLobeFuzz) == 0) return 1.0f;
  float e = table_sheen(sheen_cosine(s, w), s.sheen_roughness);
  if (s.model.literal_layers) return 1.0f - s.sheen_weight * e;
  return table_sheen_over(abs(dot(s.coat_normal, w)), s.coat_roughness, s.sheen_roughness, e).x;
}

/// And of both.
SHADE_FN float sheen_over_coat_both(SHADE_IN(Surface) s, vec3 wi) {
  if (!s.is_sheen_on_top) return 1.0f;
  if (s.model.literal_layers) return s.sheen_over_coat_o;
  return 1.0f - s.sheen_weight + s.sheen_weight * s.sheen_over_coat_o * sheen_over_coat(s, wi);
}

/// Of its reflection of light from everywhere.
SHADE_FN float sheen_over_coat_share(SHADE_IN(Surface) s) {
  return s.is_sheen_on_top ? 1.0f - s.sheen_weight * s.sheen_albedo_o : 1.0f;
}

/// Of light that is the same from everywhere, below no coat.
SHADE_FN vec3 sheen_share(SHADE_IN(Surface) s) { return s.sheen * s.sheen_albedo_o; }

SHADE_END

#endif
