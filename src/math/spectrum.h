#pragma once

#include "math/types.h"

namespace candela {

/// The wavelengths that the CIE tabulates its observer for.
inline constexpr double kSpectrumMinNm = 360.0;
inline constexpr double kSpectrumMaxNm = 830.0;

/// Colour matching functions x̄ ȳ z̄ of the CIE 1931 standard observer (2°), 0 outside 360-830 nm. CIE 15:2004,
/// "Colorimetry", table T.4 (the same numbers as CIE 018:2019), every 5 nm and linear in between.
dvec3 cie_xyz(double wavelength_nm);

/// Linear Rec.709 from XYZ by the primaries and the white (D65) of ITU-R BT.709-6; no adaptation, no clipping.
dvec3 rec709_from_xyz(dvec3 xyz);
dvec3 xyz_from_rec709(dvec3 rgb);

/// Spectral radiance of a black body in W/(m² sr nm). Planck 1901, "Ueber das Gesetz der Energieverteilung im
/// Normalspectrum", with the exact constants of the SI of 2019.
double planck(double wavelength_nm, double kelvin);

/// CIE 1931 chromaticity of a black body: Planck's law integrated against the observer.
dvec2 blackbody_xy(double kelvin);

/// Linear Rec.709 of a black body. A component below 0 (blue, below 1900 K) is cut to 0; what remains is scaled to
/// `luminance` 1. From 1000 to 40000 K; Error outside.
vec3 blackbody_color(double kelvin);

/// Chromaticity of the CIE daylight illuminant of a correlated colour temperature, 4000-25000 K; Error outside.
/// CIE 15:2004, eq. 3.2-3.4. D65 is 6504 K.
dvec2 daylight_xy(double kelvin);

/// Linear Rec.709 of a chromaticity: components below 0 are cut to 0, what remains is scaled to `luminance` 1.
vec3 color_from_xy(dvec2 xy);

}  // namespace candela
