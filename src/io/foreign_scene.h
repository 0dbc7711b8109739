#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "foreign/surroundings.h"

namespace candela::io {

/// A scene file as a glTF: itself, or what was made of another format.
struct GltfSource {
  std::vector<std::byte> bytes;
  std::string format;             ///< "glTF", "OBJ"…: what the file is
  std::size_t file_bytes = 0;     ///< of the file itself
  std::vector<std::string> read;  ///< names of other files that making it has read
};

/// Told apart by content alone. Throws Error for what is no scene, which it then names if it can. `name` is only asked
/// where nothing knows the content: what is called .gltf or .glb goes to the reader of glTF, which says what is wrong.
GltfSource as_gltf(std::vector<std::byte> bytes, const foreign::Surroundings& around, const std::filesystem::path& name,
                   Diagnostics& diagnostics);

/// The same for a file on disk and what lies around it.
GltfSource read_as_gltf(const std::filesystem::path& path, Diagnostics& diagnostics);

/// Endings that files of the formats beside glTF have, to find them in folders.
bool has_foreign_extension(const std::filesystem::path& path);

}  // namespace candela::io
