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

/// As many elements as are worked on at once: one component after the other, so that a processor's vectors fill.
constexpr std::size_t kBatch = 256;
template <class N>
using Column = std::array<N, kBatch>;

/// Calls f with kBatch elements at a time, four components each, and writes what it leaves in them.
template <class T, class F>
void each_batch(std::size_t count, std::uint8_t* data, const F& f) {
  std::array<T, 4 * kBatch> elements{};
  std::array<Column<int>, 4> v;
  for (std::size_t first = 0; first < count; first += kBatch) {
    std::uint8_t* here = data + first * 4 * sizeof(T);
    const std::size_t bytes = std::min(count - first, kBatch) * 4 * sizeof(T);
    std::memcpy(elements.data(), here, bytes);
    for (std::size_t i = 0; i < kBatch; ++i) {
      // NOLINTNEXTLINE(bugprone-signed-char-misuse): bytes here are numbers with a sign
      for (std::size_t k = 0; k < 4; ++k) v[k][i] = static_cast<int>(elements[4 * i + k]);
    }
    f(v);
    for (std::size_t i = 0; i < kBatch; ++i) {
      for (std::size_t k = 0; k < 4; ++k) elements[4 * i + k] = static_cast<T>(v[k][i]);
    }
    std::memcpy(here, elements.data(), bytes);
  }
}

/// Nearest integer, halves away from zero, of numbers far smaller than those of an int.
int rounded(float x) { return static_cast<int>(x + std::copysign(0.5f, x)); }

/// Unit vectors on the octahedron: x, y and 1.0 as integers of as many bits.
template <class T>
void decode_octahedral(std::array<Column<int>, 4>& v) {
  constexpr float kMost = std::numeric_limits<T>::max();
  for (std::size_t i = 0; i < kBatch; ++i) {
    const float one = v[2][i] == 0 ? 1.0f : static_cast<float>(v[2][i]);
    float x = static_cast<float>(v[0][i]) / one, y = static_cast<float>(v[1][i]) / one;
    const float z = 1.0f - std::fabs(x) - std::fabs(y);
    const float fold = z < 0.0f ? z : 0.0f;  // of the lower half
    x -= std::copysign(fold, x);
    y -= std::copysign(fold, y);
    const float scale = kMost / std::sqrt(x * x + y * y + z * z);
    v[0][i] = rounded(x * scale);
    v[1][i] = rounded(y * scale);
    v[2][i] = rounded(z * scale);
  }
}

/// Three components of unit quaternions and which one, the largest, is left out.
void decode_quaternion(std::array<Column<int>, 4>& v) {
  constexpr float kMost = std::numeric_limits<std::int16_t>::max();
  for (std::size_t i = 0; i < kBatch; ++i) {
    const float scale = 1.0f / (std::numbers::sqrt2_v<float> * static_cast<float>(v[3][i] | 3));
    const float x = static_cast<float>(v[0][i]) * scale, y = static_cast<float>(v[1][i]) * scale;
    const float z = static_cast<float>(v[2][i]) * scale;
    const float square = 1.0f - x * x - y * y - z * z;
    const float w = std::sqrt(square > 0.0f ? square : 0.0f);
    const auto to_word = [](float f) {
      const int word = rounded(f * kMost);
      return word < -32767 ? -32767 : word > 32767 ? 32767 : word;
    };
    const int first = to_word(x), second = to_word(y), third = to_word(z), left_out = to_word(w);
    const int largest = v[3][i] & 3;
    for (int k = 0; k < 4; ++k) {
      const int place = (k - largest) & 3;  // after the one left out
      v[static_cast<std::size_t>(k)][i] = place == 0 ? left_out : place == 1 ? first : place == 2 ? second : third;
    }
  }
}

/// Floats as a mantissa of 24 bits below an exponent of 8.
void decode_exponential(std::size_t count, std::uint8_t* data) {
  Column<std::uint32_t> words{};
  for (std::size_t first = 0; first < count; first += kBatch) {
    std::uint8_t* here = data + first * sizeof(std::uint32_t);
    const std::size_t bytes = std::min(count - first, kBatch) * sizeof(std::uint32_t);
    std::memcpy(words.data(), here, bytes);
    for (std::uint32_t& word : words) {
      const std::int32_t most = static_cast<std::int32_t>(word) >> 24;
      const std::int32_t exponent = most < -100 ? -100 : most > 100 ? 100 : most;
      const std::int32_t mantissa = static_cast<std::int32_t>(word << 8) >> 8;
      const auto power = std::bit_cast<float>(static_cast<std::uint32_t>(exponent + 127) << 23);
      word = std::bit_cast<std::uint32_t>(power * static_cast<float>(mantissa));
    }
    std::memcpy(here, words.data(), bytes);
  }
}

/// Luma, two differences of colour, and alpha below a bit that says how many bits each has.
template <class T>
void decode_color(std::array<Column<int>, 4>& v) {
  using Signed = std::make_signed_t<T>;
  constexpr float kMost = std::numeric_limits<T>::max();
  for (std::size_t i = 0; i < kBatch; ++i) {
    int most = v[3][i];
    most |= most >> 1;
    most |= most >> 2;
    most |= most >> 4;
    most |= most >> 8;
    // NOLINTNEXTLINE(bugprone-signed-char-misuse): bytes here are numbers with a sign
    const int y = v[0][i], co = static_cast<Signed>(v[1][i]), cg = static_cast<Signed>(v[2][i]);
    int a = v[3][i] & (most >> 1);
    a = a << 1 | (a & 1);
    const float scale = kMost / static_cast<float>(most < 1 ? 1 : most);
    const auto to_unit = [&](int c) {
      const float unit = static_cast<float>(c) * scale + 0.5f;
      return static_cast<int>(unit < 0.0f ? 0.0f : unit > kMost ? kMost : unit);
    };
    v[0][i] = to_unit(y + co - cg);
    v[1][i] = to_unit(y + cg);
    v[2][i] = to_unit(y - co - cg);
    v[3][i] = to_unit(a);
  }
}

}  // namespace

void apply_meshopt_filter(const MeshoptLayout& l, std::uint8_t* data) {
  using Filter = MeshoptLayout::Filter;
  const bool is_byte = l.stride == 4;
  switch (l.filter) {
    case Filter::none:
      break;
    case Filter::octahedral:
      if (is_byte) each_batch<std::int8_t>(l.count, data, decode_octahedral<std::int8_t>);
      if (!is_byte) each_batch<std::int16_t>(l.count, data, decode_octahedral<std::int16_t>);
      break;
    case Filter::quaternion:
      each_batch<std::int16_t>(l.count, data, decode_quaternion);
      break;
    case Filter::exponential:
      decode_exponential(l.count * (l.stride / 4), data);
      break;
    case Filter::color:
      if (is_byte) each_batch<std::uint8_t>(l.count, data, decode_color<std::uint8_t>);
      if (!is_byte) each_batch<std::uint16_t>(l.count, data, decode_color<std::uint16_t>);
      break;
  }
}

}  // namespace candela::io
