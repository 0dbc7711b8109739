#include "base/error.h"
#include "image/browser_pictures.h"
#include "image/codec.h"

// AVIF where the browser alone decodes it: 8 bits of every channel.
namespace candela {

namespace {

const TextureImage& decoded(std::span<const std::byte> bytes, const std::string& where) {
  const TextureImage* picture = find_browser_picture(bytes);
  if (picture == nullptr) throw Error("damaged AVIF, or none that this browser decodes", where);
  return *picture;
}

}  // namespace

ImageHeader codec::avif_header(std::span<const std::byte> bytes, const std::string& where) {
  const TextureImage& picture = decoded(bytes, where);
  check_texture_size(static_cast<std::uint64_t>(picture.width), static_cast<std::uint64_t>(picture.height), 4, where);
  return {.size = {picture.width, picture.height}, .bits = picture.bits, .has_alpha = picture.has_alpha};
}

TextureImage codec::decode_avif(std::span<const std::byte> bytes, const std::string& where) {
  return decoded(bytes, where);
}

}  // namespace candela
