#include "io/gltf_files.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "io/foreign_scene.h"
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

/// A value whose members are looked at.
struct Level {
  explicit Level(const Json& v) : value(&v), next(v.begin()) {}

  const Json* value;
  Json::const_iterator next;
  std::size_t count = 0;  ///< of members before `next`
};

/// Where the member at hand of the innermost level stands; those of the levels around it are one further already.
std::string pointer_of(const std::vector<Level>& open) {
  std::string pointer;
  for (const Level& level : open) {
    const bool is_last = &level == &open.back();
    const Json::const_iterator at = is_last ? level.next : std::prev(level.next);
    pointer += '/';
    pointer += level.value->is_object() ? at.key() : std::to_string(is_last ? level.count : level.count - 1);
  }
  return pointer;
}

}  // namespace

std::vector<ReferencedFile> referenced_files(const Json& root, const UriReader& uris) {
  std::vector<ReferencedFile> found;
  // No recursion, and no names of what holds no file: how deep a document nests is its author's choice.
  std::vector<Level> open = {Level(root)};
  while (!open.empty()) {
    Level& level = open.back();
    if (level.next == level.value->end()) {
      open.pop_back();
      continue;
    }
    const Json& member = *level.next;
    const std::string* const key = level.value->is_object() ? &level.next.key() : nullptr;
    const bool is_name = key != nullptr && (*key == "uri" || *key == "ies") && member.is_string();
    const bool is_skipped = open.size() == 1 && key != nullptr && names_no_file(*key);
    if (is_name) {
      for (fs::path& file : uris.files(member.get_ref<const std::string&>())) {
        found.push_back({std::move(file), '#' + pointer_of(open)});
      }
    }
    ++level.next;
    ++level.count;
    if (member.is_structured() && !is_skipped) open.emplace_back(member);  // `level` dangles from here on
  }
  return found;
}

void add_files(std::vector<ReferencedFile>& files, const fs::path& path, const GltfSource& source) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  files.insert(files.begin(), {path, ""});
  for (const std::string& name : source.read) files.push_back({folder / name, ": " + name});
}

std::vector<ReferencedFile> files_of_gltf(const fs::path& path) {
  Diagnostics ignored;
  const GltfSource source = read_as_gltf(path, ignored);
  const GltfDocument document(source.bytes, path.string(), ignored);
  const UriReader uris(path.has_parent_path() ? path.parent_path() : fs::path("."));
  std::vector<ReferencedFile> files = referenced_files(document.json(), uris);
  add_files(files, path, source);
  return files;
}

}  // namespace candela::io
