#pragma once

#include <bit>
#include <cstddef>

#include "math/hash.h"
#include "math/types.h"

namespace candela {

/// Of the bits of a position, for maps that find what lies at the same place. -0 and 0 differ: add 0 before.
struct PositionHash {
  std::size_t operator()(const vec3& p) const {
    const std::uint32_t h = hash_combine(hash(std::bit_cast<std::uint32_t>(p.x)), std::bit_cast<std::uint32_t>(p.y));
    return hash_combine(h, std::bit_cast<std::uint32_t>(p.z));
  }
};

}  // namespace candela
