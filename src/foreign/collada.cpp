#include "foreign/collada.h"

#include <algorithm>
#include <string>
#include <string_view>

namespace candela::foreign {

std::vector<std::byte> with_names(std::span<const std::byte> collada) {
  const std::string_view text(reinterpret_cast<const char*>(collada.data()), collada.size());
  std::string result;
  result.reserve(text.size() + 256);
  std::size_t done = 0;
  for (std::size_t at = text.find('<'); at != text.npos; at = text.find('<', at + 1)) {
    const std::string_view rest = text.substr(at);
    const std::size_t length = rest.starts_with("<camera ") ? 7 : rest.starts_with("<light ") ? 6 : 0;
    if (length == 0) continue;
    if (rest.substr(0, rest.find('>')).find(" name=") != rest.npos) continue;
    result += text.substr(done, at + length - done);
    result += " name=\"unnamed\"";
    done = at + length;
  }
  result += text.substr(done);
  const auto bytes = std::as_bytes(std::span(result));
  return {bytes.begin(), bytes.end()};
}

}  // namespace candela::foreign
