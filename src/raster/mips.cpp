#include "raster/mips.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"

namespace candela::raster {

namespace {

/// Between codes and linear light in 16 bits. IEC 61966-2-1.
struct SrgbTables {
  std::array<std::uint16_t, 256> linear{};
  std::array<std::uint8_t, 1 << 14> code{};  // by the upper 14 bits: a fifth of a code at the dark end

  SrgbTables() {
    for (std::size_t i = 0; i < linear.size(); ++i) {
      const double v = static_cast<double>(i) / 255.0;
      const double l = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
      linear[i] = static_cast<std::uint16_t>(std::lround(l * 65535.0));
    }
    for (std::size_t i = 0; i < code.size(); ++i) {
      const double l = (static_cast<double>(i) * 4.0 + 1.5) / 65535.0;
      const double v = l <= 0.0031308 ? l * 12.92 : 1.055 * std::pow(l, 1.0 / 2.4) - 0.055;
      code[i] = static_cast<std::uint8_t>(std::lround(std::min(v, 1.0) * 255.0));
    }
  }
};

const SrgbTables& srgb_tables() {
  static const SrgbTables tables;
  return tables;
}

}  // namespace

MipLevel halved(const std::uint8_t* rgba, int width, int height, bool is_srgb) {
  MipLevel out{std::max(width / 2, 1), std::max(height / 2, 1), {}};
  const auto w = static_cast<std::size_t>(out.width);
  out.rgba.resize(w * static_cast<std::size_t>(out.height) * 4);
  const SrgbTables& tables = srgb_tables();
  // A side of one texel has no neighbour.
  const std::size_t right = width > 1 ? 4 : 0;
  const std::size_t stride = static_cast<std::size_t>(width) * 4;
  const std::size_t below = height > 1 ? stride : 0;
  const std::size_t step = width > 1 ? 8 : 4;
  parallel_for(0, static_cast<std::size_t>(out.height), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      const std::uint8_t* a = rgba + (height > 1 ? 2 * y : y) * stride;
      std::uint8_t* to = out.rgba.data() + y * w * 4;
      for (std::size_t x = 0; x < w; ++x, a += step, to += 4) {
        const std::uint8_t *b = a + right, *c = a + below, *d = c + right;
        for (std::size_t i = 0; i < 4; ++i) {
          if (is_srgb && i < 3) {
            const unsigned sum = tables.linear[a[i]] + tables.linear[b[i]] + tables.linear[c[i]] + tables.linear[d[i]];
            to[i] = tables.code[sum >> 4];
          } else {
            to[i] = static_cast<std::uint8_t>((a[i] + b[i] + c[i] + d[i] + 2) >> 2);
          }
        }
      }
    }
  });
  return out;
}

}  // namespace candela::raster
