#pragma once

#include <optional>
#include <string>

#include "foreign/measures.h"
#include "math/types.h"

namespace candela::cli {

struct ViewOptions {
  std::string scene;
  std::string root;
  std::uint64_t texture_memory = 0;
  std::string scene_choice;
  foreign::Measures measures;
  std::optional<std::string> environment;
  ivec2 size{1280, 720};
  std::string shader_folder;
  int frames = 0;  ///< 0: until it is closed
};

/// A scene in a window, until it is closed. Throws Error where this build has no windows.
void show(const ViewOptions& options);

}  // namespace candela::cli
