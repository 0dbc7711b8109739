#include "image/codec.h"
#include "image/texture_codec.h"

// Microsoft, "Programming Guide for DDS" (DDS_HEADER, DDS_PIXELFORMAT, DDS_HEADER_DXT10). Written with the DX10 header;
// the older way to name a format is read too.
namespace candela::codec {

namespace {

constexpr std::uint32_t kHeaderSize = 124, kPixelFormatSize = 32;
constexpr std::uint32_t kFlagCaps = 0x1, kFlagHeight = 0x2, kFlagWidth = 0x4, kFlagPitch = 0x8, kFlagFormat = 0x1000,
                        kFlagMipmaps = 0x20000;
constexpr std::uint32_t kFormatFourCc = 0x4, kFormatRgb = 0x40;
constexpr std::uint32_t kCapsComplex = 0x8, kCapsTexture = 0x1000, kCapsMipmap = 0x400000;
constexpr std::uint32_t kCapsCube = 0x200, kCapsAllFaces = 0xfc00, kCapsVolume = 0x200000;
constexpr std::uint32_t kDx10 = 0x30315844;  // "DX10"
constexpr std::uint32_t kTexture2d = 3, kMiscCube = 0x4;

struct PixelFormat {
  std::uint32_t flags, four_cc, bits, red_mask, green_mask, blue_mask;
};

void name_format(std::optional<TexelFormat> texel, const std::string& otherwise, TextureInfo& info) {
  info.texel = texel;
  info.format = texel ? std::string(texel_layout(*texel).name) : otherwise;
}

void name_dxgi(std::uint32_t number, TextureInfo& info) {
  std::optional<TexelFormat> texel;
  for (const TexelLayout& layout : texel_layouts())
    if (number != 0 && layout.dxgi_format == number) texel = layout.format;
  const std::string other = number == 95   ? "bc6h-ufloat"
                            : number == 96 ? "bc6h-sfloat"
                                           : "DXGI " + std::to_string(number);
  name_format(texel, other, info);
}

/// Formats from before the DX10 header: numbers of D3DFORMAT in place of four characters, or masks.
void name_legacy(const PixelFormat& format, TextureInfo& info) {
  if ((format.flags & kFormatFourCc) != 0) {
    static const std::map<std::uint32_t, TexelFormat> numbers{{111, TexelFormat::r16f},    {112, TexelFormat::rg16f},
                                                              {113, TexelFormat::rgba16f}, {114, TexelFormat::r32f},
                                                              {115, TexelFormat::rg32f},   {116, TexelFormat::rgba32f}};
    const auto found = numbers.find(format.four_cc);
    std::string name = "FourCC ";
    for (int i = 0; i < 4; ++i) {
      const char c = static_cast<char>(format.four_cc >> (8 * i) & 255u);
      name += c >= ' ' && c <= '~' ? c : '?';
    }
    return name_format(found != numbers.end() ? std::optional(found->second) : std::nullopt, name, info);
  }
  const bool is_rgb = (format.flags & kFormatRgb) != 0 && format.bits == 32 && format.green_mask == 0xff00;
  if (is_rgb && format.red_mask == 0xff && format.blue_mask == 0xff0000)
    return name_format(TexelFormat::rgba8, {}, info);
  if (is_rgb && format.red_mask == 0xff0000 && format.blue_mask == 0xff)
    return name_format(TexelFormat::bgra8, {}, info);
  name_format(std::nullopt, std::to_string(format.bits) + " bits per texel", info);
}

}  // namespace

StoredTexture parse_dds(std::span<const std::byte> bytes, const std::string& where) {
  ByteReader in(bytes, where);
  in.seek(4);
  StoredTexture texture;
  TextureInfo& info = texture.info;
  info.container = TextureContainer::dds;

  // ----- header
  if (in.u32() != kHeaderSize) throw Error("damaged: a DDS header has 124 bytes", where);
  const std::uint32_t flags = in.u32(), height = in.u32(), width = in.u32();
  in.u32();  // pitch
  const std::uint32_t depth = in.u32(), stated_levels = in.u32();
  const std::uint32_t levels = (flags & kFlagMipmaps) != 0 ? std::max(stated_levels, 1u) : 1u;
  in.take(44);
  if (in.u32() != kPixelFormatSize) throw Error("damaged: a DDS pixel format has 32 bytes", where);
  PixelFormat format{};
  format.flags = in.u32(), format.four_cc = in.u32(), format.bits = in.u32();
  format.red_mask = in.u32(), format.green_mask = in.u32(), format.blue_mask = in.u32();
  in.u32();  // alpha
  in.u32();  // caps
  const std::uint32_t caps2 = in.u32();
  in.take(12);
  bool is_cube = (caps2 & kCapsCube) != 0;
  if (is_cube && (caps2 & kCapsAllFaces) != kCapsAllFaces)
    throw Error("cube maps without all six faces are not read", where);
  if ((caps2 & kCapsVolume) != 0) info.depth = static_cast<int>(std::min(depth, 65535u));
  if ((format.flags & kFormatFourCc) != 0 && format.four_cc == kDx10) {
    name_dxgi(in.u32(), info);
    const std::uint32_t dimension = in.u32();
    is_cube = (in.u32() & kMiscCube) != 0;
    info.layers = static_cast<int>(std::min(in.u32(), 65535u));
    in.u32();
    if (dimension != kTexture2d && info.depth <= 1) info.depth = 65535;  // a line or a volume: not read
  } else {
    name_legacy(format, info);
  }
  check_shape(info, width, height, is_cube ? 6 : 1, levels, where);
  info.width = static_cast<int>(width);
  info.height = static_cast<int>(height);
  info.faces = is_cube ? 6 : 1;

  // ----- face by face, each with all its levels
  info.level_bytes.assign(levels, 0);
  info.is_read = info.texel && info.depth <= 1 && info.layers <= 1;
  if (!info.is_read) return texture;
  texture.levels.resize(levels);
  for (int face = 0; face < info.faces; ++face) {
    for (std::size_t i = 0; i < levels; ++i) {
      StoredLevel& level = texture.levels[i];
      level.width = level_size(info.width, i);
      level.height = level_size(info.height, i);
      level.faces.push_back(in.take(face_bytes(texel_layout(*info.texel), level.width, level.height, 1)));
      info.level_bytes[i] += level.faces.back().size();
    }
  }
  return texture;
}

std::vector<std::byte> pack_dds(const EncodedTexture& texture, const std::string& where) {
  const TexelLayout& layout = texel_layout(texture.format);
  if (layout.dxgi_format == 0) throw Error("DDS has no name for " + std::string(layout.name), where);
  const bool is_cube = texture.faces == 6;
  const auto levels = static_cast<std::uint32_t>(texture.levels.size());
  ByteWriter out;
  out.text("DDS ");
  out.u32(kHeaderSize);
  out.u32(kFlagCaps | kFlagHeight | kFlagWidth | kFlagPitch | kFlagFormat | (levels > 1 ? kFlagMipmaps : 0));
  out.u32(static_cast<std::uint32_t>(texture.height));
  out.u32(static_cast<std::uint32_t>(texture.width));
  out.u32(static_cast<std::uint32_t>(static_cast<std::size_t>(texture.width) * layout.bytes));
  out.u32(0);  // depth
  out.u32(levels);
  out.zeros(44);
  out.u32(kPixelFormatSize);
  out.u32(kFormatFourCc);
  out.u32(kDx10);
  out.zeros(20);
  out.u32(kCapsTexture | (is_cube || levels > 1 ? kCapsComplex : 0) | (levels > 1 ? kCapsMipmap : 0));
  out.u32(is_cube ? kCapsCube | kCapsAllFaces : 0);
  out.zeros(12);
  out.u32(layout.dxgi_format);
  out.u32(kTexture2d);
  out.u32(is_cube ? kMiscCube : 0);
  out.u32(1);  // layers; a cube counts as one
  out.u32(0);
  for (std::size_t face = 0; face < static_cast<std::size_t>(texture.faces); ++face)
    for (const auto& level : texture.levels) out.append(level[face]);
  return std::move(out.bytes);
}

}  // namespace candela::codec
