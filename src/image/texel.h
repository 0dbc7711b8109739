#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "math/types.h"

// How a texture file stores a texel: codes of small floating-point numbers, and the names that each container gives to
// the same layout.
namespace candela {

/// Layouts that can be read. Those that hold floating-point numbers can be written too.
enum class TexelFormat {
  rgba16f,
  rgba32f,
  rgb9e5,      ///< three mantissas of 9 bits and one exponent of 5
  r11g11b10f,  ///< unsigned floats with 6, 6 and 5 bits of mantissa
  rgb16f,
  rgb32f,
  rg16f,
  rg32f,
  r16f,
  r32f,
  rgba8,
  rgba8_srgb,
  bgra8,
  bgra8_srgb,
  rgb8,
  rgb8_srgb
};
inline constexpr std::size_t kTexelFormats = 16;

/// 0 where a container cannot say it.
struct TexelLayout {
  TexelFormat format;
  std::string_view name;      ///< as on the command line and in reports, e.g. "rgba16f"
  std::size_t bytes;          ///< of a texel
  int channels;               ///< stored, alpha included
  std::uint32_t type_bytes;   ///< of the unit that a big-endian reader would turn around
  std::uint32_t vk_format;    ///< KTX 2
  std::uint32_t gl_type;      ///< KTX 1, and the next two
  std::uint32_t gl_format;    ///< also the base internal format, but for BGRA
  std::uint32_t gl_internal;  ///< sized
  std::uint32_t dxgi_format;  ///< DDS
  bool is_float;              ///< can be written
};
const TexelLayout& texel_layout(TexelFormat format);
std::span<const TexelLayout> texel_layouts();
/// Among those that can be written. Throws Error for an unknown name, listing the known ones.
TexelFormat parse_texel_format(std::string_view name);

/// What an encoding could not hold, in texels: a sun must not become infinite or dark in silence.
struct EncodingLoss {
  std::uint64_t clamped = 0;     ///< a channel was above the format's maximum and became it
  std::uint64_t negative = 0;    ///< a channel was below 0 in a format without sign and became 0
  std::uint64_t non_finite = 0;  ///< a channel was NaN (became 0) or infinite (became the maximum)
  float largest = 0.0f;          ///< the largest finite value that was clamped

  bool any() const { return clamped + negative + non_finite > 0; }
  EncodingLoss& operator+=(const EncodingLoss& other);
};

/// Largest value of a channel: 65504, 65408 (rgb9e5), 64512 (the blue of r11g11b10f), the largest float.
float texel_maximum(TexelFormat format);

/// Nearest half-precision number, ties to even; above 65504 it is 65504. NaN becomes 0.
std::uint16_t half_from_float(float value);
float float_from_half(std::uint16_t code);
/// Nearest colour with a shared exponent; channels are clamped to [0, 65408]. OpenGL extension
/// EXT_texture_shared_exponent (2004), "Encoding".
std::uint32_t rgb9e5_from_color(vec3 color);
vec3 color_from_rgb9e5(std::uint32_t code);
/// Nearest colour channel by channel, ties to even; clamped to [0, 65024] and, in blue, to 64512.
std::uint32_t r11g11b10f_from_color(vec3 color);
vec3 color_from_r11g11b10f(std::uint32_t code);

/// `count` pixels of `channels` floats (1, 3 or 4) to texels, and back to `channels` floats: missing colours are 0,
/// missing alpha is 1, one channel is repeated where three are stored, and what the format has no room for is dropped.
/// Encoding needs a format of floats.
EncodingLoss encode_texels(TexelFormat format, std::span<const float> pixels, int channels, std::span<std::byte> out);
void decode_texels(TexelFormat format, std::span<const std::byte> texels, int channels, std::span<float> out);

}  // namespace candela
