#pragma once

#include <functional>
#include <map>
#include <string>

namespace candela::raster {

/// The shaders and the headers of src/shade, as the build found them: text by the name that an include says.
const std::map<std::string, std::string, std::less<>>& shader_files();

}  // namespace candela::raster
