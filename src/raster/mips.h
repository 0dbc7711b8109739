#pragma once

#include <cstdint>
#include <vector>

namespace candela::raster {

/// RGBA, 8 bits per channel.
struct MipLevel {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};

/// The next smaller level: half as wide and high, rounded down, each texel the mean of four; colours in linear light
/// where they are sRGB, alpha as it is. The same on every machine, which a driver's own mips are not.
MipLevel halved(const std::uint8_t* rgba, int width, int height, bool is_srgb);

}  // namespace candela::raster
