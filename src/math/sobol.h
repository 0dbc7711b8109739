#pragma once

#include <cstdint>

#include "math/hash.h"
#include "math/types.h"

namespace candela {

inline std::uint32_t reverse_bits(std::uint32_t x) {
  x = __builtin_bswap32(x);
  x = ((x & 0x0f0f0f0fU) << 4) | ((x >> 4) & 0x0f0f0f0fU);
  x = ((x & 0x33333333U) << 2) | ((x >> 2) & 0x33333333U);
  x = ((x & 0x55555555U) << 1) | ((x >> 1) & 0x55555555U);
  return x;
}

/// A random permutation in which bit k depends on the bits below it only: an Owen scramble of the reversed number.
/// Laine & Karras 2011, "Stratified Sampling for Stochastic Transparency"; constants by Vegdahl 2021.
inline std::uint32_t laine_karras(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeaU;
  x += seed;
  x *= (seed >> 16) | 1U;
  x ^= x * 0x05526c56U;
  x ^= x * 0x53a22864U;
  return x;
}

/// Bit-reversed value of Sobol' dimension 1 for index i. Its generator matrix is Pascal's triangle mod 2, C(j,k) is odd
/// where k's bits are among j's (Lucas), so the product is a sum over supersets and takes five steps instead of 32.
inline std::uint32_t sobol_dimension_1_reversed(std::uint32_t i) {
  i ^= (i >> 1) & 0x55555555U;
  i ^= (i >> 2) & 0x33333333U;
  i ^= (i >> 4) & 0x0f0f0f0fU;
  i ^= (i >> 8) & 0x00ff00ffU;
  i ^= (i >> 16) & 0x0000ffffU;
  return i;
}

/// Owen-scrambled Sobol' points, padded: every pair of dimensions is a shuffled and scrambled (0,2)-sequence of its
/// own. Burley 2020, "Practical Hash-based Owen Scrambling", with pairs instead of quadruples. A sample is the index'th
/// point of the sequence that belongs to `seed`; two seeds (pixels) are uncorrelated.
class SobolSampler {
 public:
  SobolSampler() = default;
  SobolSampler(std::uint32_t seed, std::uint32_t index) : seed_(seed), index_reversed_(reverse_bits(index)) {}

  vec2 next_2d() {
    const std::uint32_t s = advance();
    const std::uint32_t i = reverse_bits(laine_karras(index_reversed_, s));
    const std::uint32_t x = reverse_bits(laine_karras(i, hash(s ^ 0x68bc21ebU)));
    const std::uint32_t y = reverse_bits(laine_karras(sobol_dimension_1_reversed(i), hash(s ^ 0x02e5be93U)));
    return {unit_float(x), unit_float(y)};
  }

  float next_1d() {
    const std::uint32_t s = advance();
    const std::uint32_t i = reverse_bits(laine_karras(index_reversed_, s));
    return unit_float(reverse_bits(laine_karras(i, hash(s))));
  }

  vec3 next_3d() {
    const vec2 a = next_2d();
    return {a.x, a.y, next_1d()};
  }

  /// A number that differs for every (pixel, sample, call), for decisions that need no stratification.
  std::uint32_t next_hash() { return hash(advance() ^ index_reversed_); }

 private:
  std::uint32_t advance() { return hash(seed_ + 0x9e3779b9U * ++dimension_); }

  std::uint32_t seed_ = 0;
  std::uint32_t index_reversed_ = 0;
  std::uint32_t dimension_ = 0;
};

}  // namespace candela
