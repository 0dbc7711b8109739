#include "image/repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace candela {

Repairs repair(Image& image) {
  Repairs found;
  float most = 0.0f;
  for (const float v : image.pixels) {
    if (std::isfinite(v)) most = std::max(most, v);
  }
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      bool odd = false, below = false;
      for (float& v : image.at(x, y)) {
        odd |= !std::isfinite(v);
        below |= v < 0.0f;
        if (std::isnan(v) || v < 0.0f) v = 0.0f;
        if (std::isinf(v)) v = most;
      }
      if (odd && found.not_finite++ == 0) found.first_not_finite = {x, y};
      if (below && found.negative++ == 0) found.first_negative = {x, y};
    }
  }
  return found;
}

void tell_repairs(const Repairs& repairs, const std::string& where, std::vector<Diagnostic>& warnings) {
  const auto at = [](ivec2 texel) { return fmt::format("{},{}", texel.x, texel.y); };
  if (repairs.not_finite > 0) {
    warnings.push_back({fmt::format("{} texels are not finite, the first at {}: infinity became the largest finite "
                                    "value, NaN became 0",
                                    repairs.not_finite, at(repairs.first_not_finite)),
                        where});
  }
  if (repairs.negative > 0) {
    warnings.push_back({fmt::format("{} texels are negative, the first at {}: they became 0", repairs.negative,
                                    at(repairs.first_negative)),
                        where});
  }
}

}  // namespace candela
