#ifndef CANDELA_SHADE_LOBE_CONDUCTOR_GLSL_H
#define CANDELA_SHADE_LOBE_CONDUCTOR_GLSL_H

#include "shade/surface_terms.glsl.h"

// extras.candela.conductor: a measured metal, in place of the base colour as F0.

SHADE_BEGIN

SHADE_FN void conductor_matter(SHADE_IN(SurfaceParams) p, SHADE_INOUT(Surface) s) {
  if ((SHADE_LOBES(p) & kLobeConductor) == 0) return;
  s.conductor_n = p.conductor_n;
  s.conductor_k = p.conductor_k;
  s.f0_metal = min(fresnel_conductor3(1.0f, p.conductor_n, p.conductor_k), vec3(1.0f));
}

SHADE_END

#endif
