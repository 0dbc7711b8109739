#pragma once

#include <string>
#include <string_view>

#include "base/error.h"

namespace candela {

/// The row of a table whose member `name` is `name`. Throws Error that begins with `fault` ("unknown layer") and lists
/// what there is.
template <class Rows>
const auto& row_named(const Rows& rows, std::string_view name, std::string_view fault) {
  std::string known;
  for (const auto& row : rows) {
    if (row.name == name) return row;
    known += (known.empty() ? "" : ", ") + std::string(row.name);
  }
  throw Error(std::string(fault) + " \"" + std::string(name) + "\" (known: " + known + ")");
}

}  // namespace candela
