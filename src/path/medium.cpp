#include "path/medium.h"

#include <cmath>

namespace candela::path {

vec3 single_scatter_albedo(vec3 multiscatter, float g) {
  vec3 result;
  for (int c = 0; c < 3; ++c) {
    const double m = static_cast<double>(glm::clamp(multiscatter[c], 0.0f, 1.0f));
    const double root = 4.09712 + 4.20863 * m - std::sqrt(9.59217 + 41.6808 * m + 17.7126 * m * m);
    const double isotropic = 1.0 - root * root;
    result[c] = static_cast<float>(isotropic / (1.0 - static_cast<double>(g) * (1.0 - isotropic)));
  }
  return glm::clamp(result, vec3(0.0f), vec3(1.0f));
}

}  // namespace candela::path
