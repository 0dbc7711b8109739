#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "figures/figure.h"

namespace candela::figures {

struct BookResult {
  std::size_t figures = 0;
  std::size_t files = 0;
  bool stopped = false;  ///< by Job::stop; what was made by then is there
};

/// The figures of these names, in the order of the book. Throws Error for a name that there is not, with all there are.
std::vector<FigureInfo> choose_figures(const std::vector<std::string>& names);

/// Makes figures and writes them into `folder`, which exists: their files, a page per parameter, index.html last. Each
/// file appears whole or not at all. `note` tells on the pages how they were made. Throws Error.
BookResult write_figures(const std::filesystem::path& folder, const std::vector<FigureInfo>& chosen,
                         const FigureSettings& settings, const std::string& note, const Job& job = {});

}  // namespace candela::figures
