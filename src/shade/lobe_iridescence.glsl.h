#ifndef CANDELA_SHADE_LOBE_IRIDESCENCE_GLSL_H
#define CANDELA_SHADE_LOBE_IRIDESCENCE_GLSL_H

#include "shade/lobe_anisotropy.glsl.h"

// KHR_materials_iridescence: a thin film on the base's facets, and what it leaves of the light below them.

SHADE_BEGIN

/// Whether there is a film; before the rest of the matter.
SHADE_FN void iridescence_matter(SHADE_IN(SurfaceParams) p, SHADE_INOUT(Surface) s) {
  s.iridescence = (SHADE_LOBES(p) & kLobeIridescence) != 0 && p.film_nm > 0.0f ? p.iridescence : 0.0f;
  s.has_film_below = s.iridescence > 0.0f && s.weight_dielectric > 0.0f;
}

/// The film on what the rest has made of the facets.
SHADE_FN void iridescence_matter_on_top(SHADE_IN(SurfaceParams) p, SHADE_INOUT(Surface) s) {
  s.film_ior = p.film_ior;
  s.film_nm = p.film_nm;
  s.film_f0_dielectric = s.f0_dielectric;
  s.film_f0_metal = s.f0_metal;
  if ((SHADE_LOBES(p) & kLobeIridescence) == 0) return;
  if (s.iridescence <= 0.0f) return;
  // For the albedo tables; the lobe itself has the whole curve.
  s.f0_dielectric = mix(s.f0_dielectric, terms_film(s, 1.0f, s.film_f0_dielectric), s.iridescence);
  s.f0_metal = mix(s.f0_metal, terms_film_metal(s, 1.0f), s.iridescence);
}

/// A film lets each channel through by a law of its own: base_transmission of each, where facets reflect `beyond` more
/// than the boundary's curve, over that of the whole.
SHADE_FN vec3 iridescence_below(SHADE_IN(Surface) s, vec2 ab, vec3 beyond) {
  vec3 reflected =
      s.f0_dielectric * ab.x + vec3(s.f90_dielectric * ab.y) + s.film_escape * (1.0f - ab.x - ab.y) + beyond;
  return max(vec3(1.0f) - reflected, vec3(0.0f)) * (1.0f / max(base_transmission(s, ab), 1e-3f));
}

SHADE_FN vec3 iridescence_below_at(SHADE_IN(Surface) s, vec2 ab, vec3 w) {
  if ((SHADE_LOBES(s) & kLobeIridescence) == 0) return vec3(1.0f);
  TableCell m = table_cell_mu(abs(w.z), kTableMu);
  TableCell row = anisotropy_row_along(s, w);
  vec3 beyond = vec3(0.0f);
  for (int i = 0; i < kFilmCosines; ++i) beyond += s.film_beyond[i] * table_film(i, m, row);
  return iridescence_below(s, ab, beyond);
}

SHADE_FN float iridescence_mean(SHADE_IN(Surface) s, int i) {
  if ((SHADE_LOBES(s) & kLobeAnisotropy) == 0) return table_film_mean(i, s.row);
  float sum = 0.0f;
  for (int k = 0; k < kAzimuths; ++k) {
    sum += table_film_mean(i, table_ggx_roughness(anisotropy_roughness_at(s, anisotropy_azimuth(k))));
  }
  return sum * (1.0f / float(kAzimuths));
}

/// After base_energy, whose split-sum terms and means these are.
SHADE_APART SHADE_FN void iridescence_prepare(vec3 wo, vec2 ab, vec2 mean, SHADE_INOUT(Surface) s) {
  if ((SHADE_LOBES(s) & kLobeIridescence) == 0) return;
  vec3 beyond = vec3(0.0f);
  for (int i = 0; i < kFilmCosines; ++i) {
    float mu = table_film_cosine(i);
    vec3 curve = s.f0_dielectric + (vec3(s.f90_dielectric) - s.f0_dielectric) * base_rise(s, mu);
    s.film_beyond[i] = terms_fresnel_dielectric(s, mu) - curve;
    beyond += s.film_beyond[i] * iridescence_mean(s, i);
  }
  s.film_escape = multiscatter_share3(base_mean(s), table_walk(s.row));
  s.film_below_scale = vec3(1.0f) / max(iridescence_below(s, mean, beyond), vec3(1e-3f));
  s.film_below_o = iridescence_below_at(s, ab, wo);
}

SHADE_END

#endif
