#include "foreign/guard.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "base/error.h"
#include "foreign/little_endian.h"

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

/// Calls `visit(kind, body)` for each chunk of a 3DS: its kind in two bytes, its length with these in four.
template <class F>
void for_each_chunk(std::string_view chunks, F&& visit) {
  constexpr std::size_t kHeader = 6;
  while (chunks.size() >= kHeader) {
    const std::uint32_t kind = little_endian(chunks, 0, 2);
    const std::size_t length = little_endian(chunks, 2);
    if (length < kHeader || length > chunks.size()) return;
    visit(kind, chunks.substr(kHeader, length - kHeader));
    chunks.remove_prefix(length);
  }
}

bool has_smoothing_groups(std::string_view file) {
  constexpr std::uint32_t kMain = 0x4D4D, kEditor = 0x3D3D, kObject = 0x4000, kMesh = 0x4100, kFaces = 0x4120,
                          kSmoothing = 0x4150;
  bool found = false;
  const auto look_into = [&](auto& self, std::string_view chunks) -> void {
    for_each_chunk(chunks, [&](std::uint32_t kind, std::string_view body) {
      constexpr std::size_t kFaceSize = 8;
      if (kind == kSmoothing) found = true;
      if (kind == kMain || kind == kEditor || kind == kMesh) self(self, body);
      if (kind == kObject && body.find('\0') != body.npos) self(self, body.substr(body.find('\0') + 1));
      if (kind == kFaces && body.size() >= 2) {
        const std::size_t list = 2 + kFaceSize * little_endian(body, 0, 2);
        if (list <= body.size()) self(self, body.substr(list));
      }
    });
  };
  look_into(look_into, file);
  return found;
}

}  // namespace

bool has_trusted_normals(std::span<const std::byte> bytes, Format format) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (format == Format::max_3ds) return has_smoothing_groups(text);
  return format != Format::stl;
}

void check_claims(std::span<const std::byte> bytes, Format format, std::uint64_t most_bytes, const std::string& where) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (format == Format::ply) check_ply(text, where);
  if (format == Format::three_mf) check_zip(text, most_bytes, where);
}

}  // namespace candela::foreign
