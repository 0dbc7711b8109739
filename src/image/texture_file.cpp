#include "image/texture_file.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <string_view>

#include "base/error.h"
#include "base/file.h"
#include "base/parallel.h"
#include "image/codec.h"
#include "image/texture_codec.h"
#include "image/zstandard.h"
#include "shade/color.glsl.h"

namespace candela {

using codec::BlockReader;
using codec::EncodedTexture;
using codec::Packing;
using codec::StoredLevel;
using codec::StoredTexture;

StoredTexture codec::parse_texture(std::span<const std::byte> bytes, const std::string& where) {
  const std::optional<TextureContainer> container = sniff_texture(bytes);
  if (!container) throw Error("not a texture file (KTX 2, KTX 1 and DDS are known)", where);
  switch (*container) {
    case TextureContainer::ktx2:
      return codec::parse_ktx2(bytes, where);
    case TextureContainer::ktx1:
      return codec::parse_ktx1(bytes, where);
    case TextureContainer::dds:
      break;
  }
  return codec::parse_dds(bytes, where);
}

namespace {

int channels_of(const TextureInfo& info) {
  if (info.faces == 6) return 3;
  if (info.block) return info.channels == TextureChannels::rgba ? 4 : 3;
  const int stored = texel_layout(*info.texel).channels;
  return stored == 2 ? 3 : stored;
}

/// Throws unless the texture is of a kind that is decoded, and small enough.
void check_decodable(const StoredTexture& stored, std::uint64_t max_bytes, const std::string& where) {
  const TextureInfo& info = stored.info;
  codec::check_kind(stored, where);
  std::uint64_t pixels = 0;
  for (const StoredLevel& level : stored.levels)
    pixels += static_cast<std::uint64_t>(level.width) * static_cast<std::uint64_t>(level.height);
  // Blocks are decoded to four channels first, whatever is kept of them.
  const auto channels = static_cast<std::uint64_t>(info.block ? 4 : channels_of(info));
  codec::check_pixels(info, pixels * static_cast<std::uint64_t>(info.faces), channels * sizeof(float), max_bytes,
                      where);
}

/// A level's faces in a row. `size` is what they must come to; it has been compared with what the file says.
std::vector<std::byte> unpack(std::span<const std::byte> packed, std::uint64_t size, Packing packing,
                              const std::string& where) {
  // What a byte can unfold to at most: a Zstandard block of 128 KiB takes 4 bytes, deflate packs 1032 : 1.
  const std::uint64_t ratio = packing == Packing::zstd ? 32768 : 1032;
  if (size / ratio > packed.size()) throw Error("damaged: a level is shorter than its size can be packed to", where);
  std::vector<std::byte> out(static_cast<std::size_t>(size));
  bool good = false;
  if (packing == Packing::zstd) {
    try {
      return zstandard_unpacked(packed, out.size());
    } catch (const Error&) {
      // Told below.
    }
  } else {
    uLongf got = out.size();
    good = uncompress(reinterpret_cast<Bytef*>(out.data()), &got, reinterpret_cast<const Bytef*>(packed.data()),
                      packed.size()) == Z_OK &&
           got == out.size();
  }
  if (!good) throw Error("damaged: a supercompressed level cannot be unpacked", where);
  return out;
}

Image decode_face(const TexelLayout& layout, std::span<const std::byte> texels, const StoredLevel& level, int channels,
                  std::size_t row_alignment) {
  Image image(level.width, level.height, channels);
  const std::size_t row = static_cast<std::size_t>(level.width) * layout.bytes;
  const std::size_t pitch = (row + row_alignment - 1) / row_alignment * row_alignment;
  const std::size_t floats = static_cast<std::size_t>(level.width) * static_cast<std::size_t>(channels);
  parallel_for(0, static_cast<std::size_t>(level.height), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      decode_texels(layout.format, texels.subspan(y * pitch, row), channels,
                    std::span(image.pixels).subspan(y * floats, floats));
    }
  });
  return image;
}

std::uint64_t stored_face_bytes(const StoredTexture& stored, const StoredLevel& level) {
  if (stored.info.block) return codec::block_bytes(*stored.info.block, level.width, level.height);
  return codec::face_bytes(texel_layout(*stored.info.texel), level.width, level.height, stored.row_alignment);
}

/// The first `channels` of each RGBA texel.
Image from_numbers(const StoredLevel& level, std::span<const float> rgba, int channels) {
  Image image(level.width, level.height, channels);
  const auto kept = static_cast<std::size_t>(channels);
  for (std::size_t i = 0; i < rgba.size() / 4; ++i)
    std::copy_n(rgba.begin() + static_cast<std::ptrdiff_t>(4 * i), kept,
                image.pixels.begin() + static_cast<std::ptrdiff_t>(kept * i));
  return image;
}

Image from_codes(const StoredLevel& level, std::span<const std::uint8_t> rgba, int channels, bool is_srgb) {
  std::array<float, 256> number_of_code{}, linear_of_code{};
  for (std::size_t code = 0; code < 256; ++code) {
    number_of_code[code] = static_cast<float>(code) / 255.0f;
    linear_of_code[code] = is_srgb ? shade::srgb_decode_channel(number_of_code[code]) : number_of_code[code];
  }
  Image image(level.width, level.height, channels);
  const auto kept = static_cast<std::size_t>(channels);
  for (std::size_t i = 0; i < rgba.size() / 4; ++i)
    for (std::size_t c = 0; c < kept; ++c)
      image.pixels[kept * i + c] = (c == 3 ? number_of_code : linear_of_code)[rgba[4 * i + c]];
  return image;
}

std::vector<Image> decode_blocks(const StoredTexture& stored, std::size_t number, BlockReader& reader,
                                 const std::string& where) {
  const StoredLevel& level = stored.levels[number];
  const bool is_srgb = stored.info.color_space && stored.info.color_space->transfer == ColorSpace::kSrgb;
  std::vector<std::byte> storage;
  std::vector<Image> images;
  for (const auto& face : codec::unpacked_faces(stored, level, storage, where)) {
    const int channels = channels_of(stored.info);
    images.push_back(stored.info.block->is_hdr
                         ? from_numbers(level, reader.numbers(number, face), channels)
                         : from_codes(level, reader.codes(number, images.size(), face), channels, is_srgb));
  }
  return images;
}

std::vector<Image> decode_level(const StoredTexture& stored, const StoredLevel& level, const std::string& where) {
  const TexelLayout& layout = texel_layout(*stored.info.texel);
  std::vector<std::byte> storage;
  std::vector<Image> images;
  for (const auto& face : codec::unpacked_faces(stored, level, storage, where))
    images.push_back(decode_face(layout, face, level, channels_of(stored.info), stored.row_alignment));
  return images;
}

std::vector<std::byte> encode_face(TexelFormat format, const Image& image, EncodingLoss& loss) {
  const std::size_t texel = texel_layout(format).bytes;
  const auto rows = static_cast<std::size_t>(image.height);
  const auto width = static_cast<std::size_t>(image.width);
  const std::size_t floats = width * static_cast<std::size_t>(image.channels);
  std::vector<std::byte> out(rows * width * texel);
  std::vector<EncodingLoss> losses(rows);  // counts are added in order, whoever made them
  parallel_for(0, rows, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      losses[y] = encode_texels(format, std::span(image.pixels).subspan(y * floats, floats), image.channels,
                                std::span(out).subspan(y * width * texel, width * texel));
    }
  });
  for (const EncodingLoss& row : losses) loss += row;
  return out;
}

void check_options(const TextureOptions& options, const std::string& where) {
  if (!texel_layout(options.format).is_float)
    throw Error("textures are not written in the format " + std::string(texel_layout(options.format).name), where);
  if (options.zstd_level < 1 || options.zstd_level > 22) throw Error("zstd levels are 1 to 22", where);
}

/// What no reader of ours takes is not written either; a KTX 1 counts the bytes of a face in 32 bits.
void check_size(int width, int height, TexelFormat format, const std::string& where) {
  constexpr std::uint64_t kMostFaceBytes = std::uint64_t{1} << 31;
  if (width > codec::kMaxTextureSize || height > codec::kMaxTextureSize ||
      codec::face_bytes(texel_layout(format), width, height, 4) > kMostFaceBytes)
    throw Error("a texture of " + std::to_string(width) + " x " + std::to_string(height) + " is too large", where);
}

std::vector<std::byte> pack(const EncodedTexture& texture, const TextureOptions& options, const std::string& where) {
  switch (options.container) {
    case TextureContainer::ktx2:
      return codec::pack_ktx2(texture, options.zstd, options.zstd_level);
    case TextureContainer::ktx1:
      return codec::pack_ktx1(texture, options.has_filament_type);
    case TextureContainer::dds:
      break;
  }
  return codec::pack_dds(texture, where);
}

void check_cube(const Cubemap& cube, const std::string& where) {
  if (cube.empty() || cube.size() < 1) throw Error("cannot write an empty cube map", where);
  for (std::size_t level = 0; level < cube.levels.size(); ++level) {
    const bool too_many = level > 0 && cube.size(level - 1) == 1;
    for (const Image& face : cube.levels[level]) {
      if (too_many || face.width != codec::level_size(cube.size(), level) || face.height != face.width ||
          face.channels != 3)
        throw Error("the levels of a cube map must halve, and level " + std::to_string(level) + " does not", where);
    }
  }
}

}  // namespace

namespace codec {

void check_kind(const StoredTexture& stored, const std::string& where) {
  const TextureInfo& info = stored.info;
  if (!info.reason.empty()) throw Error(info.reason, where);
  if (!info.texel && !info.block) throw Error("pixels in the format " + info.format + " are not read", where);
  if (stored.packing == Packing::unknown)
    throw Error("supercompression by " + info.supercompression + " is not read", where);
  if (!info.is_read) throw Error("volumes and arrays of textures are not read", where);
}

void check_pixels(const TextureInfo& info, std::uint64_t pixels, std::uint64_t pixel_bytes, std::uint64_t max_bytes,
                  const std::string& where) {
  if (pixels * pixel_bytes > max_bytes) {
    throw Error("texture of " + std::to_string(info.width) + " x " + std::to_string(info.height) + " is too large",
                where);
  }
}

std::vector<std::span<const std::byte>> unpacked_faces(const StoredTexture& stored, const StoredLevel& level,
                                                       std::vector<std::byte>& storage, const std::string& where) {
  const auto count = static_cast<std::size_t>(stored.info.faces);
  if (stored.packing == Packing::none) return level.faces;
  if (stored.packing == Packing::basis_lz) return std::vector<std::span<const std::byte>>(count, level.packed);
  const std::uint64_t size = stored_face_bytes(stored, level);
  storage = unpack(level.packed, size * count, stored.packing, where);
  std::vector<std::span<const std::byte>> faces;
  faces.reserve(count);
  for (std::size_t face = 0; face < count; ++face)
    faces.emplace_back(storage.data() + face * static_cast<std::size_t>(size), static_cast<std::size_t>(size));
  return faces;
}

void check_shape(const TextureInfo& info, std::uint32_t width, std::uint32_t height, std::uint32_t faces,
                 std::uint32_t levels, const std::string& where) {
  if (width < 1 || height < 1 || width > kMaxTextureSize || height > kMaxTextureSize) {
    throw Error("damaged: a texture of " + std::to_string(width) + " x " + std::to_string(height) + " texels", where);
  }
  if (faces != 1 && faces != 6) throw Error("damaged: a texture with " + std::to_string(faces) + " faces", where);
  if (faces == 6 && width != height) throw Error("damaged: the faces of a cube map are not square", where);
  const auto most = static_cast<std::uint32_t>(
      std::bit_width(std::max({width, height, static_cast<std::uint32_t>(std::max(info.depth, 0))})));
  if (levels < 1 || levels > most) throw Error("damaged: " + std::to_string(levels) + " mip levels", where);
}

std::uint64_t face_bytes(const TexelLayout& layout, int width, int height, std::size_t row_alignment) {
  const std::uint64_t row = static_cast<std::uint64_t>(width) * layout.bytes;
  return (row + row_alignment - 1) / row_alignment * row_alignment * static_cast<std::uint64_t>(height);
}

void parse_key_values(std::span<const std::byte> block, TextureInfo& info, const std::string& where) {
  constexpr std::size_t kMostEntries = 1000;
  ByteReader in(block, where);
  while (in.offset() + 4 <= block.size()) {
    const std::span<const std::byte> entry = in.take(in.u32());
    const auto* text = reinterpret_cast<const char*>(entry.data());
    const std::string_view all(text, entry.size());
    const std::size_t end = all.find('\0');
    if (end == std::string_view::npos || end == 0) throw Error("damaged: a key without a value", where);
    std::string_view value = all.substr(end + 1);
    if (value.ends_with('\0')) value.remove_suffix(1);
    const bool is_text = std::none_of(value.begin(), value.end(), [](char c) {
      const auto code = static_cast<unsigned char>(c);
      return (code < 32 && c != '\n' && c != '\t') || code == 127;
    });
    info.key_values[std::string(all.substr(0, end))] =
        is_text ? std::string(value) : std::to_string(all.size() - end - 1) + " bytes";
    if (info.key_values.size() > kMostEntries) throw Error("damaged: too many key/value pairs", where);
    in.seek(std::min((in.offset() + 3) / 4 * 4, block.size()));
  }
}

void pack_key_values(ByteWriter& out, const std::string& orientation,
                     const std::map<std::string, std::string>& key_values) {
  std::map<std::string, std::string> pairs = key_values;
  pairs.try_emplace("KTXorientation", orientation);
  pairs.try_emplace("KTXwriter", "Candela");
  for (const auto& [key, value] : pairs) {
    out.u32(static_cast<std::uint32_t>(key.size() + value.size() + 2));
    out.text(key);
    out.zeros(1);
    out.text(value);
    out.zeros(1);
    out.align(4);
  }
}

}  // namespace codec

const char* container_name(TextureContainer container) {
  switch (container) {
    case TextureContainer::ktx2:
      return "KTX 2";
    case TextureContainer::ktx1:
      return "KTX 1";
    case TextureContainer::dds:
      break;
  }
  return "DDS";
}

const char* container_extension(TextureContainer container) {
  switch (container) {
    case TextureContainer::ktx2:
      return ".ktx2";
    case TextureContainer::ktx1:
      return ".ktx";
    case TextureContainer::dds:
      return ".dds";
  }
  return "";
}

std::optional<TextureContainer> sniff_texture(std::span<const std::byte> bytes) {
  const auto starts_with = [&](std::string_view magic) {
    return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
  };
  if (starts_with("\xabKTX 20\xbb\r\n\x1a\n")) return TextureContainer::ktx2;
  if (starts_with("\xabKTX 11\xbb\r\n\x1a\n")) return TextureContainer::ktx1;
  if (starts_with("DDS ")) return TextureContainer::dds;
  return std::nullopt;
}

TextureInfo parse_texture_info(std::span<const std::byte> bytes, const std::string& where) {
  return codec::parse_texture(bytes, where).info;
}

TextureFile decode_texture_file(std::span<const std::byte> bytes, const std::string& where, std::uint64_t max_bytes) {
  StoredTexture stored = codec::parse_texture(bytes, where);
  check_decodable(stored, max_bytes, where);
  TextureFile file;
  if (stored.info.block) {
    BlockReader reader(stored, where);
    for (std::size_t i = 0; i < stored.levels.size(); ++i)
      file.levels.push_back(decode_blocks(stored, i, reader, where));
  } else {
    for (const StoredLevel& level : stored.levels) file.levels.push_back(decode_level(stored, level, where));
  }
  file.info = std::move(stored.info);
  return file;
}

TextureInfo read_texture_info(const std::filesystem::path& path) {
  return parse_texture_info(read_file(path), path.string());
}

TextureFile read_texture_file(const std::filesystem::path& path) {
  return decode_texture_file(read_file(path), path.string());
}

std::vector<std::byte> encode_texture(const Cubemap& cube, const TextureOptions& options, EncodingLoss& loss,
                                      const std::string& where) {
  check_options(options, where);
  check_cube(cube, where);
  check_size(cube.size(), cube.size(), options.format, where);
  EncodedTexture texture{.format = options.format,
                         .width = cube.size(),
                         .height = cube.size(),
                         .faces = 6,
                         .levels = {},
                         .key_values = options.key_values};
  for (const CubeFaces& level : cube.levels) {
    auto& faces = texture.levels.emplace_back();
    for (const Image& face : level) faces.push_back(encode_face(options.format, face, loss));
  }
  return pack(texture, options, where);
}

std::vector<std::byte> encode_texture(const Image& image, const TextureOptions& options, EncodingLoss& loss,
                                      const std::string& where) {
  check_options(options, where);
  if (image.empty()) throw Error("cannot write an empty texture", where);
  check_size(image.width, image.height, options.format, where);
  EncodedTexture texture{.format = options.format,
                         .width = image.width,
                         .height = image.height,
                         .faces = 1,
                         .levels = {{encode_face(options.format, image, loss)}},
                         .key_values = options.key_values};
  return pack(texture, options, where);
}

EncodingLoss write_texture(const std::filesystem::path& path, const Cubemap& cube, const TextureOptions& options) {
  EncodingLoss loss;
  write_file(path, encode_texture(cube, options, loss, path.string()));
  return loss;
}

EncodingLoss write_texture(const std::filesystem::path& path, const Image& image, const TextureOptions& options) {
  EncodingLoss loss;
  write_file(path, encode_texture(image, options, loss, path.string()));
  return loss;
}

}  // namespace candela
