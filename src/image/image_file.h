#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "image/image.h"

namespace candela {

enum class ImageFormat { unknown, png, jpeg, hdr, exr };

/// From the first bytes, never from a name.
ImageFormat sniff_image_format(std::span<const std::byte> bytes);
/// "PNG", "JPEG", "Radiance HDR", "OpenEXR" or "unknown".
const char* format_name(ImageFormat format);

/// Width and height from a PNG or JPEG header alone; throws Error(…, where) when it is neither or is damaged.
ivec2 read_image_size(std::span<const std::byte> bytes, const std::string& where);

/// Decodes PNG or JPEG to RGBA texels. Throws Error(…, where) for other formats, damaged data or sizes above 16384.
TextureImage decode_texture(std::span<const std::byte> bytes, const std::string& where);

/// Reads a linear image: Radiance .hdr, OpenEXR (RGB/RGBA/Y of the first part, or of `layer`), PNG/JPEG (sRGB decoded).
/// The result has 3 channels, or 4 where the file has alpha; PNG/JPEG alpha is premultiplied on the way in.
Image read_image(const std::filesystem::path& path, const std::string& layer = {});

/// What the first header of an OpenEXR file says, without its pixels.
struct ExrHeader {
  std::vector<std::string> channels;            ///< full names, sorted, e.g. "R", "albedo.R"
  std::map<std::string, std::string> metadata;  ///< every string attribute by name
};
/// Throws Error.
ExrHeader read_exr_header(const std::filesystem::path& path);

/// Radiance RGBE, run-length coded; negative values are clamped to 0. Alpha is dropped.
void write_hdr(const std::filesystem::path& path, const Image& image);

}  // namespace candela
