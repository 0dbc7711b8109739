#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace candela::figures {

/// A letter of the formulas, and what it stands for.
struct Symbol {
  std::string_view formula;  ///< as mathml() reads it
  std::string_view words;
};

/// The symbols that stand in some formulas, in the order of one list.
std::vector<Symbol> symbols_in(const std::vector<std::string>& formulas);

}  // namespace candela::figures
