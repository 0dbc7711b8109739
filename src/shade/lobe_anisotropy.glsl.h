#ifndef CANDELA_SHADE_LOBE_ANISOTROPY_GLSL_H
#define CANDELA_SHADE_LOBE_ANISOTROPY_GLSL_H

#include "shade/surface_terms.glsl.h"

// KHR_materials_anisotropy: facets that lean farther along one direction, and what the tables of GGX say of them.

SHADE_BEGIN

/// The direction of the texture is the rougher one.
SHADE_FN void anisotropy_matter(SHADE_IN(SurfaceParams) p, SHADE_INOUT(Surface) s) {
  s.alpha_x = s.alpha;
  s.alpha_y = s.alpha;
  if ((SHADE_LOBES(p) & kLobeAnisotropy) == 0 || p.anisotropy <= 0.0f) return;
  s.alpha_x = max(mix(s.alpha, 1.0f, shade_sqr(p.anisotropy)), kGgxMirrorAlpha);
  s.alpha_y = max(s.alpha, kGgxMirrorAlpha);
  s.alpha = s.alpha_y;  // no mirror, for terms that know one width only
  s.is_mirror = false;
  s.roughness = sqrt(sqrt(s.alpha_x * s.alpha_y));
  s.row = table_ggx_roughness(s.roughness);
}

/// Roughness of facets of the widths `alpha` along an azimuth with this squared cosine.
SHADE_FN float streak_roughness_at(vec2 alpha, float cos2) {
  return sqrt(sqrt(mix(alpha.y * alpha.y, alpha.x * alpha.x, cos2)));
}

SHADE_FN float streak_roughness_along(vec2 alpha, vec3 w) {
  return streak_roughness_at(alpha, w.x * w.x / max(w.x * w.x + w.y * w.y, 1e-12f));
}

/// Of the base's facets.
SHADE_FN float anisotropy_roughness_at(SHADE_IN(Surface) s, float cos2) {
  return streak_roughness_at(vec2(s.alpha_x, s.alpha_y), cos2);
}

SHADE_FN float anisotropy_roughness_along(SHADE_IN(Surface) s, vec3 w) {
  if ((SHADE_LOBES(s) & kLobeAnisotropy) == 0) return s.roughness;
  return streak_roughness_along(vec2(s.alpha_x, s.alpha_y), w);
}

/// And its row in the tables of GGX.
SHADE_FN TableCell anisotropy_row_along(SHADE_IN(Surface) s, vec3 w) {
  if ((SHADE_LOBES(s) & kLobeAnisotropy) == 0) return s.row;
  return table_ggx_roughness(anisotropy_roughness_along(s, w));
}

/// Squared cosines of azimuths that stand evenly in a quarter of the circle.
SHADE_CONST int kAzimuths = 4;
SHADE_FN float anisotropy_azimuth(int i) {
  return i == 0 ? 0.9619398f : i == 1 ? 0.6913417f : i == 2 ? 0.3086583f : 0.0380602f;
}

/// Split-sum terms from what an anisotropic lobe loses and its B by Schlick's curve, of a curve that moves B of a round
/// lobe from `from` to `to`.
SHADE_FN vec2 anisotropy_terms(vec2 entry, float from, float to) {
  float b = clamp(table_other_rise(entry.y, from, to, 1.0f), 0.0f, 1.0f - entry.x);
  return vec2(1.0f - entry.x - b, b);
}

/// Split-sum terms at w by a curve, of facets of the widths `alpha` along the frame's x and y.
SHADE_FN vec2 streak_ggx(vec2 alpha, vec3 w, TableCell curve) {
  float mu = abs(w.z);
  float along = streak_roughness_along(alpha, w);
  vec2 entry = table_anisotropic(mu, along, sqrt(alpha.x), sqrt(alpha.y));
  if (curve.i == 0) return vec2(1.0f - entry.x - entry.y, entry.y);
  TableCell row = table_ggx_roughness(along);
  return anisotropy_terms(entry, table_ggx(mu, row).y, table_ggx_curve(mu, row, curve).y);
}

/// Their cosine-weighted means.
SHADE_FN vec2 streak_ggx_mean(vec2 alpha, TableCell curve) {
  vec2 entry = table_anisotropic_mean(sqrt(alpha.x), sqrt(alpha.y));
  float from = 0.0f;
  float to = 0.0f;
  for (int i = 0; i < kAzimuths; ++i) {
    TableCell row = table_ggx_roughness(streak_roughness_at(alpha, anisotropy_azimuth(i)));
    from += table_ggx_mean(row).y * (1.0f / float(kAzimuths));
    to += table_ggx_curve_mean(row, curve).y * (1.0f / float(kAzimuths));
  }
  return anisotropy_terms(entry, from, to);
}

/// Split-sum terms of the base's facets.
SHADE_FN vec2 anisotropy_ggx(SHADE_IN(Surface) s, vec3 w, TableCell curve) {
  if ((SHADE_LOBES(s) & kLobeAnisotropy) == 0) return table_ggx_curve(abs(w.z), s.row, curve);
  return streak_ggx(vec2(s.alpha_x, s.alpha_y), w, curve);
}

SHADE_FN vec2 anisotropy_ggx_mean(SHADE_IN(Surface) s) {
  if ((SHADE_LOBES(s) & kLobeAnisotropy) == 0) return table_ggx_curve_mean(s.row, s.curve);
  return streak_ggx_mean(vec2(s.alpha_x, s.alpha_y), s.curve);
}

SHADE_END

#endif
