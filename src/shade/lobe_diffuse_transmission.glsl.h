#ifndef CANDELA_SHADE_LOBE_DIFFUSE_TRANSMISSION_GLSL_H
#define CANDELA_SHADE_LOBE_DIFFUSE_TRANSMISSION_GLSL_H

#include "shade/layers_above.glsl.h"

// KHR_materials_diffuse_transmission, and KHR_materials_scatter of a sheet: diffuse light that leaves on the other
// side.

SHADE_BEGIN

/// After glass_matter, whose share of the dielectric it leaves alone.
SHADE_FN void below_matter(SHADE_IN(SurfaceParams) p, SHADE_INOUT(Surface) s) {
  s.diffuse_below = vec3(0.0f);
  if ((SHADE_LOBES(p) & kLobeDiffuseTransmission) == 0) return;
  bool has_glass = (SHADE_LOBES(p) & kLobeTransmission) != 0;
  s.diffuse_below = p.diffuse_transmission_color *
                    (p.diffuse_transmission * (1.0f - p.metallic) * (has_glass ? 1.0f - p.transmission : 1.0f));
  s.diffuse = s.diffuse * (1.0f - p.diffuse_transmission);
  if (!s.is_thin) {
    // Radiance is η² times as much inside, and light from inside meets the boundary's total reflection.
    if (s.eta > 1.0f) {
      s.diffuse_below = s.diffuse_below * (1.0f / (s.eta * s.eta));
    } else {
      s.diffuse += s.diffuse_below * (1.0f - s.eta * s.eta);
    }
  }
  if (has_glass && s.is_thin && p.scatter > 0.0f) {
    // KHR_materials_scatter: that share of the glass is matter which sends light to both sides.
    float scattered = s.weight_glass * p.scatter;
    float forward = 0.5f * (1.0f + p.scatter_anisotropy);
    s.weight_glass = s.weight_glass - scattered;
    s.weight_dielectric += scattered;
    s.diffuse += p.scatter_color * (scattered * (1.0f - forward));
    s.diffuse_below += p.scatter_color * (scattered * forward);
  }
}

/// wi.z < 0.
SHADE_FN SurfaceEval below_eval(SHADE_IN(Surface) s, vec3 wi, LayersAt at, vec2 ab) {
  float cos_i = -wi.z;
  SurfaceEval r;
  r.pdf = s.chance_diffuse_below * cosine_pdf(cos_i);
  r.value = s.diffuse_below * layers_diffuse_through(s, wi, at, ab) * (cos_i * (1.0f / kShadePi));
  return r;
}

SHADE_FN vec3 below_direction(vec2 u) {
  vec3 wi = cosine_sample(u);
  wi.z = -wi.z;
  return wi;
}

SHADE_FN bool below_is_delta(SHADE_IN(Surface) s) { return s.chance_diffuse_below <= 0.0f; }

/// Of light that is the same from everywhere.
SHADE_FN vec3 below_share(SHADE_IN(Surface) s) { return s.diffuse_below * s.film_below_o * s.transmission_o; }

SHADE_END

#endif
