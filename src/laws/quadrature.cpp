#include "laws/quadrature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace candela::laws {

namespace {

// Abramowitz & Stegun 1964, table 25.4: nodes and weights of Gauss-Legendre on [-1, 1].
constexpr std::array<double, 4> kNodes4 = {-0.861136311594052575, -0.339981043584856265, 0.339981043584856265,
                                           0.861136311594052575};
constexpr std::array<double, 4> kWeights4 = {0.347854845137453857, 0.652145154862546143, 0.652145154862546143,
                                             0.347854845137453857};
constexpr std::array<double, 4> kNodes8 = {0.183434642495649805, 0.525532409916328986, 0.796666477413626740,
                                           0.960289856497536232};
constexpr std::array<double, 4> kWeights8 = {0.362683783378361983, 0.313706645877887287, 0.222381034453374471,
                                             0.101228536290376259};

// Bisections of one cell: 2⁻⁴⁸ of the hemisphere is beyond single precision.
constexpr int kMaxDepth = 48;
// Sixteen cells at least: a look at every side before the first belief.
constexpr int kMinDepth = 4;
constexpr double kTau = 2.0 * std::numbers::pi;

glm::dvec2 spherical(glm::vec3 w) {
  const double phi = std::atan2(static_cast<double>(w.y), static_cast<double>(w.x));
  return {std::atan2(std::hypot(static_cast<double>(w.x), static_cast<double>(w.y)), static_cast<double>(w.z)),
          phi < 0.0 ? phi + kTau : phi};
}

double largest(glm::dvec4 v) {
  const glm::dvec4 a = glm::abs(v);
  return std::max(std::max(a.x, a.y), std::max(a.z, a.w));
}

double gauss8(const std::function<double(double)>& f, double a, double b) {
  const double center = 0.5 * (a + b);
  const double radius = 0.5 * (b - a);
  double sum = 0.0;
  for (std::size_t i = 0; i < kNodes8.size(); ++i) {
    sum += kWeights8[i] * (f(center - radius * kNodes8[i]) + f(center + radius * kNodes8[i]));
  }
  return sum * radius;
}

double bisect(const std::function<double(double)>& f, double a, double b, double whole, double tolerance, int depth) {
  const double middle = 0.5 * (a + b);
  const double left = gauss8(f, a, middle);
  const double right = gauss8(f, middle, b);
  if (std::abs(left + right - whole) < tolerance || depth == 0) return left + right;
  return bisect(f, a, middle, left, 0.5 * tolerance, depth - 1) +
         bisect(f, middle, b, right, 0.5 * tolerance, depth - 1);
}

}  // namespace

HemisphereQuadrature::HemisphereQuadrature(const DirectionFunction& f, std::span<const glm::vec3> peaks,
                                           const QuadratureOptions& options)
    : f_(f), options_(options) {
  for (const glm::vec3& peak : peaks) peaks_.push_back(spherical(peak));
  const Rectangle all{{0.0, 0.0}, {0.5 * std::numbers::pi, kTau}};
  root_ = refine(all, estimate(all), 0);
  for (const glm::dvec4& cell : cells_) integral_ += cell;
}

HemisphereQuadrature::Estimate HemisphereQuadrature::estimate(const Rectangle& r) {
  const glm::dvec2 center = 0.5 * (r.lower + r.upper);
  const glm::dvec2 radius = 0.5 * (r.upper - r.lower);
  Estimate result;
  std::array<std::array<glm::dvec4, 4>, 4> g;
  for (std::size_t i = 0; i < 4; ++i) {
    const double theta = center.x + radius.x * kNodes4[i];
    const double sine = std::sin(theta);
    const double cosine = std::cos(theta);
    for (std::size_t j = 0; j < 4; ++j) {
      const double phi = center.y + radius.y * kNodes4[j];
      g[i][j] = f_(glm::vec3(sine * std::cos(phi), sine * std::sin(phi), cosine)) * sine;
      result.value += g[i][j] * (kWeights4[i] * kWeights4[j] * radius.x * radius.y);
    }
  }
  evaluations_ += 16;

  glm::dvec2 variation(0.0);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j + 1 < 4; ++j) {
      variation.x += largest(g[j + 1][i] - g[j][i]);
      variation.y += largest(g[i][j + 1] - g[i][j]);
    }
  }
  result.axis = variation.x >= variation.y ? 0 : 1;
  return result;
}

// Cells shrink towards a peak in proportion to their distance from it: ridges that leave it are seen before they are
// believed to be flat.
bool HemisphereQuadrature::has_unresolved_peak(const Rectangle& r) const {
  const double size = std::max(r.upper.x - r.lower.x, std::sin(r.upper.x) * (r.upper.y - r.lower.y));
  if (size < options_.peak_size) return false;
  for (const glm::dvec2& peak : peaks_) {
    const double theta = std::clamp(peak.x, r.lower.x, r.upper.x);
    double turn = kTau;
    for (const double phi : {peak.y - kTau, peak.y, peak.y + kTau}) {
      turn = std::min(turn, std::abs(phi - std::clamp(phi, r.lower.y, r.upper.y)));
    }
    if (size > std::hypot(theta - peak.x, std::sin(theta) * turn)) return true;
  }
  return false;
}

std::size_t HemisphereQuadrature::refine(const Rectangle& r, const Estimate& whole, int depth) {
  const bool unresolved = has_unresolved_peak(r);
  const int longer = r.upper.x - r.lower.x >= std::sin(r.upper.x) * (r.upper.y - r.lower.y) ? 0 : 1;
  Halves halves = split(r, unresolved || depth < options_.even_depth ? longer : whole.axis);
  bool settled = !unresolved && depth >= std::max(kMinDepth, options_.even_depth) && agrees(whole, halves);
  // A cell may look the same from both halves of one axis and still be wrong along the other.
  if (settled) {
    const Halves across = split(r, 1 - halves.axis);
    settled = agrees(whole, across);
    if (!settled) halves = across;
  }

  const std::size_t index = nodes_.size();
  nodes_.emplace_back();
  if (settled || depth >= kMaxDepth) {
    nodes_[index].cell = cells_.size();
    cells_.push_back(halves.estimate[0].value + halves.estimate[1].value);
    return index;
  }
  const std::size_t first = refine(halves.part[0], halves.estimate[0], depth + 1);
  const std::size_t second = refine(halves.part[1], halves.estimate[1], depth + 1);
  nodes_[index] = {halves.axis, halves.part[0].upper[halves.axis], {first, second}, 0, false};
  return index;
}

HemisphereQuadrature::Halves HemisphereQuadrature::split(const Rectangle& r, int axis) {
  Halves halves;
  halves.axis = axis;
  halves.part[0] = halves.part[1] = r;
  halves.part[0].upper[axis] = halves.part[1].lower[axis] = 0.5 * (r.lower[axis] + r.upper[axis]);
  for (int i = 0; i < 2; ++i) halves.estimate[i] = estimate(halves.part[i]);
  return halves;
}

bool HemisphereQuadrature::agrees(const Estimate& whole, const Halves& halves) const {
  const glm::dvec4 sum = halves.estimate[0].value + halves.estimate[1].value;
  return largest(sum - whole.value) < options_.tolerance && sum.w < options_.max_share;
}

std::size_t HemisphereQuadrature::cell_of(glm::vec3 w) const {
  const glm::dvec2 at = spherical(w);
  std::size_t index = root_;
  while (!nodes_[index].is_leaf) {
    const Node& node = nodes_[index];
    index = node.child[at[node.axis] < node.at ? 0 : 1];
  }
  return nodes_[index].cell;
}

double integrate(const std::function<double(double)>& f, double a, double b, double tolerance) {
  return bisect(f, a, b, gauss8(f, a, b), tolerance, kMaxDepth);
}

}  // namespace candela::laws
