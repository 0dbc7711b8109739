#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "image/codec.h"
#include "image/image_file.h"

// The Radiance picture format. Ward, "Radiance File Formats", section "Picture File Format", and Ward 1991, "Real
// Pixels" (Graphics Gems II). A mantissa is read as m · 2^(e-136), without Ward's half step: 0 stays black, and our own
// writer rounds to nearest instead of truncating, so that no bias remains.

namespace candela {

namespace {

using Rgbe = std::array<std::uint8_t, 4>;

/// Bytes of a file, read in order; every overrun is an Error.
class Cursor {
 public:
  Cursor(std::span<const std::byte> bytes, const std::string& where) : bytes_(bytes), where_(where) {}

  [[noreturn]] void fail(const std::string& message) const { throw Error("damaged HDR: " + message, where_); }
  std::size_t remaining() const { return bytes_.size() - offset_; }

  std::uint8_t byte() {
    if (offset_ == bytes_.size()) fail("the file is truncated");
    return static_cast<std::uint8_t>(bytes_[offset_++]);
  }
  Rgbe pixel() {
    Rgbe p;
    for (std::uint8_t& v : p) v = byte();
    return p;
  }
  bool peek_is(std::uint8_t first, std::uint8_t second) const {
    return remaining() >= 4 && bytes_[offset_] == std::byte{first} && bytes_[offset_ + 1] == std::byte{second} &&
           (bytes_[offset_ + 2] & std::byte{0x80}) == std::byte{0};
  }
  std::string line() {
    std::string text;
    for (char c; (c = static_cast<char>(byte())) != '\n';) {
      if (text.size() == 65536) fail("a header line without an end");  // no real header is near this
      text.push_back(c);
    }
    if (!text.empty() && text.back() == '\r') text.pop_back();
    return text;
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t offset_ = 0;
  const std::string& where_;
};

struct HdrHeader {
  int width = 0;
  int height = 0;
  bool flip_x = false;
  bool flip_y = false;
  float exposure = 1.0f;  ///< product of all EXPOSURE lines: what the pixels have been multiplied by
};

void parse_exposure_line(std::string_view text, HdrHeader& header, const Cursor& cursor) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  float value = 0.0f;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || !(value > 0.0f) || !std::isfinite(value)) cursor.fail("EXPOSURE is no positive number");
  header.exposure *= value;
}

/// "-Y 512 +X 1024": rows from the top, pixels from the left. A "+Y" or "-X" mirrors; "X" first would transpose.
void parse_resolution(const std::string& text, HdrHeader& header, const Cursor& cursor, const std::string& where) {
  char sign_y = 0, sign_x = 0, rest = 0;
  if (std::sscanf(text.c_str(), "%cY %9d %cX %9d%c", &sign_y, &header.height, &sign_x, &header.width, &rest) != 4 ||
      (sign_y != '-' && sign_y != '+') || (sign_x != '-' && sign_x != '+'))
    cursor.fail("no resolution line of the form \"-Y height +X width\", but \"" + text.substr(0, 40) + "\"");
  header.flip_y = sign_y == '+';
  header.flip_x = sign_x == '-';
  if (header.width < 1 || header.height < 1) cursor.fail("empty picture");
  const std::uint64_t bytes = static_cast<std::uint64_t>(header.width) * static_cast<std::uint64_t>(header.height) * 12;
  if (header.width > codec::kMaxImageSize || header.height > codec::kMaxImageSize || bytes > codec::kMaxImageBytes)
    throw Error("image of " + std::to_string(header.width) + " x " + std::to_string(header.height) + " is too large",
                where);
}

HdrHeader read_header(Cursor& cursor, const std::string& where) {
  HdrHeader header;
  cursor.line();  // "#?RADIANCE", already recognised
  for (std::string line = cursor.line(); !line.empty(); line = cursor.line()) {
    const std::string_view view = line;
    if (view.starts_with("FORMAT=") && view != "FORMAT=32-bit_rle_rgbe")
      throw Error("HDR pixels in \"" + line.substr(7, 40) + "\" are not supported, only 32-bit_rle_rgbe", where);
    if (view.starts_with("EXPOSURE=")) parse_exposure_line(view.substr(9), header, cursor);
  }
  parse_resolution(cursor.line(), header, cursor, where);
  // Each row takes at least one pixel of four bytes, packed or not.
  if (cursor.remaining() / 4 < static_cast<std::size_t>(header.height)) cursor.fail("the file is truncated");
  return header;
}

/// A row whose four components are run-length coded one after the other. The first two bytes (2, 2) are known.
void read_packed_row(Cursor& cursor, std::span<Rgbe> row) {
  const Rgbe mark = cursor.pixel();
  if (static_cast<std::size_t>(mark[2]) * 256 + mark[3] != row.size()) cursor.fail("a row of the wrong length");
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t x = 0; x < row.size();) {
      std::size_t count = cursor.byte();
      const bool is_run = count > 128;
      if (is_run) count -= 128;
      if (count == 0 || count > row.size() - x) cursor.fail("a run beyond the end of its row");
      std::uint8_t value = is_run ? cursor.byte() : std::uint8_t{0};
      for (const std::size_t end = x + count; x < end; ++x) {
        if (!is_run) value = cursor.byte();
        row[x][c] = value;
      }
    }
  }
}

/// Plain pixels, where (1, 1, 1, n) repeats the one before; consecutive repeats count in higher digits of 256.
void read_plain_row(Cursor& cursor, std::span<Rgbe> row) {
  unsigned shift = 0;
  for (std::size_t x = 0; x < row.size();) {
    const Rgbe p = cursor.pixel();
    if (p[0] != 1 || p[1] != 1 || p[2] != 1) {
      row[x++] = p;
      shift = 0;
      continue;
    }
    const std::size_t count = shift < 24 ? std::size_t{p[3]} << shift : 0;
    if (x == 0 || count == 0 || count > row.size() - x) cursor.fail("a run beyond the end of its row");
    std::fill_n(row.begin() + static_cast<std::ptrdiff_t>(x), count, row[x - 1]);
    x += count;
    shift += 8;
  }
}

void append_run_length(std::vector<std::byte>& out, std::span<const Rgbe> row, std::size_t c) {
  constexpr std::size_t kMinRun = 4;  // shorter runs cost more than they save
  const auto run_at = [&](std::size_t x) {
    std::size_t n = 1;
    while (n < 127 && x + n < row.size() && row[x + n][c] == row[x][c]) ++n;
    return n;
  };
  for (std::size_t x = 0; x < row.size();) {
    std::size_t literal_end = x;
    std::size_t run = 0;
    while (literal_end < row.size() && (run = run_at(literal_end)) < kMinRun) literal_end += run, run = 0;
    while (x < literal_end) {
      const std::size_t count = std::min<std::size_t>(128, literal_end - x);
      out.push_back(static_cast<std::byte>(count));
      for (const std::size_t end = x + count; x < end; ++x) out.push_back(std::byte{row[x][c]});
    }
    if (run == 0) continue;
    out.push_back(static_cast<std::byte>(128 + run));
    out.push_back(std::byte{row[x][c]});
    x += run;
  }
}

/// Shared exponent of the largest channel, mantissas rounded to nearest.
Rgbe encode(vec3 rgb) {
  const float kLargest = 255.0f * 0x1p119f;
  const auto usable = [kLargest](float v) { return v > 0.0f ? std::min(v, kLargest) : 0.0f; };
  const vec3 c(usable(rgb.x), usable(rgb.y), usable(rgb.z));
  int exponent = 0;
  const float fraction = std::frexp(max_component(c), &exponent);
  if (fraction * 256.0f >= 255.5f) ++exponent;  // would round to 256
  if (max_component(c) == 0.0f || exponent < -127) return {0, 0, 0, 0};
  const auto mantissa = [&](float v) { return static_cast<std::uint8_t>(std::ldexp(v, 8 - exponent) + 0.5f); };
  return {mantissa(c.x), mantissa(c.y), mantissa(c.z), static_cast<std::uint8_t>(exponent + 128)};
}

}  // namespace

Image codec::decode_hdr(std::span<const std::byte> bytes, const std::string& where) {
  Cursor cursor(bytes, where);
  const HdrHeader header = read_header(cursor, where);
  std::array<float, 256> scale{};
  for (int e = 1; e < 256; ++e) scale[static_cast<std::size_t>(e)] = std::ldexp(1.0f, e - 136) / header.exposure;

  Image image(header.width, header.height, 3);
  const auto width = static_cast<std::size_t>(header.width);
  std::vector<Rgbe> row(width);
  for (int line = 0; line < header.height; ++line) {
    // Packed rows exist only for these widths, so that their mark cannot be a pixel.
    if (width >= 8 && width < 32768 && cursor.peek_is(2, 2))
      read_packed_row(cursor, row);
    else
      read_plain_row(cursor, row);
    float* out = image.pixels.data() + image.index(0, header.flip_y ? header.height - 1 - line : line);
    for (std::size_t x = 0; x < width; ++x) {
      const Rgbe p = row[header.flip_x ? width - 1 - x : x];
      for (std::size_t c = 0; c < 3; ++c) out[x * 3 + c] = static_cast<float>(p[c]) * scale[p[3]];
    }
  }
  return image;
}

void write_hdr(const std::filesystem::path& path, const Image& image) {
  const std::string header = "#?RADIANCE\nSOFTWARE=candela\nFORMAT=32-bit_rle_rgbe\n\n-Y " +
                             std::to_string(image.height) + " +X " + std::to_string(image.width) + "\n";
  const auto header_bytes = std::as_bytes(std::span(header));
  std::vector<std::byte> bytes(header_bytes.begin(), header_bytes.end());
  const auto width = static_cast<std::size_t>(image.width);
  const bool packed = width >= 8 && width < 32768;
  std::vector<Rgbe> row(width);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) row[static_cast<std::size_t>(x)] = encode(image.rgb(x, y));
    if (packed) {
      for (const std::size_t v : {std::size_t{2}, std::size_t{2}, width / 256, width % 256})
        bytes.push_back(static_cast<std::byte>(v));
      for (std::size_t c = 0; c < 4; ++c) append_run_length(bytes, row, c);
    } else {
      const auto raw = std::as_bytes(std::span(row));
      bytes.insert(bytes.end(), raw.begin(), raw.end());
    }
  }
  write_file(path, bytes);
}

}  // namespace candela
