#include <algorithm>
#include <bit>

#include "image/codec.h"
#include "image/texture_codec.h"

// A texture file as a picture of a material: the largest image, as it is stored.
namespace candela {

namespace {

using codec::StoredTexture;

/// Also for a header alone.
void check_picture(const StoredTexture& stored, const std::string& where) {
  codec::check_kind(stored, where);
  if (stored.info.faces != 1) throw Error("a cube map is no picture", where);
}

/// Whether texels are codes of 8 bits.
bool is_coded(const TextureInfo& info) {
  return info.block ? !info.block->is_hdr : texel_layout(*info.texel).type_bytes == 1;
}

bool has_alpha(const TextureInfo& info) {
  return info.block ? info.channels == TextureChannels::rgba : texel_layout(*info.texel).channels == 4;
}

std::vector<std::uint8_t> rgba_of_codes(const TexelLayout& layout, std::span<const std::byte> texels) {
  constexpr std::uint32_t kBgra = 0x80e1;
  const auto channels = static_cast<std::size_t>(layout.channels);
  std::vector<std::uint8_t> rgba(texels.size() / layout.bytes * 4, 255);
  for (std::size_t i = 0; i < rgba.size() / 4; ++i) {
    for (std::size_t c = 0; c < channels; ++c)
      rgba[4 * i + c] = std::to_integer<std::uint8_t>(texels[i * layout.bytes + c]);
    if (layout.gl_format == kBgra) std::swap(rgba[4 * i], rgba[4 * i + 2]);
  }
  return rgba;
}

/// NaN becomes 0.
std::vector<std::uint8_t> sixteen_bits(std::span<const float> rgba) {
  std::vector<std::uint8_t> out(rgba.size() * 2);
  for (std::size_t i = 0; i < rgba.size(); ++i) {
    const float clamped = rgba[i] > 0.0f ? std::min(rgba[i], 1.0f) : 0.0f;
    const auto code = static_cast<std::uint16_t>(clamped * 65535.0f + 0.5f);
    std::memcpy(out.data() + 2 * i, &code, sizeof code);
  }
  return out;
}

}  // namespace

ImageHeader codec::texture_header(std::span<const std::byte> bytes, const std::string& where) {
  const StoredTexture stored = parse_texture(bytes, where);
  check_picture(stored, where);
  const TextureInfo& info = stored.info;
  check_texture_size(static_cast<std::uint64_t>(info.width), static_cast<std::uint64_t>(info.height),
                     is_coded(info) ? 4 : 8, where);
  return {{info.width, info.height}, is_coded(info) ? 8 : 16, has_alpha(info)};
}

TextureImage decode_texture_pixels(std::span<const std::byte> bytes, const std::string& where,
                                   std::uint64_t max_bytes) {
  const StoredTexture stored = codec::parse_texture(bytes, where);
  const TextureInfo& info = stored.info;
  check_picture(stored, where);
  // Numbers are decoded as floats first.
  codec::check_pixels(info, static_cast<std::uint64_t>(info.width) * static_cast<std::uint64_t>(info.height),
                      is_coded(info) ? 4 : 16, max_bytes, where);
  TextureImage image;
  image.width = info.width;
  image.height = info.height;
  image.bits = is_coded(info) ? 8 : 16;
  image.has_alpha = has_alpha(info);
  std::vector<std::byte> storage;
  const std::span<const std::byte> face = codec::unpacked_faces(stored, stored.levels[0], storage, where)[0];
  if (info.block) {
    codec::BlockReader reader(stored, where);
    image.pixels = is_coded(info) ? reader.codes(0, 0, face) : sixteen_bits(reader.numbers(0, face));
  } else if (is_coded(info)) {
    image.pixels = rgba_of_codes(texel_layout(*info.texel), face);
  } else {
    std::vector<float> rgba(static_cast<std::size_t>(info.width) * static_cast<std::size_t>(info.height) * 4);
    decode_texels(*info.texel, face, 4, rgba);
    image.pixels = sixteen_bits(rgba);
  }
  return image;
}

}  // namespace candela
