#include "io/meshopt.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include "base/error.h"
#include "io/meshopt_filters.h"

// Written from KHR_meshopt_compression, appendix A. Sixteen elements are decoded at a time in vectors that both
// compilers translate to the processor's own.

namespace candela::io {

namespace {

using u8x16 = std::uint8_t __attribute__((vector_size(16)));
using u16x8 = std::uint16_t __attribute__((vector_size(16)));
using u32x4 = std::uint32_t __attribute__((vector_size(16)));

constexpr std::size_t kGroup = 16;
constexpr std::size_t kMostBlockBytes = 8192;
constexpr std::size_t kMostBlockElements = 256;
constexpr std::size_t kMostStride = 256;
constexpr std::size_t kTriangleTail = 16;
constexpr std::size_t kIndexTail = 4;

[[noreturn]] void damaged(const char* what) { throw Error(std::string("damaged meshopt data: ") + what); }

/// The bytes of a stream up to its tail, in order.
class Stream {
 public:
  Stream(const std::uint8_t* begin, const std::uint8_t* end) : at_(begin), end_(end) {}

  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }
  const std::uint8_t* take(std::size_t count) {
    if (count > left()) damaged("it ends too early");
    return std::exchange(at_, at_ + count);
  }
  std::uint8_t byte() { return *take(1); }
  /// Unsigned LEB128 of at most five bytes.
  std::uint32_t varint() {
    std::uint32_t value = 0;
    for (unsigned shift = 0; shift < 35; shift += 7) {
      const std::uint8_t b = byte();
      value |= static_cast<std::uint32_t>(b & 0x7Fu) << shift;
      if (b < 0x80) return value;
    }
    damaged("a number has more than five bytes");
  }
  void expect_end() const {
    if (at_ != end_) damaged("bytes are left over");
  }

 private:
  const std::uint8_t* at_;
  const std::uint8_t* end_;
};

template <class V>
V load(const void* from) {
  V v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

template <class V>
void store(void* to, V v) {
  std::memcpy(to, &v, sizeof v);
}

// ----- mode 0: attributes

/// Each byte of packed 1-bit and 2-bit deltas as the bytes it stands for.
struct Unpacked {
  std::array<std::uint64_t, 256> one{};
  std::array<std::uint32_t, 256> two{};
};

constexpr Unpacked make_unpacked() {
  Unpacked t;
  for (unsigned b = 0; b < 256; ++b) {
    for (unsigned i = 0; i < 8; ++i) t.one[b] |= static_cast<std::uint64_t>(b >> i & 1u) << (8 * i);
    for (unsigned i = 0; i < 4; ++i) t.two[b] |= static_cast<std::uint32_t>(b >> (6 - 2 * i) & 3u) << (8 * i);
  }
  return t;
}

constexpr Unpacked kUnpacked = make_unpacked();

/// Where the bytes of a vector equal `value`: a bit for each, the first lowest.
unsigned equal_bytes(u8x16 v, std::uint8_t value) {
  const auto equal = load<std::array<std::uint64_t, 2>>(&v);
  unsigned mask = 0;
  for (unsigned half = 0; half < 2; ++half) {
    // A byte that is 0 after the XOR has its top bit clear in neither term.
    const std::uint64_t x = equal[half] ^ (0x0101010101010101u * value);
    const std::uint64_t zero = ~(((x & 0x7F7F7F7F7F7F7F7Fu) + 0x7F7F7F7F7F7F7F7Fu) | x | 0x7F7F7F7F7F7F7F7Fu);
    mask |= static_cast<unsigned>((zero >> 7) * 0x0102040810204080u >> 56) << (8 * half);
  }
  return mask;
}

/// Deltas of `bits` bits each; all ones stand for a whole byte that follows.
u8x16 unpack_group(Stream& in, unsigned bits) {
  const std::uint8_t* packed = in.take(std::size_t{2} * bits);
  u8x16 v;
  if (bits == 1) {
    const std::array<std::uint64_t, 2> spread{kUnpacked.one[packed[0]], kUnpacked.one[packed[1]]};
    v = load<u8x16>(spread.data());
  } else if (bits == 2) {
    const std::array<std::uint32_t, 4> spread{kUnpacked.two[packed[0]], kUnpacked.two[packed[1]],
                                              kUnpacked.two[packed[2]], kUnpacked.two[packed[3]]};
    v = load<u8x16>(spread.data());
  } else {
    std::array<std::uint64_t, 2> both{};
    std::memcpy(both.data(), packed, 8);
    const auto bytes = load<u8x16>(both.data());
    const u8x16 high = bytes >> 4, low = bytes & 15;
    v = __builtin_shufflevector(high, low, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  }
  unsigned wide = equal_bytes(v, static_cast<std::uint8_t>((1u << bits) - 1));
  if (wide == 0) return v;
  auto bytes = load<std::array<std::uint8_t, kGroup>>(&v);
  const std::uint8_t* next = in.take(static_cast<std::size_t>(std::popcount(wide)));
  for (; wide != 0; wide &= wide - 1) bytes[static_cast<std::size_t>(std::countr_zero(wide))] = *next++;
  return load<u8x16>(bytes.data());
}

/// The deltas of one byte of `count` elements; `lengths` by the two bits that a group's header has, 0 = none, 8 =
/// whole.
void unpack_bytes(Stream& in, std::size_t count, const std::array<unsigned, 4>& lengths, std::uint8_t* out) {
  const std::size_t groups = (count + kGroup - 1) / kGroup;
  const std::uint8_t* header = in.take((groups + 3) / 4);
  for (std::size_t g = 0; g < groups; ++g) {
    const unsigned bits = lengths[header[g / 4] >> (2 * (g % 4)) & 3u];
    u8x16 v{};
    if (bits == 8) {
      v = load<u8x16>(in.take(kGroup));
    } else if (bits != 0) {
      v = unpack_group(in, bits);
    }
    store(out + g * kGroup, v);
  }
}

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
    const auto v = load<u16x8>(&bytes);
    const u16x8 d = (v >> 1) ^ (0 - (v & 1));
    return load<u8x16>(&d);
  }
  u8x16 add(u8x16 a, u8x16 b) const {
    const u16x8 sum = load<u16x8>(&a) + load<u16x8>(&b);
    return load<u8x16>(&sum);
  }
};

struct XorDeltas {
  unsigned turn;  ///< to the left, by the encoder: the extension gives its direction, not the decoder's

  u8x16 decode(u8x16 bytes) const {
    const auto v = load<u32x4>(&bytes);
    const u32x4 d = (v >> turn) | (v << ((32 - turn) & 31));
    return load<u8x16>(&d);
  }
  u8x16 add(u8x16 a, u8x16 b) const { return a ^ b; }
};

/// Puts the four bytes of a channel together and sums up the deltas, from `last` on, which becomes the last element.
/// `deltas`: four rows of `row` bytes.
template <class Deltas>
void sum_channel(const Deltas& how, const std::uint8_t* deltas, std::size_t row, std::size_t count, std::uint8_t* last,
                 std::uint8_t* out, std::size_t stride) {
  std::uint32_t start;
  std::memcpy(&start, last, sizeof start);
  for (std::size_t i = 0; i < count; i += kGroup) {
    const auto a = load<u8x16>(deltas + i), b = load<u8x16>(deltas + row + i);
    const auto c = load<u8x16>(deltas + 2 * row + i), d = load<u8x16>(deltas + 3 * row + i);
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
      const u32x4 before{start, start, start, start};
      v = how.add(v, load<u8x16>(&before));
      const auto four = load<std::array<std::uint32_t, 4>>(&v);
      start = four[3];
      const std::size_t first = i + 4 * k;
      if (first >= count) break;
      const std::size_t here = std::min<std::size_t>(count - first, 4);
      for (std::size_t e = 0; e < here; ++e) std::memcpy(out + (first + e) * stride, &four[e], sizeof four[e]);
      std::memcpy(last, &four[here - 1], sizeof four[0]);
    }
  }
}

void sum_channel(std::uint8_t mode, const std::uint8_t* deltas, std::size_t row, std::size_t count, std::uint8_t* last,
                 std::uint8_t* out, std::size_t stride) {
  const unsigned kind = mode & 15u;
  if (kind == 0) return sum_channel(ByteDeltas{}, deltas, row, count, last, out, stride);
  if (kind == 1) return sum_channel(WordDeltas{}, deltas, row, count, last, out, stride);
  return sum_channel(XorDeltas{static_cast<unsigned>(mode >> 4)}, deltas, row, count, last, out, stride);
}

std::size_t block_elements(std::size_t stride) {
  return std::min((kMostBlockBytes / stride) & ~(kGroup - 1), kMostBlockElements);
}

void unpack_attributes(std::span<const std::uint8_t> packed, std::size_t count, std::size_t stride, std::uint8_t* out) {
  if (packed.empty() || (packed[0] != 0xA0 && packed[0] != 0xA1)) damaged("it has no header of attributes");
  const bool is_v1 = packed[0] == 0xA1;
  const std::size_t channels = stride / 4;
  const std::size_t tail = stride + (is_v1 ? channels : 0);
  const std::size_t padded_tail = std::max<std::size_t>(tail, is_v1 ? 24 : 32);
  if (packed.size() < 1 + padded_tail) damaged("it ends too early");
  std::array<std::uint8_t, kMostStride> last{};
  std::array<std::uint8_t, kMostStride / 4> modes{};
  const std::uint8_t* end = packed.data() + packed.size();
  std::copy_n(end - tail, stride, last.begin());
  if (is_v1) std::copy_n(end - channels, channels, modes.begin());
  for (const std::uint8_t mode : modes) {
    if ((mode & 15) > 2 || ((mode & 15) < 2 && mode > 1)) damaged("a channel has an unknown mode");
  }

  constexpr std::array<unsigned, 4> kV0{0, 2, 4, 8}, kNarrow{0, 1, 2, 4}, kWide{1, 2, 4, 8};
  Stream in(packed.data() + 1, end - padded_tail);
  std::array<std::uint8_t, 4 * kMostBlockElements> deltas;
  const std::size_t most = block_elements(stride);
  for (std::size_t first = 0; first < count; first += most) {
    const std::size_t here = std::min(count - first, most);
    const std::uint8_t* controls = is_v1 ? in.take(channels) : nullptr;
    for (std::size_t channel = 0; channel < channels; ++channel) {
      for (std::size_t k = 0; k < 4; ++k) {
        std::uint8_t* row = deltas.data() + k * kMostBlockElements;
        const unsigned control = is_v1 ? controls[channel] >> (2 * k) & 3u : 4;
        if (control == 2) {
          std::fill_n(row, kMostBlockElements, std::uint8_t{0});
        } else if (control == 3) {
          std::copy_n(in.take(here), here, row);
        } else {
          unpack_bytes(in, here, control == 4 ? kV0 : control == 0 ? kNarrow : kWide, row);
        }
      }
      sum_channel(modes[channel], deltas.data(), kMostBlockElements, here, last.data() + 4 * channel,
                  out + first * stride + 4 * channel, stride);
    }
  }
  in.expect_end();
}

// ----- modes 1 and 2: indices

/// Writes indices of type T.
template <class T>
class IndexWriter {
 public:
  explicit IndexWriter(std::uint8_t* out) : out_(out) {}

  void add(std::uint32_t index) {
    const T narrow = static_cast<T>(index);
    std::memcpy(out_, &narrow, sizeof narrow);
    out_ += sizeof narrow;
  }

 private:
  std::uint8_t* out_;
};

static_assert(std::endian::native == std::endian::little);

std::uint32_t unzigzag(std::uint32_t v) { return (v >> 1) ^ (0u - (v & 1u)); }

/// The last sixteen of something, the newest at 0.
template <class T>
class Recent {
 public:
  void push(T value) { entries_[count_++ & 15u] = value; }
  T operator[](unsigned age) const {
    if (age >= count_) damaged("it refers to what was not there yet");
    return entries_[(count_ - 1 - age) & 15u];
  }

 private:
  std::array<T, 16> entries_{};
  std::size_t count_ = 0;
};

/// The state of the triangle codec.
template <class T>
class TriangleDecoder {
 public:
  TriangleDecoder(Stream data, const std::uint8_t* aux, IndexWriter<T> out) : data_(data), aux_(aux), out_(out) {}

  void decode(std::uint8_t code) {
    if (code < 0xF0) {
      beside_edge(code >> 4, code & 15u);
    } else if (code < 0xFE) {
      free_triangle(aux_[code & 15u]);
    } else {
      explicit_triangle(code == 0xFE);
    }
  }
  void finish() const { data_.expect_end(); }

 private:
  using Edge = std::array<std::uint32_t, 2>;

  std::uint32_t read_index() { return last_ += unzigzag(data_.varint()); }

  void beside_edge(unsigned edge, unsigned kind) {
    const auto [a, b] = edges_[edge];
    std::uint32_t c = 0;
    if (kind == 0) {
      c = next_++;
    } else if (kind < 13) {
      c = vertices_[kind];
    } else {
      c = kind == 15 ? read_index() : last_ += kind == 13 ? ~0u : 1u;
    }
    if (kind == 0 || kind >= 13) vertices_.push(c);
    edges_.push({c, b});
    edges_.push({a, c});
    emit(a, b, c);
  }

  void free_triangle(std::uint8_t zw) {
    const unsigned z = zw >> 4, w = zw & 15u;
    const std::uint32_t a = next_++;
    const std::uint32_t b = z == 0 ? next_++ : vertices_[z - 1];
    const std::uint32_t c = w == 0 ? next_++ : vertices_[w - 1];
    remember(a, b, c, z == 0, w == 0);
  }

  void explicit_triangle(bool starts_with_next) {
    const std::uint8_t zw = data_.byte();
    if (zw == 0) next_ = 0;
    const unsigned z = zw >> 4, w = zw & 15u;
    const auto vertex = [&](unsigned which) {
      return which == 0 ? next_++ : which < 15 ? vertices_[which - 1] : read_index();
    };
    const std::uint32_t a = starts_with_next ? next_++ : read_index();
    const std::uint32_t b = vertex(z);
    const std::uint32_t c = vertex(w);
    remember(a, b, c, z == 0 || z == 15, w == 0 || w == 15);
  }

  void remember(std::uint32_t a, std::uint32_t b, std::uint32_t c, bool is_b_new, bool is_c_new) {
    edges_.push({b, a});
    edges_.push({c, b});
    edges_.push({a, c});
    vertices_.push(a);
    if (is_b_new) vertices_.push(b);
    if (is_c_new) vertices_.push(c);
    emit(a, b, c);
  }

  void emit(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    out_.add(a);
    out_.add(b);
    out_.add(c);
  }

  Stream data_;
  const std::uint8_t* aux_;
  IndexWriter<T> out_;
  Recent<Edge> edges_;
  Recent<std::uint32_t> vertices_;
  std::uint32_t next_ = 0, last_ = 0;
};

template <class T>
void unpack_triangles(std::span<const std::uint8_t> packed, std::size_t count, IndexWriter<T> out) {
  if (packed.empty() || packed[0] != 0xE1) damaged("it has no header of triangles");
  const std::size_t triangles = count / 3;
  if (packed.size() < 1 + triangles + kTriangleTail) damaged("it ends too early");
  const std::uint8_t* end = packed.data() + packed.size() - kTriangleTail;
  for (std::size_t i = 0; i < kTriangleTail; ++i) {
    if ((end[i] & 15) == 15 || end[i] >> 4 == 15 || (i >= 14 && end[i] != 0)) damaged("its table of codes is wrong");
  }
  const std::uint8_t* codes = packed.data() + 1;
  TriangleDecoder<T> decoder(Stream(codes + triangles, end), end, out);
  for (std::size_t i = 0; i < triangles; ++i) decoder.decode(codes[i]);
  decoder.finish();
}

template <class T>
void unpack_indices(std::span<const std::uint8_t> packed, std::size_t count, IndexWriter<T> out) {
  if (packed.empty() || packed[0] != 0xD1) damaged("it has no header of indices");
  if (packed.size() < 1 + kIndexTail) damaged("it ends too early");
  Stream in(packed.data() + 1, packed.data() + packed.size() - kIndexTail);
  std::array<std::uint32_t, 2> last{};
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t v = in.varint();
    std::uint32_t& baseline = last[v & 1u];
    baseline += unzigzag(v >> 1);
    out.add(baseline);
  }
  in.expect_end();
}

}  // namespace

std::string_view meshopt_fault(const MeshoptLayout& l) {
  using Filter = MeshoptLayout::Filter;
  if (l.count == 0) return "count must be at least 1";
  if (l.mode != MeshoptLayout::Mode::attributes) {
    if (l.stride != 2 && l.stride != 4) return "byteStride of indices must be 2 or 4";
    if (l.filter != Filter::none) return "indices have no filter";
    if (l.mode == MeshoptLayout::Mode::triangles && l.count % 3 != 0) return "count of triangles must divide by 3";
    return {};
  }
  if (l.stride == 0 || l.stride % 4 != 0 || l.stride > kMostStride) {
    return "byteStride of attributes must be a multiple of 4 up to 256";
  }
  if (l.filter == Filter::octahedral && l.stride != 4 && l.stride != 8)
    return "OCTAHEDRAL needs a byteStride of 4 or 8";
  if (l.filter == Filter::color && l.stride != 4 && l.stride != 8) return "COLOR needs a byteStride of 4 or 8";
  if (l.filter == Filter::quaternion && l.stride != 8) return "QUATERNION needs a byteStride of 8";
  return {};
}

std::uint64_t meshopt_least_bytes(const MeshoptLayout& l) {
  if (l.mode == MeshoptLayout::Mode::triangles) return 1 + l.count / 3 + kTriangleTail;
  if (l.mode == MeshoptLayout::Mode::indices) return 1 + l.count + kIndexTail;
  // Of a block where nothing changes the controls of version 1 remain.
  const std::size_t most = block_elements(l.stride);
  return 1 + (l.count + most - 1) / most * (l.stride / 4) + std::max<std::size_t>(l.stride, 24);
}

std::vector<std::byte> decode_meshopt(std::span<const std::byte> packed, const MeshoptLayout& layout) {
  if (packed.size() < meshopt_least_bytes(layout)) damaged("it is too short for its count");
  std::vector<std::byte> result(layout.count * layout.stride);
  auto* out = reinterpret_cast<std::uint8_t*>(result.data());
  const std::span<const std::uint8_t> in(reinterpret_cast<const std::uint8_t*>(packed.data()), packed.size());
  switch (layout.mode) {
    case MeshoptLayout::Mode::attributes:
      unpack_attributes(in, layout.count, layout.stride, out);
      apply_meshopt_filter(layout, out);
      break;
    case MeshoptLayout::Mode::triangles:
      if (layout.stride == 2) unpack_triangles(in, layout.count, IndexWriter<std::uint16_t>(out));
      if (layout.stride == 4) unpack_triangles(in, layout.count, IndexWriter<std::uint32_t>(out));
      break;
    case MeshoptLayout::Mode::indices:
      if (layout.stride == 2) unpack_indices(in, layout.count, IndexWriter<std::uint16_t>(out));
      if (layout.stride == 4) unpack_indices(in, layout.count, IndexWriter<std::uint32_t>(out));
      break;
  }
  return result;
}

}  // namespace candela::io
