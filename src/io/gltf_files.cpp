#include "io/gltf_files.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "base/file.h"
#include "io/gltf_document.h"

namespace candela::io {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::json;

/// Long lists of numbers, of which none names a file.
bool names_no_file(std::string_view key) {
  constexpr std::array kLists = {"accessors", "animations", "bufferViews", "meshes", "scenes", "skins"};
  return std::find(kLists.begin(), kLists.end(), key) != kLists.end();
}

}  // namespace

std::vector<ReferencedFile> referenced_files(const Json& root, const UriReader& uris) {
  std::vector<ReferencedFile> found;
  // No recursion: how deep a document nests is its author's choice.
  std::vector<std::pair<const Json*, std::string>> open = {{&root, ""}};
  while (!open.empty()) {
    const auto [value, pointer] = std::move(open.back());
    open.pop_back();
    for (const auto& [key, member] : value->items()) {
      if (pointer.empty() && names_no_file(key)) continue;
      if (member.is_structured()) {
        open.emplace_back(&member, pointer + '/' + key);
      } else if (member.is_string() && (key == "uri" || key == "ies")) {
        for (fs::path& file : uris.files(member.get_ref<const std::string&>())) {
          found.push_back({std::move(file), '#' + pointer + '/' + key});
        }
      }
    }
  }
  return found;
}

std::vector<ReferencedFile> files_of_gltf(const fs::path& path) {
  const std::vector<std::byte> bytes = read_file(path);
  Diagnostics ignored;
  const GltfDocument document(bytes, path.string(), ignored);
  const UriReader uris(path.has_parent_path() ? path.parent_path() : fs::path("."));
  std::vector<ReferencedFile> files = referenced_files(document.json(), uris);
  files.insert(files.begin(), {path, ""});
  return files;
}

}  // namespace candela::io
