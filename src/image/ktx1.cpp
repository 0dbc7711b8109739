#include "image/codec.h"
#include "image/texture_codec.h"

// Khronos Group, "KTX File Format Specification" 1.1.
namespace candela::codec {

namespace {

constexpr std::string_view kIdentifier = "\xabKTX 11\xbb\r\n\x1a\n";
constexpr std::uint32_t kEndianness = 0x04030201;
constexpr std::size_t kRowAlignment = 4;         // GL_UNPACK_ALIGNMENT
constexpr std::uint32_t kFilamentType = 0x8c3a;  // GL_R11F_G11F_B10F, where a type should stand

void name_format(std::uint32_t gl_type, std::uint32_t gl_format, std::uint32_t gl_internal, TextureInfo& info) {
  for (const TexelLayout& layout : texel_layouts()) {
    const bool is_type =
        layout.gl_type == gl_type || (layout.format == TexelFormat::r11g11b10f && gl_type == kFilamentType);
    if (!is_type || layout.gl_format != gl_format || layout.gl_internal != gl_internal) continue;
    info.texel = layout.format;
    info.format = layout.name;
    return;
  }
  char text[32];
  std::snprintf(text, sizeof text, "GL 0x%04x", gl_internal);
  info.format = text;
}

}  // namespace

StoredTexture parse_ktx1(std::span<const std::byte> bytes, const std::string& where) {
  ByteReader in(bytes, where);
  in.seek(kIdentifier.size());
  if (in.u32() != kEndianness) throw Error("KTX files with the large end first are not read", where);
  StoredTexture texture;
  texture.row_alignment = kRowAlignment;
  TextureInfo& info = texture.info;
  info.container = TextureContainer::ktx1;

  const std::uint32_t gl_type = in.u32();
  in.u32();  // size of the type
  const std::uint32_t gl_format = in.u32(), gl_internal = in.u32();
  in.u32();  // base internal format
  const std::uint32_t width = in.u32(), height = in.u32(), depth = in.u32(), layers = in.u32(), faces = in.u32();
  const std::uint32_t levels = std::max(in.u32(), 1u);  // 0 = one, and the reader may make the others
  if (depth > kMaxTextureSize || layers > kMaxTextureSize) throw Error("damaged: a texture of too many layers", where);
  info.depth = static_cast<int>(depth);
  info.layers = static_cast<int>(layers);
  check_shape(info, width, height, faces, levels, where);
  info.width = static_cast<int>(width);
  info.height = static_cast<int>(height);
  info.faces = static_cast<int>(faces);
  name_format(gl_type, gl_format, gl_internal, info);
  parse_key_values(in.take(in.u32()), info, where);

  info.is_read = info.texel && depth <= 1 && layers == 0;
  for (std::size_t i = 0; i < levels; ++i) {
    const std::uint32_t stated = in.u32();
    const bool is_cube = faces == 6 && layers == 0;
    StoredLevel level{
        .width = level_size(info.width, i), .height = level_size(info.height, i), .faces = {}, .packed = {}};
    if (info.is_read && stated != face_bytes(texel_layout(*info.texel), level.width, level.height, kRowAlignment))
      throw Error("damaged: level " + std::to_string(i) + " has a face of " + std::to_string(stated) + " bytes", where);
    // The size counts one face of a cube, and everything of any other texture.
    for (std::uint32_t face = 0; face < (is_cube ? 6u : 1u); ++face) {
      level.faces.push_back(in.take(stated));
      in.seek((in.offset() + 3) / 4 * 4);
    }
    info.level_bytes.push_back(std::uint64_t{stated} * level.faces.size());
    if (info.is_read) texture.levels.push_back(std::move(level));
  }
  return texture;
}

std::vector<std::byte> pack_ktx1(const EncodedTexture& texture, bool has_filament_type) {
  const TexelLayout& layout = texel_layout(texture.format);
  ByteWriter out, key_values;
  pack_key_values(key_values, "S=r,T=d", texture.key_values);

  out.text(kIdentifier);
  out.u32(kEndianness);
  out.u32(has_filament_type && texture.format == TexelFormat::r11g11b10f ? kFilamentType : layout.gl_type);
  out.u32(layout.type_bytes);
  out.u32(layout.gl_format);
  out.u32(layout.gl_internal);
  out.u32(layout.gl_format);
  out.u32(static_cast<std::uint32_t>(texture.width));
  out.u32(static_cast<std::uint32_t>(texture.height));
  out.u32(0);  // depth
  out.u32(0);  // layers
  out.u32(static_cast<std::uint32_t>(texture.faces));
  out.u32(static_cast<std::uint32_t>(texture.levels.size()));
  out.u32(static_cast<std::uint32_t>(key_values.bytes.size()));
  out.append(key_values.bytes);
  for (std::size_t i = 0; i < texture.levels.size(); ++i) {
    const int width = level_size(texture.width, i), height = level_size(texture.height, i);
    const std::size_t row = static_cast<std::size_t>(width) * layout.bytes;
    out.u32(static_cast<std::uint32_t>(face_bytes(layout, width, height, kRowAlignment)));
    for (const auto& face : texture.levels[i]) {
      for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
        out.append(std::span(face).subspan(y * row, row));
        out.align(kRowAlignment);
      }
    }
  }
  return std::move(out.bytes);
}

}  // namespace candela::codec
