#include "cli/output.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>

#include "base/error.h"
#include "base/file.h"

namespace candela::cli {

namespace fs = std::filesystem;

bool has_extension(const fs::path& path, std::string_view extension) {
  std::string own = path.extension().string();
  std::transform(own.begin(), own.end(), own.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return own == extension;
}

bool is_linear_format(const fs::path& path) { return has_extension(path, ".exr") || has_extension(path, ".hdr"); }

void check_writable(const fs::path& path) {
  std::error_code code;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::exists(folder, code)) throw Error("the folder " + folder.string() + " does not exist", path.string());
  if (!fs::is_directory(folder, code)) throw Error(folder.string() + " is not a folder", path.string());
  if (is_device(path)) {
    if (access(path.c_str(), W_OK) != 0)
      throw Error("cannot write: " + std::string(std::strerror(errno)), path.string());
    return;  // opening a pipe would wait for its reader
  }
  const AtomicFile probe(path);
}

void write_outputs(const std::vector<fs::path>& paths, const Film& film, const DevelopSettings& develop) {
  for (const fs::path& path : paths) write_film(path, film, develop);
}

}  // namespace candela::cli
