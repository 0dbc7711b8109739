#include "image/texel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>

#include "base/check.h"
#include "base/error.h"
#include "shade/color.glsl.h"

namespace candela {

namespace {

// Vulkan 1.3 § 34.1 (VkFormat), OpenGL 4.6 tables 8.2, 8.3 and 8.12, and dxgiformat.h of the Windows SDK.
constexpr std::array<TexelLayout, kTexelFormats> kLayouts{{
    {TexelFormat::rgba16f, "rgba16f", 8, 4, 2, 97, 0x140b, 0x1908, 0x881a, 10, true},
    {TexelFormat::rgba32f, "rgba32f", 16, 4, 4, 109, 0x1406, 0x1908, 0x8814, 2, true},
    {TexelFormat::rgb9e5, "rgb9e5", 4, 3, 4, 123, 0x8c3e, 0x1907, 0x8c3d, 67, true},
    {TexelFormat::r11g11b10f, "r11g11b10f", 4, 3, 4, 122, 0x8c3b, 0x1907, 0x8c3a, 26, true},
    {TexelFormat::rgb16f, "rgb16f", 6, 3, 2, 90, 0x140b, 0x1907, 0x881b, 0, true},
    {TexelFormat::rgb32f, "rgb32f", 12, 3, 4, 106, 0x1406, 0x1907, 0x8815, 6, true},
    {TexelFormat::rg16f, "rg16f", 4, 2, 2, 83, 0x140b, 0x8227, 0x822f, 34, true},
    {TexelFormat::rg32f, "rg32f", 8, 2, 4, 103, 0x1406, 0x8227, 0x8230, 16, true},
    {TexelFormat::r16f, "r16f", 2, 1, 2, 76, 0x140b, 0x1903, 0x822d, 54, true},
    {TexelFormat::r32f, "r32f", 4, 1, 4, 100, 0x1406, 0x1903, 0x822e, 41, true},
    {TexelFormat::rgba8, "rgba8", 4, 4, 1, 37, 0x1401, 0x1908, 0x8058, 28, false},
    {TexelFormat::rgba8_srgb, "rgba8-srgb", 4, 4, 1, 43, 0x1401, 0x1908, 0x8c43, 29, false},
    {TexelFormat::bgra8, "bgra8", 4, 4, 1, 44, 0x1401, 0x80e1, 0x8058, 87, false},
    {TexelFormat::bgra8_srgb, "bgra8-srgb", 4, 4, 1, 50, 0x1401, 0x80e1, 0x8c43, 91, false},
    {TexelFormat::rgb8, "rgb8", 3, 3, 1, 23, 0x1401, 0x1907, 0x8051, 0, false},
    {TexelFormat::rgb8_srgb, "rgb8-srgb", 3, 3, 1, 29, 0x1401, 0x1907, 0x8c41, 0, false},
}};

constexpr int kExponentBias = 15;  // of every small float here

/// Largest finite number with a 5-bit exponent and this many bits of mantissa.
constexpr float largest_small_float(int mantissa_bits) {
  return 65536.0f - 32768.0f / static_cast<float>(1 << mantissa_bits);
}

/// A number in [0, largest] with a 5-bit exponent and no sign: nearest, ties to even.
std::uint32_t small_float(float value, int mantissa_bits) {
  if (!(value > 0.0f)) return 0;  // NaN too
  value = std::min(value, largest_small_float(mantissa_bits));
  constexpr float kSmallestNormal = 0x1p-14f;
  if (value < kSmallestNormal) {
    // Denormal; what rounds up to 2^mantissa_bits is the smallest normal number, and has its code.
    return static_cast<std::uint32_t>(std::nearbyint(std::ldexp(value, 14 + mantissa_bits)));
  }
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const int dropped = 23 - mantissa_bits;
  const std::uint32_t half_minus_one = (1u << (dropped - 1)) - 1u;
  const std::uint32_t odd = (bits >> dropped) & 1u;
  const std::uint32_t rounded = (bits + half_minus_one + odd) >> dropped;  // a carry goes into the exponent
  return rounded - (static_cast<std::uint32_t>(127 - kExponentBias) << mantissa_bits);
}

float from_small_float(std::uint32_t code, int mantissa_bits) {
  const std::uint32_t mantissa = code & ((1u << mantissa_bits) - 1u);
  const std::uint32_t exponent = code >> mantissa_bits;
  if (exponent == 0) return std::ldexp(static_cast<float>(mantissa), -14 - mantissa_bits);
  if (exponent == 31) return mantissa == 0 ? kInfinity : std::numeric_limits<float>::quiet_NaN();
  return std::bit_cast<float>((exponent + 127u - kExponentBias) << 23 | mantissa << (23 - mantissa_bits));
}

constexpr int kSharedMantissaBits = 9;
constexpr float kSharedMaximum = 65408.0f;  // (2^9 - 1) / 2^9 · 2^(31 - 15)

template <class T>
T load(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}
template <class T>
void store(std::byte* to, T value) {
  std::memcpy(to, &value, sizeof value);
}

static_assert(std::endian::native == std::endian::little, "texels are stored with the small end first");

/// Four channels of a pixel, as a texel without some of them is read.
struct Rgba {
  std::array<float, 4> v{0.0f, 0.0f, 0.0f, 1.0f};
};

Rgba widen(const float* pixel, int channels) {
  Rgba out;
  for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) out.v[c] = pixel[c];
  if (channels == 1) out.v[1] = out.v[2] = out.v[0];
  return out;
}

/// Brings what a format cannot hold into its range, and counts the texel once per kind of loss.
void clamp_texel(Rgba& texel, const TexelLayout& layout, EncodingLoss& loss) {
  const bool has_sign = layout.format != TexelFormat::rgb9e5 && layout.format != TexelFormat::r11g11b10f;
  bool clamped = false, negative = false, non_finite = false;
  for (std::size_t c = 0; c < static_cast<std::size_t>(layout.channels); ++c) {
    float& value = texel.v[c];
    const bool is_blue = layout.format == TexelFormat::r11g11b10f && c == 2;
    const float limit =
        layout.format == TexelFormat::r11g11b10f && !is_blue ? largest_small_float(6) : texel_maximum(layout.format);
    if (!std::isfinite(value)) {
      non_finite = true;
      value = std::isnan(value) ? 0.0f : value > 0.0f ? limit : has_sign ? -limit : 0.0f;
    } else if (std::abs(value) > limit && (has_sign || value > 0.0f)) {
      clamped = true;
      loss.largest = std::max(loss.largest, std::abs(value));
      value = value > 0.0f ? limit : -limit;
    } else if (value < 0.0f && !has_sign) {
      negative = true;
      value = 0.0f;
    }
  }
  loss.clamped += clamped ? 1 : 0;
  loss.negative += negative ? 1 : 0;
  loss.non_finite += non_finite ? 1 : 0;
}

void store_texel(const TexelLayout& layout, const Rgba& texel, std::byte* out) {
  const vec3 color(texel.v[0], texel.v[1], texel.v[2]);
  if (layout.format == TexelFormat::rgb9e5) return store(out, rgb9e5_from_color(color));
  if (layout.format == TexelFormat::r11g11b10f) return store(out, r11g11b10f_from_color(color));
  for (std::size_t c = 0; c < static_cast<std::size_t>(layout.channels); ++c) {
    if (layout.type_bytes == 2)
      store(out + 2 * c, half_from_float(texel.v[c]));
    else
      store(out + 4 * c, texel.v[c]);
  }
}

bool is_srgb(TexelFormat format) {
  return format == TexelFormat::rgba8_srgb || format == TexelFormat::bgra8_srgb || format == TexelFormat::rgb8_srgb;
}

Rgba load_texel(const TexelLayout& layout, const std::byte* from) {
  Rgba out;
  if (layout.format == TexelFormat::rgb9e5 || layout.format == TexelFormat::r11g11b10f) {
    const auto code = load<std::uint32_t>(from);
    const vec3 color = layout.format == TexelFormat::rgb9e5 ? color_from_rgb9e5(code) : color_from_r11g11b10f(code);
    out.v = {color.x, color.y, color.z, 1.0f};
    return out;
  }
  for (std::size_t c = 0; c < static_cast<std::size_t>(layout.channels); ++c) {
    if (layout.type_bytes == 4)
      out.v[c] = load<float>(from + 4 * c);
    else if (layout.type_bytes == 2)
      out.v[c] = float_from_half(load<std::uint16_t>(from + 2 * c));
    else
      out.v[c] = static_cast<float>(std::to_integer<int>(from[c])) / 255.0f;
  }
  if (layout.gl_format == 0x80e1) std::swap(out.v[0], out.v[2]);
  if (is_srgb(layout.format))
    for (std::size_t c = 0; c < 3; ++c) out.v[c] = shade::srgb_decode_channel(out.v[c]);
  if (layout.channels == 1) out.v[1] = out.v[2] = out.v[0];
  return out;
}

}  // namespace

const TexelLayout& texel_layout(TexelFormat format) {
  const TexelLayout& layout = kLayouts[static_cast<std::size_t>(format)];
  CANDELA_CHECK(layout.format == format);
  return layout;
}

std::span<const TexelLayout> texel_layouts() { return kLayouts; }

TexelFormat parse_texel_format(std::string_view name) {
  std::string known;
  for (const TexelLayout& layout : kLayouts) {
    if (!layout.is_float) continue;
    if (layout.name == name) return layout.format;
    known += (known.empty() ? "" : ", ") + std::string(layout.name);
  }
  throw Error("unknown texel format \"" + std::string(name) + "\"; known are " + known);
}

EncodingLoss& EncodingLoss::operator+=(const EncodingLoss& other) {
  clamped += other.clamped;
  negative += other.negative;
  non_finite += other.non_finite;
  largest = std::max(largest, other.largest);
  return *this;
}

float texel_maximum(TexelFormat format) {
  if (format == TexelFormat::rgb9e5) return kSharedMaximum;
  if (format == TexelFormat::r11g11b10f) return largest_small_float(5);
  const TexelLayout& layout = texel_layout(format);
  if (!layout.is_float) return 1.0f;
  return layout.type_bytes == 2 ? largest_small_float(10) : std::numeric_limits<float>::max();
}

std::uint16_t half_from_float(float value) {
  if (std::isnan(value)) return 0;
  const std::uint32_t sign = std::signbit(value) ? 0x8000u : 0u;
  return static_cast<std::uint16_t>(sign | small_float(std::abs(value), 10));
}

float float_from_half(std::uint16_t code) {
  const float magnitude = from_small_float(code & 0x7fffu, 10);
  return (code & 0x8000u) != 0 ? -magnitude : magnitude;
}

std::uint32_t rgb9e5_from_color(vec3 color) {
  const auto clamped = [](float v) { return v > 0.0f ? std::min(v, kSharedMaximum) : 0.0f; };
  const vec3 c(clamped(color.x), clamped(color.y), clamped(color.z));
  const float largest = max_component(c);
  if (largest == 0.0f) return 0;
  // The smallest exponent whose mantissa holds the largest channel; rounding may need one more.
  int exponent = std::max(std::ilogb(largest), -kExponentBias - 1) + 1 + kExponentBias;
  const auto mantissa = [&](float v) {
    return static_cast<std::uint32_t>(std::floor(std::ldexp(v, kExponentBias + kSharedMantissaBits - exponent) + 0.5f));
  };
  if (mantissa(largest) == 1u << kSharedMantissaBits) ++exponent;
  return mantissa(c.x) | mantissa(c.y) << 9 | mantissa(c.z) << 18 | static_cast<std::uint32_t>(exponent) << 27;
}

vec3 color_from_rgb9e5(std::uint32_t code) {
  const float scale = std::ldexp(1.0f, static_cast<int>(code >> 27) - kExponentBias - kSharedMantissaBits);
  const auto channel = [&](unsigned shift) { return static_cast<float>(code >> shift & 511u) * scale; };
  return {channel(0), channel(9), channel(18)};
}

std::uint32_t r11g11b10f_from_color(vec3 color) {
  return small_float(color.x, 6) | small_float(color.y, 6) << 11 | small_float(color.z, 5) << 22;
}

vec3 color_from_r11g11b10f(std::uint32_t code) {
  return {from_small_float(code & 0x7ffu, 6), from_small_float(code >> 11 & 0x7ffu, 6),
          from_small_float(code >> 22, 5)};
}

EncodingLoss encode_texels(TexelFormat format, std::span<const float> pixels, int channels, std::span<std::byte> out) {
  const TexelLayout& layout = texel_layout(format);
  const std::size_t count = pixels.size() / static_cast<std::size_t>(channels);
  CANDELA_CHECK(layout.is_float && out.size() == count * layout.bytes);
  EncodingLoss loss;
  for (std::size_t i = 0; i < count; ++i) {
    Rgba texel = widen(pixels.data() + i * static_cast<std::size_t>(channels), channels);
    clamp_texel(texel, layout, loss);
    store_texel(layout, texel, out.data() + i * layout.bytes);
  }
  return loss;
}

void decode_texels(TexelFormat format, std::span<const std::byte> texels, int channels, std::span<float> out) {
  const TexelLayout& layout = texel_layout(format);
  const std::size_t count = texels.size() / layout.bytes;
  CANDELA_CHECK(out.size() == count * static_cast<std::size_t>(channels));
  for (std::size_t i = 0; i < count; ++i) {
    const Rgba texel = load_texel(layout, texels.data() + i * layout.bytes);
    std::copy_n(texel.v.begin(), channels, out.begin() + static_cast<std::ptrdiff_t>(i) * channels);
  }
}

}  // namespace candela
