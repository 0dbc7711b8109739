#pragma once

#include <cmath>
#include <numbers>
#include <vector>

namespace candela::shade {

struct GaussRule {
  std::vector<double> nodes;    ///< in (0, 1)
  std::vector<double> weights;  ///< sum 1
};

/// Gauss-Legendre on [0, 1], exact for polynomials of degree 2 count - 1. Newton's method on P_count from the
/// asymptotic roots (Abramowitz & Stegun 1964, 22.16.6 and 25.4.30).
inline GaussRule gauss_rule(int count) {
  GaussRule rule;
  for (int i = count; i >= 1; --i) {
    double x = std::cos(std::numbers::pi * (i - 0.25) / (count + 0.5));
    double slope = 1.0;
    for (int step = 0; step < 8; ++step) {
      double p = 1.0, below = 0.0;
      for (int l = 1; l <= count; ++l) {
        const double next = ((2 * l - 1) * x * p - (l - 1) * below) / l;
        below = p;
        p = next;
      }
      slope = count * (x * p - below) / (x * x - 1.0);
      x -= p / slope;
    }
    rule.nodes.push_back(0.5 * (1.0 + x));
    rule.weights.push_back(1.0 / ((1.0 - x * x) * slope * slope));
  }
  return rule;
}

}  // namespace candela::shade
