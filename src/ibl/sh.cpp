#include "ibl/sh.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "base/check.h"
#include "ibl/harmonics.h"
#include "ibl/verify.h"
#include "shade/gauss.h"

namespace candela::ibl {
namespace {

constexpr double kPiD = std::numbers::pi;

std::size_t place(int l, int m) { return static_cast<std::size_t>(l * (l + 1) + m); }

/// Luminance of what `sh` says at many directions, the least.
double least_luminance(const Sh& sh, const std::vector<std::vector<double>>& bases) {
  double least = 1e300;
  for (const std::vector<double>& basis : bases) {
    dvec3 v(0.0);
    for (std::size_t i = 0; i < basis.size(); ++i) v += sh.coefficients[i] * basis[i];
    least = std::min(least, luminance(v));
  }
  return least;
}

}  // namespace

std::vector<double> sh_basis(int order, dvec3 d) {
  std::vector<double> basis(static_cast<std::size_t>((order + 1) * (order + 1)));
  // sin^m θ (cos mφ, sin mφ) as a polynomial of x and y, times what is left of P̄_lm as one of z.
  std::complex<double> turn(1.0);
  double first = std::sqrt(1.0 / (4.0 * kPiD));
  for (int m = 0; m <= order; ++m) {
    if (m > 0) {
      turn *= std::complex<double>(d.x, d.y);
      first *= std::sqrt((2.0 * m + 1.0) / (2.0 * m));
    }
    double now = first, below = 0.0;
    for (int l = m; l <= order; ++l) {
      if (l > m) {
        const double a = std::sqrt((4.0 * l * l - 1.0) / (static_cast<double>(l) * l - m * m));
        const double k = l - 1.0;
        const double b = a * std::sqrt((k * k - m * m) / (4.0 * k * k - 1.0));
        const double next = a * d.z * now - b * below;
        below = now;
        now = next;
      }
      const double scale = m == 0 ? 1.0 : std::numbers::sqrt2;
      basis[place(l, m)] = scale * now * turn.real();
      if (m > 0) basis[place(l, -m)] = scale * now * turn.imag();
    }
  }
  return basis;
}

dvec3 sh_evaluate(const Sh& sh, dvec3 direction) {
  const std::vector<double> basis = sh_basis(sh.order, direction);
  dvec3 sum(0.0);
  for (std::size_t i = 0; i < basis.size(); ++i) sum += sh.coefficients[i] * basis[i];
  return sum;
}

Sh sh_project(const Source& source, int order) {
  CANDELA_CHECK(order >= 0 && order <= kMostShOrder);
  Sh sh{order, std::vector<dvec3>(static_cast<std::size_t>((order + 1) * (order + 1)), dvec3(0.0))};
  // The panorama's harmonics stand about y. Up to the same degree they are the same functions, so that projecting their
  // sum on these, by a quadrature exact for products of both, changes the basis and loses nothing.
  const Image fine = subdivided(source.map, 0.5 / std::max(order, 1));
  const Harmonics harmonics = analyse(fine, column_edge(source, 0), order);
  const shade::GaussRule rule = shade::gauss_rule(order + 1);
  const int around = 2 * order + 2;
  for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
    const double z = 2.0 * rule.nodes[j] - 1.0;
    const double r = std::sqrt(1.0 - z * z);
    for (int i = 0; i < around; ++i) {
      const double azimuth = 2.0 * kPiD * i / around;
      const dvec3 d(r * std::cos(azimuth), r * std::sin(azimuth), z);
      const std::vector<double> basis = sh_basis(order, d);
      const dvec3 value = evaluate(harmonics, d) * (rule.weights[j] * 4.0 * kPiD / around);
      for (std::size_t k = 0; k < basis.size(); ++k) sh.coefficients[k] += value * basis[k];
    }
  }
  for (const SunDisc& sun : source.suns) {
    for (const Point& p : disc_points(sun)) {
      const std::vector<double> basis = sh_basis(order, p.direction);
      for (std::size_t k = 0; k < basis.size(); ++k) sh.coefficients[k] += p.flux * basis[k];
    }
  }
  return sh;
}

double cosine_factor(int l) {
  if (l == 1) return 2.0 * kPiD / 3.0;
  if (l % 2 == 1) return 0.0;
  // 2π (-1)^(l/2-1) / ((l + 2)(l - 1)) · l! / (2^l (l/2)!²)
  double ratio = 1.0;
  for (int k = 1; k <= l / 2; ++k) ratio *= (2.0 * k - 1.0) / (2.0 * k);
  const double sign = (l / 2) % 2 == 0 ? -1.0 : 1.0;
  return 2.0 * kPiD * sign * ratio / ((l + 2.0) * (l - 1.0));
}

Sh sh_irradiance(Sh radiance) {
  for (int l = 0; l <= radiance.order; ++l) {
    for (int m = -l; m <= l; ++m) radiance.coefficients[place(l, m)] *= cosine_factor(l);
  }
  return radiance;
}

double window_factor(Window window, double width, int l) {
  if (window == Window::none || l == 0) return 1.0;
  if (l >= width) return 0.0;
  const double x = kPiD * l / width;
  return window == Window::hann ? 0.5 * (1.0 + std::cos(x)) : std::sin(x) / x;
}

Sh sh_damped(Sh sh, Window window, double width) {
  for (int l = 0; l <= sh.order; ++l) {
    for (int m = -l; m <= l; ++m) sh.coefficients[place(l, m)] *= window_factor(window, width, l);
  }
  return sh;
}

Sh sh_window(const Sh& sh, Window window, double* width) {
  double used = window == Window::none ? 0.0 : sh.order + 1.0;
  if (window == Window::automatic) {
    constexpr int kDirections = 2048, kSteps = 40;
    constexpr double kWidest = 64.0;  // sin x / x above 0.99 at l = 5
    std::vector<std::vector<double>> bases;
    for (const dvec3& d : random_directions(kDirections, 0)) bases.push_back(sh_basis(sh.order, d));
    used = 0.0;
    if (least_luminance(sh, bases) < 0.0) {
      double low = 1.0, high = kWidest;  // at width 1 only the mean is left
      for (int step = 0; step < kSteps; ++step) {
        const double middle = 0.5 * (low + high);
        (least_luminance(sh_damped(sh, Window::lanczos, middle), bases) < 0.0 ? high : low) = middle;
      }
      used = low;
    }
  }
  if (width != nullptr) *width = used;
  if (used == 0.0) return sh;
  return sh_damped(sh, window == Window::automatic ? Window::lanczos : window, used);
}

}  // namespace candela::ibl
