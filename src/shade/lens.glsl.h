#ifndef CANDELA_SHADE_LENS_GLSL_H
#define CANDELA_SHADE_LENS_GLSL_H

#include "shade/shim.glsl.h"

SHADE_BEGIN

/// What a lens leaves of light that arrives at this squared cosine to its axis: the natural fall-off by cos⁴, as far as
/// it has it.
SHADE_FN float lens_vignetting(float cos2, float amount) { return mix(1.0f, cos2 * cos2, amount); }

SHADE_END

#endif
