#pragma once

#include <cstddef>
#include <filesystem>

#include "base/diagnostics.h"
#include "foreign/measures.h"
#include "io/scene_files.h"

namespace candela::io {

/// Opens a scene of any format and makes a glTF of it, which the rest of this folder reads: what a file is its content
/// tells, never its name. Where nothing knows the content, what is called .gltf or .glb goes to the reader of glTF,
/// which says what is wrong, and the rest is an Error that names what it is if it can. Throws Error as open_scene.
/// `measures` are of OBJ, STL and PLY alone.
SceneSource open_gltf(const std::filesystem::path& path, const std::filesystem::path& root,
                      const foreign::Measures& measures, Diagnostics& diagnostics);

/// Endings that files of the formats beside glTF have, to find them in folders and archives.
bool has_foreign_extension(const std::filesystem::path& path);

}  // namespace candela::io
