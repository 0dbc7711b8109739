#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "io/gltf.h"
#include "io/gltf_document.h"
#include "io/gltf_mesh.h"

namespace candela::io {

/// What a document says of itself. `scene` as LoadOptions::scene. Throws Error for what is no glTF 2.0.
FileInfo read_info(const GltfDocument& document, std::size_t file_bytes, const std::string& scene);

/// The variant of that name, the first where several share it; none for an empty one. Throws Error that lists what
/// there is.
std::optional<Variant> find_variant(const JsonView& root, const FileInfo& info, const std::string& name);

}  // namespace candela::io
