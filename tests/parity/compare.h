#pragma once

#include <string>
#include <vector>

#include "parity/function.h"

namespace candela::parity {

/// How far two languages may differ in one function.
struct Limits {
  double relative = 1e-4;  ///< |a - b| against the larger, for a vector against its largest component
  double floor = 1e-4;     ///< values below it are measured against it
  double outliers = 1e-3;  ///< share of inputs that may be further apart, or where a bool or int may differ
};

/// The default, or what tests/parity/compare.cpp says of the function and why.
Limits limits_of(const std::string& function);

struct Comparison {
  int inputs = 0;
  int outliers = 0;
  double typical = 0.0;  ///< median error over the inputs
  double worst = 0.0;    ///< largest error of the inputs that are not outliers
  bool holds = false;
  std::string evidence;  ///< the worst outlier: input, C++, GLSL
};

/// `inputs` as draw_inputs gives them, `cpp` and `glsl` as evaluate_* do.
Comparison compare(const Function& function, const Limits& limits, const std::vector<float>& inputs,
                   const std::vector<float>& cpp, const std::vector<float>& glsl);

}  // namespace candela::parity
