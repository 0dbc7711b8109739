#include "image/rgbd.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/check.h"
#include "shade/color.glsl.h"

namespace candela {

Image image_from_rgbd(const TextureImage& texels) {
  Image result(texels.width, texels.height, 3);
  const std::size_t bytes = texels.bits == 16 ? 2 : 1;
  const float scale = 1.0f / (bytes == 2 ? 65535.0f : 255.0f);
  const std::size_t count = static_cast<std::size_t>(texels.width) * static_cast<std::size_t>(texels.height);
  CANDELA_CHECK(texels.pixels.size() == count * 4 * bytes);
  for (std::size_t i = 0; i < count; ++i) {
    vec4 code(0.0f);
    for (std::size_t c = 0; c < 4; ++c) {
      const std::size_t at = (i * 4 + c) * bytes;
      std::uint16_t wide = texels.pixels[at];
      if (bytes == 2) std::memcpy(&wide, &texels.pixels[at], sizeof wide);
      code[static_cast<int>(c)] = static_cast<float>(wide) * scale;
    }
    const vec3 light = shade::srgb_decode(vec3(code)) / std::max(code.w, 1.0f / 255.0f);
    for (std::size_t c = 0; c < 3; ++c) result.pixels[i * 3 + c] = light[static_cast<int>(c)];
  }
  return result;
}

TextureImage rgbd_from_image(const Image& radiance, EncodingLoss& loss) {
  TextureImage result;
  result.width = radiance.width;
  result.height = radiance.height;
  result.has_alpha = true;
  result.pixels.reserve(static_cast<std::size_t>(radiance.width) * static_cast<std::size_t>(radiance.height) * 4);
  for (int y = 0; y < radiance.height; ++y) {
    for (int x = 0; x < radiance.width; ++x) {
      const vec3 color = radiance.rgb(x, y);
      if (!is_finite(color)) ++loss.non_finite;
      const vec3 light = is_finite(color) ? glm::max(color, vec3(0.0f)) : vec3(0.0f);
      loss.negative += is_finite(color) && light != color ? 1 : 0;
      const float largest = max_component(light);
      if (largest > kBrightestRgbd) {
        ++loss.clamped;
        loss.largest = std::max(loss.largest, largest);
      }
      const float divisor = std::clamp(std::floor(255.0f / std::max(largest, 1.0f)), 1.0f, 255.0f);
      const vec3 coded = shade::srgb_encode(glm::min(light * (divisor / 255.0f), vec3(1.0f)));
      for (int c = 0; c < 3; ++c) result.pixels.push_back(static_cast<std::uint8_t>(coded[c] * 255.0f + 0.5f));
      result.pixels.push_back(static_cast<std::uint8_t>(divisor));
    }
  }
  return result;
}

Image mirrored(const Image& image) {
  Image result(image.width, image.height, 3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) result.set_rgb(image.width - 1 - x, y, image.rgb(x, y));
  return result;
}

}  // namespace candela
