#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "io/meshopt.h"

namespace candela::io {

inline constexpr std::size_t kMostMeshoptStride = 256;

/// Elements that are packed together.
std::size_t meshopt_block_elements(std::size_t stride);

/// Decodes attributes, filter included, to layout.count × layout.stride bytes.
void unpack_attributes(std::span<const std::uint8_t> packed, const MeshoptLayout& layout, std::uint8_t* out);

}  // namespace candela::io
