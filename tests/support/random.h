#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace candela::test {

/// Independent random numbers for tests; statistics about the samplers of the renderer must not be driven by them.
/// PCG-XSH-RR 64/32. O'Neill 2014, "PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms".
class Pcg32 {
 public:
  explicit Pcg32(std::uint64_t seed) : state_(seed + kIncrement) {
    next();
    state_ += seed * 0x9e3779b97f4a7c15U;
    next();
  }

  std::uint32_t next() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005U + kIncrement;
    const auto mixed = static_cast<std::uint32_t>(((old >> 18) ^ old) >> 27);
    const auto turn = static_cast<std::uint32_t>(old >> 59);
    return (mixed >> turn) | (mixed << ((32U - turn) & 31U));
  }

  /// Uniform in [0, 1), a multiple of 2⁻²⁴.
  float next_float() { return static_cast<float>(next() >> 8) * 0x1p-24f; }
  glm::vec2 next_vec2() {
    const float x = next_float();
    return {x, next_float()};
  }
  glm::vec3 next_vec3() {
    const glm::vec2 xy = next_vec2();
    return {xy.x, xy.y, next_float()};
  }

 private:
  static constexpr std::uint64_t kIncrement = 1442695040888963407U;
  std::uint64_t state_;
};

}  // namespace candela::test
