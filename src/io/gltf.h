#pragma once

#include <filesystem>
#include <span>

#include "base/diagnostics.h"
#include "scene/scene.h"

namespace candela::io {

/// Loads a .gltf or .glb. Every number is checked before it is used; on bad input throws Error whose `where` is the file and,
/// where there is one, the JSON pointer. An unknown required extension is an Error that names it; unknown optional ones
/// and recoverable oddities go to `diagnostics`. The result passes validate().
Scene load_gltf(const std::filesystem::path& path, Diagnostics& diagnostics);

/// The same from memory (GLB or JSON text), for tests and fuzzing; `base_folder` resolves external files, empty = refuse them.
Scene load_gltf(std::span<const std::byte> bytes, const std::filesystem::path& base_folder, Diagnostics& diagnostics);

}  // namespace candela::io
