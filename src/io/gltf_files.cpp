#include "io/gltf_files.h"

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "io/foreign_scene.h"
#include "io/gltf_document.h"
#include "io/scene_files.h"

namespace candela::io {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::json;

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

/// Calls `visit(pointer, uri)` for all of them.
void visit_uris(const Json& root, const std::function<void(std::string, const std::string&)>& visit) {
  // No recursion: how deep a document nests is its author's choice.
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
    if (is_name) visit(pointer_of(open), member.get_ref<const std::string&>());
    ++level.next;
    ++level.count;
    // Nothing in a list of numbers names a file.
    const bool is_numbers = member.is_array() && !member.empty() && member.front().is_number();
    if (member.is_structured() && !is_numbers) open.emplace_back(member);  // `level` dangles from here on
  }
}

}  // namespace

std::vector<ReferencedFile> referenced_files(const Json& root, const UriReader& uris) {
  std::vector<ReferencedFile> found;
  visit_uris(root, [&](const std::string& pointer, const std::string& uri) {
    for (fs::path& file : uris.files(uri)) found.push_back({std::move(file), '#' + pointer});
  });
  return found;
}

std::vector<ReferencedFile> files_of_source(const fs::path& path, const SceneSource& source) {
  std::vector<ReferencedFile> files = {{path, ""}};
  for (const auto* names : {&source.read, &source.mentioned}) {
    for (const std::string& name : *names) {
      if (fs::path file = source.files.path(name); !file.empty()) files.push_back({std::move(file), ": " + name});
    }
  }
  return files;
}

void check_references(const JsonView& document, const Json& root, const UriReader& uris) {
  visit_uris(root, [&](const std::string& pointer, const std::string& uri) {
    if (const std::string fault = uris.fault(uri); !fault.empty()) throw Error(fault, document.where() + '#' + pointer);
  });
}

std::vector<std::pair<std::string, std::string>> names_outside(const Json& root, const UriReader& uris) {
  std::vector<std::pair<std::string, std::string>> found;
  visit_uris(root, [&](std::string pointer, const std::string& uri) {
    if (uris.leaves_folder(uri)) found.emplace_back(std::move(pointer), uri);
  });
  return found;
}

std::vector<ReferencedFile> files_of_gltf(const fs::path& path, const fs::path& root) {
  Diagnostics ignored;
  const SceneSource source = open_gltf(path, root, {}, ignored);
  const GltfDocument document(source.bytes, source.label, ignored);
  const UriReader uris(source.files);
  std::vector<ReferencedFile> files = files_of_source(path, source);
  for (ReferencedFile& file : referenced_files(document.json(), uris)) files.push_back(std::move(file));
  return files;
}

}  // namespace candela::io
