#include "candela/cache.h"

#include <cstdlib>

namespace candela {

std::filesystem::path cache_folder() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::filesystem::path(value == nullptr ? "" : value);
  };
  if (const auto xdg = variable("XDG_CACHE_HOME"); xdg.is_absolute()) return xdg / "candela";
  if (const auto home = variable("HOME"); home.is_absolute()) return home / ".cache" / "candela";
  return {};
}

}  // namespace candela
