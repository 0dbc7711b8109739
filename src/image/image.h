#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "math/types.h"

namespace candela {

/// Linear float pixels, interleaved, row 0 at the top. `channels` is 1, 3 or 4 (4 = RGB premultiplied by alpha, alpha).
struct Image {
  int width = 0;
  int height = 0;
  int channels = 3;
  std::vector<float> pixels;  ///< width * height * channels

  Image() = default;
  Image(int w, int h, int c)
      : width(w),
        height(h),
        channels(c),
        pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * static_cast<std::size_t>(c)) {}

  bool empty() const { return pixels.empty(); }
  std::size_t index(int x, int y) const {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
           static_cast<std::size_t>(channels);
  }
  std::span<float> at(int x, int y) { return {pixels.data() + index(x, y), static_cast<std::size_t>(channels)}; }
  std::span<const float> at(int x, int y) const {
    return {pixels.data() + index(x, y), static_cast<std::size_t>(channels)};
  }
  /// First three channels of a pixel (a single channel is repeated).
  vec3 rgb(int x, int y) const {
    const float* p = pixels.data() + index(x, y);
    return channels == 1 ? vec3(p[0]) : vec3(p[0], p[1], p[2]);
  }
  void set_rgb(int x, int y, vec3 v) {
    float* p = pixels.data() + index(x, y);
    p[0] = v.x, p[1] = v.y, p[2] = v.z;
  }
};

/// Texture pixels as stored in the file: RGBA, 8 or 16 bits per channel, row 0 at the top, still encoded (sRGB or
/// data). Missing channels are filled the way PNG and JPEG mean them (grey repeats, alpha is opaque).
struct TextureImage {
  int width = 0;
  int height = 0;
  int bits = 8;                      ///< 8 or 16 (16: native-endian uint16 pairs)
  bool has_alpha = false;            ///< the file had an alpha channel
  std::vector<std::uint8_t> pixels;  ///< width * height * 4 * bits / 8
};

}  // namespace candela
