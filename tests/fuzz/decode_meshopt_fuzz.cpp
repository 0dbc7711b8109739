#include <cstdint>
#include <vector>

#include "base/error.h"
#include "io/meshopt.h"

/// Five bytes of layout, then what is packed: an Error or as many bytes as the layout has.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace candela::io;
  if (size < 5) return 0;
  MeshoptLayout layout;
  layout.mode = static_cast<MeshoptLayout::Mode>(data[0] % 3);
  layout.filter = static_cast<MeshoptLayout::Filter>(data[1] % 5);
  layout.count = data[2] | std::size_t{data[3]} << 8;
  layout.stride = data[4];
  const auto packed = std::as_bytes(std::span(data + 5, size - 5));
  if (!meshopt_fault(layout).empty() || packed.size() < meshopt_least_bytes(layout)) return 0;
  try {
    std::vector<std::byte> decoded(layout.count * layout.stride);
    decode_meshopt(packed, layout, decoded);
  } catch (const candela::Error&) {
  }
  return 0;
}
