#include "foreign/formats.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <utility>

#include "foreign/little_endian.h"

namespace candela::foreign {

namespace {

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

/// Without a byte order mark and white space before it.
std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  return text;
}

bool is_text(std::string_view head) {
  return std::none_of(head.begin(), head.end(), [](char c) {
    const auto code = static_cast<unsigned char>(c);
    return code < 0x20 && !is_space(c) && c != '\f' && c != '\v';
  });
}

/// 80 bytes of title, the number of triangles, 50 bytes for each. The title may start with "solid" as a text does.
bool is_binary_stl(std::span<const std::byte> bytes) {
  constexpr std::size_t kHeader = 84, kTriangle = 50;
  if (bytes.size() < kHeader) return false;
  const std::uint64_t needed = kHeader + std::uint64_t{kTriangle} * little_endian(text_of(bytes), 80);
  return needed > kHeader && needed == bytes.size();
}

/// A chunk of the type of a main chunk, whose first child is one that a 3DS file begins with.
bool is_3ds(std::span<const std::byte> bytes) {
  if (bytes.size() < 12 || bytes[0] != std::byte{0x4D} || bytes[1] != std::byte{0x4D}) return false;
  const auto child = std::to_integer<unsigned>(bytes[6]) | std::to_integer<unsigned>(bytes[7]) << 8;
  constexpr unsigned kVersion = 0x0002, kEditor = 0x3D3D, kKeyFramer = 0xB000;
  return little_endian(text_of(bytes), 2) >= 12 && (child == kVersion || child == kEditor || child == kKeyFramer);
}

/// A zip whose list of contents, at its end, has a 3-D model of the Open Packaging Conventions.
bool is_3mf(std::string_view text) {
  constexpr std::size_t kTail = 1 << 20;
  if (!text.starts_with("PK\3\4")) return false;
  const std::string_view tail = text.substr(text.size() - std::min(text.size(), kTail));
  return tail.find("[Content_Types].xml") != tail.npos && tail.find(".model") != tail.npos;
}

/// Whether a line is a statement of Wavefront OBJ, and whether one that only an OBJ has.
struct ObjLine {
  bool is_known = false;
  bool is_telling = false;
};
ObjLine judge_obj_line(std::string_view line) {
  constexpr auto kStatements = std::to_array<std::string_view>(
      {"vt", "vn", "vp", "g", "o", "s", "l", "p", "curv", "surf", "cstype", "deg", "parm", "end", "mg", "usemap"});
  const std::string_view word = line.substr(0, line.find_first_of(" \t"));
  const std::string_view rest = trimmed(line.substr(word.size()));
  if (word == "mtllib" || word == "usemtl") return {true, !rest.empty()};
  if (word == "v" || word == "f") {
    const char first = rest.empty() ? ' ' : rest.front();
    const bool is_number = first == '-' || first == '+' || first == '.' || (first >= '0' && first <= '9');
    return {is_number, is_number};
  }
  return {std::find(kStatements.begin(), kStatements.end(), word) != kStatements.end(), false};
}

/// The first statements are all of OBJ, and one of them of nothing else.
bool is_obj(std::string_view text) {
  constexpr int kMostLines = 200;
  constexpr std::size_t kMostComment = 1 << 20;  // a licence may stand before the first statement
  bool is_telling = false;
  std::size_t at = 0;
  for (int lines = 0; lines < kMostLines && at < text.size() && at < kMostComment;) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = trimmed(text.substr(at, end - at));
    at = end + 1;
    if (line.empty() || line.front() == '#') continue;
    const ObjLine judged = judge_obj_line(line);
    if (!judged.is_known) return false;
    is_telling |= judged.is_telling;
    ++lines;
  }
  return is_telling;
}

bool contains(std::string_view text, std::string_view part) { return text.find(part) != text.npos; }

}  // namespace

Format recognise(std::span<const std::byte> bytes) {
  constexpr std::size_t kHead = 4096;
  const std::string_view text = text_of(bytes);
  const std::string_view head = text.substr(0, kHead);
  const std::string_view start = trimmed(head);
  if (head.starts_with("glTF") || start.starts_with('{')) return Format::gltf;
  if (head.starts_with("Kaydara FBX Binary")) return Format::fbx;
  if (is_3mf(text)) return Format::three_mf;
  if (is_3ds(bytes)) return Format::max_3ds;
  if (head.starts_with("ply\n") || head.starts_with("ply\r")) return Format::ply;
  if (is_binary_stl(bytes)) return Format::stl;
  if (!is_text(head)) return Format::unknown;
  if (start.starts_with('<')) return contains(head, "<COLLADA") ? Format::collada : Format::unknown;
  if (start.starts_with(';') && (contains(head, "FBX") || contains(head, "FBXHeaderExtension"))) return Format::fbx;
  if (start.starts_with("FBXHeaderExtension")) return Format::fbx;
  if (start.starts_with("solid") && contains(head, "facet")) return Format::stl;
  return is_obj(text) ? Format::obj : Format::unknown;
}

std::string_view format_name(Format format) {
  switch (format) {
    case Format::gltf:
      return "glTF";
    case Format::obj:
      return "OBJ";
    case Format::fbx:
      return "FBX";
    case Format::stl:
      return "STL";
    case Format::ply:
      return "PLY";
    case Format::collada:
      return "COLLADA";
    case Format::max_3ds:
      return "3DS";
    case Format::three_mf:
      return "3MF";
    case Format::unknown:
      break;
  }
  return "unknown";
}

std::string_view guess_kind(std::span<const std::byte> bytes) {
  constexpr auto kKinds = std::to_array<std::pair<std::string_view, std::string_view>>(
      {{"\x89PNG", "a PNG image"},
       {"\xFF\xD8\xFF", "a JPEG image"},
       {"RIFF", "a WebP image or another RIFF file"},
       {"v/1\x01", "an OpenEXR image"},
       {"#?", "a Radiance HDR image"},
       {"\xABKTX", "a KTX texture"},
       {"DDS ", "a DDS texture"},
       {"BLENDER", "a Blender file; export it as glTF"},
       {"\x28\xB5\x2F\xFD", "a compressed Blender file or another Zstandard file; export it as glTF"},
       {"PXR-USDC", "a USD file; export it as glTF"},
       {"#usda", "a USD file; export it as glTF"},
       {"ISO-10303-21", "a STEP file; export it as glTF or STL"},
       {"Ogawa", "an Alembic file; export it as glTF"},
       {"PK\3\4", "a zip archive"},
       {"\x1F\x8B", "a gzip archive"}});
  const std::string_view text = trimmed(text_of(bytes.first(std::min<std::size_t>(bytes.size(), 64))));
  for (const auto& [magic, kind] : kKinds) {
    if (text.starts_with(magic)) return kind;
  }
  return text.empty() ? "empty" : "";
}

std::string known_formats() {
  return is_available() ? "glTF, OBJ, FBX, STL, PLY, COLLADA, 3DS, 3MF" : "glTF (built without Assimp)";
}

}  // namespace candela::foreign
