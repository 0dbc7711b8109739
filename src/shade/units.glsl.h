#ifndef CANDELA_SHADE_UNITS_GLSL_H
#define CANDELA_SHADE_UNITS_GLSL_H

#include "shade/lights.glsl.h"

// Quantities of light. A name says both ends: units_candela_from_point_lumens. The same numbers hold in watts: flux
// (lm, W), intensity (cd, W/sr), irradiance (lux, W/m²), radiance (cd/m² = nit, W/(m² sr)); the efficacy of a spectrum
// (lm/W) turns one column into the other.

SHADE_BEGIN

/// lm/W of light of 540 THz (555 nm in air), the definition of the candela. BIPM 2019, "The International System of
/// Units", §2.3.1.
SHADE_CONST float kLuminousEfficacy = 683.0f;

/// `efficacy` in lm/W: 683 of 555 nm, 93 of daylight, about 15 of an incandescent lamp (of its electrical power).
SHADE_FN float units_lumens_from_watts(float watts, float efficacy) { return watts * efficacy; }
SHADE_FN float units_watts_from_lumens(float lumens, float efficacy) { return lumens / efficacy; }

/// A lamp of equal intensity everywhere: Φ = 4π I.
SHADE_FN float units_candela_from_point_lumens(float lumens) { return lumens / (4.0f * kShadePi); }
SHADE_FN float units_point_lumens_from_candela(float candela) { return 4.0f * kShadePi * candela; }

/// A spot of KHR_lights_punctual's cone: I is the intensity of its axis, Φ what the cone lets out, exactly.
SHADE_FN float units_candela_from_spot_lumens(float lumens, float cos_inner, float cos_outer) {
  return lumens / light_spot_solid_angle(cos_inner, cos_outer);
}
SHADE_FN float units_spot_lumens_from_candela(float candela, float cos_inner, float cos_outer) {
  return candela * light_spot_solid_angle(cos_inner, cos_outer);
}

/// One side of a Lambertian area (m²): Φ = π A L, L in nit.
SHADE_FN float units_nit_from_area_lumens(float lumens, float area) { return lumens / (kShadePi * area); }
SHADE_FN float units_area_lumens_from_nit(float nit, float area) { return nit * kShadePi * area; }

/// Illuminance by a point of intensity I at distance d under the angle θ to the surface's normal: E = I cos θ / d².
SHADE_FN float units_lux_from_candela(float candela, float distance, float cos_theta) {
  return candela * max(cos_theta, 0.0f) * light_falloff_inverse_square(distance);
}

/// Luminance of a Lambertian surface of this albedo under E: L = ρ E / π.
SHADE_FN float units_nit_from_lux(float lux, float albedo) { return lux * albedo / kShadePi; }
SHADE_FN float units_lux_from_nit(float nit, float albedo) { return nit * kShadePi / albedo; }

SHADE_END

#endif
