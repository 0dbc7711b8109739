#include "path/texture.h"

#include <cstring>

#include "shade/color.glsl.h"
#include "shade/footprint.glsl.h"

namespace candela::path {

namespace {

static_assert(static_cast<int>(Wrap::repeat) == shade::kFootprintRepeat);
static_assert(static_cast<int>(Wrap::clamp_to_edge) == shade::kFootprintClamp);
static_assert(static_cast<int>(Wrap::mirrored_repeat) == shade::kFootprintMirror);

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

TextureReader::Footprint TextureReader::locate(vec2 uv) const {
  if (!is_identity_) uv = slot_.apply(uv);
  const float x = shade::footprint_unit(uv.x, static_cast<int>(wrap_u_));
  const float y = shade::footprint_unit(uv.y, static_cast<int>(wrap_v_));
  shade::FootprintAxis across = shade::footprint_nearest(x, width_);
  shade::FootprintAxis down = shade::footprint_nearest(y, height_);
  if (filter_ == Filter::linear) {
    across = shade::footprint_linear(x, width_, static_cast<int>(wrap_u_));
    down = shade::footprint_linear(y, height_, static_cast<int>(wrap_v_));
  }
  const auto w = static_cast<std::uint32_t>(width_);
  const std::uint32_t top = static_cast<std::uint32_t>(down.first) * w;
  const std::uint32_t bottom = static_cast<std::uint32_t>(down.second) * w;
  Footprint f;
  f.tx = across.share;
  f.ty = down.share;
  f.offsets[0] = top + static_cast<std::uint32_t>(across.first);
  f.offsets[1] = top + static_cast<std::uint32_t>(across.second);
  f.offsets[2] = bottom + static_cast<std::uint32_t>(across.first);
  f.offsets[3] = bottom + static_cast<std::uint32_t>(across.second);
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
