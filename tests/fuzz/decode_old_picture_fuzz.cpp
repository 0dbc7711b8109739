#include <cstdlib>

#include "base/error.h"
#include "foreign/old_pictures.h"

/// Any bytes: no TGA or BMP, an Error, or as many texels as it says.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace candela;
  try {
    const auto image = foreign::decode_old_picture(std::as_bytes(std::span(data, size)), {});
    if (image && image->pixels.size() != std::size_t{4} * static_cast<std::size_t>(image->width) *
                                             static_cast<std::size_t>(image->height)) {
      std::abort();
    }
  } catch (const Error&) {
  }
  return 0;
}
