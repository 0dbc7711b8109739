#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "io/ies.h"

/// Any text: an Error or a profile.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace candela;
  try {
    Diagnostics diagnostics;
    io::parse_ies({reinterpret_cast<const char*>(data), size}, "fuzz", diagnostics);
  } catch (const Error&) {
  }
  return 0;
}
