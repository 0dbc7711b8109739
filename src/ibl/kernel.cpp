#include "ibl/kernel.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/check.h"
#include "shade/gauss.h"
#include "shade/surface_constants.glsl.h"

namespace candela::ibl {
namespace {

constexpr double kPiD = std::numbers::pi;

/// Where composite quadrature over the angle puts its panels: as fine as the lobe near its axis, and never coarser than
/// what P_lmax needs.
std::vector<double> panel_edges(double alpha, int lmax) {
  constexpr double kNodesPerDegree = 8.0;  // radians of P_l's phase per panel of 16 nodes
  std::vector<double> edges = {0.0};
  while (edges.back() < 0.5 * kPiD) {
    const double theta = edges.back();
    const double step = std::min(0.25 * (alpha + theta), kNodesPerDegree / std::max(lmax, 8));
    edges.push_back(std::min(theta + step, 0.5 * kPiD));
  }
  return edges;
}

/// f(θ, weight) over the nodes on [0, π/2].
template <class F>
void over_quarter(double alpha, int lmax, const F& f) {
  static const shade::GaussRule rule = shade::gauss_rule(16);
  const std::vector<double> edges = panel_edges(alpha, lmax);
  for (std::size_t p = 0; p + 1 < edges.size(); ++p) {
    const double width = edges[p + 1] - edges[p];
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) f(edges[p] + width * rule.nodes[k], width * rule.weights[k]);
  }
}

double half_chord_squared(double theta) {
  const double s = std::sin(0.5 * theta);
  return 2.0 * s * s;
}

}  // namespace

Kernel::Kernel(Lobe lobe, double roughness) : lobe_(lobe) {
  CANDELA_CHECK(roughness > 0.0 || lobe == Lobe::cosine);
  alpha_ = roughness * roughness;
  if (lobe == Lobe::cosine) alpha_ = 1.0;
  if (lobe == Lobe::charlie) {
    const auto least = static_cast<double>(shade::kSheenLeastRoughness);
    alpha_ = std::pow(std::max(roughness, least), 2.0);
    exponent_ = 0.5 / alpha_;
  }
  if (lobe == Lobe::charlie) {
    constexpr int kSteps = 1 << 14;  // linear between them: 5e-6 for the narrowest lobe, 1e-7 for most
    for (int i = 0; i <= kSteps; ++i) table_.push_back(shape(static_cast<double>(i) / kSteps));
  }
  slope_ = 0.5 * (1.0 - alpha_ * alpha_);
  double sum = 0.0;
  over_quarter(alpha_, 0, [&](double theta, double weight) {
    sum += weight * std::sin(theta) * shape(half_chord_squared(theta));
  });
  scale_ = 1.0 / (2.0 * kPiD * sum);
}

double Kernel::shape(double t) const {
  const double c = std::max(1.0 - t, 0.0);
  if (lobe_ == Lobe::charlie) return c * std::pow(0.5 * t, exponent_) * std::pow(4.0, exponent_);
  // D(h) is as 1 / (NoH² (α² - 1) + 1)² and NoH² = 1 - t/2 (Walter et al. 2007, "Microfacet Models", eq. 33). The
  // cosine lobe is the same with α = 1.
  const double width = alpha_ * alpha_ + slope_ * t;
  return c / (width * width);
}

double Kernel::tabulated(double t) const {
  const double x = std::clamp(t, 0.0, 1.0) * static_cast<double>(table_.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(x), table_.size() - 2);
  return table_[i] + (table_[i + 1] - table_[i]) * (x - static_cast<double>(i));
}

double Kernel::operator()(double t) const { return scale_ * (lobe_ == Lobe::charlie ? tabulated(t) : shape(t)); }

double Kernel::width() const { return lobe_ == Lobe::charlie ? std::min(1.0, std::sqrt(alpha_)) : alpha_; }

std::vector<double> Kernel::coefficients(int lmax) const {
  std::vector<double> k(static_cast<std::size_t>(lmax) + 1, 0.0);
  over_quarter(alpha_, lmax, [&](double theta, double weight) {
    const double value = 2.0 * kPiD * weight * std::sin(theta) * (*this)(half_chord_squared(theta));
    const double x = std::cos(theta);
    double p = 1.0, below = 0.0;
    for (int l = 0; l <= lmax; ++l) {
      k[static_cast<std::size_t>(l)] += value * p;
      const double next = ((2 * l + 1) * x * p - l * below) / (l + 1);
      below = p;
      p = next;
    }
  });
  return k;
}

int Kernel::bandwidth() const {
  // GGX: (2αl) K₁(2αl), about e^(-2αl): 1e-8 at 2αl = 20.
  constexpr double kReach = 10.0;
  return static_cast<int>(std::ceil(kReach / width()));
}

}  // namespace candela::ibl
