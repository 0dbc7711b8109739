#include "cli/inputs.h"

#include "base/error.h"
#include "base/file.h"
#include "content/make_environment.h"
#include "image/cube_file.h"
#include "image/image_file.h"
#include "scene/environment.h"

namespace candela::cli {

namespace fs = std::filesystem;

void Inputs::add(const fs::path& path, const Use& use) {
  if (is_device(path) || path.string().starts_with("demo:")) return;
  files_.try_emplace(file_identity(path), use);
  paths_.try_emplace(real_path(path), use);
}

void Inputs::add(const fs::path& path, const std::string& what) { add(path, Use{what, false}); }

void Inputs::add_written(const fs::path& path, const std::string& what) { add(path, Use{what, true}); }

void Inputs::add(const Inputs& others) {
  files_.insert(others.files_.begin(), others.files_.end());
  paths_.insert(others.paths_.begin(), others.paths_.end());
}

void Inputs::add_existing(const Inputs& others) {
  for (const auto& [path, use] : others.paths_) {
    std::error_code ignored;
    if (fs::exists(path, ignored)) add(path, use);
  }
}

void Inputs::add(const std::vector<io::ReferencedFile>& files) {
  for (const io::ReferencedFile& file : files) {
    const std::string& owner = files.front().path.string();
    add(file.path, file.place.empty() ? "the scene " + owner : "read by " + owner + file.place);
  }
}

void Inputs::add_environment(const std::string& name) {
  if (name.empty() || is_built_in_environment(name)) return;
  for (const fs::path& file : files_of_environment(parse_image_name(name).path)) add(file, "the environment " + name);
}

void Inputs::add_folder(const fs::path& folder, const std::string& what) {
  std::error_code code;
  for (fs::recursive_directory_iterator at(folder, code), end; !code && at != end; at.increment(code)) {
    std::error_code ignored;
    if (at->is_regular_file(ignored)) add(at->path(), what);
  }
}

const Inputs::Use* Inputs::find(const fs::path& path) const {
  const auto found = files_.find(file_identity(path));
  return found == files_.end() ? nullptr : &found->second;
}

void Inputs::refuse(const fs::path& path) const {
  const Use* use = find(path);
  if (use == nullptr) return;
  const std::string fault = use->is_written ? "would be overwritten: " : "is an input and would be overwritten: ";
  throw Error(fault + use->what, path.string());
}

void Inputs::refuse_folder(const fs::path& folder) const {
  const fs::path place = real_path(folder);
  for (const auto& [path, use] : paths_) {
    const fs::path inside = path.lexically_relative(place);
    if (inside.empty() || inside.begin()->string() == "..") continue;
    throw Error("lies in the output folder and could be overwritten: " + use.what, path.string());
  }
}

}  // namespace candela::cli
