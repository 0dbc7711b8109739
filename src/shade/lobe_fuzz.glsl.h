#ifndef CANDELA_SHADE_LOBE_FUZZ_GLSL_H
#define CANDELA_SHADE_LOBE_FUZZ_GLSL_H

#include "shade/lobe_sheen.glsl.h"

// KHR_materials_fuzz: fibres, or dust, on top of everything, in place of a sheen. Their weight says how much lies
// there, their colour what it is made of: black fuzz darkens. They are the fibres of sheen, on another normal.

SHADE_BEGIN

/// After the coat, which the fibres lie on as far as there is one.
SHADE_FN void fuzz_prepare(SHADE_IN(SurfaceParams) p, SHADE_INOUT(Surface) s) {
  s.sheen = p.fuzz_color * p.fuzz;
  s.sheen_roughness = max(p.fuzz_roughness, kSheenLeastRoughness);
  s.sheen_alpha = sheen_alpha(p.fuzz_roughness);
  s.sheen_weight = p.fuzz;
  s.is_sheen_on_top = true;
  s.sheen_normal = normalize(mix(vec3(0.0f, 0.0f, 1.0f), s.coat_normal, s.coat));
}

SHADE_END

#endif
