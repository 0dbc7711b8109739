#include "io/foreign_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "base/error.h"
#include "base/text.h"
#include "foreign/convert.h"
#include "foreign/formats.h"

namespace candela::io {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse(std::span<const std::byte> bytes, const std::string& label) {
  const std::string_view kind = foreign::guess_kind(bytes);
  throw Error(fmt::format("{}: no scene of a known format ({})", kind.empty() ? "its content is unknown" : kind,
                          foreign::known_formats()),
              label);
}

}  // namespace

namespace {

/// Whether a text has a file's name, not as a part of a longer one.
bool mentions(std::string_view text, std::string_view name) {
  const auto goes_on = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '-';
  };
  for (std::size_t at = text.find(name); at != std::string_view::npos; at = text.find(name, at + 1)) {
    const std::size_t end = at + name.size();
    const bool is_longer = (at > 0 && goes_on(text[at - 1])) || (end < text.size() && goes_on(text[end]));
    if (!is_longer) return true;
  }
  return false;
}

/// What lies around a scene and is named in it or in its material libraries, though its reader makes nothing of it: an
/// unused image, a key of a material that no glTF has. It is the scene's, and no place for a picture.
std::vector<std::string> mentioned_files(const fs::path& folder, const SceneSource& source) {
  constexpr std::size_t kMostBytes = std::size_t{4} << 20;  // formats name their files at the beginning
  constexpr int kMostFiles = 10000, kDeepest = 2;
  std::vector<std::string> texts;
  const auto add = [&](std::span<const std::byte> bytes) {
    bytes = bytes.first(std::min(bytes.size(), kMostBytes));
    texts.emplace_back(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  add(source.bytes);
  for (const std::string& name : source.read) {
    if (lower_extension(name) == ".mtl") add(source.files.read(name));
  }
  std::vector<std::string> found;
  std::error_code code;
  int count = 0;
  for (fs::recursive_directory_iterator at(folder.empty() ? "." : folder, code), end;
       !code && at != end && count < kMostFiles; at.increment(code), ++count) {
    if (at.depth() >= kDeepest) at.disable_recursion_pending();
    std::error_code ignored;
    const std::string name = at->path().filename().string();
    if (!at->is_regular_file(ignored) || !at->path().has_extension()) continue;
    std::string escaped;  // as in XML
    for (const char c : name) escaped += c == ' ' ? "%20" : std::string(1, c);
    const bool is_named = std::any_of(texts.begin(), texts.end(), [&](const std::string& text) {
      return mentions(text, name) || (escaped != name && mentions(text, escaped));
    });
    if (is_named) found.push_back(at->path().lexically_relative(folder.empty() ? "." : folder).generic_string());
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

SceneSource open_gltf(const fs::path& path, const fs::path& root, const foreign::Measures& measures,
                      Diagnostics& diagnostics) {
  SceneSource source = open_scene(path, root);
  source.file_bytes = source.bytes.size();
  source.format = foreign::format_name(foreign::Format::gltf);
  const fs::path name = source.entry.empty() ? path : fs::path(source.entry);
  const foreign::Format format = foreign::recognise(source.bytes);
  if (format == foreign::Format::gltf) {
    foreign::require_silence(format, measures, source.label);
    return source;
  }
  if (format == foreign::Format::unknown) {
    const std::string extension = lower_extension(name);
    if (extension != ".gltf" && extension != ".glb") refuse(source.bytes, source.label);
    return source;
  }
  // Names of foreign files are those of another machine: what leads out of bounds may still lie beside the scene.
  const foreign::Surroundings around{[&](const std::string& file) {
                                       try {
                                         return source.files.contains(file);
                                       } catch (const Error&) {
                                         return false;
                                       }
                                     },
                                     [&](const std::string& file) { return source.files.read(file); }};
  foreign::Converted made =
      foreign::convert(source.bytes, format, around, name.stem().string(), source.label, diagnostics, measures);
  source.read = std::move(made.read);
  if (source.entry.empty()) source.mentioned = mentioned_files(path.parent_path(), source);
  source.bytes = std::move(made.glb);
  source.format = foreign::format_name(format);
  return source;
}

bool has_foreign_extension(const fs::path& path) {
  constexpr auto kEndings = std::to_array<std::string_view>({".obj", ".fbx", ".stl", ".ply", ".dae", ".3ds", ".3mf"});
  return foreign::is_available() &&
         std::find(kEndings.begin(), kEndings.end(), lower_extension(path)) != kEndings.end();
}

}  // namespace candela::io
