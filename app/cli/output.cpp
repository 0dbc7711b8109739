#include "cli/output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string_view>

#include "base/error.h"
#include "base/file.h"
#include "base/text.h"

namespace candela::cli {

namespace fs = std::filesystem;

bool has_extension(const fs::path& path, std::string_view extension) { return lower_extension(path) == extension; }

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

/// A name with a place for a number: %d, or %0Nd with N digits. %% is a %, as is any other.
struct FramePattern {
  std::string before, after;
  int digits = 0;
  int places = 0;
};
FramePattern parse_pattern(const std::string& name) {
  // Of a folder's name everything is itself.
  const std::size_t slash = name.rfind('/');
  const std::size_t begin = slash == std::string::npos ? 0 : slash + 1;
  FramePattern pattern;
  pattern.before = name.substr(0, begin);
  for (std::size_t i = begin; i < name.size(); ++i) {
    std::string& text = pattern.places > 0 ? pattern.after : pattern.before;
    const std::string_view rest = std::string_view(name).substr(i);
    const bool has_digits = rest.size() > 3 && rest[1] == '0' && rest[2] >= '1' && rest[2] <= '9' && rest[3] == 'd';
    if (rest.starts_with("%d") || (rest[0] == '%' && has_digits)) {
      if (++pattern.places == 1) pattern.digits = has_digits ? rest[2] - '0' : 0;
      i += has_digits ? 3 : 1;
      continue;
    }
    if (rest.starts_with("%%")) ++i;
    text += rest[0];
  }
  return pattern;
}

}  // namespace

bool is_frame_pattern(const std::string& name) { return parse_pattern(name).places == 1; }

std::string frame_name(const std::string& pattern, int index) {
  const FramePattern p = parse_pattern(pattern);
  return p.places == 0 ? p.before : p.before + fmt::format("{:0{}}", index, p.digits) + p.after;
}

std::string literal_in_pattern(const std::string& name) {
  std::string text;
  for (const char c : name) text += c == '%' ? "%%" : std::string(1, c);
  return text;
}

}  // namespace candela::cli
