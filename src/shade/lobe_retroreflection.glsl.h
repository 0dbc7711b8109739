#ifndef CANDELA_SHADE_LOBE_RETROREFLECTION_GLSL_H
#define CANDELA_SHADE_LOBE_RETROREFLECTION_GLSL_H

#include "shade/surface_terms.glsl.h"

// KHR_materials_retroreflection: a share of the light that opaque facets reflect leaves as if it had been turned by
// half a circle about the normal, so that it returns to where it came from. f(wo, turned wi) is the value of f at the
// viewer's mirror direction, which is what the extension asks for; it has the albedo of f, and its reciprocity.

SHADE_BEGIN

SHADE_FN void retro_matter(SHADE_IN(SurfaceParams) p, SHADE_INOUT(Surface) s) {
  s.retroreflection = (SHADE_LOBES(p) & kLobeRetroreflection) != 0 ? p.retroreflection : 0.0f;
}

SHADE_FN vec3 retro_turned(vec3 w) { return vec3(-w.x, -w.y, w.z); }

/// The opaque facets at a direction that is turned: value without the cosine, and density.
SHADE_FN SurfaceEval retro_facets(SHADE_IN(Surface) s, vec3 wo, vec3 wi) {
  SurfaceEval r;
  r.value = vec3(0.0f);
  r.pdf = 0.0f;
  if ((SHADE_LOBES(s) & kLobeRetroreflection) == 0) return r;
  vec3 turned = retro_turned(wi);
  vec3 wm = wo + turned;
  float cos_m = 0.5f * length(wm);
  wm = wm * (0.5f / cos_m);
  r.value = terms_fresnel_opaque(s, cos_m) * (s.retroreflection * terms_dv(s, wo, turned, wm));
  r.pdf = s.chance_specular * s.retroreflection * terms_pdf_visible(s, wo, wm);
  return r;
}

/// Of a mirror's two directions, the share of the one that is turned or not; straight down they are one.
SHADE_FN float retro_mirror_share(SHADE_IN(Surface) s, vec3 wo, bool is_turned) {
  if (wo.x == 0.0f && wo.y == 0.0f) return 1.0f;
  return is_turned ? s.retroreflection : 1.0f - s.retroreflection;
}

SHADE_END

#endif
