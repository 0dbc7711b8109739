#include "io/meshopt_groups.h"

#include <algorithm>
#include <array>
#include <bit>

#if defined(__SSSE3__)
#include <immintrin.h>
#endif

// KHR_meshopt_compression, appendix A: sixteen deltas of a few bits each, and behind them a whole byte for each whose
// bits are all ones. Single bits begin with a byte's lowest, wider deltas with its highest.

namespace candela::io {

namespace {

constexpr std::size_t kInHeader = 4;  ///< groups of one byte of it

constexpr std::array<std::array<unsigned, kInHeader>, 3> kBits{{{0, 2, 4, 8}, {0, 1, 2, 4}, {1, 2, 4, 8}}};

/// Calls `unpack(width, out)` for each group, but for those of which four at once need no look at any delta.
template <class Unpack>
void each_group(MeshoptStream& in, std::size_t count, MeshoptWidths widths, std::uint8_t* out, const Unpack& unpack) {
  const std::size_t groups = (count + kMeshoptGroup - 1) / kMeshoptGroup;
  const std::uint8_t* header = in.take((groups + kInHeader - 1) / kInHeader);
  const auto& bits = kBits[static_cast<std::size_t>(widths)];
  const bool has_nothing = bits[0] == 0, has_whole = bits[3] == 8;
  for (std::size_t g = 0; g < groups; g += kInHeader, ++header) {
    const std::size_t here = std::min(groups - g, kInHeader);
    if (*header == 0 && has_nothing) {
      out = std::fill_n(out, kInHeader * kMeshoptGroup, std::uint8_t{0});
    } else if (*header == 0xFF && has_whole && here == kInHeader) {
      out = std::copy_n(in.take(kInHeader * kMeshoptGroup), kInHeader * kMeshoptGroup, out);
    } else {
      for (std::size_t k = 0; k < here; ++k, out += kMeshoptGroup) unpack(*header >> (2 * k) & 3u, out);
    }
  }
}

template <unsigned bits>
void unpack_group_plainly(MeshoptStream& in, std::uint8_t* out) {
  constexpr unsigned kOnes = (1u << bits) - 1, kInByte = 8 / bits;
  const std::uint8_t* packed = in.take(std::size_t{2} * bits);
  for (unsigned i = 0; i < kMeshoptGroup; ++i) {
    const unsigned place = i % kInByte, shift = bits == 1 ? place : 8 - bits * (place + 1);
    out[i] = static_cast<std::uint8_t>(packed[i / kInByte] >> shift & kOnes);
  }
  for (std::uint8_t* delta = out; bits < 8; ++delta) {
    delta = std::find(delta, out + kMeshoptGroup, static_cast<std::uint8_t>(kOnes));
    if (delta == out + kMeshoptGroup) return;
    *delta = in.byte();
  }
}

}  // namespace

void unpack_groups_plainly(MeshoptStream& in, std::size_t count, MeshoptWidths widths, std::uint8_t* out) {
  each_group(in, count, widths, out, [&](unsigned width, std::uint8_t* to) {
    switch (kBits[static_cast<std::size_t>(widths)][width]) {
      case 1:
        return unpack_group_plainly<1>(in, to);
      case 2:
        return unpack_group_plainly<2>(in, to);
      case 4:
        return unpack_group_plainly<4>(in, to);
      case 8:
        return unpack_group_plainly<8>(in, to);
      default:
        std::fill_n(to, kMeshoptGroup, std::uint8_t{0});
    }
  });
}

#if defined(__SSSE3__)

namespace {

using u8x16 = std::uint8_t __attribute__((vector_size(16)));
using u16x8 = std::uint16_t __attribute__((vector_size(16)));

/// How a group of a width is laid out.
struct Width {
  std::size_t bytes = 0;                                       ///< of packed bits
  std::array<std::uint8_t, kMeshoptGroup> source{};            ///< the one that a delta is in; 0x80 = none
  std::array<std::uint8_t, kMeshoptGroup> mask{};              ///< its bits there
  std::array<std::uint16_t, kMeshoptGroup / 2> even{}, odd{};  ///< what moves them to a byte's end, times 256
  std::array<std::uint8_t, kMeshoptGroup> escapes{};           ///< 0xFF where all ones stand for a byte that follows
  // To count those in the packed bits: x & x >> first, that & itself >> second, and one bit of each delta.
  unsigned first = 0, second = 0;
  std::uint64_t counted = 0;
};

constexpr Width make_width(unsigned bits) {
  Width w;
  w.bytes = std::size_t{2} * bits;
  w.first = bits == 2 || bits == 4 ? 1 : 0;
  w.second = bits == 4 ? 2 : 0;
  w.counted = bits == 1 ? 0xFFFF : bits == 2 ? 0x55555555 : bits == 4 ? 0x1111111111111111 : 0;
  for (unsigned i = 0; i < kMeshoptGroup; ++i) {
    const unsigned in_byte = bits == 0 ? 1 : 8 / bits;
    const unsigned place = i % in_byte, shift = bits == 0 ? 0 : bits == 1 ? place : 8 - bits * (place + 1);
    w.source[i] = static_cast<std::uint8_t>(bits == 0 ? 0x80 : i / in_byte);
    w.mask[i] = static_cast<std::uint8_t>(((1u << bits) - 1) << shift);
    (i % 2 == 0 ? w.even : w.odd)[i / 2] = static_cast<std::uint16_t>(256u >> shift);
    w.escapes[i] = bits == 0 || bits == 8 ? 0 : 0xFF;
  }
  return w;
}

using Widths = std::array<Width, kInHeader>;
constexpr Widths make_widths(const std::array<unsigned, kInHeader>& bits) {
  return {make_width(bits[0]), make_width(bits[1]), make_width(bits[2]), make_width(bits[3])};
}
constexpr std::array<Widths, 3> kWidths{make_widths(kBits[0]), make_widths(kBits[1]), make_widths(kBits[2])};

/// Bytes of v by their numbers; 0 where a number is beyond 0x7F.
u8x16 shuffled(u8x16 v, u8x16 numbers) {
  return reinterpret_cast<u8x16>(_mm_shuffle_epi8(reinterpret_cast<__m128i>(v), reinterpret_cast<__m128i>(numbers)));
}

/// Each byte and all before it, added up.
u8x16 running_sum(u8x16 v) {
  const u8x16 zero{};
  v += __builtin_shufflevector(zero, v, 0, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30);
  v += __builtin_shufflevector(zero, v, 0, 0, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29);
  v += __builtin_shufflevector(zero, v, 0, 0, 0, 0, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27);
  v += __builtin_shufflevector(zero, v, 0, 0, 0, 0, 0, 0, 0, 0, 16, 17, 18, 19, 20, 21, 22, 23);
  return v;
}

/// The deltas of a group whose packed bits and following bytes are at `packed`.
u8x16 unpack_group(const std::uint8_t* packed, const Width& w) {
  const auto mask = load_bytes<u8x16>(w.mask.data());
  const u8x16 field = shuffled(load_bytes<u8x16>(packed), load_bytes<u8x16>(w.source.data())) & mask;
  const u8x16 escaped = reinterpret_cast<u8x16>(field == mask) & load_bytes<u8x16>(w.escapes.data());
  const auto pairs = reinterpret_cast<u16x8>(field);
  const u16x8 even = (pairs & 0xFF) * load_bytes<u16x8>(w.even.data()) >> 8;
  const u16x8 odd = (pairs >> 8) * load_bytes<u16x8>(w.odd.data()) & 0xFF00;
  const auto values = reinterpret_cast<u8x16>(even | odd);
  // -1 for each escape, added up, is the complement of the number of the byte that it is.
  const u8x16 which = ~(running_sum(escaped) & escaped);
  return (values & ~escaped) | shuffled(load_bytes<u8x16>(packed + w.bytes), which);
}

/// Bytes of a group, found without its deltas: the next group has to wait for nothing else.
std::size_t group_bytes(const std::uint8_t* packed, const Width& w) {
  auto ones = load_bytes<std::uint64_t>(packed);
  ones &= ones >> w.first;
  ones &= ones >> w.second;
  return w.bytes + static_cast<std::size_t>(std::popcount(ones & w.counted));
}

}  // namespace

void unpack_groups(MeshoptStream& in, std::size_t count, MeshoptWidths widths, std::uint8_t* out) {
  const Widths& of_header = kWidths[static_cast<std::size_t>(widths)];
  each_group(in, count, widths, out, [&](unsigned width, std::uint8_t* to) {
    const std::uint8_t* packed = in.peek();
    in.take(group_bytes(packed, of_header[width]));
    store_bytes(to, unpack_group(packed, of_header[width]));
  });
}

#else

void unpack_groups(MeshoptStream& in, std::size_t count, MeshoptWidths widths, std::uint8_t* out) {
  unpack_groups_plainly(in, count, widths, out);
}

#endif

}  // namespace candela::io
