#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace candela::test {

// ----- random blocks of UASTC: all is random but for what names the mode and must not be damaged

inline constexpr std::size_t kUastcModes = 19;

struct UastcShape {
  unsigned bits, length;                        ///< the mode's code
  unsigned pattern_at, pattern_bits, patterns;  ///< PAT, where there is one
  unsigned etc2m_at;                            ///< ETC2M, which is not 0
};
inline constexpr std::array<UastcShape, kUastcModes> kUastcShapes{{{0x01, 4, 0, 0, 0, 0},
                                                                   {0x35, 6, 0, 0, 0, 0},
                                                                   {0x1d, 5, 20, 5, 30, 0},
                                                                   {0x03, 5, 20, 4, 11, 0},
                                                                   {0x13, 5, 20, 5, 30, 0},
                                                                   {0x0b, 5, 0, 0, 0, 0},
                                                                   {0x1b, 5, 0, 0, 0, 0},
                                                                   {0x07, 5, 20, 5, 19, 0},
                                                                   {0x17, 5, 0, 0, 0, 0},
                                                                   {0x0f, 5, 28, 5, 30, 24},
                                                                   {0x02, 3, 0, 0, 0, 16},
                                                                   {0x00, 2, 0, 0, 0, 15},
                                                                   {0x06, 3, 0, 0, 0, 16},
                                                                   {0x1f, 5, 0, 0, 0, 24},
                                                                   {0x0d, 5, 0, 0, 0, 24},
                                                                   {0x05, 7, 0, 0, 0, 26},
                                                                   {0x15, 6, 29, 5, 30, 25},
                                                                   {0x25, 6, 0, 0, 0, 25},
                                                                   {0x09, 4, 0, 0, 0, 0}}};

inline void put_bits(std::span<std::byte> block, unsigned at, unsigned count, unsigned value) {
  for (unsigned i = 0; i < count; ++i, ++at) {
    const std::byte bit{static_cast<unsigned char>(1u << (at & 7))};
    block[at / 8] = (block[at / 8] & ~bit) | ((value >> i & 1u) != 0 ? bit : std::byte{0});
  }
}

inline unsigned bits_at(std::span<const std::byte> block, unsigned at, unsigned count) {
  unsigned value = 0;
  for (unsigned i = 0; i < count; ++i, ++at) value |= (std::to_integer<unsigned>(block[at / 8]) >> (at & 7) & 1u) << i;
  return value;
}

/// xorshift32, as tests/unit/image/basis/make_fixtures.mjs has it.
class XorShift {
 public:
  explicit XorShift(std::uint32_t seed) : state_(seed) {}
  std::uint32_t operator()() {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 17;
    return state_ ^= state_ << 5;
  }

 private:
  std::uint32_t state_;
};

/// The same blocks as make_fixtures.mjs makes, all patterns in turn.
inline std::vector<std::byte> random_uastc(std::size_t mode, std::size_t count) {
  XorShift random(static_cast<std::uint32_t>(mode) + 1);
  const UastcShape& shape = kUastcShapes[mode];
  std::vector<std::byte> blocks(16 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::span<std::byte> block = std::span(blocks).subspan(16 * i, 16);
    for (std::byte& b : block) b = static_cast<std::byte>(random() >> 24);
    put_bits(block, 0, shape.length, shape.bits);
    const auto number = static_cast<unsigned>(i);
    if (shape.patterns > 0) put_bits(block, shape.pattern_at, shape.pattern_bits, number % shape.patterns);
    if (shape.etc2m_at > 0) put_bits(block, shape.etc2m_at, 4, 1 + number % 15);
  }
  return blocks;
}

}  // namespace candela::test
