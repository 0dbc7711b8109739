#include <string>

#include "base/error.h"
#include "image/image_file.h"

/// Any bytes: what their header says of PNG, JPEG, WebP and AVIF is what decoding gives, or it is an Error. Large
/// pictures are allowed and only slow.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace candela;
  constexpr std::int64_t kMostPixels = 1 << 20;
  const auto bytes = std::as_bytes(std::span(data, size));
  try {
    const ImageHeader header = read_image_header(bytes, {});
    if (std::int64_t{header.size.x} * header.size.y > kMostPixels) return 0;
    const TextureImage image = decode_texture(bytes, {});
    const std::size_t texels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    const std::size_t texel_bytes = image.bits == 16 ? 8 : 4;
    if (ivec2(image.width, image.height) != header.size || image.pixels.size() != texels * texel_bytes) {
      std::abort();
    }
  } catch (const Error&) {
  }
  return 0;
}
