#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "io/gltf.h"
#include "io/json_view.h"

namespace candela::io {

class UriReader;
struct SceneSource;

/// Every file that the document names by a `uri` anywhere, or as a light's profile in extras: those of buffers, images
/// and profiles, decoded or not, there or not, of known extensions and of others.
std::vector<ReferencedFile> referenced_files(const nlohmann::json& root, const UriReader& uris);

/// The scene file itself, what was read to make a glTF of it, and what it names besides.
std::vector<ReferencedFile> files_of_source(const std::filesystem::path& path, const SceneSource& source);

/// Throws Error for the first of these names that leads where the scene must not read, whether it would be read or not:
/// what forbids a file is no reason to show the scene without it.
void check_references(const JsonView& document, const nlohmann::json& root, const UriReader& uris);

/// The JSON pointers and names of what lies outside of the scene's own folder.
std::vector<std::pair<std::string, std::string>> names_outside(const nlohmann::json& root, const UriReader& uris);

}  // namespace candela::io
