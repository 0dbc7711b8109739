#include "base/error.h"
#include "image/texture_file.h"

/// Any bytes: an Error or pixels. Memory is bounded by what the caller allows, whatever a file says.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace candela;
  constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 24;
  try {
    const TextureFile file = decode_texture_file(std::as_bytes(std::span(data, size)), {}, kMostBytes);
    for (const auto& level : file.levels)
      for (const Image& face : level)
        if (face.empty()) std::abort();
  } catch (const Error&) {
  }
  try {
    if (decode_texture_pixels(std::as_bytes(std::span(data, size)), {}, kMostBytes).pixels.empty()) std::abort();
  } catch (const Error&) {
  }
  return 0;
}
