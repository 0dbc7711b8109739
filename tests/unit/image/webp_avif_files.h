#pragma once

#include <avif/avif.h>
#include <webp/encode.h>
#include <webp/mux.h>

#include <cstring>
#include <stdexcept>
#include <vector>

#include "unit/image/image_util.h"

// Small WebP and AVIF files of every kind, by the libraries' own encoders.
namespace candela::test {

using Pixels = std::vector<std::uint8_t>;

constexpr int kWidth = 21, kHeight = 13;

inline void must(bool is_done) {
  if (!is_done) throw std::runtime_error("an encoder failed");
}

inline Bytes bytes_at(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(size);
  std::memcpy(bytes.data(), data, size);
  return bytes;
}

/// Straight RGBA: one colour in each corner region, so that no turn of it looks the same.
inline Pixels picture(bool has_alpha) {
  Pixels pixels;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool right = x >= kWidth / 2, low = y >= kHeight / 2;
      const std::uint8_t alpha = has_alpha && low ? (right ? 0 : 100) : 255;
      pixels.insert(pixels.end(), {static_cast<std::uint8_t>(right ? 220 : 30),
                                   static_cast<std::uint8_t>(low ? 200 : 40), static_cast<std::uint8_t>(128), alpha});
    }
  }
  return pixels;
}

inline Bytes webp(const Pixels& pixels, bool lossless) {
  WebPConfig config;
  WebPPicture source;
  WebPMemoryWriter writer;
  WebPConfigInit(&config);
  WebPPictureInit(&source);
  WebPMemoryWriterInit(&writer);
  config.lossless = lossless ? 1 : 0;
  config.exact = 1;
  config.quality = 95;
  source.use_argb = 1;
  source.width = kWidth;
  source.height = kHeight;
  WebPPictureImportRGBA(&source, pixels.data(), kWidth * 4);
  source.writer = WebPMemoryWrite;
  source.custom_ptr = &writer;
  must(WebPEncode(&config, &source));
  const Bytes bytes = bytes_at(writer.mem, writer.size);
  WebPPictureFree(&source);
  WebPMemoryWriterClear(&writer);
  return bytes;
}

inline Bytes animated_webp(const std::vector<Pixels>& frames) {
  WebPAnimEncoderOptions options;
  WebPAnimEncoderOptionsInit(&options);
  WebPAnimEncoder* encoder = WebPAnimEncoderNew(kWidth, kHeight, &options);
  int time_ms = 0;
  WebPConfig config;
  WebPConfigInit(&config);
  config.lossless = 1;
  config.exact = 1;
  for (const Pixels& frame : frames) {
    WebPPicture source;
    WebPPictureInit(&source);
    source.use_argb = 1;
    source.width = kWidth;
    source.height = kHeight;
    WebPPictureImportRGBA(&source, frame.data(), kWidth * 4);
    must(WebPAnimEncoderAdd(encoder, &source, time_ms, &config));
    WebPPictureFree(&source);
    time_ms += 100;
  }
  WebPAnimEncoderAdd(encoder, nullptr, time_ms, nullptr);
  WebPData data;
  WebPDataInit(&data);
  must(WebPAnimEncoderAssemble(encoder, &data));
  const Bytes bytes = bytes_at(data.bytes, data.size);
  WebPDataClear(&data);
  WebPAnimEncoderDelete(encoder);
  return bytes;
}

struct AvifOptions {
  std::uint32_t depth = 8;
  avifTransferCharacteristics transfer = AVIF_TRANSFER_CHARACTERISTICS_SRGB;
  avifColorPrimaries primaries = AVIF_COLOR_PRIMARIES_BT709;
  avifTransformFlags transforms = AVIF_TRANSFORM_NONE;
  std::uint8_t quarters = 0, mirror = 0;
  bool is_premultiplied = false;
};

/// Without loss: all chroma, and matrix coefficients that leave RGB as it is.
inline Bytes avif(const std::vector<Pixels>& frames, const AvifOptions& o = {}) {
  avifEncoder* encoder = avifEncoderCreate();
  encoder->minQuantizer = encoder->maxQuantizer = AVIF_QUANTIZER_LOSSLESS;
  encoder->minQuantizerAlpha = encoder->maxQuantizerAlpha = AVIF_QUANTIZER_LOSSLESS;
  encoder->speed = AVIF_SPEED_FASTEST;
  for (const Pixels& frame : frames) {
    avifImage* image = avifImageCreate(kWidth, kHeight, o.depth, AVIF_PIXEL_FORMAT_YUV444);
    image->matrixCoefficients = AVIF_MATRIX_COEFFICIENTS_IDENTITY;
    image->transferCharacteristics = o.transfer;
    image->colorPrimaries = o.primaries;
    image->transformFlags = o.transforms;
    image->irot.angle = o.quarters;
    image->alphaPremultiplied = o.is_premultiplied ? AVIF_TRUE : AVIF_FALSE;
#if AVIF_VERSION >= 1000000
    image->imir.axis = o.mirror;
#else
    image->imir.mode = o.mirror;
#endif
    avifRGBImage rgb;
    avifRGBImageSetDefaults(&rgb, image);
    rgb.depth = 8;
    rgb.format = AVIF_RGB_FORMAT_RGBA;
    Pixels copy = frame;
    rgb.pixels = copy.data();
    rgb.rowBytes = kWidth * 4;
    must(avifImageRGBToYUV(image, &rgb) == AVIF_RESULT_OK);
    const bool is_single = frames.size() == 1;
    must(avifEncoderAddImage(encoder, image, 1, is_single ? AVIF_ADD_IMAGE_FLAG_SINGLE : AVIF_ADD_IMAGE_FLAG_NONE) ==
         AVIF_RESULT_OK);
    avifImageDestroy(image);
  }
  avifRWData data = AVIF_DATA_EMPTY;
  must(avifEncoderFinish(encoder, &data) == AVIF_RESULT_OK);
  const Bytes bytes = bytes_at(data.data, data.size);
  avifRWDataFree(&data);
  avifEncoderDestroy(encoder);
  return bytes;
}

/// What mutation and fuzzing start from.
inline std::vector<Bytes> webp_seeds() {
  return {webp(picture(false), false), webp(picture(true), false), webp(picture(false), true),
          webp(picture(true), true), animated_webp({picture(false), picture(true)})};
}
inline std::vector<Bytes> avif_seeds() {
  return {avif({picture(false)}), avif({picture(true)}), avif({picture(true)}, {.depth = 12}),
          avif({picture(true)}, {.transforms = AVIF_TRANSFORM_IROT, .quarters = 1, .is_premultiplied = true}),
          avif({picture(false), picture(true)})};
}

}  // namespace candela::test
