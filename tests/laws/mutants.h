#pragma once

#include <functional>
#include <string>
#include <vector>

#include "laws/bsdf_laws.h"

namespace candela::laws {

/// The real surface with one mistake that people make.
struct Mutant {
  std::string name;
  std::function<Bsdf(const SurfaceParams&)> make;
  std::function<bool(const SurfaceParams&)> shows;  ///< surfaces on which the mistake changes anything that can be seen
};

std::vector<Mutant> reciprocity_mutants();
std::vector<Mutant> finiteness_mutants();
std::vector<Mutant> opacity_mutants();
std::vector<Mutant> energy_mutants();
std::vector<Mutant> pdf_mutants();
std::vector<Mutant> sampling_mutants();
std::vector<Mutant> density_mutants();
std::vector<Mutant> weight_mutants();
std::vector<Mutant> mean_mutants();
std::vector<Mutant> smooth_limit_mutants();

}  // namespace candela::laws
