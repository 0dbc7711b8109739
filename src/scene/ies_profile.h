#pragma once

#include <string>
#include <vector>

#include "math/types.h"

namespace candela {

/// Luminous intensity of a lamp in every direction, as measured (ANSI/IES LM-63) and laid out in full: whoever reads a
/// file unfolds its symmetries. In the space of the web the vertical angle 0 is -z and 180° +z, the horizontal angle 0
/// is +x and 90° +y. Of type C that is the light's own space (EXT_lights_ies); types A and B are the same web about
/// another axis.
struct IesProfile {
  std::string name;
  mat3 web_from_light{1.0f};          ///< a rotation
  std::vector<float> vertical_deg;    ///< ascending within 0 … 180; dark below the first and beyond the last
  std::vector<float> horizontal_deg;  ///< ascending from 0 to 360, or 0 alone: the same all around
  std::vector<float> candela;         ///< ≥ 0; one row of vertical angles after another, a row per horizontal angle
};

/// Whether the arrays are as the comments above promise.
bool is_valid(const IesProfile& profile);

/// Candela in a unit direction of the light's own space, away from the lamp; bilinear in the angles.
float ies_intensity(const IesProfile& profile, vec3 local_direction);

/// Lumens: the integral of ies_intensity over the sphere, exactly (but for rounding). Its mean is this over 4π.
double ies_flux(const IesProfile& profile);

}  // namespace candela
