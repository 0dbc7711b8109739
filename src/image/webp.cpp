#include <webp/decode.h>
#include <webp/demux.h>
#include <webp/encode.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>

#include "base/error.h"
#include "base/file.h"
#include "image/codec.h"

namespace candela {

namespace {

const std::uint8_t* webp_data(std::span<const std::byte> bytes) {
  return reinterpret_cast<const std::uint8_t*>(bytes.data());
}

const char* status_text(VP8StatusCode status) {
  switch (status) {
    case VP8_STATUS_NOT_ENOUGH_DATA:
      return "the file is truncated";
    case VP8_STATUS_UNSUPPORTED_FEATURE:
      return "it has a feature that is not supported";
    case VP8_STATUS_OUT_OF_MEMORY:
      return "out of memory";
    default:
      return "its data is no picture";
  }
}

struct DemuxDeleter {
  void operator()(WebPDemuxer* demuxer) const { WebPDemuxDelete(demuxer); }
};
using Demuxer = std::unique_ptr<WebPDemuxer, DemuxDeleter>;

struct AnimationDeleter {
  void operator()(WebPAnimDecoder* decoder) const { WebPAnimDecoderDelete(decoder); }
};

/// Frames of an animation as its directory has them, without decoding one.
std::uint32_t count_frames(std::span<const std::byte> bytes) {
  const WebPData data{webp_data(bytes), bytes.size()};
  WebPDemuxState state = WEBP_DEMUX_PARSE_ERROR;
  const Demuxer demuxer(WebPDemuxPartial(&data, &state));
  return demuxer ? WebPDemuxGetI(demuxer.get(), WEBP_FF_FRAME_COUNT) : 0;
}

WebPBitstreamFeatures read_features(std::span<const std::byte> bytes, const std::string& where) {
  WebPBitstreamFeatures features;
  const VP8StatusCode status = WebPGetFeatures(webp_data(bytes), bytes.size(), &features);
  if (status != VP8_STATUS_OK) throw Error(std::string("damaged WebP: ") + status_text(status), where);
  if (features.width <= 0 || features.height <= 0) throw Error("damaged WebP: it has no size", where);
  // Animations are put together on two canvases beside ours.
  const std::uint64_t pixel_bytes = features.has_animation != 0 ? 12 : 4;
  codec::check_texture_size(static_cast<std::uint64_t>(features.width), static_cast<std::uint64_t>(features.height),
                            pixel_bytes, where);
  return features;
}

/// The first frame on its canvas, which is transparent where the frame does not reach: straight alpha.
void decode_first_frame(std::span<const std::byte> bytes, std::vector<std::uint8_t>& pixels, const std::string& where) {
  WebPAnimDecoderOptions options;
  if (WebPAnimDecoderOptionsInit(&options) == 0) throw Error("cannot start the WebP decoder", where);
  options.color_mode = MODE_RGBA;
  const WebPData data{webp_data(bytes), bytes.size()};
  const std::unique_ptr<WebPAnimDecoder, AnimationDeleter> decoder(WebPAnimDecoderNew(&data, &options));
  std::uint8_t* canvas = nullptr;
  int time_ms = 0;
  if (!decoder || WebPAnimDecoderGetNext(decoder.get(), &canvas, &time_ms) == 0) {
    throw Error("damaged WebP: its first frame cannot be read", where);
  }
  std::memcpy(pixels.data(), canvas, pixels.size());
}

}  // namespace

ImageHeader codec::webp_header(std::span<const std::byte> bytes, const std::string& where) {
  const WebPBitstreamFeatures features = read_features(bytes, where);
  ImageHeader header;
  header.size = {features.width, features.height};
  header.has_alpha = features.has_alpha != 0;
  if (features.has_animation != 0) {
    header.facts.push_back({"animation", std::to_string(count_frames(bytes)) + " frames", "the first is shown", true});
  }
  return header;
}

TextureImage codec::decode_webp(std::span<const std::byte> bytes, const std::string& where) {
  const WebPBitstreamFeatures features = read_features(bytes, where);
  TextureImage image;
  image.width = features.width;
  image.height = features.height;
  image.has_alpha = features.has_alpha != 0;
  const std::size_t row_bytes = static_cast<std::size_t>(image.width) * 4;
  image.pixels.resize(row_bytes * static_cast<std::size_t>(image.height));
  if (features.has_animation != 0) {
    decode_first_frame(bytes, image.pixels, where);
    return image;
  }
  WebPDecoderConfig config;
  if (WebPInitDecoderConfig(&config) == 0) throw Error("cannot start the WebP decoder", where);
  config.output.colorspace = MODE_RGBA;
  config.output.is_external_memory = 1;
  config.output.u.RGBA = {image.pixels.data(), static_cast<int>(row_bytes), image.pixels.size()};
  const VP8StatusCode status = WebPDecode(webp_data(bytes), bytes.size(), &config);
  WebPFreeDecBuffer(&config.output);
  if (status != VP8_STATUS_OK) throw Error(std::string("damaged WebP: ") + status_text(status), where);
  return image;
}

namespace {

/// What is encoded, freed with it.
class WebpPicture {
 public:
  explicit WebpPicture(const std::string& where) {
    if (WebPPictureInit(&picture) == 0) throw Error("cannot start the WebP encoder", where);
    WebPMemoryWriterInit(&writer);
    picture.use_argb = 1;  // without loss
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &writer;
  }
  ~WebpPicture() {
    WebPPictureFree(&picture);
    WebPMemoryWriterClear(&writer);
  }
  WebpPicture(const WebpPicture&) = delete;
  WebpPicture& operator=(const WebpPicture&) = delete;

  WebPPicture picture{};
  WebPMemoryWriter writer{};
};

}  // namespace

void write_webp(const std::filesystem::path& path, const DisplayImage& image) {
  const std::string where = path.string();
  if (std::max(image.width, image.height) > WEBP_MAX_DIMENSION) {
    throw Error("a WebP has at most " + std::to_string(WEBP_MAX_DIMENSION) + " pixels a side", where);
  }
  // Files are about half as large as PNG's here and take three to ten times as long; higher levels take longer still.
  constexpr int kLevel = 2;
  WebPConfig config;
  if (WebPConfigInit(&config) == 0 || WebPConfigLosslessPreset(&config, kLevel) == 0) {
    throw Error("cannot start the WebP encoder", where);
  }
  config.exact = 1;  // colours stay where nothing covers
  WebpPicture webp(where);
  webp.picture.width = image.width;
  webp.picture.height = image.height;
  const bool is_whole = WebPPictureImportRGBA(&webp.picture, image.rgba.data(), image.width * 4) != 0 &&
                        WebPEncode(&config, &webp.picture) != 0;
  if (!is_whole) throw Error("cannot encode WebP: error " + std::to_string(webp.picture.error_code), where);
  write_file(path, std::as_bytes(std::span(webp.writer.mem, webp.writer.size)));
}

}  // namespace candela
