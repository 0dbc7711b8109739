#include <webp/encode.h>
#include <webp/mux.h>

#include <cmath>
#include <cstddef>
#include <span>
#include <string>

#include "base/error.h"
#include "base/file.h"
#include "image/movie.h"

namespace candela::movie {

namespace {

struct EncoderDeleter {
  void operator()(WebPAnimEncoder* encoder) const { WebPAnimEncoderDelete(encoder); }
};

class WebpWriter : public MovieWriter {
 public:
  WebpWriter(const std::filesystem::path& path, const MovieSettings& settings) : path_(path), settings_(settings) {
    constexpr float kQuality = 90.0f;
    WebPAnimEncoderOptions options;
    if (WebPAnimEncoderOptionsInit(&options) == 0 || WebPConfigPreset(&config_, WEBP_PRESET_PICTURE, kQuality) == 0) {
      throw Error("the installed libwebp is another than this program was built with", path.string());
    }
    options.anim_params.loop_count = 0;  // again and again
    config_.use_sharp_yuv = 1;
    encoder_.reset(WebPAnimEncoderNew(settings.size.x, settings.size.y, &options));
    if (encoder_ == nullptr) throw Error("the size of the pictures is not possible in a WebP", path.string());
  }

  void add(const DisplayImage& picture) override {
    if (ivec2(picture.width, picture.height) != settings_.size) {
      throw Error("a picture has another size", path_.string());
    }
    WebPPicture frame;
    if (WebPPictureInit(&frame) == 0) throw Error("libwebp fails", path_.string());
    frame.use_argb = 1;
    frame.width = picture.width;
    frame.height = picture.height;
    const auto import = settings_.has_alpha ? WebPPictureImportRGBA : WebPPictureImportRGBX;
    const bool is_there = import(&frame, picture.rgba.data(), 4 * picture.width) != 0 &&
                          WebPAnimEncoderAdd(encoder_.get(), &frame, moment_ms(), &config_) != 0;
    WebPPictureFree(&frame);
    if (!is_there) fail();
    ++count_;
  }

  void finish() override {
    if (count_ == 0) throw Error("there is no picture for the film", path_.string());
    WebPData data;
    WebPDataInit(&data);
    if (WebPAnimEncoderAdd(encoder_.get(), nullptr, moment_ms(), nullptr) == 0 ||
        WebPAnimEncoderAssemble(encoder_.get(), &data) == 0) {
      WebPDataClear(&data);
      fail();
    }
    const std::string bytes(reinterpret_cast<const char*>(data.bytes), data.size);
    WebPDataClear(&data);
    write_file(path_, bytes);
  }

 private:
  int moment_ms() const { return static_cast<int>(std::lround(1000.0 * count_ / settings_.frame_rate)); }
  [[noreturn]] void fail() const {
    throw Error(std::string("cannot be encoded: ") + WebPAnimEncoderGetError(encoder_.get()), path_.string());
  }

  std::filesystem::path path_;
  MovieSettings settings_;
  WebPConfig config_{};
  std::unique_ptr<WebPAnimEncoder, EncoderDeleter> encoder_;
  int count_ = 0;
};

}  // namespace

std::unique_ptr<MovieWriter> open_webp(const std::filesystem::path& path, const MovieSettings& settings) {
  return std::make_unique<WebpWriter>(path, settings);
}

}  // namespace candela::movie
