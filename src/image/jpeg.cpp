#include <turbojpeg.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "base/large_pages.h"
#include "image/codec.h"
#include "image/develop.h"
#include "shade/color.glsl.h"

namespace candela {

namespace {

struct HandleDeleter {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using Handle = std::unique_ptr<void, HandleDeleter>;

Handle open_decoder(const std::string& where) {
  Handle handle(tjInitDecompress());
  if (!handle) throw Error("cannot start the JPEG decoder", where);
  return handle;
}

const unsigned char* jpeg_data(std::span<const std::byte> bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}

struct JpegHeader {
  int width = 0;
  int height = 0;
  int colorspace = 0;
};

/// libjpeg goes on after damage with a warning and grey pixels. Only bytes between the segments, which many cameras
/// leave, do no harm to the picture.
void check(tjhandle handle, int result, const std::string& where) {
  if (result == 0) return;
  const std::string message = tjGetErrorStr2(handle);
  if (tjGetErrorCode(handle) == TJERR_WARNING && message.find("extraneous bytes") != std::string::npos) return;
  if (message.find("image dimension") != std::string::npos) throw Error("image is too large: " + message, where);
  throw Error("damaged JPEG: " + message, where);
}

JpegHeader read_header(tjhandle handle, std::span<const std::byte> bytes, const std::string& where) {
  JpegHeader header;
  int subsampling = 0;
  const int result = tjDecompressHeader3(handle, jpeg_data(bytes), static_cast<unsigned long>(bytes.size()),
                                         &header.width, &header.height, &subsampling, &header.colorspace);
  check(handle, result, where);
  // Where the data ends before it comes to a frame the library reports success.
  if (header.width <= 0 || header.height <= 0) throw Error("damaged JPEG: it has no frame", where);
  codec::check_texture_size(static_cast<std::uint64_t>(header.width), static_cast<std::uint64_t>(header.height), 4,
                            where);
  return header;
}

void decompress(tjhandle handle, std::span<const std::byte> bytes, const JpegHeader& header, TJPF format,
                std::uint8_t* pixels, const std::string& where) {
  // A progressive file of a few kilobytes may hold thousands of scans over the whole picture: LIMITSCANS stops at 500.
  const int flags = TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS;
  const int result = tjDecompress2(handle, jpeg_data(bytes), static_cast<unsigned long>(bytes.size()), pixels,
                                   header.width, 0, header.height, format, flags);
  check(handle, result, where);
}

/// Adobe's inverted CMYK (255 = no ink), which is what JPEG files hold in practice, to RGBA.
void cmyk_to_rgba(std::vector<std::uint8_t>& pixels) {
  for (std::size_t i = 0; i < pixels.size(); i += 4) {
    const unsigned k = pixels[i + 3];
    for (std::size_t c = 0; c < 3; ++c) pixels[i + c] = static_cast<std::uint8_t>((pixels[i + c] * k + 127) / 255);
    pixels[i + 3] = 255;
  }
}

/// Straight alpha over black, in linear light. Fully opaque pixels stay as they are.
std::vector<std::uint8_t> over_black(const DisplayImage& image) {
  std::vector<std::uint8_t> rgba = image.rgba;
  std::array<float, 256> linear_of_code{};
  for (std::size_t i = 0; i < 256; ++i) linear_of_code[i] = shade::srgb_decode_channel(static_cast<float>(i) / 255.0f);
  for (std::size_t i = 0; i < rgba.size(); i += 4) {
    if (rgba[i + 3] == 255) continue;
    const float alpha = static_cast<float>(rgba[i + 3]) / 255.0f;
    for (std::size_t c = 0; c < 3; ++c)
      rgba[i + c] =
          static_cast<std::uint8_t>(shade::srgb_encode_channel(linear_of_code[rgba[i + c]] * alpha) * 255.0f + 0.5f);
  }
  return rgba;
}

}  // namespace

ImageHeader codec::jpeg_header(std::span<const std::byte> bytes, const std::string& where) {
  const Handle handle = open_decoder(where);
  const JpegHeader header = read_header(handle.get(), bytes, where);
  return {.size = {header.width, header.height}};
}

TextureImage codec::decode_jpeg(std::span<const std::byte> bytes, const std::string& where) {
  const Handle handle = open_decoder(where);
  const JpegHeader header = read_header(handle.get(), bytes, where);
  const std::uint64_t pixels = static_cast<std::uint64_t>(header.width) * static_cast<std::uint64_t>(header.height);
  // Every 8 x 8 block costs a Huffman code of at least one bit, so a short file cannot hold a large picture.
  if (pixels > std::uint64_t{bytes.size()} * 8 * 64) throw Error("damaged JPEG: the file is truncated", where);

  TextureImage image;
  image.width = header.width;
  image.height = header.height;
  resize_large(image.pixels, static_cast<std::size_t>(pixels) * 4);
  // TurboJPEG converts everything to RGBA except the four-ink colour spaces.
  const bool inks = header.colorspace == TJCS_CMYK || header.colorspace == TJCS_YCCK;
  decompress(handle.get(), bytes, header, inks ? TJPF_CMYK : TJPF_RGBA, image.pixels.data(), where);
  if (inks) cmyk_to_rgba(image.pixels);
  return image;
}

void write_jpeg(const std::filesystem::path& path, const DisplayImage& image) {
  const Handle handle(tjInitCompress());
  if (!handle) throw Error("cannot start the JPEG encoder", path.string());
  const std::vector<std::uint8_t> rgba = over_black(image);
  std::vector<std::byte> bytes(tjBufSize(image.width, image.height, TJSAMP_444));
  auto* out = reinterpret_cast<unsigned char*>(bytes.data());
  unsigned long size = static_cast<unsigned long>(bytes.size());
  if (tjCompress2(handle.get(), rgba.data(), image.width, 0, image.height, TJPF_RGBX, &out, &size, TJSAMP_444, 92,
                  TJFLAG_ACCURATEDCT | TJFLAG_NOREALLOC) != 0)
    throw Error(std::string("cannot encode JPEG: ") + tjGetErrorStr2(handle.get()), path.string());
  bytes.resize(size);
  write_file(path, bytes);
}

}  // namespace candela
