#include <cstdlib>
#include <string>

#include "base/error.h"
#include "image/codec.h"

/// Any bytes as a Radiance or an OpenEXR picture: an image that holds what its size says, or an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace candela;
  const auto bytes = std::as_bytes(std::span(data, size));
  try {
    const bool is_exr = sniff_image_format(bytes) == ImageFormat::exr;
    const ImageFile file = is_exr ? codec::decode_exr(bytes, {}, {}) : codec::decode_hdr(bytes, {});
    const auto texels = static_cast<std::size_t>(file.image.width) * static_cast<std::size_t>(file.image.height);
    if (file.image.pixels.size() != texels * static_cast<std::size_t>(file.image.channels)) std::abort();
  } catch (const Error&) {
  }
  return 0;
}
