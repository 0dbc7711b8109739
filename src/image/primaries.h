#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "image/image.h"
#include "math/types.h"

// The colours that R, G and B of a file stand for, and their way to Rec.709.
namespace candela {

/// CIE 1931 (x, y) of (1,0,0), (0,1,0), (0,0,1) and (1,1,1).
struct Primaries {
  dvec2 red, green, blue, white;
};
inline constexpr Primaries kRec709{{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0.3290}};
/// Those of XYZ itself: pixels are measured, not relative to a white.
inline constexpr Primaries kXyz{{1.0, 0.0}, {0.0, 1.0}, {0.0, 0.0}, {1.0 / 3.0, 1.0 / 3.0}};

/// Whether both name the same primaries and white, as far as files round them.
bool is_same(const Primaries& a, const Primaries& b);

/// Columns are XYZ of R, G and B, white having Y = 1. Empty where these are no primaries: not finite, on one line, or
/// with their white outside.
std::optional<glm::dmat3> xyz_from_rgb(const Primaries& primaries);

/// Linear Rec.709 from linear RGB of other primaries. What is neutral there becomes neutral here (Lam 1985's "Bradford"
/// cone responses, scaled): `neutral`, where it is given, else the white. XYZ itself (kXyz) names no neutral and is
/// taken as measured. Empty as xyz_from_rgb, or where the neutral is no colour.
std::optional<mat3> rec709_from_rgb(const Primaries& primaries, std::optional<dvec2> neutral = {});

/// Multiplies every pixel by `rec709_from_file`. A colour that Rec.709 does not reach would have a component below 0,
/// which no light has: it is moved towards the grey of its luminance until none is. Pixels that are negative or not
/// finite to begin with are left so. Returns the number of those moved.
std::size_t convert_to_rec709(Image& image, const mat3& rec709_from_file);

/// "R 0.64 0.33, G 0.3 0.6, B 0.15 0.06, white 0.3127 0.329".
std::string primaries_text(const Primaries& primaries);

}  // namespace candela
