#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"

namespace candela::content {

/// A scene made by code: "spheres", "materials", "cornell", "furnace", or a row of balls, "row-…". Throws Error naming
/// the known ones.
Scene make_demo(const std::string& name);

struct DemoInfo {
  std::string name;
  std::string description;  ///< one line
};
const std::vector<DemoInfo>& demos();

}  // namespace candela::content
