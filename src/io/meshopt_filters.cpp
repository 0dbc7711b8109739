#include "io/meshopt_filters.h"

#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "io/meshopt_groups.h"

// KHR_meshopt_compression, appendix B. Loops run over columns, without a branch, so that a processor's vectors fill.

namespace candela::io {

namespace {

/// Elements of a block, where each has four or eight bytes.
constexpr std::size_t kElements = 256;

/// Four components of `bits` bits.
struct Four {
  std::uint32_t x, y, z, w;
};

template <int bits>
Four get(const std::uint32_t* columns, std::size_t i) {
  const std::uint32_t v = columns[i];
  if constexpr (bits == 8) return {v & 0xFF, v >> 8 & 0xFF, v >> 16 & 0xFF, v >> 24};
  const std::uint32_t v2 = columns[kElements + i];
  return {v & 0xFFFF, v >> 16, v2 & 0xFFFF, v2 >> 16};
}

template <int bits>
void set(std::uint32_t* columns, std::size_t i, Four f) {
  if constexpr (bits == 8) {
    columns[i] = (f.x & 0xFF) | (f.y & 0xFF) << 8 | (f.z & 0xFF) << 16 | f.w << 24;
  } else {
    columns[i] = (f.x & 0xFFFF) | f.y << 16;
    columns[kElements + i] = (f.z & 0xFFFF) | f.w << 16;
  }
}

template <int bits>
int with_sign(std::uint32_t v) {
  return static_cast<int>(v << (32 - bits)) >> (32 - bits);
}

/// Nearest integer, halves away from zero, of numbers far smaller than those of an int.
std::uint32_t rounded(float x) { return static_cast<std::uint32_t>(static_cast<int>(x + std::copysign(0.5f, x))); }

/// Unit vectors on the octahedron: x, y and 1.0 as integers of as many bits.
template <int bits>
void decode_octahedral(std::uint32_t* columns) {
  constexpr float kMost = (1 << (bits - 1)) - 1;
  for (std::size_t i = 0; i < kElements; ++i) {
    const Four v = get<bits>(columns, i);
    const int given = with_sign<bits>(v.z);
    const float one = given == 0 ? 1.0f : static_cast<float>(given);
    float x = static_cast<float>(with_sign<bits>(v.x)) / one, y = static_cast<float>(with_sign<bits>(v.y)) / one;
    const float z = 1.0f - std::fabs(x) - std::fabs(y);
    const float fold = z < 0.0f ? z : 0.0f;  // of the lower half
    x -= std::copysign(fold, x);
    y -= std::copysign(fold, y);
    const float scale = kMost / std::sqrt(x * x + y * y + z * z);
    set<bits>(columns, i, {rounded(x * scale), rounded(y * scale), rounded(z * scale), v.w});
  }
}

/// Three components of unit quaternions and which one, the largest, is left out.
void decode_quaternion(std::uint32_t* columns) {
  constexpr float kMost = std::numeric_limits<std::int16_t>::max();
  for (std::size_t i = 0; i < kElements; ++i) {
    const Four v = get<16>(columns, i);
    const int bits_of_one = with_sign<16>(v.w) | 3;
    const float scale = 1.0f / (std::numbers::sqrt2_v<float> * static_cast<float>(bits_of_one));
    const float x = static_cast<float>(with_sign<16>(v.x)) * scale;
    const float y = static_cast<float>(with_sign<16>(v.y)) * scale;
    const float z = static_cast<float>(with_sign<16>(v.z)) * scale;
    const float square = 1.0f - x * x - y * y - z * z;
    const float w = std::sqrt(square > 0.0f ? square : 0.0f);
    const auto to_word = [](float f) {
      const auto word = static_cast<int>(rounded(f * kMost));
      return static_cast<std::uint32_t>(word < -32767 ? -32767 : word > 32767 ? 32767 : word) & 0xFFFF;
    };
    // The one left out, then those after it, turned to where they belong.
    const std::uint32_t a = to_word(w) | to_word(x) << 16, b = to_word(y) | to_word(z) << 16;
    const std::uint32_t a1 = a << 16 | b >> 16, b1 = b << 16 | a >> 16;
    const bool is_odd = (v.w & 1) != 0, is_beyond = (v.w & 2) != 0;
    const std::uint32_t a2 = is_odd ? a1 : a, b2 = is_odd ? b1 : b;
    columns[i] = is_beyond ? b2 : a2;
    columns[kElements + i] = is_beyond ? a2 : b2;
  }
}

/// Floats as a mantissa of 24 bits below an exponent of 8.
void decode_exponential(std::span<std::uint32_t, kMeshoptGroup> words) {
  for (std::uint32_t& word : words) {
    const std::int32_t most = static_cast<std::int32_t>(word) >> 24;
    const std::int32_t exponent = most < -100 ? -100 : most > 100 ? 100 : most;
    const std::int32_t mantissa = static_cast<std::int32_t>(word << 8) >> 8;
    const auto power = std::bit_cast<float>(static_cast<std::uint32_t>(exponent + 127) << 23);
    word = std::bit_cast<std::uint32_t>(power * static_cast<float>(mantissa));
  }
}

/// Luma, two differences of colour, and alpha below a bit that says how many bits each has.
template <int bits>
void decode_color(std::uint32_t* columns) {
  constexpr float kMost = (1 << bits) - 1;
  for (std::size_t i = 0; i < kElements; ++i) {
    const Four v = get<bits>(columns, i);
    const auto alpha = static_cast<int>(v.w);
    int most = alpha;
    most |= most >> 1;
    most |= most >> 2;
    most |= most >> 4;
    most |= most >> 8;
    const int y = static_cast<int>(v.x), co = with_sign<bits>(v.y), cg = with_sign<bits>(v.z);
    int a = alpha & (most >> 1);
    a = a << 1 | (a & 1);
    const float scale = kMost / static_cast<float>(most < 1 ? 1 : most);
    const auto to_unit = [&](int c) {
      const float unit = static_cast<float>(c) * scale + 0.5f;
      return static_cast<std::uint32_t>(static_cast<int>(unit < 0.0f ? 0.0f : unit > kMost ? kMost : unit));
    };
    set<bits>(columns, i, {to_unit(y + co - cg), to_unit(y + cg), to_unit(y - co - cg), to_unit(a)});
  }
}

}  // namespace

void apply_meshopt_filter(const MeshoptLayout& l, std::span<std::uint32_t> columns) {
  using Filter = MeshoptLayout::Filter;
  const bool is_byte = l.stride == 4;
  switch (l.filter) {
    case Filter::none:
      break;
    case Filter::octahedral:
      is_byte ? decode_octahedral<8>(columns.data()) : decode_octahedral<16>(columns.data());
      break;
    case Filter::quaternion:
      decode_quaternion(columns.data());
      break;
    case Filter::exponential:
      for (; !columns.empty(); columns = columns.subspan(kMeshoptGroup)) {
        decode_exponential(columns.first<kMeshoptGroup>());
      }
      break;
    case Filter::color:
      is_byte ? decode_color<8>(columns.data()) : decode_color<16>(columns.data());
      break;
  }
}

}  // namespace candela::io
