#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "image/develop.h"
#include "image/image.h"
#include "image/image_file.h"

// What image_file.cpp dispatches to, one file per format. Private to this folder. All throw Error(…, where).
namespace candela::codec {

/// Largest side of a texture; what every current GPU accepts.
inline constexpr int kMaxTextureSize = 16384;
/// Largest side of a linear image.
inline constexpr int kMaxImageSize = 32768;
/// Most memory that the pixels of one decoded image may take; larger ones are refused before anything is allocated.
inline constexpr std::uint64_t kMaxTextureBytes = std::uint64_t{1} << 30;
inline constexpr std::uint64_t kMaxImageBytes = std::uint64_t{1} << 31;

/// Throws Error for a texture that is larger than the above, of `pixel_bytes` per pixel once it is decoded.
void check_texture_size(std::uint64_t width, std::uint64_t height, std::uint64_t pixel_bytes, const std::string& where);

/// They throw Error where decoding would for the size's sake, and decode no pixel.
ImageHeader png_header(std::span<const std::byte> bytes, const std::string& where);
ImageHeader jpeg_header(std::span<const std::byte> bytes, const std::string& where);
ImageHeader webp_header(std::span<const std::byte> bytes, const std::string& where);
ImageHeader avif_header(std::span<const std::byte> bytes, const std::string& where);
/// Of a KTX 2 that decode_texture_pixels reads.
ImageHeader texture_header(std::span<const std::byte> bytes, const std::string& where);
TextureImage decode_png(std::span<const std::byte> bytes, const std::string& where);
TextureImage decode_jpeg(std::span<const std::byte> bytes, const std::string& where);
TextureImage decode_webp(std::span<const std::byte> bytes, const std::string& where);
TextureImage decode_avif(std::span<const std::byte> bytes, const std::string& where);
ImageFile decode_hdr(std::span<const std::byte> bytes, const std::string& where);
ImageFile decode_exr(std::span<const std::byte> bytes, const std::string& layer, const std::string& where);

/// Like write_png, for numbers that are no colours of a display: the file says nothing of sRGB.
void write_png_data(const std::filesystem::path& path, const DisplayImage& image);

}  // namespace candela::codec
