#include "cli/exr_header.h"

#include <cstdint>

#include "base/error.h"

namespace candela::cli {

namespace {

/// Reads the layout of "OpenEXR File Layout" (openexr.com), chapter Header; little-endian.
class Cursor {
 public:
  Cursor(std::span<const std::byte> bytes, const std::string& where) : bytes_(bytes), where_(where) {}

  std::span<const std::byte> take(std::size_t count) {
    if (count > bytes_.size()) throw Error("the EXR header is cut short", where_);
    const auto taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  std::uint32_t u32() {
    const auto b = take(4);
    return std::to_integer<std::uint32_t>(b[0]) | std::to_integer<std::uint32_t>(b[1]) << 8 |
           std::to_integer<std::uint32_t>(b[2]) << 16 | std::to_integer<std::uint32_t>(b[3]) << 24;
  }
  std::string zero_terminated() {
    constexpr std::size_t kLongestName = 255;
    std::string text;
    for (char c = next(); c != '\0'; c = next()) {
      text += c;
      if (text.size() > kLongestName) throw Error("the EXR header holds a name that is too long", where_);
    }
    return text;
  }

 private:
  char next() { return static_cast<char>(take(1)[0]); }

  std::span<const std::byte> bytes_;
  const std::string& where_;
};

std::vector<std::string> channel_names(std::span<const std::byte> value, const std::string& where) {
  constexpr std::size_t kChannelFields = 16;  // pixel type, linearity and padding, two sampling rates
  std::vector<std::string> names;
  Cursor cursor(value, where);
  for (std::string name = cursor.zero_terminated(); !name.empty(); name = cursor.zero_terminated()) {
    names.push_back(name);
    cursor.take(kChannelFields);
  }
  return names;
}

}  // namespace

ExrHeader read_exr_header(std::span<const std::byte> bytes, const std::string& where) {
  constexpr std::uint32_t kMagic = 20000630;
  Cursor cursor(bytes, where);
  if (cursor.u32() != kMagic) throw Error("not an OpenEXR file", where);
  cursor.u32();  // version and flags
  ExrHeader header;
  for (std::string name = cursor.zero_terminated(); !name.empty(); name = cursor.zero_terminated()) {
    const std::string type = cursor.zero_terminated();
    const auto value = cursor.take(cursor.u32());
    if (type == "chlist") header.channels = channel_names(value, where);
    if (type == "string") header.metadata[name] = {reinterpret_cast<const char*>(value.data()), value.size()};
  }
  return header;
}

}  // namespace candela::cli
