#include "image/exr_guard.h"

#include <algorithm>
#include <cstdint>
#include <string>

#include "base/error.h"
#include "image/codec.h"

// OpenEXR, "File Layout": magic, version and flags; then per part attributes (name, type, size, value) up to an empty
// name; a multi-part file ends its headers with one more empty name. All numbers little-endian.

namespace candela::codec {

namespace {

constexpr std::uint32_t kMultiPartFlag = 0x1000;
constexpr std::uint64_t kChannelBytes = 4;    // the widest pixel type
constexpr std::size_t kMinChannelEntry = 18;  // one letter, its zero, type, linear flag and padding, two samplings

class Cursor {
 public:
  Cursor(std::span<const std::byte> bytes, const std::string& where) : bytes_(bytes), where_(where) {}

  [[noreturn]] void fail(const std::string& message) const { throw Error("damaged OpenEXR: " + message, where_); }
  const std::string& where() const { return where_; }
  std::size_t remaining() const { return bytes_.size() - offset_; }

  std::uint8_t byte() {
    if (remaining() == 0) fail("the file is truncated");
    return static_cast<std::uint8_t>(bytes_[offset_++]);
  }
  std::uint32_t u32() {
    std::uint32_t value = 0;
    for (unsigned shift = 0; shift < 32; shift += 8) value |= std::uint32_t{byte()} << shift;
    return value;
  }
  std::int64_t i32() { return static_cast<std::int32_t>(u32()); }
  std::string name() {
    std::string text;
    while (const char c = static_cast<char>(byte())) {
      if (text.size() == 255) fail("an attribute name above 255 characters");
      text.push_back(c);
    }
    return text;
  }
  Cursor take(std::size_t count) {
    if (count > remaining()) fail("an attribute beyond the end of the file");
    Cursor part(bytes_.subspan(offset_, count), where_);
    offset_ += count;
    return part;
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t offset_ = 0;
  const std::string& where_;
};

struct PartSize {
  std::uint64_t data_pixels = 0;
  std::uint64_t display_pixels = 0;
  std::uint64_t tile_pixels = 0;
  std::uint64_t channels = 0;
};

std::uint64_t window_pixels(Cursor value) {
  const std::int64_t x0 = value.i32(), y0 = value.i32(), x1 = value.i32(), y1 = value.i32();
  const std::int64_t width = x1 - x0 + 1, height = y1 - y0 + 1;
  // Coordinates far from the origin overflow the library's own arithmetic.
  constexpr std::int64_t kFarthest = 1 << 28;
  if (width < 1 || height < 1 || std::max({std::abs(x0), std::abs(x1), std::abs(y0), std::abs(y1)}) > kFarthest)
    value.fail("an impossible image window");
  if (width > kMaxImageSize || height > kMaxImageSize)
    throw Error("image of " + std::to_string(width) + " x " + std::to_string(height) + " is too large", value.where());
  return static_cast<std::uint64_t>(width * height);
}

std::uint64_t tile_pixels(Cursor value) {
  const std::uint64_t width = value.u32(), height = value.u32();
  if (width < 1 || height < 1 || width > kMaxImageSize || height > kMaxImageSize) value.fail("impossible tiles");
  return width * height;
}

void check_preview(Cursor value) {
  const std::uint64_t width = value.u32(), height = value.u32();
  if (width * height > value.remaining() / 4) value.fail("an impossible preview image");
}

/// Reads one part's attributes; false at the empty header that ends a multi-part file.
bool check_part(Cursor& cursor) {
  PartSize part;
  bool any = false;
  for (std::string name = cursor.name(); !name.empty(); name = cursor.name()) {
    any = true;
    const std::string type = cursor.name();
    const std::uint32_t size = cursor.u32();
    const Cursor value = cursor.take(size);
    if (name == "dataWindow") part.data_pixels = window_pixels(value);
    if (name == "displayWindow") part.display_pixels = window_pixels(value);
    if (name == "tiles") part.tile_pixels = tile_pixels(value);
    if (name == "channels") part.channels = size / kMinChannelEntry;
    if (type == "preview") check_preview(value);
  }
  if (!any) return false;
  if (part.data_pixels == 0 || part.display_pixels == 0 || part.channels == 0)
    cursor.fail("a header without channels or windows");
  const std::uint64_t most_pixels = kMaxImageBytes / kChannelBytes;
  if (part.display_pixels > most_pixels / 4 || part.channels > most_pixels ||
      std::max(part.data_pixels, part.tile_pixels) > most_pixels / part.channels)
    throw Error("the picture takes more than 2 GiB of memory", cursor.where());
  return true;
}

}  // namespace

void check_exr_header(std::span<const std::byte> bytes, const std::string& where) {
  Cursor cursor(bytes, where);
  cursor.u32();  // magic, already recognised
  const bool multi_part = (cursor.u32() & kMultiPartFlag) != 0;
  if (!check_part(cursor)) cursor.fail("an empty header");
  while (multi_part && check_part(cursor)) {
  }
}

}  // namespace candela::codec
