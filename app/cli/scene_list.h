#pragma once

#include <string>
#include <vector>

namespace candela::cli {

/// A scene of several that were named.
struct ListedScene {
  std::string name;
  /// What its picture is called below a folder of pictures, without an extension: of a scene that was named itself its
  /// own name, FOLDER-NAME where others share it and it is not of the current folder; of one found below a folder its
  /// path from there, after the folder's name where several were given.
  std::string stem;
};

/// The scenes that `names` mean, folders searched. Throws UsageError for an empty name, Error for a folder without any.
std::vector<ListedScene> list_scenes(const std::vector<std::string>& names);

/// The name that a scene's picture has unless another is given: the file's, or that of a demo.
std::string default_stem(const std::string& scene);

}  // namespace candela::cli
