#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace candela::foreign {

/// What lies around a scene file and may be read with it. Names are relative to its folder, with forward slashes.
struct Surroundings {
  std::function<bool(const std::string& name)> has;
  std::function<std::vector<std::byte>(const std::string& name)> read;  ///< throws Error
};

/// The name beside the scene by which a foreign file's reference can be read: as it stands, with slashes turned,
/// in the scene's own folder or one named textures; of absolute names, which are another machine's, the last part
/// alone. As it stands where nothing is found.
std::string find_reference(const Surroundings& around, std::string name);

}  // namespace candela::foreign
