#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"

namespace candela::io {

/// A scene made by code: "spheres", "materials", "cornell", "furnace". Throws Error naming the known ones.
Scene make_demo(const std::string& name);

struct DemoInfo {
  std::string name;
  std::string description;  ///< one line
};
const std::vector<DemoInfo>& demos();

}  // namespace candela::io
