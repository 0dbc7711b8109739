#include "cli/output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <string_view>

#include "base/error.h"
#include "base/file.h"
#include "base/text.h"
#include "cli/verbs.h"

namespace candela::cli {

namespace fs = std::filesystem;

bool has_extension(const fs::path& path, std::string_view extension) { return lower_extension(path) == extension; }

bool is_linear_format(const fs::path& path) { return has_extension(path, ".exr") || has_extension(path, ".hdr"); }

namespace {

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

}  // namespace

void check_writable(const fs::path& path) {
  if (!standard_output_format(path.string()).empty()) return;
  std::error_code code;
  fs::path folder = folder_of(path);
  while (!fs::exists(fs::symlink_status(folder, code))) folder = folder_of(folder);
  if (!fs::is_directory(folder, code)) throw Error(folder.string() + " is not a folder", path.string());
  if (is_device(path)) {
    if (access(path.c_str(), W_OK) != 0)
      throw Error("cannot write: " + std::string(std::strerror(errno)), path.string());
    return;  // opening a pipe would wait for its reader
  }
  if (folder == folder_of(path)) {
    const AtomicFile probe(path);
  } else if (access(folder.c_str(), W_OK | X_OK) != 0) {
    throw Error("cannot make its folder: " + std::string(std::strerror(errno)), path.string());
  }
}

std::string standard_output_format(const std::string& name) {
  if (name == "-") return ".png";
  for (const char* format : {"png", "jpg", "jpeg", "webp", "hdr", "exr"}) {
    if (name == std::string(format) + ":-") return std::string(".") + format;
  }
  return {};
}

void write_standard_output(const std::string& extension, const std::function<void(const fs::path&)>& write) {
  // Some formats go back to what they wrote first, which a pipe cannot.
  std::string pattern = (fs::temp_directory_path() / "candela-XXXXXX").string() + extension;
  const int file = mkstemps(pattern.data(), static_cast<int>(extension.size()));
  if (file < 0) throw Error("cannot write: " + std::string(std::strerror(errno)), pattern);
  ::close(file);
  const auto remove = [](const std::string* path) {
    std::error_code ignored;
    fs::remove(*path, ignored);
  };
  const std::unique_ptr<const std::string, decltype(remove)> removed(&pattern, remove);
  write(pattern);
  const std::vector<std::byte> bytes = read_file(pattern);
  print({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

FolderFor::FolderFor(const fs::path& file) {
  std::error_code code;
  const fs::path folder = folder_of(file);
  std::vector<fs::path> missing;
  for (fs::path at = folder; !fs::exists(at, code); at = folder_of(at)) missing.push_back(at);
  for (auto at = missing.rbegin(); at != missing.rend(); ++at) {
    if (fs::create_directory(*at, code)) made_.push_back(*at);
    if (code) throw Error("cannot make its folder: " + code.message(), file.string());
  }
}

FolderFor::~FolderFor() {
  std::error_code ignored;
  // Of a folder that is not empty it does nothing.
  for (auto at = made_.rbegin(); at != made_.rend(); ++at) fs::remove(*at, ignored);
}

void write_outputs(const std::vector<fs::path>& paths, const Film& film, const DevelopSettings& develop) {
  for (const fs::path& path : paths) {
    if (const std::string format = standard_output_format(path.string()); !format.empty()) {
      write_standard_output(format, [&](const fs::path& file) { write_film(file, film, develop); });
      continue;
    }
    const FolderFor folder(path);
    write_film(path, film, develop);
  }
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
