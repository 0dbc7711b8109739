#include "ibl/sampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ibl/cube.h"
#include "math/hash.h"
#include "math/sobol.h"

namespace candela::ibl {
namespace {

constexpr double kPiD = std::numbers::pi;

struct LobeSample {
  double cosine = 1.0;  ///< between axis and light
  double pdf = 0.0;     ///< per solid angle of the light's direction
  double weight = 0.0;
};

/// The lobe's own distribution of halfway vectors, reflected: pdf = D(h) (h·n) / (4 h·v) = D / 4 where n = v.
LobeSample sample_lobe(const Kernel& kernel, double u) {
  if (kernel.lobe() == Lobe::cosine) {
    const double c = std::sqrt(1.0 - u);
    return {c, c / kPiD, 1.0};
  }
  const double alpha = kernel.alpha();
  if (kernel.lobe() == Lobe::charlie) {
    const double sine = std::pow(u, alpha / (2.0 * alpha + 1.0));  // Estevez & Kulla 2017, section 4
    const double d = (2.0 + 1.0 / alpha) * std::pow(sine, 1.0 / alpha) / (2.0 * kPiD);
    const double c = 1.0 - 2.0 * sine * sine;
    return {c, 0.25 * d, std::max(c, 0.0)};
  }
  const double cos2 = (1.0 - u) / (1.0 + (alpha * alpha - 1.0) * u);  // Walter et al. 2007, eq. 35
  const double t = cos2 * (alpha * alpha - 1.0) + 1.0;
  const double c = 2.0 * cos2 - 1.0;
  return {c, 0.25 * alpha * alpha / (kPiD * t * t), std::max(c, 0.0)};
}

/// Radical inverse in base 2.
double van_der_corput(std::uint32_t i) { return static_cast<double>(reverse_bits(i)) * 0x1p-32; }

struct Axes {
  dvec3 t, b, n;

  explicit Axes(dvec3 normal)
      : t(glm::normalize(glm::cross(normal, std::abs(normal.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0)))),
        b(glm::cross(normal, t)),
        n(normal) {}
  dvec3 direction(double cosine, double azimuth) const {
    const double sine = std::sqrt(std::max(1.0 - cosine * cosine, 0.0));
    return n * cosine + (t * std::cos(azimuth) + b * std::sin(azimuth)) * sine;
  }
};

}  // namespace

dvec3 radiance_at(const Source& source, dvec3 d) {
  const double turn = (std::atan2(d.z, d.x) - column_edge(source, 0)) / (2.0 * kPiD);
  const double polar = std::atan2(std::hypot(d.x, d.z), d.y) / kPiD;
  const int x = std::min(static_cast<int>((turn - std::floor(turn)) * source.map.width), source.map.width - 1);
  const int y = std::min(static_cast<int>(polar * source.map.height), source.map.height - 1);
  dvec3 radiance(source.map.rgb(x, y));
  for (const SunDisc& sun : source.suns) {
    const double reach = 2.0 * std::sin(0.5 * static_cast<double>(sun.angular_radius));
    if (glm::distance(d, dvec3(sun.direction)) <= reach) radiance += dvec3(sun.radiance);
  }
  return radiance;
}

dvec3 MonteCarloFilter::sum(const Kernel& kernel, dvec3 direction, std::uint32_t index) const {
  const Axes axes(direction);
  const std::uint32_t key = hash_combine(seed_, index);
  const auto shift_u = static_cast<double>(unit_float(key)), shift_v = static_cast<double>(unit_float(hash(key)));
  dvec3 sum(0.0);
  double weights = 0.0;
  for (int i = 0; i < samples_; ++i) {
    const double u = (i + 0.5) / samples_ + shift_u, v = van_der_corput(static_cast<std::uint32_t>(i)) + shift_v;
    const LobeSample s = sample_lobe(kernel, u - std::floor(u));
    if (!(s.weight > 0.0)) continue;
    sum += s.weight * radiance_at(source_, axes.direction(s.cosine, 2.0 * kPiD * v));
    weights += s.weight;
  }
  return weights > 0.0 ? sum / weights : dvec3(0.0);
}

FilteredFilter::FilteredFilter(const Source& source, int size, int samples)
    : cube_(cube_mips(cube_from_source(source, size))), samples_(samples) {}

dvec3 FilteredFilter::lookup(dvec3 direction, double lod) const {
  const double most = static_cast<double>(cube_.levels.size()) - 1.0;
  const double at = std::clamp(lod, 0.0, most);
  const auto fine = static_cast<std::size_t>(at);
  const std::size_t coarse = std::min(fine + 1, cube_.levels.size() - 1);
  return glm::mix(dvec3(cube_lookup(cube_.levels[fine], direction)),
                  dvec3(cube_lookup(cube_.levels[coarse], direction)), at - static_cast<double>(fine));
}

dvec3 FilteredFilter::sum(const Kernel& kernel, dvec3 direction) const {
  constexpr double kBias = 1.0;  // K = 4 in solid angles, one level
  const Axes axes(direction);
  const double size = cube_.size();
  const double texel = 4.0 * kPiD / (6.0 * size * size);
  dvec3 sum(0.0);
  double weights = 0.0;
  for (int i = 0; i < samples_; ++i) {
    const LobeSample s = sample_lobe(kernel, (i + 0.5) / samples_);
    if (!(s.weight > 0.0)) continue;
    const double lod = 0.5 * std::log2(1.0 / (samples_ * s.pdf * texel)) + kBias;
    const double azimuth = 2.0 * kPiD * van_der_corput(static_cast<std::uint32_t>(i));
    sum += s.weight * lookup(axes.direction(s.cosine, azimuth), lod);
    weights += s.weight;
  }
  return weights > 0.0 ? sum / weights : dvec3(0.0);
}

dvec3 riemann_sum(const Source& source, dvec3 direction, int around, int up) {
  const Axes axes(direction);
  const double step_u = 2.0 * kPiD / around, step_v = 0.5 * kPiD / up;
  dvec3 sum(0.0);
  for (int j = 0; j < up; ++j) {
    const double theta = (j + 0.5) * step_v;
    dvec3 ring(0.0);
    for (int i = 0; i < around; ++i) ring += radiance_at(source, axes.direction(std::cos(theta), (i + 0.5) * step_u));
    sum += ring * (std::cos(theta) * std::sin(theta));
  }
  return sum * (step_u * step_v / kPiD);
}

}  // namespace candela::ibl
