#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <utility>
#include <vector>

// TGA and BMP files of one small picture, for tests and as seeds of the fuzzer.
namespace candela::foreign::test {

using Bytes = std::vector<std::byte>;

inline constexpr int kWidth = 7, kHeight = 5;

/// What all of them show: four colours of full and no channels, so that every depth holds them, in runs.
inline std::array<std::uint8_t, 4> shown(int x, int y) {
  switch ((x / 3 + y) % 4) {
    case 0:
      return {255, 0, 0, 255};
    case 1:
      return {0, 255, 0, 255};
    case 2:
      return {0, 0, 255, 0};
    default:
      return {255, 255, 255, 255};
  }
}
inline std::uint8_t index_of(int x, int y) { return static_cast<std::uint8_t>((x / 3 + y) % 4); }

inline void put(Bytes& out, std::uint64_t value, std::size_t count) {
  for (; count > 0; --count, value >>= 8) out.push_back(static_cast<std::byte>(value & 255));
}

/// The texel as so many bits hold it, little-endian.
inline std::uint32_t coded(std::array<std::uint8_t, 4> c, int bits) {
  if (bits >= 24) return static_cast<std::uint32_t>(c[2] | c[1] << 8 | c[0] << 16) | std::uint32_t{c[3]} << 24;
  return static_cast<std::uint32_t>(c[0] / 8 << 10 | c[1] / 8 << 5 | c[2] / 8 | (c[3] != 0 ? 0x8000 : 0));
}

struct Tga {
  int kind = 2;  ///< as the header has it: 1, 2, 3; with 8 added run-length coded
  int bits = 24;
  int map_bits = 24;
  int alpha_bits = 0;
  bool top_down = false;
  bool mirrored = false;
};

inline Bytes tga(const Tga& t) {
  Bytes out;
  const int kind = t.kind & ~8;
  put(out, 3, 1), put(out, kind == 1 ? 1 : 0, 1), put(out, static_cast<std::uint64_t>(t.kind), 1);
  put(out, kind == 1 ? 10 : 0, 2), put(out, kind == 1 ? 4 : 0, 2),
      put(out, kind == 1 ? static_cast<std::uint64_t>(t.map_bits) : 0, 1);
  put(out, 0, 4), put(out, kWidth, 2), put(out, kHeight, 2), put(out, static_cast<std::uint64_t>(t.bits), 1);
  put(out, static_cast<std::uint64_t>(t.alpha_bits | (t.mirrored ? 16 : 0) | (t.top_down ? 32 : 0)), 1);
  put(out, 0x616263, 3);
  // The map begins at index 10; its colours are those of columns 0, 3 and 6 and of the next row.
  for (int i = 0; kind == 1 && i < 4; ++i) {
    put(out, coded(shown(0, i), t.map_bits), static_cast<std::size_t>(t.map_bits + 7) / 8);
  }
  const auto texel = [&](int x, int y) -> std::uint32_t {
    const int column = t.mirrored ? kWidth - 1 - x : x, row = t.top_down ? y : kHeight - 1 - y;
    if (kind == 1) return 10u + index_of(column, row);
    const auto c = shown(column, row);
    return kind == 3 ? c[0] | (t.bits == 16 ? std::uint32_t{c[3]} << 8 : 0u) : coded(c, t.bits);
  };
  const std::size_t size = static_cast<std::size_t>(t.bits + 7) / 8;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth;) {
      int run = 1;
      while (x + run < kWidth && texel(x + run, y) == texel(x, y)) ++run;
      if ((t.kind & 8) == 0) run = 1;
      if ((t.kind & 8) != 0) put(out, run > 1 ? 0x80u | static_cast<unsigned>(run - 1) : 0u, 1);
      put(out, texel(x, y), size);
      x += run;
    }
  }
  return out;
}

inline std::vector<Tga> tgas() {
  return {{},
          {2, 32, 0, 8},
          {2, 32, 0, 0, true},
          {2, 16, 0, 1},
          {2, 15, 0, 0},
          {3, 8},
          {3, 16, 0, 8},
          {1, 8, 24},
          {1, 8, 32, 8, true},
          {1, 16, 16, 1},
          {2, 24, 0, 0, false, true},
          {10, 24, 0, 0, true},
          {10, 32, 0, 8},
          {10, 16, 0, 1},
          {11, 8},
          {9, 8, 24, 0, false, true}};
}

struct Bmp {
  std::uint32_t bits = 24, packing = 0, header = 40;
  bool top_down = false;
};

inline void put_bmp_texels(const Bmp& b, Bytes& out) {
  const auto row_of = [&](int line) { return b.top_down ? line : kHeight - 1 - line; };
  if (b.packing == 1 || b.packing == 2) {
    const auto value = [&](int x, int y) { return b.packing == 1 ? index_of(x, y) : index_of(x, y) * 0x11u; };
    for (int line = 0; line < kHeight; ++line) {
      const int y = row_of(line);
      put(out, 3, 1), put(out, value(0, y), 1);
      // Three as they stand, padded to two bytes, and one as a run.
      put(out, 0, 1), put(out, 3, 1);
      put(out, b.packing == 1 ? value(3, y) * 0x10101u : value(3, y) | value(3, y) << 8, b.packing == 1 ? 4 : 2);
      put(out, 1, 1), put(out, value(6, y), 1), put(out, 0, 2);
    }
    put(out, 0x100, 2);
    return;
  }
  for (int line = 0; line < kHeight; ++line) {
    const std::size_t begin = out.size();
    std::uint32_t bits = 0, held = 0;
    for (int x = 0; x < kWidth; ++x) {
      const int y = row_of(line);
      if (b.bits > 8) {
        put(out, coded(shown(x, y), static_cast<int>(b.bits)), b.bits / 8);
        continue;
      }
      bits = bits << b.bits | (b.bits == 1 ? index_of(x, y) / 2u : index_of(x, y)), held += b.bits;
      if (held == 8) put(out, bits, 1), held = bits = 0;
    }
    if (held > 0) put(out, bits << (8 - held), 1);
    while ((out.size() - begin) % 4 != 0) put(out, 0, 1);
  }
}

inline Bytes bmp(const Bmp& b) {
  const std::size_t colors = b.bits > 8 ? 0 : std::size_t{1} << b.bits, entry = b.header == 12 ? 3 : 4;
  const std::size_t masks = b.header == 40 && b.packing == 3 ? 12 : 0;
  Bytes out;
  put(out, 'B', 1), put(out, 'M', 1), put(out, 0, 8), put(out, 14 + b.header + masks + colors * entry, 4);
  put(out, b.header, 4);
  const auto height = static_cast<std::uint64_t>(b.top_down ? -kHeight : kHeight);
  if (b.header == 12) {
    put(out, kWidth, 2), put(out, kHeight, 2), put(out, 1, 2), put(out, b.bits, 2);
  } else {
    put(out, kWidth, 4), put(out, height, 4), put(out, 1, 2), put(out, b.bits, 2), put(out, b.packing, 4);
    put(out, 0, 20);
    if (b.packing == 3) {
      const bool wide = b.bits == 32;
      put(out, wide ? 0xFF0000 : 0x7C00, 4), put(out, wide ? 0xFF00 : 0x3E0, 4), put(out, wide ? 0xFF : 0x1F, 4);
      if (b.header > 40) put(out, wide ? 0xFF000000 : 0x8000, 4);
    }
    while (out.size() < 14 + b.header) put(out, 0, 1);
  }
  for (std::size_t i = 0; i < colors; ++i) {
    // Of one bit the second colour is that of the indices 2 and 3.
    const auto c = i < 4 ? shown(0, static_cast<int>(b.bits == 1 ? 2 * i : i)) : std::array<std::uint8_t, 4>{};
    put(out, coded(c, 24) & 0xFFFFFF, entry);
  }
  put_bmp_texels(b, out);
  return out;
}

inline std::vector<Bmp> bmps() {
  return {{},
          {24, 0, 12},
          {1},
          {4},
          {8},
          {8, 0, 12},
          {16},
          {32},
          {16, 3, 40},
          {32, 3, 108},
          {16, 3, 56},
          {32, 3, 124},
          {8, 1},
          {4, 2},
          {24, 0, 40, true},
          {32, 3, 108, true}};
}

inline std::vector<Bytes> old_picture_seeds() {
  std::vector<Bytes> seeds;
  for (const Tga& t : tgas()) seeds.push_back(tga(t));
  for (const Bmp& b : bmps()) seeds.push_back(bmp(b));
  return seeds;
}

}  // namespace candela::foreign::test
