#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "math/types.h"

namespace candela::io {

/// Triangles of indices by a mode of glTF 2.0 §3.7.2.1: 4 a list, 5 a strip, 6 a fan; kPrimitiveRestart begins anew.
/// Those with a vertex twice are left out.
std::vector<uvec3> assemble(std::span<const std::uint32_t> indices, std::uint64_t mode);

/// The vertices that triangles name, ascending; triangles are renumbered to positions in that list.
std::vector<std::uint32_t> compact(std::vector<uvec3>& triangles, std::size_t vertex_count);

}  // namespace candela::io
