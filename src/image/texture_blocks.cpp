#include <optional>

#include "image/astc.h"
#include "image/basis_uastc.h"
#include "image/texture_codec.h"

namespace candela::codec {

struct BlockReader::Parts {
  const StoredTexture& stored;
  std::string where;
  std::optional<Etc1sBook> book;
  std::unique_ptr<AstcDecoder> astc;

  bool is_srgb() const { return stored.info.color_space && stored.info.color_space->transfer == ColorSpace::kSrgb; }
  void read_etc1s(std::size_t level, std::size_t face, std::span<const std::byte> bytes,
                  std::span<std::uint8_t> rgba) const;
  void keep_channels(std::span<std::uint8_t> rgba) const;
};

namespace {

std::span<const std::byte> slice_of(std::span<const std::byte> level, std::uint32_t offset, std::uint32_t length,
                                    const std::string& where) {
  if (offset > level.size() || length > level.size() - offset)
    throw Error("damaged: a BasisLZ slice lies outside of its level", where);
  return level.subspan(offset, length);
}

AstcProfile profile_of(const BlockFormat& format, bool is_srgb) {
  return format.is_hdr ? AstcProfile::hdr : is_srgb ? AstcProfile::srgb : AstcProfile::linear;
}

std::size_t texels_of(const StoredLevel& level) {
  return static_cast<std::size_t>(level.width) * static_cast<std::size_t>(level.height) * 4;
}

}  // namespace

std::uint64_t block_bytes(const BlockFormat& format, int width, int height) {
  const auto blocks = [](int size, int block) { return static_cast<std::uint64_t>((size + block - 1) / block); };
  return blocks(width, format.width) * blocks(height, format.height) * kAstcBlockBytes;
}

BlockReader::BlockReader(const StoredTexture& stored, const std::string& where)
    : parts_(std::make_unique<Parts>(Parts{stored, where, {}, {}})) {
  const BlockFormat& format = *stored.info.block;
  if (format.codec == BlockCodec::etc1s)
    parts_->book = read_etc1s_book(stored.global_data, stored.images.size(), where);
  if (format.codec == BlockCodec::astc)
    parts_->astc =
        std::make_unique<AstcDecoder>(format.width, format.height, profile_of(format, parts_->is_srgb()), where);
}

BlockReader::~BlockReader() = default;

void BlockReader::Parts::read_etc1s(std::size_t level, std::size_t face, std::span<const std::byte> bytes,
                                    std::span<std::uint8_t> rgba) const {
  const Etc1sImage& image = stored.images[level * static_cast<std::size_t>(stored.info.faces) + face];
  const bool is_green = stored.info.channels == TextureChannels::red_green;
  const Etc1sSecond second = image.alpha_length == 0 ? Etc1sSecond::none
                             : is_green              ? Etc1sSecond::green
                                                     : Etc1sSecond::alpha;
  decode_etc1s(*book, slice_of(bytes, image.rgb_offset, image.rgb_length, where),
               slice_of(bytes, image.alpha_offset, image.alpha_length, where), second, stored.levels[level].width,
               stored.levels[level].height, rgba, where);
}

/// Alpha that only fills a block is no alpha.
void BlockReader::Parts::keep_channels(std::span<std::uint8_t> rgba) const {
  const TextureChannels channels = stored.info.channels;
  if (channels == TextureChannels::rgba) return;
  for (std::size_t i = 0; i < rgba.size(); i += 4) {
    if (channels == TextureChannels::red) rgba[i + 1] = rgba[i + 2] = rgba[i];
    if (channels == TextureChannels::red_alpha) rgba[i + 1] = rgba[i + 3];
    if (channels == TextureChannels::red_green || channels == TextureChannels::red_alpha) rgba[i + 2] = 0;
    rgba[i + 3] = 255;
  }
}

std::vector<std::uint8_t> BlockReader::codes(std::size_t level, std::size_t face, std::span<const std::byte> bytes) {
  const StoredLevel& place = parts_->stored.levels[level];
  std::vector<std::uint8_t> rgba(texels_of(place));
  switch (parts_->stored.info.block->codec) {
    case BlockCodec::etc1s:
      parts_->read_etc1s(level, face, bytes, rgba);
      break;
    case BlockCodec::uastc:
      decode_uastc(bytes, place.width, place.height, parts_->is_srgb() ? UastcRounding::srgb : UastcRounding::linear,
                   rgba);
      break;
    case BlockCodec::astc:
      parts_->astc->decode(bytes, place.width, place.height, rgba);
      break;
  }
  parts_->keep_channels(rgba);
  return rgba;
}

std::vector<float> BlockReader::numbers(std::size_t level, std::span<const std::byte> bytes) {
  const StoredLevel& place = parts_->stored.levels[level];
  std::vector<float> rgba(texels_of(place));
  parts_->astc->decode(bytes, place.width, place.height, std::span<float>(rgba));
  return rgba;
}

}  // namespace candela::codec
