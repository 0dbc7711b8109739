#ifndef CANDELA_SHADE_SURFACE_CONSTANTS_GLSL_H
#define CANDELA_SHADE_SURFACE_CONSTANTS_GLSL_H

#include "shade/microfacet.glsl.h"
#include "shade/tables.glsl.h"

SHADE_BEGIN

/// A coat's reflectance at normal incidence: index 1.5 (KHR_materials_clearcoat).
SHADE_CONST float kCoatF0 = 0.04f;

/// Width of the sheen lobe.
SHADE_FN float sheen_alpha(float roughness) { return roughness_to_alpha(max(roughness, kSheenLeastRoughness)); }

SHADE_END

#endif
