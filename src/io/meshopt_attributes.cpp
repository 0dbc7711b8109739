#include "io/meshopt_attributes.h"

#include <algorithm>
#include <array>

#include "io/meshopt_filters.h"
#include "io/meshopt_groups.h"

// KHR_meshopt_compression, appendix A, mode 0. A block is decoded channel by channel to columns of 32-bit words, which
// filters work on; vectors of sixteen bytes are what both compilers translate to the processor's own.

namespace candela::io {

namespace {

using u8x16 = std::uint8_t __attribute__((vector_size(16)));
using u16x8 = std::uint16_t __attribute__((vector_size(16)));
using u32x4 = std::uint32_t __attribute__((vector_size(16)));

constexpr std::size_t kGroup = kMeshoptGroup;
constexpr std::size_t kMostBlockBytes = 8192;
constexpr std::size_t kMostBlockElements = 256;
constexpr std::size_t kSpill = 3 * sizeof(std::uint32_t);

/// The deltas of a channel: a row for each of its four bytes.
using Deltas = std::array<std::uint8_t, 4 * kMostBlockElements>;

u8x16 shifted_in(u8x16 v, int elements) {
  const u8x16 zero{};
  if (elements == 1)
    return __builtin_shufflevector(zero, v, 0, 0, 0, 0, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27);
  return __builtin_shufflevector(zero, v, 0, 0, 0, 0, 0, 0, 0, 0, 16, 17, 18, 19, 20, 21, 22, 23);
}

// What a channel of four bytes does with its deltas: how one is read, and how two follow each other.
struct ByteDeltas {
  u8x16 decode(u8x16 v) const { return (v >> 1) ^ (0 - (v & 1)); }
  u8x16 add(u8x16 a, u8x16 b) const { return a + b; }
};

struct WordDeltas {
  u8x16 decode(u8x16 bytes) const {
    const auto v = load_bytes<u16x8>(&bytes);
    const u16x8 d = (v >> 1) ^ (0 - (v & 1));
    return load_bytes<u8x16>(&d);
  }
  u8x16 add(u8x16 a, u8x16 b) const {
    const u16x8 sum = load_bytes<u16x8>(&a) + load_bytes<u16x8>(&b);
    return load_bytes<u8x16>(&sum);
  }
};

struct XorDeltas {
  unsigned turn;  ///< to the left, by the encoder: the extension gives its direction, not the decoder's

  u8x16 decode(u8x16 bytes) const {
    const auto v = load_bytes<u32x4>(&bytes);
    const u32x4 d = (v >> turn) | (v << ((32 - turn) & 31));
    return load_bytes<u8x16>(&d);
  }
  u8x16 add(u8x16 a, u8x16 b) const { return a ^ b; }
};

/// Puts the four bytes of a channel together and sums up the deltas, from `last` on; whole groups.
template <class How>
void sum_channel(const How& how, const Deltas& deltas, std::size_t count, std::uint32_t last, std::uint32_t* column) {
  constexpr std::size_t kRow = kMostBlockElements;
  const u32x4 start{last, last, last, last};
  auto before = load_bytes<u8x16>(&start);
  for (std::size_t i = 0; i < count; i += kGroup) {
    const std::uint8_t* rows = deltas.data() + i;
    const auto a = load_bytes<u8x16>(rows), b = load_bytes<u8x16>(rows + kRow);
    const auto c = load_bytes<u8x16>(rows + 2 * kRow), d = load_bytes<u8x16>(rows + 3 * kRow);
    const u8x16 ab_low = __builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    const u8x16 ab_high = __builtin_shufflevector(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
    const u8x16 cd_low = __builtin_shufflevector(c, d, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    const u8x16 cd_high = __builtin_shufflevector(c, d, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
    const std::array<u8x16, 4> elements{
        __builtin_shufflevector(ab_low, cd_low, 0, 1, 16, 17, 2, 3, 18, 19, 4, 5, 20, 21, 6, 7, 22, 23),
        __builtin_shufflevector(ab_low, cd_low, 8, 9, 24, 25, 10, 11, 26, 27, 12, 13, 28, 29, 14, 15, 30, 31),
        __builtin_shufflevector(ab_high, cd_high, 0, 1, 16, 17, 2, 3, 18, 19, 4, 5, 20, 21, 6, 7, 22, 23),
        __builtin_shufflevector(ab_high, cd_high, 8, 9, 24, 25, 10, 11, 26, 27, 12, 13, 28, 29, 14, 15, 30, 31)};
    for (std::size_t k = 0; k < elements.size(); ++k) {
      u8x16 v = how.decode(elements[k]);
      v = how.add(v, shifted_in(v, 1));
      v = how.add(v, shifted_in(v, 2));
      v = how.add(v, before);
      before = __builtin_shufflevector(v, v, 12, 13, 14, 15, 12, 13, 14, 15, 12, 13, 14, 15, 12, 13, 14, 15);
      store_bytes(column + i + 4 * k, v);
    }
  }
}

/// Columns of a block's channels to its elements. Four elements and four words of each are written at once; words of
/// columns that are not there lie over the next element, which overwrites them, or behind the last: kSpill bytes.
void interleave(const std::uint32_t* columns, std::size_t height, std::size_t channels, std::size_t count,
                std::uint8_t* out) {
  constexpr std::size_t kWord = sizeof(std::uint32_t);
  for (std::size_t i = 0; i < count; i += 4) {
    for (std::size_t quad = (channels + 3) / 4; quad-- > 0;) {
      const std::uint32_t* from = columns + 4 * quad * height + i;
      const auto a = load_bytes<u32x4>(from), b = load_bytes<u32x4>(from + height);
      const auto c = load_bytes<u32x4>(from + 2 * height), d = load_bytes<u32x4>(from + 3 * height);
      const u32x4 ab_low = __builtin_shufflevector(a, b, 0, 4, 1, 5),
                  ab_high = __builtin_shufflevector(a, b, 2, 6, 3, 7);
      const u32x4 cd_low = __builtin_shufflevector(c, d, 0, 4, 1, 5),
                  cd_high = __builtin_shufflevector(c, d, 2, 6, 3, 7);
      std::uint8_t* to = out + (i * channels + 4 * quad) * kWord;
      store_bytes(to, __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5));
      store_bytes(to + channels * kWord, __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7));
      store_bytes(to + 2 * channels * kWord, __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5));
      store_bytes(to + 3 * channels * kWord, __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7));
    }
  }
}

/// The same of two columns.
void interleave_two(const std::uint32_t* columns, std::size_t height, std::size_t count, std::uint8_t* out) {
  for (std::size_t i = 0; i < count; i += 4) {
    const auto a = load_bytes<u32x4>(columns + i), b = load_bytes<u32x4>(columns + height + i);
    store_bytes(out + 8 * i, __builtin_shufflevector(a, b, 0, 4, 1, 5));
    store_bytes(out + 8 * i + 16, __builtin_shufflevector(a, b, 2, 6, 3, 7));
  }
}

/// Decodes a view block by block.
class AttributeDecoder {
 public:
  AttributeDecoder(std::span<const std::uint8_t> packed, const MeshoptLayout& layout);

  void decode(std::uint8_t* out);

 private:
  void decode_channel(std::size_t channel, std::size_t count, std::uint8_t controls);
  void write(std::size_t first, std::size_t count, std::uint8_t* out) const;

  MeshoptLayout layout_;
  std::size_t channels_, height_;  ///< the latter of a block's columns
  bool is_v1_;
  MeshoptStream in_;
  Deltas deltas_{};
  std::array<std::uint32_t, kMostMeshoptStride / 4> last_{};  ///< element
  std::array<std::uint8_t, kMostMeshoptStride / 4> modes_{};
  std::array<std::uint32_t, kMostBlockBytes / 4 + 3 * kMostBlockElements> columns_{};  ///< four at a time are read
};

AttributeDecoder::AttributeDecoder(std::span<const std::uint8_t> packed, const MeshoptLayout& layout)
    : layout_(layout),
      channels_(layout.stride / 4),
      height_(meshopt_block_elements(layout.stride)),
      is_v1_(!packed.empty() && packed[0] == 0xA1),
      in_(nullptr, nullptr) {
  if (packed.empty() || (packed[0] != 0xA0 && packed[0] != 0xA1)) damaged_meshopt("it has no header of attributes");
  const std::size_t tail = layout.stride + (is_v1_ ? channels_ : 0);
  const std::size_t padded_tail = std::max<std::size_t>(tail, is_v1_ ? 24 : 32);
  static_assert(kMeshoptSlack <= 24);
  if (packed.size() < 1 + padded_tail) damaged_meshopt("it ends too early");
  const std::uint8_t* end = packed.data() + packed.size();
  in_ = MeshoptStream(packed.data() + 1, end - padded_tail);
  std::memcpy(last_.data(), end - tail, layout.stride);
  if (is_v1_) std::copy_n(end - channels_, channels_, modes_.begin());
  for (const std::uint8_t mode : modes_) {
    if ((mode & 15) > 2 || ((mode & 15) < 2 && mode > 1)) damaged_meshopt("a channel has an unknown mode");
  }
}

/// `controls`: two bits for each byte of the channel, version 1 only.
void AttributeDecoder::decode_channel(std::size_t channel, std::size_t count, std::uint8_t controls) {
  std::uint32_t* column = columns_.data() + channel * height_;
  std::uint32_t& last = last_[channel];
  constexpr std::uint8_t kNothingChanges = 0xAA;
  if (is_v1_ && controls == kNothingChanges) {
    std::fill_n(column, height_, last);
    return;
  }
  for (std::size_t k = 0; k < 4; ++k) {
    std::uint8_t* row = deltas_.data() + k * kMostBlockElements;
    const unsigned control = controls >> (2 * k) & 3u;
    if (!is_v1_) {
      unpack_groups(in_, count, MeshoptWidths::v0_0_2_4_8, row);
    } else if (control == 2) {
      std::fill_n(row, kMostBlockElements, std::uint8_t{0});
    } else if (control == 3) {
      std::copy_n(in_.take(count), count, row);
    } else {
      unpack_groups(in_, count, control == 0 ? MeshoptWidths::v1_0_1_2_4 : MeshoptWidths::v1_1_2_4_8, row);
    }
  }
  const std::uint8_t mode = modes_[channel];
  if ((mode & 15) == 0) sum_channel(ByteDeltas{}, deltas_, count, last, column);
  if ((mode & 15) == 1) sum_channel(WordDeltas{}, deltas_, count, last, column);
  if ((mode & 15) == 2) sum_channel(XorDeltas{mode / 16u}, deltas_, count, last, column);
  last = column[count - 1];
}

/// Elements from `first` on.
void AttributeDecoder::write(std::size_t first, std::size_t count, std::uint8_t* out) const {
  const std::size_t bytes = count * layout_.stride;
  if (channels_ == 1) {
    std::memcpy(out, columns_.data(), bytes);
    return;
  }
  const auto write_to = [&](std::uint8_t* to) {
    if (channels_ == 2) return interleave_two(columns_.data(), height_, count, to);
    interleave(columns_.data(), height_, channels_, count, to);
  };
  if (first + count < layout_.count) return write_to(out);
  std::array<std::uint8_t, kMostBlockBytes + kSpill> rows;
  write_to(rows.data());
  std::memcpy(out, rows.data(), bytes);
}

void AttributeDecoder::decode(std::uint8_t* out) {
  for (std::size_t first = 0; first < layout_.count; first += height_) {
    const std::size_t count = std::min(layout_.count - first, height_);
    const std::uint8_t* controls = is_v1_ ? in_.take(channels_) : nullptr;
    for (std::size_t channel = 0; channel < channels_; ++channel) {
      decode_channel(channel, count, is_v1_ ? controls[channel] : std::uint8_t{0});
    }
    apply_meshopt_filter(layout_, {columns_.data(), channels_ * height_});
    write(first, count, out + first * layout_.stride);
  }
  in_.expect_end();
}

}  // namespace

std::size_t meshopt_block_elements(std::size_t stride) {
  return std::min((kMostBlockBytes / stride) & ~(kGroup - 1), kMostBlockElements);
}

void unpack_attributes(std::span<const std::uint8_t> packed, const MeshoptLayout& layout, std::uint8_t* out) {
  AttributeDecoder(packed, layout).decode(out);
}

}  // namespace candela::io
