#ifndef CANDELA_SHADE_SURFACE_CONSTANTS_GLSL_H
#define CANDELA_SHADE_SURFACE_CONSTANTS_GLSL_H

#include "shade/microfacet.glsl.h"
#include "shade/tables.glsl.h"

SHADE_BEGIN

/// A coat's index (KHR_materials_clearcoat), and with it its reflectance at normal incidence.
SHADE_CONST float kCoatIndex = 1.5f;
SHADE_CONST float kCoatF0 = 0.04f;

/// Width of the sheen lobe.
SHADE_FN float sheen_alpha(float roughness) { return roughness_to_alpha(max(roughness, kSheenLeastRoughness)); }

SHADE_END

#endif
