#include <bit>
#include <vector>

#include "base/error.h"
#include "foreign/little_endian.h"
#include "foreign/old_pictures.h"
#include "foreign/texel_canvas.h"

// Microsoft, "Bitmap Storage" and "BITMAPV5HEADER structure"; of OS/2 the first version, whose header is shorter.
namespace candela::foreign {

namespace {

constexpr std::size_t kFileHeader = 14, kCoreHeader = 12, kInfoHeader = 40;
enum Packing : std::uint32_t { plain = 0, rle8 = 1, rle4 = 2, masks = 3, masks_with_alpha = 6 };

struct Header {
  std::size_t size = 0, data = 0;  ///< of itself; where texels begin
  std::int64_t width = 0, height = 0;
  bool is_top_down = false;
  std::uint32_t bits = 0, packing = plain;
  std::array<std::uint32_t, 4> mask{};  ///< red, green, blue, alpha
  std::vector<Texel> palette;
};

class Parser {
 public:
  Parser(std::string_view text, const std::string& where) : text_(text), where_(where) {}

  Header read_header() const;
  TextureImage decode(const Header& header) const;

 private:
  std::uint32_t number(std::size_t at, std::size_t count = 4) const {
    if (at > text_.size() || count > text_.size() - at) throw Error("a BMP that is cut short", where_);
    return little_endian(text_, at, count);
  }
  void read_masks(Header& h) const;
  void read_palette(Header& h) const;
  Texel colored(const Header& h, std::uint32_t index) const {
    if (index >= h.palette.size()) throw Error("a BMP whose texel is beyond its palette", where_);
    return h.palette[index];
  }
  Texel texel(const Header& h, std::size_t row, std::size_t x) const;
  void unroll(const Header& h, Canvas& canvas) const;

  std::string_view text_;
  const std::string& where_;
};

Header Parser::read_header() const {
  Header h;
  h.data = number(10);
  h.size = number(kFileHeader);
  if (h.size == kCoreHeader) {
    h.width = number(18, 2), h.height = number(20, 2), h.bits = number(24, 2);
  } else if (h.size >= kInfoHeader && h.size <= 1024) {
    h.width = static_cast<std::int32_t>(number(18));
    h.height = static_cast<std::int32_t>(number(22));
    h.bits = number(28, 2), h.packing = number(30);
  } else {
    throw Error("a BMP with a header of " + std::to_string(h.size) + " bytes, which none has", where_);
  }
  h.is_top_down = h.height < 0;
  if (h.is_top_down) h.height = -h.height;
  const bool has_masks = h.packing == masks || h.packing == masks_with_alpha;
  const bool is_known = (h.packing == plain &&
                         (h.bits == 1 || h.bits == 4 || h.bits == 8 || h.bits == 16 || h.bits == 24 || h.bits == 32)) ||
                        (h.packing == rle8 && h.bits == 8) || (h.packing == rle4 && h.bits == 4) ||
                        (has_masks && (h.bits == 16 || h.bits == 32));
  if (!is_known) {
    throw Error(
        "a BMP of " + std::to_string(h.bits) + " bits and packing " + std::to_string(h.packing) + ", which is not read",
        where_);
  }
  read_masks(h);
  read_palette(h);
  return h;
}

void Parser::read_masks(Header& h) const {
  constexpr std::size_t kMasks = kFileHeader + kInfoHeader;
  if (h.packing == plain) {
    if (h.bits == 16) h.mask = {0x7C00, 0x3E0, 0x1F, 0};
    if (h.bits == 32) h.mask = {0xFF0000, 0xFF00, 0xFF, 0};
    return;
  }
  if (h.packing != masks && h.packing != masks_with_alpha) return;
  const std::size_t count = h.size >= 56 || h.packing == masks_with_alpha ? 4 : 3;
  for (std::size_t i = 0; i < count; ++i) {
    h.mask[i] = number(kMasks + 4 * i);
    // A run of ones, or none.
    const std::uint32_t low = h.mask[i] == 0 ? 0 : h.mask[i] >> std::countr_zero(h.mask[i]);
    if ((low & (low + 1)) != 0) throw Error("a BMP with a mask that has gaps", where_);
  }
}

void Parser::read_palette(Header& h) const {
  if (h.bits > 8) return;
  const bool is_core = h.size == kCoreHeader;
  const std::uint32_t most = 1u << h.bits, said = is_core ? 0 : number(46);
  const std::size_t count = said == 0 || said > most ? most : said, stride = is_core ? 3 : 4;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = kFileHeader + h.size + i * stride;
    if (at + stride > h.data) break;  // texels begin here
    h.palette.push_back({static_cast<std::uint8_t>(number(at + 2, 1)), static_cast<std::uint8_t>(number(at + 1, 1)),
                         static_cast<std::uint8_t>(number(at, 1)), 255});
  }
}

Texel Parser::texel(const Header& h, std::size_t row, std::size_t x) const {
  if (h.bits <= 8) {
    const std::size_t bit = x * h.bits;
    const std::uint32_t byte = little_endian(text_, row + bit / 8, 1);
    return colored(h, byte >> (8 - h.bits - bit % 8) & ((1u << h.bits) - 1));
  }
  const std::size_t size = h.bits / 8;
  const std::uint32_t word = little_endian(text_, row + x * size, size);
  if (h.bits == 24) {
    return {static_cast<std::uint8_t>(word >> 16), static_cast<std::uint8_t>(word >> 8),
            static_cast<std::uint8_t>(word), 255};
  }
  Texel result{0, 0, 0, 0};
  for (std::size_t c = 0; c < 4; ++c) {
    if (h.mask[c] == 0) continue;
    result[c] = scaled_to_byte((word & h.mask[c]) >> std::countr_zero(h.mask[c]), std::popcount(h.mask[c]));
  }
  return result;
}

/// Pairs of bytes: a run of one index (of two by turns in 4 bits), or after a 0 an end of the line, the end, a step, or
/// that many indices as they stand. What is stepped over has index 0.
void Parser::unroll(const Header& h, Canvas& canvas) const {
  const bool halves = h.packing == rle4;
  std::size_t at = h.data, x = 0, line = 0;
  const auto put = [&](std::uint32_t index) {
    if (x >= canvas.width() || line >= canvas.height()) throw Error("a BMP whose runs leave the picture", where_);
    canvas.set(x++, h.is_top_down ? line : canvas.height() - 1 - line, colored(h, index));
  };
  const auto nibble = [&](std::uint32_t byte, std::size_t i) {
    return !halves ? byte : i % 2 == 0 ? byte >> 4 : byte & 15;
  };
  for (;;) {
    const std::uint32_t count = number(at, 1), value = number(at + 1, 1);
    at += 2;
    if (count > 0) {
      for (std::size_t i = 0; i < count; ++i) put(nibble(value, i));
    } else if (value == 0) {
      x = 0, ++line;
    } else if (value == 1) {
      return;
    } else if (value == 2) {
      x += number(at, 1), line += number(at + 1, 1);
      at += 2;
    } else {
      for (std::size_t i = 0; i < value; ++i) put(nibble(number(at + (halves ? i / 2 : i), 1), i));
      const std::size_t bytes = halves ? (value + 1) / 2 : value;
      at += bytes + bytes % 2;
    }
  }
}

TextureImage Parser::decode(const Header& h) const {
  const bool is_packed = h.packing == rle8 || h.packing == rle4;
  Canvas canvas(h.width, h.height, where_);
  if (is_packed) {
    for (std::size_t y = 0; y < canvas.height(); ++y) {
      for (std::size_t x = 0; x < canvas.width(); ++x) canvas.set(x, y, colored(h, 0));
    }
    unroll(h, canvas);
    return canvas.finish(false);
  }
  const std::size_t stride = (canvas.width() * h.bits + 31) / 32 * 4;
  for (std::size_t y = 0; y < canvas.height(); ++y) {
    const std::size_t row = h.data + (h.is_top_down ? y : canvas.height() - 1 - y) * stride;
    for (std::size_t x = 0; x < canvas.width(); ++x) canvas.set(x, y, texel(h, row, x));
  }
  return canvas.finish(h.mask[3] != 0);
}

}  // namespace

bool is_bmp(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  // Two bytes are few: what is reserved is 0.
  return text.size() >= kFileHeader + kCoreHeader && text.starts_with("BM") && little_endian(text, 6) == 0;
}

TextureImage decode_bmp(std::span<const std::byte> bytes, const std::string& where) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const Parser parser(text, where);
  const Header h = parser.read_header();
  // A run of two bytes stands for 255 texels at most; what is plain has its size.
  const bool is_packed = h.packing == rle8 || h.packing == rle4;
  const std::uint64_t width = static_cast<std::uint64_t>(h.width), height = static_cast<std::uint64_t>(h.height);
  if (h.width < 1 || width > kMostTexels || height > kMostTexels) Canvas(h.width, h.height, where);  // says which
  const std::uint64_t stride = (width * h.bits + 31) / 32 * 4, last = (width * h.bits + 7) / 8;
  const std::uint64_t least = is_packed ? width * height / 128 : height == 0 ? 0 : stride * (height - 1) + last;
  if (h.data > text.size() || least > text.size() - h.data) throw Error("a BMP that is cut short", where);
  return parser.decode(h);
}

}  // namespace candela::foreign
