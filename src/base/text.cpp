#include "base/text.h"

#include <algorithm>
#include <cctype>

namespace candela {

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string lower_extension(const std::filesystem::path& path) { return lower_case(path.extension().string()); }

}  // namespace candela
