#include "image/image_file.h"

#include <algorithm>
#include <cstring>

#include "base/error.h"
#include "base/file.h"
#include "base/parallel.h"
#include "image/browser_pictures.h"
#include "image/codec.h"
#include "image/texture_file.h"
#include "shade/color.glsl.h"

namespace candela {

namespace {

bool starts_with(std::span<const std::byte> bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

/// ISO/IEC 14496-12 §4.3: the first box names the brands that a file is made by; AVIF's are avif and avis.
bool is_avif(std::span<const std::byte> bytes) {
  constexpr std::size_t kBoxHeader = 8, kBrand = 4;
  if (bytes.size() < 16 || !starts_with(bytes.subspan(4), "ftyp")) return false;
  std::size_t length = 0;
  for (std::size_t i = 0; i < 4; ++i) length = length << 8 | std::to_integer<std::size_t>(bytes[i]);
  for (std::size_t at = kBoxHeader; at + kBrand <= std::min(length, bytes.size()); at += kBrand) {
    const auto brand = bytes.subspan(at);
    if (starts_with(brand, "avif") || starts_with(brand, "avis")) return true;
  }
  return false;
}

Error unexpected(ImageFormat format, const std::string& where) {
  return Error(std::string("expected a PNG, JPEG, WebP, AVIF or KTX 2 image, found ") + format_name(format), where);
}

template <class Code>
void decode_rows(const TextureImage& texture, const std::vector<float>& linear_of_code, Image& image) {
  const auto width = static_cast<std::size_t>(texture.width);
  const float alpha_scale = 1.0f / static_cast<float>(linear_of_code.size() - 1);
  const auto code_at = [&](std::size_t i) {
    Code code;
    std::memcpy(&code, texture.pixels.data() + i * sizeof(Code), sizeof(Code));
    return code;
  };
  parallel_for(0, static_cast<std::size_t>(texture.height), 32, [&](std::size_t begin, std::size_t end) {
    for (std::size_t pixel = begin * width; pixel < end * width; ++pixel) {
      float* out = image.pixels.data() + pixel * static_cast<std::size_t>(image.channels);
      const float alpha = static_cast<float>(code_at(pixel * 4 + 3)) * alpha_scale;
      for (std::size_t c = 0; c < 3; ++c) out[c] = linear_of_code[code_at(pixel * 4 + c)] * alpha;
      if (image.channels == 4) out[3] = alpha;
    }
  });
}

/// sRGB codes to linear light, alpha premultiplied.
Image linear_image(const TextureImage& texture) {
  std::vector<float> linear_of_code(texture.bits == 16 ? 65536 : 256);
  const float scale = 1.0f / static_cast<float>(linear_of_code.size() - 1);
  for (std::size_t i = 0; i < linear_of_code.size(); ++i)
    linear_of_code[i] = shade::srgb_decode_channel(static_cast<float>(i) * scale);

  Image image(texture.width, texture.height, texture.has_alpha ? 4 : 3);
  if (texture.bits == 16)
    decode_rows<std::uint16_t>(texture, linear_of_code, image);
  else
    decode_rows<std::uint8_t>(texture, linear_of_code, image);
  return image;
}

}  // namespace

void codec::check_texture_size(std::uint64_t width, std::uint64_t height, std::uint64_t pixel_bytes,
                               const std::string& where) {
  const std::string size = "image of " + std::to_string(width) + " x " + std::to_string(height) + " is too large: ";
  if (width > kMaxTextureSize || height > kMaxTextureSize)
    throw Error(size + "a side has at most " + std::to_string(kMaxTextureSize) + " pixels", where);
  if (width * height * pixel_bytes > kMaxTextureBytes)
    throw Error(size + "it would take more than " + std::to_string(kMaxTextureBytes >> 20) + " MiB", where);
}

const char* format_name(ImageFormat format) {
  switch (format) {
    case ImageFormat::png:
      return "PNG";
    case ImageFormat::jpeg:
      return "JPEG";
    case ImageFormat::webp:
      return "WebP";
    case ImageFormat::avif:
      return "AVIF";
    case ImageFormat::hdr:
      return "Radiance HDR";
    case ImageFormat::exr:
      return "OpenEXR";
    case ImageFormat::unknown:
      break;
  }
  return "unknown";
}

ImageFormat sniff_image_format(std::span<const std::byte> bytes) {
  if (starts_with(bytes, "\x89PNG\r\n\x1a\n")) return ImageFormat::png;
  if (starts_with(bytes, "\xff\xd8\xff")) return ImageFormat::jpeg;
  if (starts_with(bytes, "RIFF") && bytes.size() >= 12 && starts_with(bytes.subspan(8), "WEBP"))
    return ImageFormat::webp;
  if (is_avif(bytes)) return ImageFormat::avif;
  if (starts_with(bytes, "#?RADIANCE") || starts_with(bytes, "#?RGBE")) return ImageFormat::hdr;
  if (starts_with(bytes, "\x76\x2f\x31\x01")) return ImageFormat::exr;
  return ImageFormat::unknown;
}

bool is_display_format(ImageFormat format) {
  return format == ImageFormat::png || format == ImageFormat::jpeg || format == ImageFormat::webp ||
         format == ImageFormat::avif;
}

ImageHeader read_image_header(std::span<const std::byte> bytes, const std::string& where) {
  switch (const ImageFormat format = sniff_image_format(bytes)) {
    case ImageFormat::png:
      return codec::png_header(bytes, where);
    case ImageFormat::jpeg:
      return codec::jpeg_header(bytes, where);
    case ImageFormat::webp:
      return codec::webp_header(bytes, where);
    case ImageFormat::avif:
      return codec::avif_header(bytes, where);
    default:
      if (sniff_texture(bytes) == TextureContainer::ktx2) return codec::texture_header(bytes, where);
      throw unexpected(format, where);
  }
}

ivec2 read_image_size(std::span<const std::byte> bytes, const std::string& where) {
  return read_image_header(bytes, where).size;
}

TextureImage decode_texture(std::span<const std::byte> bytes, const std::string& where) {
#ifdef __EMSCRIPTEN__
  // What the browser has decoded already; the header is still judged here.
  if (const TextureImage* given = find_browser_picture(bytes)) {
    TextureImage picture = *given;
    picture.has_alpha = read_image_header(bytes, where).has_alpha;
    return picture;
  }
#endif
  switch (const ImageFormat format = sniff_image_format(bytes)) {
    case ImageFormat::png:
      return codec::decode_png(bytes, where);
    case ImageFormat::jpeg:
      return codec::decode_jpeg(bytes, where);
    case ImageFormat::webp:
      return codec::decode_webp(bytes, where);
    case ImageFormat::avif:
      return codec::decode_avif(bytes, where);
    default:
      if (sniff_texture(bytes) == TextureContainer::ktx2) return decode_texture_pixels(bytes, where);
      throw unexpected(format, where);
  }
}

ImageName parse_image_name(const std::string& name) {
  const auto is_there = [](const std::string& path) {
    std::error_code code;
    return std::filesystem::exists(path, code) && !std::filesystem::is_directory(path, code);
  };
  std::error_code code;
  if (std::filesystem::exists(name, code)) return {name, {}};
  for (std::size_t colon = name.rfind(':'); colon != std::string::npos && colon > 0; colon = name.rfind(':', colon - 1))
    if (colon + 1 < name.size() && is_there(name.substr(0, colon)))
      return {name.substr(0, colon), name.substr(colon + 1)};
  return {name, {}};
}

ImageFile read_image_file(const ImageName& name) {
  const std::string where = name.path.string();
  const std::vector<std::byte> bytes = read_file(name.path);
  const ImageFormat format = sniff_image_format(bytes);
  if (!name.layer.empty() && format != ImageFormat::exr)
    throw Error("layer \"" + name.layer + "\" asked for, but only OpenEXR files have layers", where);
  ImageFile file;
  switch (format) {
    case ImageFormat::png:
    case ImageFormat::jpeg:
    case ImageFormat::webp:
    case ImageFormat::avif:
      file.facts = read_image_header(bytes, where).facts;
      file.image = linear_image(decode_texture(bytes, where));
      break;
    case ImageFormat::hdr:
      file = codec::decode_hdr(bytes, where);
      break;
    case ImageFormat::exr:
      file = codec::decode_exr(bytes, name.layer, where);
      break;
    case ImageFormat::unknown:
      throw Error("not an image (PNG, JPEG, WebP, AVIF, Radiance HDR and OpenEXR are known)", where);
  }
  file.format = format;
  return file;
}

Image read_image(const std::filesystem::path& path, const std::string& layer) {
  return read_image_file(layer.empty() ? parse_image_name(path.string()) : ImageName{path, layer}).image;
}

}  // namespace candela
