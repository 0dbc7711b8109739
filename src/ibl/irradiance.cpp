#include "ibl/irradiance.h"

#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "ibl/cube.h"
#include "ibl/prefilter.h"
#include "ibl/sampling.h"

namespace candela::ibl {

std::vector<dvec3> irradiance(const Source& source, const std::vector<dvec3>& directions, IrradianceMethod method,
                              int samples, std::uint32_t seed) {
  const Kernel cosine(Lobe::cosine, 1.0);
  std::vector<dvec3> values(directions.size());
  if (method == IrradianceMethod::riemann) {
    const int up = std::max(1, static_cast<int>(std::sqrt(samples / 4.0)));
    parallel_for(0, directions.size(), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) values[i] = riemann_sum(source, directions[i], 4 * up, up);
    });
  } else {
    PrefilterSettings settings;
    settings.samples = samples;
    settings.seed = seed;
    if (method == IrradianceMethod::montecarlo) settings.method = Method::montecarlo;
    values = Prefilter(source, {cosine}, settings).at(cosine, directions);
  }
  for (dvec3& v : values) v *= std::numbers::pi;
  return values;
}

CubeFaces irradiance_cube(const Source& source, int size, IrradianceMethod method, int samples, std::uint32_t seed) {
  return cube_from_values(irradiance(source, cube_directions(size), method, samples, seed), size);
}

}  // namespace candela::ibl
