#pragma once

#include <vector>

#include "parity/function.h"

namespace candela::parity {

/// `count` random inputs of a function, each of function.input_size floats, from the tables in domains.cpp. The same
/// function gets the same inputs in every run.
std::vector<float> draw_inputs(const Function& function, int count);

}  // namespace candela::parity
