#include "cli/inputs.h"

#include "base/error.h"
#include "base/file.h"
#include "content/make_environment.h"
#include "image/cube_file.h"
#include "image/image_file.h"
#include "scene/environment.h"

namespace candela::cli {

namespace fs = std::filesystem;

void Inputs::add(const fs::path& path, const std::string& what) {
  if (is_device(path)) return;
  what_.try_emplace(file_identity(path), what);
  std::error_code code;
  paths_.try_emplace(fs::weakly_canonical(path, code), what);
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

std::string Inputs::reader_of(const fs::path& path) const {
  const auto found = what_.find(file_identity(path));
  return found == what_.end() ? std::string() : found->second;
}

void Inputs::refuse(const fs::path& path) const {
  if (const std::string what = reader_of(path); !what.empty()) {
    throw Error("is an input and would be overwritten: " + what, path.string());
  }
}

void Inputs::refuse_folder(const fs::path& folder) const {
  std::error_code code;
  const fs::path place = fs::weakly_canonical(folder, code);
  for (const auto& [path, what] : paths_) {
    const fs::path inside = path.lexically_relative(place);
    if (inside.empty() || inside.begin()->string() == "..") continue;
    throw Error("lies in the folder of the data set and could be overwritten: " + what, path.string());
  }
}

}  // namespace candela::cli
