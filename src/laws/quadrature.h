#pragma once

#include <cstddef>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace candela::laws {

/// Four functions of a direction, integrated together (a colour and a density, say). Plain numbers use the first.
using DirectionFunction = std::function<glm::dvec4(glm::vec3)>;

struct QuadratureOptions {
  double tolerance = 2e-6;  ///< of one cell, absolute, in every component
  double max_share = 1e30;  ///< cells are split until the w component of each is below: bins for a χ² test
  double peak_size = 0.01;  ///< radians; nearest cells are split down to it before an error is believed
  int even_depth = 0;       ///< bisections of longer sides before anything is believed: for edges in the midst
};

/// Integral over the upper hemisphere (z ≥ 0) with respect to solid angle, by adaptive bisection in (θ, φ) along the
/// axis of greater variation with 4 × 4 Gauss points per cell (Abramowitz & Stegun 1964, 25.4.30). The horizon is an
/// edge of the domain, so functions that jump there are smooth inside. `peaks` are directions near which the integrand
/// may be narrow.
class HemisphereQuadrature {
 public:
  HemisphereQuadrature(const DirectionFunction& f, std::span<const glm::vec3> peaks,
                       const QuadratureOptions& options = {});

  glm::dvec4 integral() const { return integral_; }
  std::size_t evaluations() const { return evaluations_; }

  /// Integral over each leaf of the subdivision, in an order in which neighbours tend to be near.
  std::span<const glm::dvec4> cells() const { return cells_; }
  /// The leaf that holds a direction with z ≥ 0.
  std::size_t cell_of(glm::vec3 w) const;

 private:
  struct Rectangle {
    glm::dvec2 lower{0.0};  ///< (θ, φ)
    glm::dvec2 upper{0.0};
  };
  struct Estimate {
    glm::dvec4 value{0.0};
    int axis = 0;  ///< of greater variation
  };
  struct Halves {
    int axis = 0;
    Rectangle part[2];
    Estimate estimate[2];
  };
  struct Node {
    int axis = 0;
    double at = 0.0;
    std::size_t child[2] = {0, 0};
    std::size_t cell = 0;
    bool is_leaf = true;
  };

  Estimate estimate(const Rectangle& r);
  Halves split(const Rectangle& r, int axis);
  bool agrees(const Estimate& whole, const Halves& halves) const;
  std::size_t refine(const Rectangle& r, const Estimate& whole, int depth);
  bool has_unresolved_peak(const Rectangle& r) const;

  const DirectionFunction& f_;  // valid during construction
  QuadratureOptions options_;
  std::vector<glm::dvec2> peaks_;
  std::vector<Node> nodes_;
  std::vector<glm::dvec4> cells_;
  std::size_t root_ = 0;
  glm::dvec4 integral_{0.0};
  std::size_t evaluations_ = 0;
};

/// ∫ f over [a, b] by adaptive Gauss bisection (8 points against two halves) to an absolute tolerance.
double integrate(const std::function<double(double)>& f, double a, double b, double tolerance = 1e-9);

}  // namespace candela::laws
