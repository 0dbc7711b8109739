#pragma once

#include <array>
#include <cmath>

#include "scene/material_table.h"
#include "scene/scene.h"

namespace candela::path {

enum class Encoding { srgb, data };

/// Reads one slot of a material: transforms uv, wraps, filters, decodes. Refers to the scene's own pixels (no copy).
class TextureReader {
 public:
  TextureReader() = default;
  TextureReader(const Scene& scene, const TextureSlot& slot, Encoding encoding);

  explicit operator bool() const { return pixels_ != nullptr; }
  int uv_set() const { return slot_.uv_set; }
  ivec2 size() const { return {width_, height_}; }

  /// Where a lookup will read. Finding it starts the memory access, so several textures wait for memory together.
  struct Footprint {
    std::uint32_t offsets[4];  ///< texels: top left, top right, bottom left, bottom right
    float tx, ty;
  };
  Footprint locate(vec2 uv) const;
  /// Whether a footprint of `other` is one of this too: sizes, sampler and coordinates are the same.
  bool is_addressed_like(const TextureReader& other) const;
  /// Starts the memory access of a footprint that was found for another.
  void prefetch(const Footprint& footprint) const {
    const std::size_t texel_bytes = is_16_bit_ ? 8 : 4;
    __builtin_prefetch(pixels_ + footprint.offsets[0] * texel_bytes);
    __builtin_prefetch(pixels_ + footprint.offsets[2] * texel_bytes);
  }
  vec4 read(const Footprint& footprint) const;

  /// Linear RGBA at the authored (untransformed) uv.
  vec4 sample(vec2 uv) const { return read(locate(uv)); }

 private:
  vec4 texel(std::uint32_t offset) const;

  const std::uint8_t* pixels_ = nullptr;
  const float* decode_ = nullptr;  ///< 256 values for R, G and B
  int width_ = 0;
  int height_ = 0;
  bool is_16_bit_ = false;
  bool is_identity_ = true;
  Encoding encoding_ = Encoding::data;
  Wrap wrap_u_ = Wrap::repeat;
  Wrap wrap_v_ = Wrap::repeat;
  Filter filter_ = Filter::linear;
  TextureSlot slot_;
};

/// One for each slot of a material, by the rows of kTextureRows.
std::array<TextureReader, kTextureSlots> texture_readers(const Scene& scene, const Material& material);

}  // namespace candela::path
