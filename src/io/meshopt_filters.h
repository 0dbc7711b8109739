#pragma once

#include <cstdint>
#include <span>

#include "io/meshopt.h"

namespace candela::io {

/// Undoes the filter of decoded attributes in place. `columns`: of a block's elements, in whole groups, the first
/// words, then the second… What the extension leaves unspecified gives some value, never an error.
void apply_meshopt_filter(const MeshoptLayout& layout, std::span<std::uint32_t> columns);

}  // namespace candela::io
