#include "cli/scene_list.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "base/text.h"
#include "candela/verdict.h"
#include "cli/values.h"

namespace candela::cli {

namespace fs = std::filesystem;

namespace {

bool is_folder(const std::string& name) {
  std::error_code ignored;
  return fs::is_directory(name, ignored);
}

/// The last name of a folder, whatever the way to it.
std::string folder_name(const fs::path& folder) {
  std::error_code code;
  const fs::path whole = fs::weakly_canonical(folder.empty() ? fs::path(".") : folder, code);
  return (code ? folder : whole).filename().string();
}

std::string stem_below(const std::string& scene, const fs::path& folder) {
  return fs::path(scene).lexically_relative(folder).replace_extension().string();
}

/// Scenes of one name are told apart by their folders.
void name_folders(std::vector<ListedScene>& scenes) {
  std::map<std::string, std::size_t> shared;
  for (const ListedScene& scene : scenes) ++shared[lower_case(scene.stem)];
  for (ListedScene& scene : scenes) {
    if (shared[lower_case(scene.stem)] < 2 || scene.name.starts_with("demo:")) continue;
    // One of the current folder keeps its name.
    const fs::path parent = fs::path(scene.name).lexically_normal().parent_path();
    const std::string folder = parent.empty() ? "" : folder_name(parent);
    if (!folder.empty()) scene.stem = folder + "-" + scene.stem;
  }
}

}  // namespace

std::string default_stem(const std::string& scene) {
  const std::string name = scene.starts_with("demo:") ? scene.substr(5) : fs::path(scene).stem().string();
  return name.empty() ? "picture" : name;
}

std::vector<ListedScene> list_scenes(const std::vector<std::string>& names) {
  std::vector<ListedScene> named, result;
  for (const std::string& name : names) {
    if (name.empty()) throw UsageError("SCENE: the name is empty");
    if (!is_folder(name)) named.push_back({name, default_stem(name)});
  }
  name_folders(named);
  const bool has_folders = names.size() - named.size() > 1;
  auto next = named.begin();
  for (const std::string& name : names) {
    if (!is_folder(name)) {
      result.push_back(std::move(*next++));
      continue;
    }
    for (const std::string& scene : scenes_below(name)) {
      const std::string stem = stem_below(scene, name);
      result.push_back({scene, has_folders ? (fs::path(folder_name(name)) / stem).string() : stem});
    }
  }
  return result;
}

}  // namespace candela::cli
