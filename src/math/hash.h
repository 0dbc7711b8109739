#pragma once

#include <cstdint>

namespace candela {

/// A well-mixed 32-bit permutation ("lowbias32", Wellons 2018, "Prospecting for Hash Functions").
inline std::uint32_t hash(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352dU;
  x ^= x >> 15;
  x *= 0x846ca68bU;
  x ^= x >> 16;
  return x;
}

inline std::uint32_t hash_combine(std::uint32_t seed, std::uint32_t v) {
  return hash(seed ^ (v * 0x9e3779b9U + 0x7f4a7c15U));
}

/// Top 24 bits as a number in [0, 1).
inline float unit_float(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

}  // namespace candela
