#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "io/gltf.h"

namespace candela::cli {

/// The files that a run reads, none of which it may write: by whatever name, through links and hard links.
class Inputs {
 public:
  void add(const std::filesystem::path& path, const std::string& what);
  void add(const std::vector<io::ReferencedFile>& files);
  /// A file of --env, the six of a cube map, or nothing for a built-in environment.
  void add_environment(const std::string& name);
  /// All files below a folder.
  void add_folder(const std::filesystem::path& folder, const std::string& what);

  /// What reads `path`, or empty.
  std::string reader_of(const std::filesystem::path& path) const;
  bool contains(const std::filesystem::path& path) const { return !reader_of(path).empty(); }
  /// Throws Error where `path` is one of them.
  void refuse(const std::filesystem::path& path) const;
  /// Throws Error where one of them lies in `folder`, which is to be filled with files of many names.
  void refuse_folder(const std::filesystem::path& folder) const;

 private:
  std::map<std::filesystem::path, std::string> paths_;  ///< what each is, links resolved
  std::map<std::string, std::string> what_;             ///< by file_identity()
};

}  // namespace candela::cli
