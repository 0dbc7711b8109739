#pragma once

#include <filesystem>
#include <vector>

#include "io/gltf.h"
#include "io/json_view.h"

namespace candela::io {

class UriReader;
struct GltfSource;

/// Every file that the document names by a `uri` anywhere, or as a light's profile in extras: those of buffers, images
/// and profiles, decoded or not, there or not, of known extensions and of others.
std::vector<ReferencedFile> referenced_files(const nlohmann::json& root, const UriReader& uris);

/// Puts the scene file itself first, and what was read to make a glTF of it last.
void add_files(std::vector<ReferencedFile>& files, const std::filesystem::path& path, const GltfSource& source);

}  // namespace candela::io
