#include "raster/opacity.h"

#include <algorithm>
#include <cstring>

#include "scene/cutoff.h"

namespace candela::raster {

namespace {

float alpha_at(const TextureImage& image, std::size_t texel) {
  if (image.bits != 16) return static_cast<float>(image.pixels[4 * texel + 3]) / 255.0f;
  std::uint16_t word = 0;
  std::memcpy(&word, image.pixels.data() + 2 * (4 * texel + 3), sizeof word);
  return static_cast<float>(word) / 65535.0f;
}

}  // namespace

AlphaRange alpha_of_image(const TextureImage& image) {
  if (image.pixels.empty()) return {};
  AlphaRange range{1.0f, 0.0f};
  const auto texels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  for (std::size_t i = 0; i < texels; ++i) {
    const float a = alpha_at(image, i);
    range.least = std::min(range.least, a), range.most = std::max(range.most, a);
  }
  return range;
}

AlphaRange alpha_of_vertices(const Primitive& primitive) {
  if (primitive.colors.empty()) return {};
  AlphaRange range{kInfinity, 0.0f};
  for (const vec4& color : primitive.colors) {
    range.least = std::min(range.least, color.w), range.most = std::max(range.most, color.w);
  }
  return range;
}

AlphaMode drawn_mode(const Material& material, const AlphaRange& range) {
  switch (material.alpha_mode) {
    case AlphaMode::opaque:
      return AlphaMode::opaque;
    case AlphaMode::mask:
      return range.least >= drawn_cutoff(material.alpha_cutoff) ? AlphaMode::opaque : AlphaMode::mask;
    case AlphaMode::blend:
      return range.least >= kOpaqueAlpha ? AlphaMode::opaque : AlphaMode::blend;
  }
  return material.alpha_mode;
}

}  // namespace candela::raster
