#include <avif/avif.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "image/codec.h"

namespace candela {

namespace {

struct DecoderDeleter {
  void operator()(avifDecoder* decoder) const { avifDecoderDestroy(decoder); }
};
using Decoder = std::unique_ptr<avifDecoder, DecoderDeleter>;

void check(avifResult result, const std::string& where) {
  if (result == AVIF_RESULT_OK) return;
  std::string text = avifResultToString(result);
  if (result == AVIF_RESULT_TRUNCATED_DATA) text = "the file is truncated";
  throw Error("damaged AVIF: " + text, where);
}

/// A decoder that has read the boxes of the file and no pixel.
Decoder open(std::span<const std::byte> bytes, const std::string& where) {
  Decoder decoder(avifDecoderCreate());
  if (!decoder) throw Error("cannot start the AVIF decoder", where);
  decoder->maxThreads = 1;  // images of a scene are decoded side by side
  decoder->ignoreExif = AVIF_TRUE;
  decoder->ignoreXMP = AVIF_TRUE;
  decoder->imageSizeLimit = static_cast<std::uint32_t>(codec::kMaxTextureBytes / 4);
  decoder->imageDimensionLimit = 0;  // what is too large is told by check_texture_size
  // Older encoders leave out boxes that nothing here depends on.
  decoder->strictFlags = AVIF_STRICT_ALPHA_ISPE_REQUIRED;
  check(avifDecoderSetIOMemory(decoder.get(), reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()),
        where);
  check(avifDecoderParse(decoder.get()), where);
  const avifImage& image = *decoder->image;
  if (image.width == 0 || image.height == 0) throw Error("damaged AVIF: it has no size", where);
  codec::check_texture_size(image.width, image.height, image.depth > 8 ? 8 : 4, where);
  return decoder;
}

/// How a picture is turned before it is shown: ISO/IEC 23000-22:2019, §7.3.6.7, first by quarters counter-clockwise,
/// then mirrored.
struct Orientation {
  int quarters = 0;
  bool flips_rows = false;
  bool flips_columns = false;

  bool is_upright() const { return quarters == 0 && !flips_rows && !flips_columns; }
};

Orientation orientation_of(const avifImage& image) {
  Orientation result;
  if ((image.transformFlags & AVIF_TRANSFORM_IROT) != 0) result.quarters = image.irot.angle & 3;
  if ((image.transformFlags & AVIF_TRANSFORM_IMIR) != 0) {
#if AVIF_VERSION >= 1000000
    const bool is_left_right = image.imir.axis != 0;
#else
    const bool is_left_right = image.imir.mode != 0;
#endif
    (is_left_right ? result.flips_columns : result.flips_rows) = true;
  }
  return result;
}

ivec2 turned_size(ivec2 size, const Orientation& orientation) {
  return orientation.quarters % 2 == 0 ? size : ivec2(size.y, size.x);
}

/// Pixel (x, y) of the result is where the file has it.
void turn(TextureImage& image, const Orientation& orientation) {
  if (orientation.is_upright()) return;
  const ivec2 from(image.width, image.height);
  const ivec2 size = turned_size(from, orientation);
  const auto texel = static_cast<std::size_t>(image.bits / 2);
  std::vector<std::uint8_t> pixels(image.pixels.size());
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const int u = orientation.flips_columns ? size.x - 1 - x : x;
      const int v = orientation.flips_rows ? size.y - 1 - y : y;
      ivec2 source(u, v);
      if (orientation.quarters == 1) source = {from.x - 1 - v, u};
      if (orientation.quarters == 2) source = {from.x - 1 - u, from.y - 1 - v};
      if (orientation.quarters == 3) source = {v, from.y - 1 - u};
      const auto at = [texel](int column, int row, int width) {
        return (static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)) *
               texel;
      };
      std::memcpy(&pixels[at(x, y, size.x)], &image.pixels[at(source.x, source.y, from.x)], texel);
    }
  }
  image.width = size.x;
  image.height = size.y;
  image.pixels = std::move(pixels);
}

/// What the file says of its colours and sRGB texels cannot follow; ITU-T H.273 names the numbers.
void add_color_facts(const avifImage& image, std::vector<ImageFact>& facts) {
  const auto is_one_of = [](int value, std::initializer_list<int> known) {
    return std::find(known.begin(), known.end(), value) != known.end();
  };
  constexpr int kBt709 = 1, kUnspecified = 2, kBt601 = 6, kSrgb = 13;
  const int primaries = static_cast<int>(image.colorPrimaries);
  const int transfer = static_cast<int>(image.transferCharacteristics);
  if (!is_one_of(primaries, {0, kBt709, kUnspecified})) {
    facts.push_back({"colour primaries", std::to_string(primaries), "not followed: read as those of sRGB", true});
  }
  if (!is_one_of(transfer, {0, kBt709, kUnspecified, kBt601, kSrgb})) {
    facts.push_back({"transfer function", std::to_string(transfer), "not followed: read as that of sRGB", true});
  }
}

}  // namespace

ImageHeader codec::avif_header(std::span<const std::byte> bytes, const std::string& where) {
  const Decoder decoder = open(bytes, where);
  const avifImage& image = *decoder->image;
  ImageHeader header;
  header.size = turned_size({static_cast<int>(image.width), static_cast<int>(image.height)}, orientation_of(image));
  header.bits = image.depth > 8 ? 16 : 8;
  header.has_alpha = decoder->alphaPresent != AVIF_FALSE;
  if (decoder->imageCount > 1 && decoder->progressiveState == AVIF_PROGRESSIVE_STATE_UNAVAILABLE) {
    header.facts.push_back({"animation", std::to_string(decoder->imageCount) + " frames", "the first is shown", true});
  }
  if ((image.transformFlags & AVIF_TRANSFORM_CLAP) != 0) {
    header.facts.push_back({"clean aperture", "a part of the picture", "not followed: the whole is shown", true});
  }
  add_color_facts(image, header.facts);
  return header;
}

TextureImage codec::decode_avif(std::span<const std::byte> bytes, const std::string& where) {
  const Decoder decoder = open(bytes, where);
  check(avifDecoderNextImage(decoder.get()), where);
  const avifImage& source = *decoder->image;
  codec::check_texture_size(source.width, source.height, source.depth > 8 ? 8 : 4, where);

  TextureImage image;
  image.width = static_cast<int>(source.width);
  image.height = static_cast<int>(source.height);
  image.bits = source.depth > 8 ? 16 : 8;
  image.has_alpha = decoder->alphaPresent != AVIF_FALSE;
  const std::size_t row_bytes = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.bits / 2);
  image.pixels.resize(row_bytes * static_cast<std::size_t>(image.height));

  avifRGBImage rgb;
  avifRGBImageSetDefaults(&rgb, &source);
  rgb.format = AVIF_RGB_FORMAT_RGBA;
  rgb.depth = static_cast<std::uint32_t>(image.bits);
  rgb.alphaPremultiplied = AVIF_FALSE;
  rgb.pixels = image.pixels.data();
  rgb.rowBytes = static_cast<std::uint32_t>(row_bytes);
  check(avifImageYUVToRGB(&source, &rgb), where);
  turn(image, orientation_of(source));
  return image;
}

}  // namespace candela
