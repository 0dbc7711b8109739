#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "io/gltf.h"

namespace candela::cli {

/// The files that a run reads, none of which it may write, and of several commands those that earlier ones have
/// written: by whatever name, through links and hard links.
class Inputs {
 public:
  void add(const std::filesystem::path& path, const std::string& what);
  void add(const std::vector<io::ReferencedFile>& files);
  /// A file of --env, the six of a cube map, or nothing for a built-in environment.
  void add_environment(const std::string& name);
  /// All files below a folder.
  void add_folder(const std::filesystem::path& folder, const std::string& what);
  void add(const Inputs& others);
  /// Those of them that are there.
  void add_existing(const Inputs& others);
  /// What another command writes; `what` begins with "written by".
  void add_written(const std::filesystem::path& path, const std::string& what);

  bool contains(const std::filesystem::path& path) const { return find(path) != nullptr; }
  /// Throws Error where `path` is one of them.
  void refuse(const std::filesystem::path& path) const;
  /// Throws Error where one of them lies in `folder`, which is to be filled with files of many names.
  void refuse_folder(const std::filesystem::path& folder) const;

 private:
  struct Use {
    std::string what;
    bool is_written = false;
  };
  void add(const std::filesystem::path& path, const Use& use);
  const Use* find(const std::filesystem::path& path) const;

  std::map<std::filesystem::path, Use> paths_;  ///< links resolved
  std::map<std::string, Use> files_;            ///< by file_identity()
};

}  // namespace candela::cli
