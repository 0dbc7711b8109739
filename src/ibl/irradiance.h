#pragma once

#include <cstdint>
#include <vector>

#include "ibl/source.h"
#include "image/cubemap.h"

namespace candela::ibl {

/// - exact: the sum over all texels, prefilter() with the cosine lobe.
/// - montecarlo: `samples` directions of cosine density.
/// - riemann: N1 × N2 steps in azimuth and polar angle, with the sin θ of dω; N1 = 4 N2, N1 N2 ≤ `samples`.
enum class IrradianceMethod { exact, montecarlo, riemann };

/// Irradiance (W/m², or lx where radiance is cd/m²), not divided by π.
CubeFaces irradiance_cube(const Source& source, int size, IrradianceMethod method = IrradianceMethod::exact,
                          int samples = 1024, std::uint32_t seed = 0);
std::vector<dvec3> irradiance(const Source& source, const std::vector<dvec3>& directions, IrradianceMethod method,
                              int samples, std::uint32_t seed = 0);

}  // namespace candela::ibl
