#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "image/image.h"

// What the readers of old pictures share.
namespace candela::foreign {

using Texel = std::array<std::uint8_t, 4>;

/// A picture in the making; what is not set is black and has no alpha.
class Canvas {
 public:
  Canvas(std::int64_t width, std::int64_t height, const std::string& where);

  std::size_t width() const { return static_cast<std::size_t>(image_.width); }
  std::size_t height() const { return static_cast<std::size_t>(image_.height); }
  void set(std::size_t x, std::size_t y, Texel texel) {
    for (std::size_t c = 0; c < 4; ++c) image_.pixels[(y * width() + x) * 4 + c] = texel[c];
  }
  /// Opaque where the file has no alpha, or writes one of zeros.
  TextureImage finish(bool may_have_alpha);

 private:
  TextureImage image_;
};

/// `value` of `bits` bits, 1 to 32, as 8 of them.
inline std::uint8_t scaled_to_byte(std::uint32_t value, int bits) {
  const std::uint64_t most = (std::uint64_t{1} << bits) - 1;
  return static_cast<std::uint8_t>((value * std::uint64_t{255} + most / 2) / most);
}

}  // namespace candela::foreign
