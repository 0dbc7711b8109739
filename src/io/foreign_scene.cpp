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
  source.bytes = std::move(made.glb);
  source.format = foreign::format_name(format);
  source.read = std::move(made.read);
  return source;
}

bool has_foreign_extension(const fs::path& path) {
  constexpr auto kEndings = std::to_array<std::string_view>({".obj", ".fbx", ".stl", ".ply", ".dae", ".3ds", ".3mf"});
  return foreign::is_available() &&
         std::find(kEndings.begin(), kEndings.end(), lower_extension(path)) != kEndings.end();
}

}  // namespace candela::io
