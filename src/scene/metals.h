#pragma once

#include <span>
#include <string_view>

#include "math/types.h"

namespace candela {

/// A metal by its measured complex index n + ik in air.
///
/// `n` and `k` are per linear Rec.709 channel, for fresnel_conductor3: per channel the index whose reflectance at the
/// normal and at arccos 1/7 (82°) is that of the spectrum seen under D65 by the CIE 1931 observer (380 to 780 nm,
/// linear between the table's wavelengths). They differ from the measurement at one wavelength by a few per cent, and
/// the colour is right. Red of gold lies outside Rec.709 (1.022) and is held at 0.999.
struct Metal {
  std::string_view name;
  vec3 n;
  vec3 k;
  vec3 n_measured;  ///< at 650, 550 and 450 nm, interpolated in the source's table
  vec3 k_measured;
  std::string_view source;  ///< author, year, title
};

/// In alphabetical order.
std::span<const Metal> metals();

/// By name in lower case ("gold"), chemical symbol ("Au") or American spelling; nullptr if there is none.
const Metal* find_metal(std::string_view name);

}  // namespace candela
