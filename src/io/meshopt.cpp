#include "io/meshopt.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "base/check.h"
#include "io/meshopt_attributes.h"
#include "io/meshopt_stream.h"

// Written from KHR_meshopt_compression, appendix A; here modes 1 and 2, the indices.

namespace candela::io {

namespace {

using u8x16 = std::uint8_t __attribute__((vector_size(16)));
using u16x8 = std::uint16_t __attribute__((vector_size(16)));
using u16x4 = std::uint16_t __attribute__((vector_size(8)));
using u32x4 = std::uint32_t __attribute__((vector_size(16)));
using u64x2 = std::uint64_t __attribute__((vector_size(16)));

constexpr std::size_t kTriangleTail = 16;
constexpr std::size_t kIndexTail = 4;

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
  void add_four(u32x4 indices) {
    if constexpr (sizeof(T) == sizeof(std::uint32_t)) {
      store_bytes(out_, indices);
    } else {
      store_bytes(out_, __builtin_convertvector(indices, u16x4));
    }
    out_ += 4 * sizeof(T);
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
    if (age >= count_) damaged_meshopt("it refers to what was not there yet");
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
  TriangleDecoder(MeshoptStream data, const std::uint8_t* aux, IndexWriter<T> out)
      : data_(data), aux_(aux), out_(out) {}

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

  MeshoptStream data_;
  const std::uint8_t* aux_;
  IndexWriter<T> out_;
  Recent<Edge> edges_;
  Recent<std::uint32_t> vertices_;
  std::uint32_t next_ = 0, last_ = 0;
};

template <class T>
void unpack_triangles(std::span<const std::uint8_t> packed, std::size_t count, IndexWriter<T> out) {
  if (packed.empty() || packed[0] != 0xE1) damaged_meshopt("it has no header of triangles");
  const std::size_t triangles = count / 3;
  if (packed.size() < 1 + triangles + kTriangleTail) damaged_meshopt("it ends too early");
  const std::uint8_t* end = packed.data() + packed.size() - kTriangleTail;
  for (std::size_t i = 0; i < kTriangleTail; ++i) {
    if ((end[i] & 15) == 15 || end[i] >> 4 == 15 || (i >= 14 && end[i] != 0))
      damaged_meshopt("its table of codes is wrong");
  }
  const std::uint8_t* codes = packed.data() + 1;
  TriangleDecoder<T> decoder(MeshoptStream(codes + triangles, end), end, out);
  for (std::size_t i = 0; i < triangles; ++i) decoder.decode(codes[i]);
  decoder.finish();
}

/// The last index of each of two kinds, which a number's lowest bit tells apart.
struct LastIndices {
  std::uint32_t even = 0, odd = 0;

  std::uint32_t next(std::uint32_t number) {
    std::uint32_t& last = (number & 1u) != 0 ? odd : even;
    return last += unzigzag(number >> 1);
  }
};

u16x8 running_sum(u16x8 v) {
  const u16x8 zero{};
  v += __builtin_shufflevector(zero, v, 0, 8, 9, 10, 11, 12, 13, 14);
  v += __builtin_shufflevector(zero, v, 0, 0, 8, 9, 10, 11, 12, 13);
  v += __builtin_shufflevector(zero, v, 0, 0, 0, 0, 8, 9, 10, 11);
  return v;
}

constexpr std::size_t kAtOnce = 8;

/// Eight at once, of as many numbers below 128, so that their sums are numbers of 16 bits with a sign.
std::array<u32x4, 2> next_indices(const std::uint8_t* numbers, LastIndices& last) {
  const u64x2 padded{load_bytes<std::uint64_t>(numbers), 0};
  const auto bytes = reinterpret_cast<u8x16>(padded);
  const u8x16 words = __builtin_shufflevector(bytes, u8x16{}, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  const auto v = reinterpret_cast<u16x8>(words);
  const u16x8 is_odd = 0 - (v & 1), code = v >> 1, delta = (code >> 1) ^ (0 - (code & 1));
  const u16x8 evens = running_sum(delta & ~is_odd), odds = running_sum(delta & is_odd);
  const u16x8 sums = (evens & ~is_odd) | (odds & is_odd), signs = 0 - (sums >> 15);
  const u32x4 even{last.even, last.even, last.even, last.even}, odd{last.odd, last.odd, last.odd, last.odd};
  const auto indices = [&](u16x8 change, u16x8 odd_ones) {
    const auto use_odd = reinterpret_cast<u32x4>(odd_ones);
    return reinterpret_cast<u32x4>(change) + ((even & ~use_odd) | (odd & use_odd));
  };
  last.even += static_cast<std::uint32_t>(static_cast<std::int16_t>(evens[7]));
  last.odd += static_cast<std::uint32_t>(static_cast<std::int16_t>(odds[7]));
  return {indices(__builtin_shufflevector(sums, signs, 0, 8, 1, 9, 2, 10, 3, 11),
                  __builtin_shufflevector(is_odd, is_odd, 0, 0, 1, 1, 2, 2, 3, 3)),
          indices(__builtin_shufflevector(sums, signs, 4, 12, 5, 13, 6, 14, 7, 15),
                  __builtin_shufflevector(is_odd, is_odd, 4, 4, 5, 5, 6, 6, 7, 7))};
}

template <class T>
void unpack_indices(std::span<const std::uint8_t> packed, std::size_t count, IndexWriter<T> out) {
  if (packed.empty() || packed[0] != 0xD1) damaged_meshopt("it has no header of indices");
  if (packed.size() < 1 + kIndexTail) damaged_meshopt("it ends too early");
  MeshoptStream in(packed.data() + 1, packed.data() + packed.size() - kIndexTail);
  LastIndices last;
  for (std::size_t i = 0; i < count;) {
    constexpr std::uint64_t kGoOn = 0x8080808080808080;
    if (count - i >= kAtOnce && in.left() >= kAtOnce && (load_bytes<std::uint64_t>(in.peek()) & kGoOn) == 0) {
      for (const u32x4 four : next_indices(in.take(kAtOnce), last)) out.add_four(four);
      i += kAtOnce;
    } else {
      out.add(last.next(in.varint()));
      ++i;
    }
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
  if (l.stride == 0 || l.stride % 4 != 0 || l.stride > kMostMeshoptStride) {
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
  const std::size_t most = meshopt_block_elements(l.stride);
  return 1 + (l.count + most - 1) / most * (l.stride / 4) + std::max<std::size_t>(l.stride, 24);
}

void decode_meshopt(std::span<const std::byte> packed, const MeshoptLayout& layout, std::span<std::byte> decoded) {
  CANDELA_CHECK(decoded.size() == layout.count * layout.stride);
  if (packed.size() < meshopt_least_bytes(layout)) damaged_meshopt("it is too short for its count");
  auto* out = reinterpret_cast<std::uint8_t*>(decoded.data());
  const std::span<const std::uint8_t> in(reinterpret_cast<const std::uint8_t*>(packed.data()), packed.size());
  switch (layout.mode) {
    case MeshoptLayout::Mode::attributes:
      unpack_attributes(in, layout, out);
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
}

}  // namespace candela::io
