#include "io/foreign_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "base/error.h"
#include "base/file.h"
#include "foreign/convert.h"
#include "foreign/formats.h"

namespace candela::io {

namespace fs = std::filesystem;

namespace {

std::string lower_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

[[noreturn]] void refuse(std::span<const std::byte> bytes, const fs::path& name) {
  const std::string_view kind = foreign::guess_kind(bytes);
  throw Error(fmt::format("{}: no scene of a known format ({})", kind.empty() ? "its content is unknown" : kind,
                          foreign::known_formats()),
              name.string());
}

}  // namespace

GltfSource as_gltf(std::vector<std::byte> bytes, const foreign::Surroundings& around, const fs::path& name,
                   Diagnostics& diagnostics) {
  const foreign::Format format = foreign::recognise(bytes);
  GltfSource source{{}, std::string(foreign::format_name(foreign::Format::gltf)), bytes.size(), {}};
  if (format == foreign::Format::unknown) {
    const std::string extension = lower_extension(name);
    if (extension != ".gltf" && extension != ".glb") refuse(bytes, name);
  }
  if (format == foreign::Format::unknown || format == foreign::Format::gltf) {
    source.bytes = std::move(bytes);
    return source;
  }
  foreign::Converted made = foreign::convert(bytes, format, around, name.stem().string(), name.string(), diagnostics);
  source.bytes = std::move(made.glb);
  source.format = foreign::format_name(format);
  source.read = std::move(made.read);
  return source;
}

GltfSource read_as_gltf(const fs::path& path, Diagnostics& diagnostics) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const foreign::Surroundings around{[&](const std::string& name) {
                                       std::error_code code;
                                       return fs::is_regular_file(folder / name, code);
                                     },
                                     [&](const std::string& name) { return read_file(folder / name); }};
  return as_gltf(read_file(path), around, path, diagnostics);
}

bool has_foreign_extension(const fs::path& path) {
  constexpr auto kEndings = std::to_array<std::string_view>({".obj", ".fbx", ".stl", ".ply", ".dae", ".3ds", ".3mf"});
  return foreign::is_available() &&
         std::find(kEndings.begin(), kEndings.end(), lower_extension(path)) != kEndings.end();
}

}  // namespace candela::io
