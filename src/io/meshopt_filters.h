#pragma once

#include <cstdint>

#include "io/meshopt.h"

namespace candela::io {

/// Undoes the filter of decoded attributes in place, layout.count × layout.stride bytes. What the extension leaves
/// unspecified gives some value, never an error.
void apply_meshopt_filter(const MeshoptLayout& layout, std::uint8_t* data);

}  // namespace candela::io
