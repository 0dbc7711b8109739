#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "image/cubemap.h"
#include "image/texel.h"

// The files in which engines keep textures: KTX 2.0, KTX 1.1 and DDS, with mip levels and cube faces. Khronos Group,
// "KTX File Format Specification" 2.0 and 1.1; Microsoft, "Programming Guide for DDS" with the DX10 header.
namespace candela {

enum class TextureContainer { ktx2, ktx1, dds };

/// "KTX 2", "KTX 1" or "DDS".
const char* container_name(TextureContainer container);
/// ".ktx2", ".ktx" or ".dds".
const char* container_extension(TextureContainer container);
/// From the first bytes, never from a name.
std::optional<TextureContainer> sniff_texture(std::span<const std::byte> bytes);

/// Texels that are stored in blocks: ETC1S and UASTC (the universal formats of Basis Universal), and ASTC.
enum class BlockCodec { etc1s, uastc, astc };

struct BlockFormat {
  BlockCodec codec = BlockCodec::uastc;
  int width = 4, height = 4;  ///< of a block, in texels
  bool is_hdr = false;
};

/// What the numbers of a texture are, from its data format descriptor; numbered as there.
struct ColorSpace {
  static constexpr int kLinear = 1, kSrgb = 2, kRec709 = 1;  // 0 = it does not say
  int transfer = 0;
  int primaries = 0;
  bool is_premultiplied = false;
};

/// What the channels of a texture are for where a format could hold more of them.
enum class TextureChannels { rgba, rgb, red, red_green, red_alpha };  // the last: green lies in alpha

/// What a texture file says about itself; its pixels may be in a format that we cannot decode.
struct TextureInfo {
  TextureContainer container = TextureContainer::ktx2;
  std::optional<TexelFormat> texel;  ///< empty where the format has no decoder here, or is the next
  std::optional<BlockFormat> block;
  TextureChannels channels = TextureChannels::rgba;  ///< of a block format
  std::optional<ColorSpace> color_space;             ///< KTX 2
  std::string format;                                ///< its name, or the container's number for it
  int width = 0;
  int height = 0;
  int depth = 0;   ///< above 1 in a volume
  int layers = 0;  ///< above 1 in an array
  int faces = 1;   ///< 6 in a cube map
  std::string supercompression = "none";
  bool is_read = false;                           ///< whether decode_texture_file knows format, packing and kind
  std::string reason;                             ///< why it is not read, where more can be said than the format's name
  std::vector<std::uint64_t> level_bytes;         ///< as stored, largest level first; 0 where the file does not say
  std::map<std::string, std::string> key_values;  ///< binary values as "N bytes"
};

/// A texture with its pixels: images by level and face, linear (sRGB decoded), each half as large as the one before,
/// rounded down. Cube faces have 3 channels; others as many as are stored, two become three.
struct TextureFile {
  TextureInfo info;
  std::vector<std::vector<Image>> levels;
};

/// Throws Error(…, where) for damage.
TextureInfo parse_texture_info(std::span<const std::byte> bytes, const std::string& where);
/// Throws Error(…, where) for damage, for formats and kinds (volumes, arrays) that are not read, and for pixels above
/// `max_bytes`, which is looked at before anything is allocated.
TextureFile decode_texture_file(std::span<const std::byte> bytes, const std::string& where,
                                std::uint64_t max_bytes = std::uint64_t{1} << 31);
/// The largest image of a 2-D texture as a material has it: 8 bits as stored, still encoded; numbers with a fraction in
/// 16 bits, clamped to [0, 1]. Throws like decode_texture_file, and for cube maps.
TextureImage decode_texture_pixels(std::span<const std::byte> bytes, const std::string& where,
                                   std::uint64_t max_bytes = std::uint64_t{1} << 30);
TextureInfo read_texture_info(const std::filesystem::path& path);
TextureFile read_texture_file(const std::filesystem::path& path);

struct TextureOptions {
  TextureContainer container = TextureContainer::ktx2;
  TexelFormat format = TexelFormat::rgba16f;
  bool zstd = true;    ///< KTX 2 only: each level packed by itself (RFC 8878)
  int zstd_level = 3;  ///< 1 to 22; docs/performance.md says what they cost
  /// KTX 1 and r11g11b10f only: the type as Filament's tools write it and its reader wants it, GL_R11F_G11F_B10F (a
  /// name of an internal format) in place of GL_UNSIGNED_INT_10F_11F_11F_REV. Files of either type are read.
  bool has_filament_type = false;
  /// KTX only, beside KTXwriter and KTXorientation, which it may replace. Values are text.
  std::map<std::string, std::string> key_values = {};
};

/// Writes a cube map with its levels, or a 2-D texture of one level, whole or not at all. Says what the format could
/// not hold. Throws Error for more than 16384 texels a side, where a level is not half of the one before, or where the
/// container has no name for the format. The same pixels give the same bytes.
EncodingLoss write_texture(const std::filesystem::path& path, const Cubemap& cube, const TextureOptions& options);
EncodingLoss write_texture(const std::filesystem::path& path, const Image& image, const TextureOptions& options);

/// The bytes that write_texture writes; `where` is for errors.
std::vector<std::byte> encode_texture(const Cubemap& cube, const TextureOptions& options, EncodingLoss& loss,
                                      const std::string& where);
std::vector<std::byte> encode_texture(const Image& image, const TextureOptions& options, EncodingLoss& loss,
                                      const std::string& where);

}  // namespace candela
