
#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "image/codec.h"
#include "image/texture_codec.h"
#include "image/zstandard.h"

// Khronos Group, "KTX File Format Specification" 2.0 and "Khronos Data Format Specification" 1.3, § 5 (the basic
// descriptor block).
namespace candela::codec {

namespace {

constexpr std::string_view kIdentifier = "\xabKTX 20\xbb\r\n\x1a\n";
constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kLevelIndexBytes = 24;  // per level
constexpr std::uint32_t kSchemeZstd = 2;

struct Scheme {
  Packing packing;
  std::string name;
};

Scheme scheme_of(std::uint32_t number) {
  switch (number) {
    case 0:
      return {Packing::none, "none"};
    case 1:
      return {Packing::basis_lz, "BasisLZ"};
    case kSchemeZstd:
      return {Packing::zstd, "zstd"};
    case 3:
      return {Packing::zlib, "zlib"};
    case 4:
      return {Packing::unknown, "UASTC HDR 6x6 intermediate"};
    case 5:
      return {Packing::unknown, "XUASTC"};
    default:
      return {Packing::unknown, "scheme " + std::to_string(number)};
  }
}

// ----- reading the data format descriptor

/// What of the basic descriptor block counts here; all 0 where there is none.
struct Descriptor {
  std::uint32_t model = 0, first_channel = 0, second_channel = 0;
  std::size_t samples = 0;
  ColorSpace color_space;
};

Descriptor read_descriptor(std::span<const std::byte> bytes, const std::string& where) {
  constexpr std::size_t kBasicBytes = 24, kSampleBytes = 16;
  Descriptor result;
  if (bytes.empty()) return result;
  ByteReader in(bytes, where);
  in.u32();  // size of all
  const std::uint32_t kind = in.u32();
  const std::uint32_t size = in.u32() >> 16;
  if (kind != 0 || size < kBasicBytes) return result;  // not the basic block of Khronos
  const std::uint32_t model = in.u32();
  result.model = model & 0xffu;
  result.color_space = {.transfer = static_cast<int>(model >> 16 & 0xffu),
                        .primaries = static_cast<int>(model >> 8 & 0xffu),
                        .is_premultiplied = (model >> 24 & 1u) != 0};
  in.take(12);  // size of a block, bytes of the planes
  result.samples = (size - kBasicBytes) / kSampleBytes;
  const auto channel = [&] {
    const std::uint32_t sample = in.u32();
    in.take(12);
    return sample >> 24 & 15u;
  };
  if (result.samples > 0) result.first_channel = channel();
  if (result.samples > 1) result.second_channel = channel();
  return result;
}

constexpr std::uint32_t kModelEtc1s = 163, kModelUastc = 166, kModelUastcHdr4x4 = 167;

// ----- formats

/// The sizes in the order of Vulkan's names.
constexpr std::array<std::array<int, 2>, 14> kAstcBlocks{{{4, 4},
                                                          {5, 4},
                                                          {5, 5},
                                                          {6, 5},
                                                          {6, 6},
                                                          {8, 5},
                                                          {8, 6},
                                                          {8, 8},
                                                          {10, 5},
                                                          {10, 6},
                                                          {10, 8},
                                                          {10, 10},
                                                          {12, 10},
                                                          {12, 12}}};
// VK_FORMAT_ASTC_4x4_UNORM_BLOCK, after which each size has a linear and an sRGB format, and …_SFLOAT_BLOCK.
constexpr std::uint32_t kVkAstc = 157, kVkAstcHdr = 1000066000;

void name_astc(std::size_t number, bool is_hdr, bool is_srgb, TextureInfo& info) {
  const auto [width, height] = kAstcBlocks[number];
  info.block = BlockFormat{BlockCodec::astc, width, height, is_hdr};
  info.format = "astc-" + std::to_string(width) + "x" + std::to_string(height) +
                (is_hdr    ? "-hdr"
                 : is_srgb ? "-srgb"
                           : "");
}

/// A universal format: the descriptor names it.
void name_universal(const Descriptor& descriptor, TextureInfo& info) {
  const bool has_two = descriptor.samples > 1;
  constexpr std::uint32_t kEtc1sRed = 3, kEtc1sGreen = 4;
  constexpr std::uint32_t kUastcRgb = 0, kUastcRed = 4, kUastcRedAlpha = 5, kUastcRedGreen = 6;
  switch (descriptor.model) {
    case kModelEtc1s:
      info.block = BlockFormat{.codec = BlockCodec::etc1s};
      info.format = "etc1s";
      info.channels = has_two && descriptor.second_channel == kEtc1sGreen ? TextureChannels::red_green
                      : has_two                                           ? TextureChannels::rgba
                      : descriptor.first_channel == kEtc1sRed             ? TextureChannels::red
                                                                          : TextureChannels::rgb;
      break;
    case kModelUastc:
      info.block = BlockFormat{.codec = BlockCodec::uastc};
      info.format = "uastc-4x4";
      info.channels = descriptor.first_channel == kUastcRgb        ? TextureChannels::rgb
                      : descriptor.first_channel == kUastcRed      ? TextureChannels::red
                      : descriptor.first_channel == kUastcRedAlpha ? TextureChannels::red_alpha
                      : descriptor.first_channel == kUastcRedGreen ? TextureChannels::red_green
                                                                   : TextureChannels::rgba;
      break;
    case kModelUastcHdr4x4:
      name_astc(0, true, false, info);
      break;
    default:
      info.format = "undefined (model " + std::to_string(descriptor.model) + ")";
  }
}

/// Formats of blocks that graphics cards read and this reader does not, by ranges of Vulkan's numbers.
struct CardFormat {
  std::uint32_t first, last;
  const char* name;
};
constexpr auto kCardFormats = std::to_array<CardFormat>({{131, 134, "bc1"},
                                                         {135, 136, "bc2"},
                                                         {137, 138, "bc3"},
                                                         {139, 140, "bc4"},
                                                         {141, 142, "bc5"},
                                                         {143, 143, "bc6h-ufloat"},
                                                         {144, 144, "bc6h-sfloat"},
                                                         {145, 146, "bc7"},
                                                         {147, 152, "etc2"},
                                                         {153, 156, "eac"},
                                                         {1000054000, 1000054007, "pvrtc"}});

void name_format(std::uint32_t vk_format, const Descriptor& descriptor, TextureInfo& info) {
  for (const TexelLayout& layout : texel_layouts()) {
    if (layout.vk_format != vk_format || vk_format == 0) continue;
    info.texel = layout.format;
    info.format = layout.name;
    return;
  }
  if (vk_format == 0) return name_universal(descriptor, info);
  if (vk_format >= kVkAstc && vk_format < kVkAstc + 2 * kAstcBlocks.size())
    return name_astc((vk_format - kVkAstc) / 2, false, (vk_format - kVkAstc) % 2 != 0, info);
  if (vk_format >= kVkAstcHdr && vk_format < kVkAstcHdr + kAstcBlocks.size())
    return name_astc(vk_format - kVkAstcHdr, true, false, info);
  info.format = "VkFormat " + std::to_string(vk_format);
  for (const CardFormat& card : kCardFormats) {
    if (vk_format < card.first || vk_format > card.last) continue;
    info.format = card.name;
    info.reason = std::string("the format ") + card.name +
                  " is one of a kind of graphics card and is not read (ETC1S, UASTC, ASTC and plain texels are)";
  }
}

void refuse(std::string reason, TextureInfo& info) {
  info.reason = std::move(reason);
  info.is_read = false;
}

/// A universal format has one way to be packed, and schemes that few files have yet are told by what they are.
void judge_packing(std::uint32_t scheme, const Scheme& packing, TextureInfo& info) {
  if (scheme == 4 || scheme == 5) {
    info.reason = "supercompression scheme " + std::to_string(scheme) + " (" + packing.name +
                  ") is of a draft of KTX 2 and is not read";
  } else if ((packing.packing == Packing::basis_lz) != (info.block && info.block->codec == BlockCodec::etc1s)) {
    info.reason = "damaged: " + info.format + " packed by " + packing.name + " (BasisLZ and ETC1S go together)";
  }
}

struct LevelIndex {
  std::uint64_t offset, length, uncompressed;
};

/// A level's place in the file, its lengths compared with what its size asks for.
StoredLevel stored_level(const ByteReader& in, const TextureInfo& info, std::size_t number, const LevelIndex& index,
                         Packing packing, const std::string& where) {
  StoredLevel level;
  level.width = level_size(info.width, number);
  level.height = level_size(info.height, number);
  if (packing == Packing::basis_lz) {
    level.packed = in.part(index.offset, index.length);
    return level;
  }
  const std::uint64_t face = info.block ? block_bytes(*info.block, level.width, level.height)
                                        : face_bytes(texel_layout(*info.texel), level.width, level.height, 1);
  const std::uint64_t expected = face * static_cast<std::uint64_t>(info.faces);
  const std::uint64_t stated = packing == Packing::none ? index.length : index.uncompressed;
  if (stated != expected) {
    throw Error("damaged: level " + std::to_string(number) + " has " + std::to_string(stated) + " bytes, not " +
                    std::to_string(expected),
                where);
  }
  const std::span<const std::byte> bytes = in.part(index.offset, index.length);
  if (packing != Packing::none) {
    level.packed = bytes;
    return level;
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(info.faces); ++i)
    level.faces.push_back(bytes.subspan(i * static_cast<std::size_t>(face), static_cast<std::size_t>(face)));
  return level;
}

// ----- the data format descriptor

constexpr std::uint32_t kRed = 0, kGreen = 1, kBlue = 2, kAlpha = 15;
constexpr std::uint32_t kExponent = 0x20, kSigned = 0x40, kFloat = 0x80;

struct Sample {
  std::uint32_t bit_offset, bits, channel, qualifiers, lower, upper;
};

std::vector<Sample> samples_of(const TexelLayout& layout) {
  const auto one = std::bit_cast<std::uint32_t>(1.0f);
  if (layout.format == TexelFormat::rgb9e5) {
    // Data Format Specification, example of a shared exponent: the largest mantissa of a channel and its exponent.
    std::vector<Sample> samples;
    for (const std::uint32_t channel : {kRed, kGreen, kBlue}) {
      samples.push_back({9 * channel, 9, channel, 0, 0, 8448});
      samples.push_back({27, 5, channel, kExponent, 15, 31});
    }
    return samples;
  }
  if (layout.format == TexelFormat::r11g11b10f)
    return {{0, 11, kRed, kFloat, 0, one}, {11, 11, kGreen, kFloat, 0, one}, {22, 10, kBlue, kFloat, 0, one}};
  std::vector<Sample> samples;
  samples.reserve(static_cast<std::size_t>(layout.channels));
  const std::uint32_t bits = 8 * layout.type_bytes;
  for (std::uint32_t c = 0; c < static_cast<std::uint32_t>(layout.channels); ++c)
    samples.push_back(
        {c * bits, bits, c == 3 ? kAlpha : c, kSigned | kFloat, std::bit_cast<std::uint32_t>(-1.0f), one});
  return samples;
}

void pack_descriptor(ByteWriter& out, const TexelLayout& layout) {
  constexpr std::uint32_t kVersion = 2, kModelRgbsda = 1, kPrimariesBt709 = 1, kTransferLinear = 1;
  const std::vector<Sample> samples = samples_of(layout);
  const auto block = static_cast<std::uint32_t>(24 + 16 * samples.size());
  out.u32(4 + block);
  out.u32(0);  // Khronos, basic descriptor
  out.u32(kVersion | block << 16);
  out.u32(kModelRgbsda | kPrimariesBt709 << 8 | kTransferLinear << 16);  // alpha is straight
  out.u32(0);                                                            // a block is one texel
  out.u32(static_cast<std::uint32_t>(layout.bytes));
  out.u32(0);
  for (const Sample& s : samples) {
    out.u32(s.bit_offset | (s.bits - 1) << 16 | (s.channel | s.qualifiers) << 24);
    out.u32(0);  // position
    out.u32(s.lower);
    out.u32(s.upper);
  }
}

std::vector<std::byte> joined(const std::vector<std::vector<std::byte>>& faces) {
  std::vector<std::byte> out;
  for (const auto& face : faces) out.insert(out.end(), face.begin(), face.end());
  return out;
}

}  // namespace

StoredTexture parse_ktx2(std::span<const std::byte> bytes, const std::string& where) {
  ByteReader in(bytes, where);
  in.seek(kIdentifier.size());
  StoredTexture texture;
  TextureInfo& info = texture.info;
  info.container = TextureContainer::ktx2;

  const std::uint32_t vk_format = in.u32();
  in.u32();  // size of the type, for big-endian readers
  const std::uint32_t width = in.u32(), height = in.u32(), depth = in.u32(), layers = in.u32(), faces = in.u32();
  const std::uint32_t levels = std::max(in.u32(), 1u);  // 0 = one, and the reader may make the others
  const std::uint32_t scheme_number = in.u32();
  const Scheme scheme = scheme_of(scheme_number);
  if (depth > kMaxTextureSize || layers > kMaxTextureSize) throw Error("damaged: a texture of too many layers", where);
  info.depth = static_cast<int>(depth);
  info.layers = static_cast<int>(layers);
  check_shape(info, width, height, faces, levels, where);
  info.width = static_cast<int>(width);
  info.height = static_cast<int>(height);
  info.faces = static_cast<int>(faces);
  info.supercompression = scheme.name;
  texture.packing = scheme.packing;

  const std::uint32_t descriptor_offset = in.u32(), descriptor_length = in.u32();
  const std::uint32_t key_offset = in.u32(), key_length = in.u32();
  const std::uint64_t global_offset = in.u64(), global_length = in.u64();
  const Descriptor descriptor = read_descriptor(in.part(descriptor_offset, descriptor_length), where);
  info.color_space = descriptor.color_space;
  name_format(vk_format, descriptor, info);
  judge_packing(scheme_number, scheme, info);
  texture.global_data = in.part(global_offset, global_length);
  if (key_length > 0) parse_key_values(in.part(key_offset, key_length), info, where);

  if (info.key_values.contains("KTXanimData")) refuse("video is not read", info);
  info.is_read = (info.texel || info.block) && info.reason.empty() && depth <= 1 && layers <= 1 &&
                 scheme.packing != Packing::unknown;
  if (info.is_read && scheme.packing == Packing::basis_lz) {
    texture.images = read_etc1s_images(texture.global_data, std::size_t{levels} * faces, where);
    const bool is_video = std::any_of(texture.images.begin(), texture.images.end(),
                                      [](const Etc1sImage& image) { return image.is_p_frame; });
    if (is_video) refuse("video is not read", info);
  }
  for (std::size_t i = 0; i < levels; ++i) {
    const LevelIndex index{in.u64(), in.u64(), in.u64()};
    in.part(index.offset, index.length);
    info.level_bytes.push_back(index.length);
    if (info.is_read) texture.levels.push_back(stored_level(in, info, i, index, scheme.packing, where));
  }
  return texture;
}

std::vector<std::byte> pack_ktx2(const EncodedTexture& texture, bool zstd, int zstd_level) {
  const TexelLayout& layout = texel_layout(texture.format);
  ByteWriter out;
  out.text(kIdentifier);
  out.u32(layout.vk_format);
  out.u32(layout.type_bytes);
  out.u32(static_cast<std::uint32_t>(texture.width));
  out.u32(static_cast<std::uint32_t>(texture.height));
  out.u32(0);  // depth
  out.u32(0);  // layers
  out.u32(static_cast<std::uint32_t>(texture.faces));
  out.u32(static_cast<std::uint32_t>(texture.levels.size()));
  out.u32(zstd ? kSchemeZstd : 0);

  ByteWriter descriptor, key_values;
  pack_descriptor(descriptor, layout);
  pack_key_values(key_values, "rd", texture.key_values);
  const std::size_t descriptor_at = kHeaderBytes + kLevelIndexBytes * texture.levels.size();
  out.u32(static_cast<std::uint32_t>(descriptor_at));
  out.u32(static_cast<std::uint32_t>(descriptor.bytes.size()));
  out.u32(static_cast<std::uint32_t>(descriptor_at + descriptor.bytes.size()));
  out.u32(static_cast<std::uint32_t>(key_values.bytes.size()));
  out.u64(0);  // no global data
  out.u64(0);
  out.zeros(kLevelIndexBytes * texture.levels.size());
  out.append(descriptor.bytes);
  out.append(key_values.bytes);

  // The smallest level comes first, so that a stream shows something early.
  const std::size_t alignment = zstd ? 1 : std::lcm(layout.bytes, std::size_t{4});
  for (std::size_t level = texture.levels.size(); level-- > 0;) {
    std::vector<std::byte> data = joined(texture.levels[level]);
    const std::size_t uncompressed = data.size();
    if (zstd) data = zstandard_packed(data, zstd_level);
    out.align(alignment);
    const std::size_t entry = kHeaderBytes + kLevelIndexBytes * level;
    out.put_u64(entry, out.bytes.size());
    out.put_u64(entry + 8, data.size());
    out.put_u64(entry + 16, uncompressed);
    out.append(data);
  }
  return std::move(out.bytes);
}

}  // namespace candela::codec
