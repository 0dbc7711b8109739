#include "io/gltf_info.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "io/gltf_animation.h"
#include "io/gltf_extensions.h"
#include "io/gltf_nodes.h"

namespace candela::io {

namespace {

std::vector<std::string> read_names(const JsonView& root, const char* key) {
  std::vector<std::string> result;
  const auto list = root.find(key);
  for (std::size_t i = 0; list && i < list->size(); ++i) result.push_back((*list)[i].string());
  return result;
}

std::vector<std::string> read_variants(const JsonView& root) {
  std::vector<std::string> result;
  const auto extension = root.extension("KHR_materials_variants");
  if (!extension) return result;
  const JsonView list = extension->at("variants");
  for (std::size_t i = 0; i < list.size(); ++i) result.push_back(list[i].at("name").string());
  return result;
}

}  // namespace

std::optional<Variant> find_variant(const JsonView& root, const FileInfo& info, const std::string& name) {
  if (name.empty()) return std::nullopt;
  const auto found = std::find(info.variants.begin(), info.variants.end(), name);
  if (found == info.variants.end()) {
    const std::string names = info.variants.empty() ? "none" : fmt::format("{}", fmt::join(info.variants, ", "));
    throw root.error(fmt::format("there is no variant '{}'; the file has: {}", name, names));
  }
  return Variant{static_cast<std::size_t>(found - info.variants.begin()), info.variants.size()};
}

FileInfo read_info(const GltfDocument& document, std::size_t file_bytes, const std::string& scene) {
  const JsonView root = document.root();
  FileInfo info;
  const auto asset = root.find("asset");
  if (!asset || !asset->find("version")) throw root.error("not a glTF 2.0 file: it has no asset version");
  info.version = asset->at("version").string();
  if (!info.version.starts_with("2.")) {
    throw asset->at("version").error(fmt::format("glTF {} is not supported (only 2.x)", info.version.substr(0, 20)));
  }
  const std::string minimum = asset->string_or("minVersion", "2.0");
  if (minimum != "2.0")
    throw asset->at("minVersion").error(fmt::format("glTF {} is not supported", minimum.substr(0, 20)));
  info.generator = asset->string_or("generator");
  info.copyright = asset->string_or("copyright");
  info.extensions_used = read_names(root, "extensionsUsed");
  info.extensions_required = read_names(root, "extensionsRequired");
  sort_extensions(document, info);
  info.variants = read_variants(root);
  info.animations = read_animation_list(root);
  info.scenes = read_scene_names(root);
  info.scene = find_scene(root, scene);
  info.skins = static_cast<int>(count_of(root, "skins"));
  info.file_bytes = file_bytes;
  return info;
}

}  // namespace candela::io
