#include "image/repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"

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
  const auto tell = [&](std::size_t count, const char* what, ivec2 first, const std::string& repair) {
    if (count == 0) return;
    warnings.push_back({fmt::format("{} {} {}, {}at {},{}: {}", counted(count, "texel"), count == 1 ? "is" : "are",
                                    what, count == 1 ? "" : "the first ", first.x, first.y, repair),
                        where});
  };
  tell(repairs.not_finite, "not finite", repairs.first_not_finite,
       "infinity became the largest finite value, NaN became 0");
  tell(repairs.negative, "negative", repairs.first_negative,
       (repairs.negative == 1 ? "it" : "they") + std::string(" became 0"));
}

}  // namespace candela
