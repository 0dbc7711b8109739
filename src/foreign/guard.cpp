#include "foreign/guard.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "base/error.h"

namespace candela::foreign {

namespace {

/// Each element of a PLY takes a byte at least.
void check_ply(std::string_view text, const std::string& where) {
  constexpr std::size_t kMostHeader = 1 << 20;
  const std::string_view header = text.substr(0, std::min(text.find("end_header"), kMostHeader));
  constexpr std::string_view kElement = "element ";
  for (std::size_t at = header.find(kElement); at != header.npos; at = header.find(kElement, at + 1)) {
    const std::string_view line = header.substr(at, header.find_first_of("\r\n", at) - at);
    const std::string_view number = line.substr(line.find_last_of(' ') + 1);
    std::uint64_t count = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), count);
    if (error != std::errc() || count > text.size()) {
      throw Error(fmt::format("damaged: the header claims {} elements", number.substr(0, 30)), where);
    }
  }
}

std::uint32_t little_endian(std::string_view text, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value |= std::uint32_t{static_cast<unsigned char>(text[at + i])} << (8 * i);
  }
  return value;
}

/// What all files of a zip hold, by its list of contents.
void check_zip(std::string_view text, std::uint64_t most_bytes, const std::string& where) {
  constexpr std::string_view kEntry("PK\1\2", 4);
  constexpr std::size_t kEntrySize = 46, kUnpacked = 24;
  std::uint64_t total = 0;
  for (std::size_t at = text.find(kEntry); at != text.npos && at + kEntrySize <= text.size();
       at = text.find(kEntry, at + kEntry.size())) {
    total += little_endian(text, at + kUnpacked);
  }
  if (total > most_bytes) throw Error(fmt::format("it unpacks to {} bytes", total), where);
}

}  // namespace

void check_claims(std::span<const std::byte> bytes, Format format, std::uint64_t most_bytes, const std::string& where) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (format == Format::ply) check_ply(text, where);
  if (format == Format::three_mf) check_zip(text, most_bytes, where);
}

}  // namespace candela::foreign
