#include "foreign/old_pictures.h"

#include <fmt/format.h>

#include "base/error.h"
#include "foreign/texel_canvas.h"

namespace candela::foreign {

Canvas::Canvas(std::int64_t width, std::int64_t height, const std::string& where) {
  if (width < 1 || height < 1) throw Error("a picture without texels", where);
  if (width > kMostTexels || height > kMostTexels) {
    throw Error(fmt::format("image of {} x {} is too large: a side has at most {} pixels", width, height, kMostTexels),
                where);
  }
  image_.width = static_cast<int>(width);
  image_.height = static_cast<int>(height);
  image_.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
}

TextureImage Canvas::finish(bool may_have_alpha) {
  bool has_alpha = false;
  for (std::size_t i = 3; may_have_alpha && i < image_.pixels.size() && !has_alpha; i += 4) {
    has_alpha = image_.pixels[i] != 0;
  }
  for (std::size_t i = 3; !has_alpha && i < image_.pixels.size(); i += 4) image_.pixels[i] = 255;
  image_.has_alpha = has_alpha;
  return std::move(image_);
}

std::optional<TextureImage> decode_old_picture(std::span<const std::byte> bytes, const std::string& where) {
  if (is_bmp(bytes)) return decode_bmp(bytes, where);
  if (is_tga(bytes)) return decode_tga(bytes, where);
  return std::nullopt;
}

}  // namespace candela::foreign
