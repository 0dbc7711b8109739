#include "cli/render_outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/error.h"
#include "base/file.h"
#include "base/text.h"
#include "cli/output.h"

namespace candela::cli {

namespace fs = std::filesystem;

std::vector<fs::path> outputs_of(const RenderOptions& o, std::size_t index) {
  std::vector<fs::path> paths;
  paths.reserve(o.outputs.size());
  for (const std::string& output : o.outputs) {
    paths.emplace_back(o.shot.has_many_pictures() ? frame_name(output, static_cast<int>(index)) : output);
  }
  return paths;
}

namespace {

std::vector<fs::path> all_outputs(const RenderOptions& o) {
  std::vector<fs::path> paths;
  const int count = o.shot.turntable.value_or(o.shot.sequence.value_or(1));
  for (int i = 0; i < count; ++i) {
    for (fs::path& path : outputs_of(o, static_cast<std::size_t>(i))) paths.push_back(std::move(path));
  }
  if (o.stats && *o.stats != "-") paths.push_back(*o.stats);
  return paths;
}

}  // namespace

Inputs inputs_of_options(const RenderOptions& o) {
  Inputs inputs;
  for (const std::string& scene : o.scenes) inputs.add(scene, "the scene " + scene);
  inputs.add_environment(o.shot.environment.value_or(""));
  if (!o.shot.drawn.shader_folder.empty()) inputs.add_folder(o.shot.drawn.shader_folder, "a shader");
  return inputs;
}

void check_overwriting(const RenderOptions& o, const Inputs& inputs) {
  std::map<std::string, fs::path> seen;
  for (const fs::path& path : all_outputs(o)) {
    if (is_device(path) || !standard_output_format(path.string()).empty()) continue;
    inputs.refuse(path);
    const auto [found, is_new] = seen.try_emplace(file_identity(path), path);
    if (!is_new) throw Error("would be written twice, also as " + found->second.string(), path.string());
  }
}

void check_paths(const RenderOptions& o) {
  for (const fs::path& path : outputs_of(o, 0)) check_writable(path);
  if (o.stats && *o.stats != "-") check_writable(*o.stats);
}

void choose_default_name(RenderOptions& o, const Inputs& inputs) {
  const auto is_taken = [&] {
    const std::vector<fs::path> outputs = all_outputs(o);
    return std::any_of(outputs.begin(), outputs.end(), [&](const fs::path& p) { return inputs.contains(p); });
  };
  if (!o.has_default_name || (o.stats && inputs.contains(*o.stats))) return;
  for (int attempt = 2; is_taken(); ++attempt) o.outputs = {default_output(o, attempt)};
}

void add_scene_files(const std::vector<std::string>& scenes, const fs::path& root, Inputs& inputs) {
  for (const std::string& scene : scenes) {
    try {
      if (!scene.starts_with("demo:")) inputs.add(io::files_of_gltf(scene, root));
    } catch (const Error&) {
      // Told when it is its turn.
    }
  }
}

namespace {

std::string numbered(const std::string& stem, int number) {
  return stem + (number > 1 ? fmt::format("-{}", number) : "") + ".png";
}

/// Names of a folder that are given to nobody else.
class FolderNames {
 public:
  FolderNames(fs::path folder, const Inputs& inputs) : folder_(std::move(folder)), inputs_(inputs) {}

  /// Whether it is free; then it is taken from here on.
  bool take(const std::string& name) {
    const std::string key = lower_case(name);
    const fs::path path = folder_ / name;
    if (names_.contains(key) || inputs_.contains(path)) return false;
    // Two names may be links to one file.
    if (!is_device(path) && !files_.insert(file_identity(path)).second) return false;
    names_.insert(key);
    return true;
  }

 private:
  fs::path folder_;
  const Inputs& inputs_;
  std::set<std::string> names_, files_;
};

}  // namespace

std::vector<fs::path> batch_outputs(const std::vector<std::string>& stems, const fs::path& folder,
                                    const Inputs& inputs) {
  FolderNames names(folder, inputs);
  std::vector<fs::path> outputs(stems.size());
  for (std::size_t i = 0; i < stems.size(); ++i) {
    const std::string own = numbered(stems[i], 1);
    if (names.take(own)) outputs[i] = folder / own;
  }
  for (std::size_t i = 0; i < stems.size(); ++i) {
    for (int number = 2; outputs[i].empty(); ++number) {
      const std::string name = numbered(stems[i], number);
      if (names.take(name)) outputs[i] = folder / name;
    }
  }
  return outputs;
}

fs::path free_name(const fs::path& folder, const std::string& stem, const Inputs& inputs) {
  int number = 1;
  while (inputs.contains(folder / numbered(stem, number))) ++number;
  return folder / numbered(stem, number);
}

}  // namespace candela::cli
