#include "io/scene_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/file.h"
#include "base/text.h"
#include "foreign/formats.h"
#include "io/foreign_scene.h"
#include "io/zip_archive.h"

namespace candela::io {

namespace fs = std::filesystem;

namespace {

/// Both without links. A folder contains itself.
bool is_inside(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

/// Where a name leads in the end; of what is not there, where it would.
fs::path without_links(const fs::path& path) {
  std::error_code code;
  const fs::path whole = fs::absolute(path, code);
  fs::path real = fs::weakly_canonical(whole, code);
  // A loop of links leads nowhere; nothing is inside of nothing.
  return code ? fs::path() : real;
}

fs::path real_folder(const fs::path& root) {
  if (root.empty()) return {};
  std::error_code code;
  if (!fs::is_directory(root, code)) throw Error("no such folder", root.string());
  fs::path real = fs::canonical(root, code);
  if (code) throw Error("cannot be resolved: " + code.message(), root.string());
  return real;
}

std::string folder_of_entry(const std::string& name) {
  const auto slash = name.rfind('/');
  return slash == std::string::npos ? std::string() : name.substr(0, slash);
}

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

// ----- the glTF of an archive

constexpr std::size_t kHead = 64;

bool has_gltf_name(const std::string& name) {
  const std::string extension = lower_extension(name);
  return extension == ".gltf" || extension == ".glb";
}

std::string_view text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A .zip that is no scene itself.
bool is_archive(std::span<const std::byte> bytes) {
  return is_zip(bytes) && foreign::recognise(bytes) != foreign::Format::three_mf;
}

bool is_object_text(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const auto first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '{';
}

/// Of a name that promises nothing: JSON is common, and glTF must have this member.
bool holds_gltf(const ZipArchive& archive, const std::string& name) {
  constexpr std::size_t kLongestLook = std::size_t{64} << 20;
  const std::vector<std::byte> head = archive.read_head(name, kHead);
  if (text_of(head).starts_with("glTF")) return true;
  if (!is_object_text(text_of(head))) return false;
  const std::vector<std::byte> text = archive.read_head(name, kLongestLook);
  return text_of(text).find("\"asset\"") != std::string_view::npos;
}

std::vector<std::string> find_scenes(const ZipArchive& archive) {
  std::vector<std::string> found, others;
  for (const std::string& name : archive.names()) {
    if (!has_gltf_name(name)) {
      others.push_back(name);
      continue;
    }
    const std::vector<std::byte> head = archive.read_head(name, kHead);
    if (text_of(head).starts_with("glTF") || is_object_text(text_of(head))) found.push_back(name);
  }
  if (!found.empty()) return found;
  for (const std::string& name : others) {
    try {
      if (holds_gltf(archive, name)) found.push_back(name);
    } catch (const Error&) {
      // What cannot be read is no glTF, and nobody has said that it is one.
    }
  }
  if (!found.empty()) return found;
  std::copy_if(others.begin(), others.end(), std::back_inserter(found),
               [](const std::string& name) { return has_foreign_extension(name); });
  return found;
}

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 6;
  const auto end = names.begin() + static_cast<std::ptrdiff_t>(std::min(names.size(), kMost));
  std::string text = fmt::format("{}", fmt::join(names.begin(), end, ", "));
  if (names.size() > kMost) text += fmt::format(" and {} more", names.size() - kMost);
  return text;
}

SceneSource open_archive(std::shared_ptr<const ZipArchive> archive) {
  const std::vector<std::string> found = find_scenes(*archive);
  if (found.empty()) {
    const std::vector<std::string> names = archive->names();
    throw Error(
        names.empty() ? "the archive is empty" : "the archive holds no glTF or other scene, but " + listed(names),
        archive->label());
  }
  if (found.size() > 1) {
    const char* kind = has_gltf_name(found.front()) ? "glTF files" : "scenes";
    throw Error(fmt::format("the archive holds {} {}, and it is not said which is meant: {}; unpack it and "
                            "name one",
                            found.size(), kind, listed(found)),
                archive->label());
  }
  SceneSource source;
  source.entry = found.front();
  source.bytes = archive->read(source.entry);
  source.label = archive->label() + ":" + source.entry;
  source.files = SceneFiles(std::move(archive), folder_of_entry(source.entry));
  return source;
}

}  // namespace

SceneFiles::SceneFiles(fs::path folder, const fs::path& root) : folder_(std::move(folder)), root_(real_folder(root)) {}

SceneFiles::SceneFiles(std::shared_ptr<const ZipArchive> archive, std::string folder)
    : archive_(std::move(archive)), archive_folder_(std::move(folder)) {}

bool SceneFiles::leaves_folder(const std::string& name) const {
  return archive_ == nullptr && !is_inside(without_links(folder_ / name), without_links(folder_));
}

/// The name in the archive. Throws Error where it leads out of it.
std::string SceneFiles::entry(const std::string& name) const {
  std::string whole = (fs::path(archive_folder_) / name).lexically_normal().generic_string();
  if (whole == ".." || whole.starts_with("../") || whole.starts_with('/')) {
    throw Error("leads out of the archive, where all files of its scene must be");
  }
  return whole;
}

/// Throws Error where it is not allowed. What was looked at is what is read: a path without links.
fs::path SceneFiles::allowed_path(const std::string& name) const {
  fs::path whole = folder_ / name;
  if (root_.empty()) return whole;
  fs::path real = without_links(whole);
  if (!is_inside(real, root_)) {
    throw Error(fmt::format("leads out of '{}', where all files of a scene must be", root_.string()));
  }
  return real;
}

void SceneFiles::check(const std::string& name) const {
  if (archive_ != nullptr) {
    entry(name);
  } else {
    allowed_path(name);
  }
}

bool SceneFiles::contains(const std::string& name) const {
  std::error_code code;
  return archive_ != nullptr ? archive_->contains(entry(name)) : fs::exists(allowed_path(name), code);
}

std::vector<std::byte> SceneFiles::read(const std::string& name) const {
  return archive_ != nullptr ? archive_->read(entry(name)) : read_file(allowed_path(name));
}

fs::path SceneFiles::path(const std::string& name) const { return archive_ != nullptr ? fs::path() : folder_ / name; }

void check_inside(const fs::path& file, const fs::path& root) {
  try {
    SceneFiles(folder_of(file), root).check(file.filename().string());
  } catch (const Error& cause) {
    throw Error(cause.message(), cause.where().empty() ? file.string() : cause.where());
  }
}

bool is_scene_archive(const fs::path& path) {
  try {
    return is_zip(path) && !find_scenes(ZipArchive(path)).empty();
  } catch (const Error&) {
    return false;
  }
}

SceneSource open_scene(const fs::path& path, const fs::path& root) {
  check_inside(path, root);
  std::vector<std::byte> bytes = read_file(path);
  if (is_archive(bytes)) return open_archive(std::make_shared<const ZipArchive>(path));
  SceneSource source;
  source.bytes = std::move(bytes);
  source.label = path.string();
  source.files = SceneFiles(folder_of(path), root);
  return source;
}

SceneSource open_scene(std::vector<std::byte> bytes, const fs::path& folder, std::string label, const fs::path& root) {
  if (is_archive(bytes)) return open_archive(std::make_shared<const ZipArchive>(std::move(bytes), std::move(label)));
  SceneSource source;
  source.bytes = std::move(bytes);
  source.label = std::move(label);
  if (!folder.empty()) source.files = SceneFiles(folder, root);
  return source;
}

}  // namespace candela::io
