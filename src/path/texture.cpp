#include "path/texture.h"

#include <cstring>

#include "shade/color.glsl.h"

namespace candela::path {

namespace {

template <class F>
std::array<float, 256> make_table(F decode) {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = decode(static_cast<float>(i) / 255.0f);
  return table;
}

const float* decode_table(Encoding encoding) {
  static const std::array<float, 256> srgb = make_table(shade::srgb_decode_channel);
  static const std::array<float, 256> data = make_table([](float v) { return v; });
  return encoding == Encoding::srgb ? srgb.data() : data.data();
}

}  // namespace

TextureReader::TextureReader(const Scene& scene, const TextureSlot& slot, Encoding encoding) {
  if (!slot) return;
  const Texture& texture = scene.textures[static_cast<std::size_t>(slot.texture)];
  const TextureImage& image = *scene.images[static_cast<std::size_t>(texture.image)];
  pixels_ = image.pixels.data();
  decode_ = decode_table(encoding);
  width_ = image.width;
  height_ = image.height;
  is_16_bit_ = image.bits == 16;
  encoding_ = encoding;
  wrap_u_ = texture.wrap_u;
  wrap_v_ = texture.wrap_v;
  filter_ = texture.filter;
  slot_ = slot;
  is_identity_ = slot.transform == TextureSlot{}.transform;
}

inline vec4 TextureReader::texel(std::uint32_t offset) const {
  const std::size_t index = std::size_t{offset} * 4;
  if (!is_16_bit_) {
    const std::uint8_t* p = pixels_ + index;
    return {decode_[p[0]], decode_[p[1]], decode_[p[2]], static_cast<float>(p[3]) * (1.0f / 255.0f)};
  }
  std::array<std::uint16_t, 4> p;
  std::memcpy(p.data(), pixels_ + index * 2, sizeof p);
  vec4 v = vec4(p[0], p[1], p[2], p[3]) * (1.0f / 65535.0f);
  if (encoding_ == Encoding::srgb) v = {shade::srgb_decode(vec3(v)), v.w};
  return v;
}

/// Into [0, 1]; mirrored repeat is a triangle wave. Infinite coordinates and NaN become 0: max(0, NaN) is 0 in this
/// order.
inline float TextureReader::wrap_unit(float t, Wrap wrap) {
  switch (wrap) {
    case Wrap::repeat:
      return glm::max(0.0f, t - std::floor(t));
    case Wrap::clamp_to_edge:
      return glm::min(glm::max(0.0f, t), 1.0f);
    case Wrap::mirrored_repeat: {
      const float m = glm::max(0.0f, t - 2.0f * std::floor(0.5f * t));
      return m > 1.0f ? 2.0f - m : m;
    }
  }
  return t;
}

inline int TextureReader::wrap_index(int i, int size, Wrap wrap) const {
  if (i >= 0 && i < size) return i;
  if (wrap == Wrap::repeat) return i < 0 ? i + size : i - size;
  return i < 0 ? 0 : size - 1;
}

TextureReader::Footprint TextureReader::locate(vec2 uv) const {
  if (!is_identity_) uv = slot_.apply(uv);
  const float x = wrap_unit(uv.x, wrap_u_) * static_cast<float>(width_);
  const float y = wrap_unit(uv.y, wrap_v_) * static_cast<float>(height_);
  Footprint f;
  int x0 = glm::min(static_cast<int>(x), width_ - 1);
  int y0 = glm::min(static_cast<int>(y), height_ - 1);
  int x1 = x0;
  int y1 = y0;
  f.tx = f.ty = 0.0f;
  if (filter_ == Filter::linear) {
    const float fx = std::floor(x - 0.5f);
    const float fy = std::floor(y - 0.5f);
    f.tx = x - 0.5f - fx;
    f.ty = y - 0.5f - fy;
    x0 = wrap_index(static_cast<int>(fx), width_, wrap_u_);
    y0 = wrap_index(static_cast<int>(fy), height_, wrap_v_);
    x1 = wrap_index(static_cast<int>(fx) + 1, width_, wrap_u_);
    y1 = wrap_index(static_cast<int>(fy) + 1, height_, wrap_v_);
  }
  const auto w = static_cast<std::uint32_t>(width_);
  const std::uint32_t top = static_cast<std::uint32_t>(y0) * w;
  const std::uint32_t bottom = static_cast<std::uint32_t>(y1) * w;
  f.offsets[0] = top + static_cast<std::uint32_t>(x0);
  f.offsets[1] = top + static_cast<std::uint32_t>(x1);
  f.offsets[2] = bottom + static_cast<std::uint32_t>(x0);
  f.offsets[3] = bottom + static_cast<std::uint32_t>(x1);
  prefetch(f);
  return f;
}

bool TextureReader::is_addressed_like(const TextureReader& other) const {
  return width_ == other.width_ && height_ == other.height_ && wrap_u_ == other.wrap_u_ && wrap_v_ == other.wrap_v_ &&
         filter_ == other.filter_ && slot_.uv_set == other.slot_.uv_set && slot_.transform == other.slot_.transform;
}

vec4 TextureReader::read(const Footprint& f) const {
  if (filter_ == Filter::nearest) return texel(f.offsets[0]);
  const vec4 top = texel(f.offsets[0]) * (1.0f - f.tx) + texel(f.offsets[1]) * f.tx;
  const vec4 bottom = texel(f.offsets[2]) * (1.0f - f.tx) + texel(f.offsets[3]) * f.tx;
  return top * (1.0f - f.ty) + bottom * f.ty;
}

std::array<TextureReader, kTextureSlots> texture_readers(const Scene& scene, const Material& material) {
  std::array<TextureReader, kTextureSlots> readers;
  for (std::size_t i = 0; i < kTextureSlots; ++i) {
    const TextureRow& row = kTextureRows[i];
    readers[i] = TextureReader(scene, material.*row.slot, row.is_srgb() ? Encoding::srgb : Encoding::data);
  }
  return readers;
}

}  // namespace candela::path
