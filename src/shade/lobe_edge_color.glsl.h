#ifndef CANDELA_SHADE_LOBE_EDGE_COLOR_GLSL_H
#define CANDELA_SHADE_LOBE_EDGE_COLOR_GLSL_H

#include "shade/lobe_anisotropy.glsl.h"

// EXT_materials_specular_edge_color: KHR_materials_specular's colour tints a dielectric's whole reflection rather than
// its F0, and is what a metal reflects near 82° over what Schlick's curve has there.

SHADE_BEGIN

/// A boundary's reflectance at the normal without its colour, which may brighten it.
SHADE_FN float edge_f0(SHADE_IN(SurfaceParams) p, float f0) {
  return min(f0 * max(shade_max3(p.specular_color), 1.0f), 1.0f) * p.specular;
}

/// After the matter of glass, which lets through what it would without a colour.
SHADE_FN void edge_matter(SHADE_IN(SurfaceParams) p, SHADE_INOUT(Surface) s) {
  if ((SHADE_LOBES(p) & kLobeEdgeColor) == 0) return;
  s.glass_f0_tinted = vec3(edge_f0(p, s.glass_f0));
  // Seen from within, all of what cannot leave stays.
  if (s.eta >= 1.0f) s.glass_shine = p.specular_color * (1.0f / max(shade_max3(p.specular_color), 1.0f));
  s.f90_tint = min(p.specular_color, vec3(1.0f));
  s.has_f82_tint = true;
  s.f82_tint = min(p.specular_color * p.specular, vec3(1.0f));
}

/// What a metal of a row in the tables of film reflects less at a cosine than by Schlick's curve: cosines of the
/// tables, each with its share of the lobe's light.
SHADE_FN vec3 edge_dip(SHADE_IN(Surface) s, TableCell mu, TableCell row) {
  vec3 dip = vec3(0.0f);
  for (int i = 0; i < kFilmCosines; ++i) {
    float cosine = table_film_cosine(i);
    vec3 curve = s.f0_metal + (vec3(1.0f) - s.f0_metal) * schlick_weight(cosine);
    dip += (curve - fresnel_f82(s.f0_metal, s.f82_tint, cosine)) * table_film(i, mu, row);
  }
  return dip;
}

/// Its cosine-weighted mean.
SHADE_FN vec3 edge_dip_mean(SHADE_IN(Surface) s) {
  vec3 dip = vec3(0.0f);
  for (int i = 0; i < kFilmCosines; ++i) {
    float cosine = table_film_cosine(i);
    vec3 curve = s.f0_metal + (vec3(1.0f) - s.f0_metal) * schlick_weight(cosine);
    dip += (curve - fresnel_f82(s.f0_metal, s.f82_tint, cosine)) * table_film_mean(i, s.row);
  }
  return dip;
}

/// In place of what base_energy says, which knows neither colour: what lies below the boundary sees its reflectance
/// without one. `ab` and `mean` are the split-sum terms at wo and their means.
SHADE_FN void edge_prepare(SHADE_IN(SurfaceParams) p, vec3 wo, vec2 ab, vec2 mean, SHADE_INOUT(Surface) s) {
  if ((SHADE_LOBES(s) & kLobeEdgeColor) == 0) return;
  vec2 walk = table_walk(s.row);
  vec3 f90 = terms_f90(s);

  // ----- the boundary above the diffuse layer
  s.boundary_f0 = edge_f0(p, p.ior == 0.0f ? 1.0f : f0_from_eta(p.ior));
  s.boundary_escape = multiscatter_share(s.boundary_f0 + (s.f90_dielectric - s.boundary_f0) * s.rise_mean, walk);
  s.transmission_o = base_transmission(s, ab);
  s.diffuse_scale = 1.0f / max(base_transmission(s, mean), 1e-6f);

  // ----- the facets of both
  vec3 share = s.weight_dielectric * multiscatter_share3(s.f0_dielectric + (f90 - s.f0_dielectric) * s.rise_mean, walk);
  s.single_albedo_o = s.weight_dielectric * (s.f0_dielectric * ab.x + f90 * ab.y);
  if (s.weight_metal > 0.0f) {
    vec2 ab_metal = anisotropy_ggx(s, wo, table_curve_schlick());
    vec3 dip = edge_dip(s, table_cell_mu(wo.z, kTableMu), anisotropy_row_along(s, wo));
    float rise = table_walk_rise(s.row, table_curve_schlick());
    // Of multiply scattered light the mean of the lobe's own.
    vec3 metal = max(s.f0_metal + (vec3(1.0f) - s.f0_metal) * rise - edge_dip_mean(s), vec3(0.0f));
    share += s.weight_metal * multiscatter_share3(metal, walk);
    s.single_albedo_o += s.weight_metal * max(s.f0_metal * ab_metal.x + vec3(ab_metal.y) - dip, vec3(0.0f));
  }
  s.specular_albedo_o = s.single_albedo_o + share * s.escape_o;
  s.multiscatter = s.model.multiscatter ? share * (1.0f / (kShadePi * max(s.escape_mean, 1e-6f))) : vec3(0.0f);
}

SHADE_END

#endif
