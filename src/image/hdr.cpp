#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "image/codec.h"
#include "image/image_file.h"
#include "image/primaries.h"

// The Radiance picture format. Ward, "Radiance File Formats", section "Picture File Format", and Ward 1991, "Real
// Pixels" (Graphics Gems II). EXPOSURE and COLORCORR are what pixels have been multiplied by; PRIMARIES are those of R,
// G, B and white; pixels of the format XYZE are XYZ in cd/m², 179 times the unit of RGBE. A mantissa is read as m ·
// 2^(e-136), without Ward's half step: 0 stays black, and our own writer rounds to nearest instead of truncating, so
// that no bias remains.

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

/// Luminous efficacy that Radiance takes for white light (lm/W).
constexpr double kWhiteEfficacy = 179.0;

struct HdrHeader {
  int width = 0;
  int height = 0;
  bool by_columns = false;  ///< a scanline of the file is a column
  bool flip_x = false;
  bool flip_y = false;
  bool is_xyz = false;
  dvec3 multiplied{1.0};  ///< product of all EXPOSURE and COLORCORR lines: what the pixels have been multiplied by
  std::optional<Primaries> primaries;
  std::vector<ImageFact> facts;

  int scanlines() const { return by_columns ? width : height; }
  int scanline_pixels() const { return by_columns ? height : width; }
};

/// The first numbers of a header line, at most `most`, up to whatever else stands there.
std::vector<double> parse_numbers(std::string_view text, std::size_t most) {
  std::vector<double> numbers;
  while (numbers.size() < most) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    if (text.starts_with('+')) text.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || !std::isfinite(value)) break;
    numbers.push_back(value);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  }
  return numbers;
}

/// Three or one factor that the pixels have been multiplied by.
void parse_factors(const std::string& name, std::string_view text, std::size_t count, HdrHeader& header,
                   const Cursor& cursor) {
  const std::vector<double> factors = parse_numbers(text, count);
  const bool are_positive = std::all_of(factors.begin(), factors.end(), [](double v) { return v > 0.0; });
  if (factors.size() != count || !are_positive)
    cursor.fail(name + " is no " + (count == 1 ? "positive number" : "three positive numbers"));
  header.multiplied *= count == 1 ? dvec3(factors[0]) : dvec3(factors[0], factors[1], factors[2]);
  header.facts.push_back({name, std::string(text), "divided out"});
}

/// The last of several lines counts. Eight zeros stand for none.
void parse_primaries(std::string_view text, HdrHeader& header) {
  constexpr std::size_t kNumbers = 8;
  const std::vector<double> n = parse_numbers(text, kNumbers + 1);
  ImageFact fact{"PRIMARIES", std::string(text), "converted to Rec.709"};
  header.primaries.reset();
  if (n.size() == kNumbers && std::all_of(n.begin(), n.end(), [](double v) { return v == 0.0; })) {
    fact.done = "none: taken as Rec.709";
  } else if (n.size() == kNumbers) {
    header.primaries = Primaries{{n[0], n[1]}, {n[2], n[3]}, {n[4], n[5]}, {n[6], n[7]}};
    if (is_same(*header.primaries, kRec709)) fact.done = "Rec.709: nothing to do";
    if (!rec709_from_rgb(*header.primaries)) header.primaries.reset();
    fact.is_odd = !header.primaries;
    if (fact.is_odd) fact.done = "no colours of a display: taken as Rec.709";
  } else {
    fact.is_odd = true;
    fact.done = "not eight numbers: taken as Rec.709";
  }
  std::erase_if(header.facts, [](const ImageFact& earlier) { return earlier.name == "PRIMARIES"; });
  header.facts.push_back(std::move(fact));
}

void parse_gamma(std::string_view text, HdrHeader& header) {
  const std::vector<double> gamma = parse_numbers(text, 1);
  const bool is_linear = gamma.size() == 1 && gamma[0] == 1.0;
  header.facts.push_back({"GAMMA", std::string(text),
                          is_linear ? "linear: nothing to do" : "not followed: Radiance pixels are linear",
                          !is_linear});
}

/// One line "KEY=value". What says nothing of the pixels' light is left alone.
void parse_line(std::string_view line, HdrHeader& header, const Cursor& cursor, const std::string& where) {
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) return;
  const std::string key(line.substr(0, equals));
  std::string_view value = line.substr(equals + 1);
  while (!value.empty() && value.front() == ' ') value.remove_prefix(1);
  if (key == "FORMAT") {
    header.is_xyz = value == "32-bit_rle_xyze";
    if (!header.is_xyz && value != "32-bit_rle_rgbe")
      throw Error("HDR pixels in \"" + std::string(value.substr(0, 40)) +
                      "\" are not supported, only 32-bit_rle_rgbe and 32-bit_rle_xyze",
                  where);
    if (header.is_xyz)
      header.facts.push_back({key, std::string(value), "XYZ in cd/m² over 179, converted to Rec.709 as measured"});
  }
  if (key == "EXPOSURE") parse_factors(key, value, 1, header, cursor);
  if (key == "COLORCORR") parse_factors(key, value, 3, header, cursor);
  if (key == "PRIMARIES") parse_primaries(value, header);
  if (key == "GAMMA") parse_gamma(value, header);
  if (key == "VIEW" || key == "PIXASPECT") header.facts.push_back({key, std::string(value), "not used"});
}

/// "-Y 512 +X 1024": scanlines are rows from the top, pixels run from the left. "+Y" and "-X" mirror; where "X" stands
/// first, scanlines are columns.
void parse_resolution(const std::string& text, HdrHeader& header, const Cursor& cursor, const std::string& where) {
  char sign[2] = {}, axis[2] = {}, rest = 0;
  int count[2] = {};
  const auto is_sign = [](char c) { return c == '-' || c == '+'; };
  if (std::sscanf(text.c_str(), "%c%c %9d %c%c %9d%c", &sign[0], &axis[0], &count[0], &sign[1], &axis[1], &count[1],
                  &rest) != 6 ||
      !is_sign(sign[0]) || !is_sign(sign[1]) ||
      !((axis[0] == 'Y' && axis[1] == 'X') || (axis[0] == 'X' && axis[1] == 'Y')))
    cursor.fail("no resolution line of the form \"-Y height +X width\", but \"" + text.substr(0, 40) + "\"");
  header.by_columns = axis[0] == 'X';
  const int x = header.by_columns ? 0 : 1;
  header.width = count[x];
  header.height = count[1 - x];
  header.flip_x = sign[x] == '-';
  header.flip_y = sign[1 - x] == '+';
  if (header.by_columns || header.flip_x || header.flip_y)
    header.facts.push_back({"order", text, header.by_columns ? "columns, set upright" : "mirrored back"});
  if (header.width < 1 || header.height < 1) cursor.fail("empty picture");
  const std::uint64_t bytes = static_cast<std::uint64_t>(header.width) * static_cast<std::uint64_t>(header.height) * 12;
  if (header.width > codec::kMaxImageSize || header.height > codec::kMaxImageSize || bytes > codec::kMaxImageBytes)
    throw Error("image of " + std::to_string(header.width) + " x " + std::to_string(header.height) + " is too large",
                where);
}

HdrHeader read_header(Cursor& cursor, const std::string& where) {
  HdrHeader header;
  cursor.line();  // "#?RADIANCE", already recognised
  for (std::string line = cursor.line(); !line.empty(); line = cursor.line()) parse_line(line, header, cursor, where);
  for (int c = 0; c < 3; ++c) {
    constexpr double kMost = 1e38;  // of a float
    if (!(header.multiplied[c] > 1.0 / kMost && header.multiplied[c] < kMost))
      cursor.fail("EXPOSURE and COLORCORR multiply to no number");
  }
  parse_resolution(cursor.line(), header, cursor, where);
  // Each scanline takes at least one pixel of four bytes, packed or not.
  if (cursor.remaining() / 4 < static_cast<std::size_t>(header.scanlines())) cursor.fail("the file is truncated");
  return header;
}

/// The pixels are XYZ, or RGB of the file's primaries.
void convert(HdrHeader& header, Image& image) {
  std::optional<mat3> matrix;
  if (header.is_xyz) {
    matrix = *rec709_from_rgb(kXyz) * static_cast<float>(1.0 / kWhiteEfficacy);
    for (ImageFact& fact : header.facts)
      if (fact.name == "PRIMARIES") fact.done = "not used: pixels are XYZ", fact.is_odd = false;
  } else if (header.primaries && !is_same(*header.primaries, kRec709)) {
    matrix = rec709_from_rgb(*header.primaries);
  }
  if (!matrix) return;
  const std::size_t moved = convert_to_rec709(image, *matrix);
  if (moved > 0)
    header.facts.push_back({"gamut", fmt::format("{} pixels beyond Rec.709", moved), "brought in at equal luminance"});
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

ImageFile codec::decode_hdr(std::span<const std::byte> bytes, const std::string& where) {
  Cursor cursor(bytes, where);
  HdrHeader header = read_header(cursor, where);
  std::array<float, 256> scale{};
  for (int e = 1; e < 256; ++e) scale[static_cast<std::size_t>(e)] = std::ldexp(1.0f, e - 136);
  const bool is_multiplied = header.multiplied != dvec3(1.0);
  const vec3 divided(1.0 / header.multiplied);

  ImageFile file;
  file.image = Image(header.width, header.height, 3);
  const auto pixels = static_cast<std::size_t>(header.scanline_pixels());
  std::vector<Rgbe> scanline(pixels);
  for (int line = 0; line < header.scanlines(); ++line) {
    // Packed scanlines exist only for these lengths, so that their mark cannot be a pixel.
    if (pixels >= 8 && pixels < 32768 && cursor.peek_is(2, 2))
      read_packed_row(cursor, scanline);
    else
      read_plain_row(cursor, scanline);
    for (int i = 0; i < static_cast<int>(pixels); ++i) {
      const Rgbe p = scanline[static_cast<std::size_t>(i)];
      vec3 color(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
      color *= scale[p[3]];
      if (is_multiplied) color *= divided;
      const int x = header.by_columns ? line : i, y = header.by_columns ? i : line;
      file.image.set_rgb(header.flip_x ? header.width - 1 - x : x, header.flip_y ? header.height - 1 - y : y, color);
    }
  }
  convert(header, file.image);
  file.facts = std::move(header.facts);
  return file;
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
