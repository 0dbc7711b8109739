#include "cli/output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <optional>

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

namespace {

/// Where %d or %0Nd stands in a name, and N; empty unless it stands there once.
struct FrameNumber {
  std::size_t begin = 0, end = 0;
  int digits = 0;
};
std::optional<FrameNumber> find_frame_number(const std::string& name) {
  std::optional<FrameNumber> found;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (name[i] != '%') continue;
    FrameNumber number{.begin = i, .end = i + 1};
    if (number.end + 1 < name.size() && name[number.end] == '0' && name[number.end + 1] >= '1' &&
        name[number.end + 1] <= '9') {
      number.digits = name[number.end + 1] - '0';
      number.end += 2;
    }
    if (number.end >= name.size() || name[number.end] != 'd' || found) return std::nullopt;
    ++number.end;
    found = number;
  }
  return found;
}

}  // namespace

bool is_frame_pattern(const std::string& name) { return find_frame_number(name).has_value(); }

std::string frame_name(const std::string& pattern, int index) {
  const std::optional<FrameNumber> number = find_frame_number(pattern);
  if (!number) return pattern;
  return pattern.substr(0, number->begin) + fmt::format("{:0{}}", index, number->digits) + pattern.substr(number->end);
}

}  // namespace candela::cli
