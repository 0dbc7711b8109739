#include <vector>

#include "base/error.h"
#include "foreign/little_endian.h"
#include "foreign/old_pictures.h"
#include "foreign/texel_canvas.h"

namespace candela::foreign {

namespace {

constexpr std::size_t kHeader = 18;
enum Kind : unsigned { kind_mapped = 1, kind_color = 2, kind_grey = 3 };

struct Header {
  unsigned kind = 0;
  bool is_packed = false;  ///< by run lengths
  bool has_map = false;
  std::size_t data = 0;  ///< where the map begins, and the texels behind it
  std::size_t map_first = 0, map_count = 0;
  int map_bits = 0, bits = 0, alpha_bits = 0;
  std::uint32_t width = 0, height = 0;
  bool is_mirrored = false, is_top_down = false;

  /// Bits of what a texel looks like in the end.
  int color_bits() const { return kind == kind_mapped ? map_bits : bits; }
};

std::size_t bytes_of(int bits) { return static_cast<std::size_t>(bits + 7) / 8; }

Header read_header(std::string_view text) {
  const auto byte = [&](std::size_t at) { return little_endian(text, at, 1); };
  Header h;
  h.data = kHeader + byte(0);
  h.has_map = byte(1) == 1;
  h.is_packed = (byte(2) & 8) != 0;
  h.kind = byte(2) & ~8u;
  h.map_first = little_endian(text, 3, 2);
  h.map_count = little_endian(text, 5, 2);
  h.map_bits = static_cast<int>(byte(7));
  h.width = little_endian(text, 12, 2);
  h.height = little_endian(text, 14, 2);
  h.bits = static_cast<int>(byte(16));
  h.alpha_bits = static_cast<int>(byte(17) & 15);
  h.is_mirrored = (byte(17) & 16) != 0;
  h.is_top_down = (byte(17) & 32) != 0;
  return h;
}

bool is_color_depth(int bits) { return bits == 15 || bits == 16 || bits == 24 || bits == 32; }

bool makes_sense(const Header& h, std::string_view text) {
  const bool is_known = h.kind == kind_mapped ? h.has_map && (h.bits == 8 || h.bits == 16) && is_color_depth(h.map_bits)
                        : h.kind == kind_color ? is_color_depth(h.bits)
                                               : h.kind == kind_grey && (h.bits == 8 || h.bits == 16);
  // Bytes 1 and 17: the kind of map, and two bits of interleaving that nobody uses.
  return is_known && little_endian(text, 1, 1) <= 1 && (little_endian(text, 17, 1) & 0xC0) == 0 && h.width > 0 &&
         h.height > 0;
}

/// One texel, or one of the map's, as it stands.
Texel color_of(std::string_view text, std::size_t at, int bits) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[at + i]); };
  if (bits >= 24) return {byte(2), byte(1), byte(0), bits == 32 ? byte(3) : std::uint8_t{255}};
  const std::uint32_t word = little_endian(text, at, 2);
  return {scaled_to_byte(word >> 10 & 31, 5), scaled_to_byte(word >> 5 & 31, 5), scaled_to_byte(word & 31, 5),
          static_cast<std::uint8_t>(word >> 15 != 0 ? 255 : 0)};
}

/// Reads texels one after the other, runs unrolled.
class Reader {
 public:
  Reader(std::string_view text, const Header& h, std::size_t at, std::vector<Texel> map, const std::string& where)
      : text_(text), header_(h), at_(at), map_(std::move(map)), where_(where) {}

  Texel next() {
    if (!header_.is_packed) return read();
    if (left_ == 0) {
      require(1);
      const unsigned packet = little_endian(text_, at_++, 1);
      left_ = (packet & 127) + 1;
      is_run_ = packet >= 128;
      if (is_run_) texel_ = read();
    }
    --left_;
    return is_run_ ? texel_ : read();
  }

 private:
  void require(std::size_t count) const {
    if (count > text_.size() - at_) throw Error("a TGA that is cut short", where_);
  }
  Texel read() {
    const std::size_t size = bytes_of(header_.bits);
    require(size);
    const std::size_t at = at_;
    at_ += size;
    if (header_.kind == kind_color) return color_of(text_, at, header_.bits);
    if (header_.kind == kind_grey) {
      const auto grey = static_cast<std::uint8_t>(text_[at]);
      return {grey, grey, grey, size == 2 ? static_cast<std::uint8_t>(text_[at + 1]) : std::uint8_t{255}};
    }
    const std::size_t index = little_endian(text_, at, size) - header_.map_first;  // below the first it wraps around
    if (index >= map_.size()) throw Error("a TGA whose texel is beyond its colour map", where_);
    return map_[index];
  }

  std::string_view text_;
  const Header& header_;
  std::size_t at_;
  std::vector<Texel> map_;
  const std::string& where_;
  unsigned left_ = 0;
  bool is_run_ = false;
  Texel texel_{};
};

}  // namespace

bool is_tga(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return text.size() >= kHeader && makes_sense(read_header(text), text);
}

TextureImage decode_tga(std::span<const std::byte> bytes, const std::string& where) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!is_tga(bytes)) throw Error("no TGA", where);
  const Header h = read_header(text);
  const std::size_t map_bytes = h.has_map ? h.map_count * bytes_of(h.map_bits) : 0;
  const std::size_t data = h.data + map_bytes;
  // A packet of one byte and a texel stands for 128 at most.
  const std::uint64_t texels = std::uint64_t{h.width} * h.height;
  const std::uint64_t least = h.is_packed ? (texels + 127) / 128 * (1 + bytes_of(h.bits)) : texels * bytes_of(h.bits);
  if (data > text.size() || least > text.size() - data) throw Error("a TGA that is cut short", where);
  std::vector<Texel> map;
  for (std::size_t i = 0; h.kind == kind_mapped && i < h.map_count; ++i) {
    map.push_back(color_of(text, h.data + i * bytes_of(h.map_bits), h.map_bits));
  }
  Canvas canvas(h.width, h.height, where);
  Reader reader(text, h, data, std::move(map), where);
  for (std::size_t y = 0; y < canvas.height(); ++y) {
    for (std::size_t x = 0; x < canvas.width(); ++x) {
      canvas.set(h.is_mirrored ? canvas.width() - 1 - x : x, h.is_top_down ? y : canvas.height() - 1 - y,
                 reader.next());
    }
  }
  return canvas.finish(h.alpha_bits > 0 && (h.color_bits() == 16 || h.color_bits() == 32));
}

}  // namespace candela::foreign
