#pragma once

#include <string>
#include <vector>

#include "parity/function.h"
#include "parity/tables.h"

namespace candela::parity {

/// What a deliberately broken GLSL text replaces; nothing where `from` is empty.
struct Alteration {
  std::string from;
  std::string to;
};

/// `function` in C++ for each of the inputs, function.output.size floats apiece.
std::vector<float> evaluate_cpp(const Function& function, const std::vector<float>& inputs);

/// The same in GLSL on the current gl::Context: one vertex per input, caught by transform feedback. Throws Error with
/// file and line where the text does not compile, and for a sampler that `textures` does not know.
std::vector<float> evaluate_glsl(const Function& function, const std::vector<float>& inputs,
                                 const Alteration& alteration = {}, const std::vector<Table>& textures = tables());

}  // namespace candela::parity
