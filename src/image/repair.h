#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "image/image.h"

// Texels that are no light, put right.
namespace candela {

/// What was wrong with the texels of a picture, and what was made of it.
struct Repairs {
  std::size_t not_finite = 0;  ///< infinite ones became the largest finite value of the picture, NaN 0
  ivec2 first_not_finite{0};
  std::size_t negative = 0;  ///< became 0
  ivec2 first_negative{0};
};
/// Makes every channel of every texel finite and ≥ 0.
Repairs repair(Image& image);

/// One warning for each kind.
void tell_repairs(const Repairs& repairs, const std::string& where, std::vector<Diagnostic>& warnings);

}  // namespace candela
