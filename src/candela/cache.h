#pragma once

#include <filesystem>

namespace candela {

/// Where the environment says that things are kept which can be made again: $XDG_CACHE_HOME/candela, else
/// ~/.cache/candela; empty where neither is known. For raster::Settings::cache.
std::filesystem::path cache_folder();

}  // namespace candela
