#include "raster/opacity.h"

#include <algorithm>
#include <cstring>

namespace candela::raster {

namespace {

const TextureImage* image_of(const Scene& scene, const TextureSlot& slot) {
  if (!slot) return nullptr;
  const Texture& texture = scene.textures[static_cast<std::size_t>(slot.texture)];
  const TextureImage& image = *scene.images[static_cast<std::size_t>(texture.image)];
  return image.pixels.empty() ? nullptr : &image;
}

float alpha_at(const TextureImage& image, std::size_t texel) {
  if (image.bits != 16) return static_cast<float>(image.pixels[4 * texel + 3]) / 255.0f;
  std::uint16_t word = 0;
  std::memcpy(&word, image.pixels.data() + 2 * (4 * texel + 3), sizeof word);
  return static_cast<float>(word) / 65535.0f;
}

float wrapped(float u, Wrap wrap) {
  switch (wrap) {
    case Wrap::repeat:
      return u - std::floor(u);
    case Wrap::clamp_to_edge:
      return glm::clamp(u, 0.0f, 1.0f);
    case Wrap::mirrored_repeat:
      return 1.0f - std::abs(u - 2.0f * std::floor(0.5f * u) - 1.0f);
  }
  return u;
}

}  // namespace

AlphaRange alpha_of_material(const Scene& scene, const Material& material) {
  AlphaRange range;
  if (const TextureImage* image = image_of(scene, material.base_color_texture)) {
    const auto texels = static_cast<std::size_t>(image->width) * static_cast<std::size_t>(image->height);
    range = {1.0f, 0.0f};
    for (std::size_t i = 0; i < texels; ++i) {
      const float a = alpha_at(*image, i);
      range.least = std::min(range.least, a), range.most = std::max(range.most, a);
    }
  }
  return range * AlphaRange{material.opacity, material.opacity};
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

float mean_opacity(const Scene& scene, const Primitive& primitive, const Material& material) {
  if (material.alpha_mode == AlphaMode::opaque) return 1.0f;
  const AlphaRange range = alpha_of_material(scene, material) * alpha_of_vertices(primitive);
  if (drawn_mode(material, range) == AlphaMode::opaque) return 1.0f;
  const TextureSlot& slot = material.base_color_texture;
  const TextureImage* image = image_of(scene, slot);
  const auto& uvs = primitive.uvs[slot.uv_set == 1 && !primitive.uvs[1].empty() ? 1 : 0];
  const auto opacity_at = [&](const uvec3& t, vec3 b) {
    float a = material.opacity;
    if (!primitive.colors.empty()) {
      a *= primitive.colors[t.x].w * b.x + primitive.colors[t.y].w * b.y + primitive.colors[t.z].w * b.z;
    }
    if (image != nullptr) {
      const Texture& texture = scene.textures[static_cast<std::size_t>(slot.texture)];
      vec2 uv = slot.apply(uvs.empty() ? vec2(0.0f) : uvs[t.x] * b.x + uvs[t.y] * b.y + uvs[t.z] * b.z);
      uv = {wrapped(uv.x, texture.wrap_u), wrapped(uv.y, texture.wrap_v)};
      const auto nearest = [](float u, int size) {
        return static_cast<std::size_t>(std::min(static_cast<int>(u * static_cast<float>(size)), size - 1));
      };
      a *= alpha_at(
          *image, nearest(uv.y, image->height) * static_cast<std::size_t>(image->width) + nearest(uv.x, image->width));
    }
    if (material.alpha_mode == AlphaMode::mask) return a >= drawn_cutoff(material.alpha_cutoff) ? 1.0f : 0.0f;
    return glm::clamp(a, 0.0f, 1.0f);
  };
  // A few points of each triangle, the more the fewer triangles there are.
  const int side = primitive.triangles.size() <= 64 ? 24 : 4;
  float sum = 0.0f, weight = 0.0f;
  for (const uvec3& t : primitive.triangles) {
    const vec3 a = primitive.positions[t.x];
    const float area = glm::length(glm::cross(primitive.positions[t.y] - a, primitive.positions[t.z] - a));
    for (int i = 0; i < side; ++i) {
      for (int j = 0; j < 2 * (side - i) - 1; ++j) {
        // Middles of the triangles that the sides' division makes, of either way up.
        const float shift = j % 2 == 0 ? 1.0f / 3.0f : 2.0f / 3.0f;
        const vec2 at = (vec2(i, j / 2) + shift) / static_cast<float>(side);
        sum += area * opacity_at(t, {1.0f - at.x - at.y, at.x, at.y});
        weight += area;
      }
    }
  }
  return weight > 0.0f ? sum / weight : 1.0f;
}

}  // namespace candela::raster
