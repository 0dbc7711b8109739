#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <functional>
#include <vector>

#include "laws/bsdf_laws.h"
#include "laws/mutants.h"
#include "support/statistics.h"

// How a TEST runs a law over rows of the table of surfaces, and over mutants of them that must fail.

namespace candela::laws {

using Law = Verdict (*)(const Bsdf&, const Trial&);
using Rows = std::vector<NamedSurface>;

/// Every `stride`th row that `wanted` takes; a stride that shares no factor with the roughnesses meets all of them.
inline Rows rows(std::size_t stride, const std::function<bool(const NamedSurface&)>& wanted) {
  Rows some;
  std::size_t count = 0;
  for (NamedSurface& row : laws::law_surfaces()) {
    if (wanted(row) && count++ % stride == 0) some.push_back(std::move(row));
  }
  return some;
}
inline bool is_any(const NamedSurface&) { return true; }
inline bool is_core(const NamedSurface& row) { return row.is_core; }

/// Seeds differ by row, and p-values are judged as one family over all rows.
inline Trial trial(const NamedSurface& row, std::size_t index, std::size_t rows, int tests_per_row) {
  return {row.promise, 1000 + index, test::sidak_threshold(rows * static_cast<std::size_t>(tests_per_row))};
}

inline void expect_law(const Rows& table, Law law, int tests_per_row = 1) {
  EXPECT_FALSE(table.empty());
  for (std::size_t i = 0; i < table.size(); ++i) {
    const Verdict verdict = law(real_bsdf(table[i].params), trial(table[i], i, table.size(), tests_per_row));
    EXPECT_TRUE(verdict.holds) << table[i].name << ": " << verdict.evidence;
  }
}

/// Each mutant must be caught on `most` of the surfaces that show it, spread over the table.
inline void expect_mutants_caught(const Rows& table, Law law, const std::vector<Mutant>& mutants, int tests_per_row = 1,
                                  std::size_t most = 12) {
  for (const Mutant& mutant : mutants) {
    std::vector<std::size_t> shown;
    for (std::size_t i = 0; i < table.size(); ++i) {
      if (mutant.shows(table[i].params)) shown.push_back(i);
    }
    EXPECT_FALSE(shown.empty()) << "no surface of the table shows: " << mutant.name;
    const std::size_t stride = std::max<std::size_t>(1, shown.size() / most);
    for (std::size_t k = 0; k < shown.size(); k += stride) {
      const NamedSurface& row = table[shown[k]];
      EXPECT_FALSE(law(mutant.make(row.params), trial(row, shown[k], table.size(), tests_per_row)).holds)
          << "not caught: " << mutant.name << " on " << row.name;
    }
  }
}

}  // namespace candela::laws
