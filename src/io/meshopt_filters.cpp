#include "io/meshopt_filters.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

// KHR_meshopt_compression, appendix B.

namespace candela::io {

namespace {

/// Calls f with the components of each element, and writes what it leaves in them.
template <class T, std::size_t N, class F>
void each_element(std::size_t count, std::uint8_t* data, const F& f) {
  for (std::size_t i = 0; i < count; ++i) {
    std::array<T, N> v;
    std::memcpy(v.data(), data + i * sizeof v, sizeof v);
    f(v);
    std::memcpy(data + i * sizeof v, v.data(), sizeof v);
  }
}

/// Nearest integer, halves away from zero, of numbers far smaller than those of an int.
int rounded(float x) { return static_cast<int>(x + (x < 0.0f ? -0.5f : 0.5f)); }

/// A unit vector on the octahedron: x, y and 1.0 as integers of as many bits.
template <class T>
void decode_octahedral(std::array<T, 4>& v) {
  constexpr float kMost = std::numeric_limits<T>::max();
  const float one = v[2] == 0 ? 1.0f : static_cast<float>(v[2]);
  float x = static_cast<float>(v[0]) / one, y = static_cast<float>(v[1]) / one;
  const float z = 1.0f - std::fabs(x) - std::fabs(y);
  const float fold = std::min(z, 0.0f);  // of the lower half
  x -= std::copysign(fold, x);
  y -= std::copysign(fold, y);
  const float scale = kMost / std::sqrt(x * x + y * y + z * z);
  v[0] = static_cast<T>(rounded(x * scale));
  v[1] = static_cast<T>(rounded(y * scale));
  v[2] = static_cast<T>(rounded(z * scale));
}

/// Three components of a unit quaternion and which one, the largest, is left out.
void decode_quaternion(std::array<std::int16_t, 4>& v) {
  constexpr float kMost = std::numeric_limits<std::int16_t>::max();
  const float scale = 1.0f / (std::numbers::sqrt2_v<float> * static_cast<float>(v[3] | 3));
  const float x = static_cast<float>(v[0]) * scale, y = static_cast<float>(v[1]) * scale;
  const float z = static_cast<float>(v[2]) * scale;
  const float w = std::sqrt(std::max(0.0f, 1.0f - x * x - y * y - z * z));
  const auto largest = static_cast<unsigned>(v[3]) & 3u;
  const auto to_word = [](float f) { return static_cast<std::int16_t>(std::clamp(rounded(f * kMost), -32767, 32767)); };
  v[(largest + 1) & 3u] = to_word(x);
  v[(largest + 2) & 3u] = to_word(y);
  v[(largest + 3) & 3u] = to_word(z);
  v[largest] = to_word(w);
}

/// A float as a mantissa of 24 bits below an exponent of 8.
void decode_exponential(std::array<std::uint32_t, 1>& v) {
  const auto signed_bits = static_cast<std::int32_t>(v[0]);
  const std::int32_t exponent = std::clamp(signed_bits >> 24, -100, 100);
  const std::int32_t mantissa = static_cast<std::int32_t>(v[0] << 8) >> 8;
  const auto power = std::bit_cast<float>(static_cast<std::uint32_t>(exponent + 127) << 23);
  v[0] = std::bit_cast<std::uint32_t>(power * static_cast<float>(mantissa));
}

/// Luma, two differences of colour, and alpha below a bit that says how many bits each has.
template <class T>
void decode_color(std::array<T, 4>& v) {
  using Signed = std::make_signed_t<T>;
  constexpr float kMost = std::numeric_limits<T>::max();
  const int most = static_cast<int>(std::bit_ceil(static_cast<unsigned>(v[3]) + 1u)) - 1;
  // NOLINTNEXTLINE(bugprone-signed-char-misuse): bytes here are numbers with a sign
  const int y = v[0], co = static_cast<Signed>(v[1]), cg = static_cast<Signed>(v[2]);
  int a = v[3] & (most >> 1);
  a = a << 1 | (a & 1);
  const float scale = kMost / static_cast<float>(std::max(most, 1));
  const auto to_unit = [&](int c) {
    return static_cast<T>(std::clamp(static_cast<float>(c) * scale + 0.5f, 0.0f, kMost));
  };
  v = {to_unit(y + co - cg), to_unit(y + cg), to_unit(y - co - cg), to_unit(a)};
}

}  // namespace

void apply_meshopt_filter(const MeshoptLayout& l, std::uint8_t* data) {
  using Filter = MeshoptLayout::Filter;
  const bool is_byte = l.stride == 4;
  switch (l.filter) {
    case Filter::none:
      break;
    case Filter::octahedral:
      if (is_byte) each_element<std::int8_t, 4>(l.count, data, decode_octahedral<std::int8_t>);
      if (!is_byte) each_element<std::int16_t, 4>(l.count, data, decode_octahedral<std::int16_t>);
      break;
    case Filter::quaternion:
      each_element<std::int16_t, 4>(l.count, data, decode_quaternion);
      break;
    case Filter::exponential:
      each_element<std::uint32_t, 1>(l.count * (l.stride / 4), data, decode_exponential);
      break;
    case Filter::color:
      if (is_byte) each_element<std::uint8_t, 4>(l.count, data, decode_color<std::uint8_t>);
      if (!is_byte) each_element<std::uint16_t, 4>(l.count, data, decode_color<std::uint16_t>);
      break;
  }
}

}  // namespace candela::io
