#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "image/image.h"

// TGA and BMP, which textures of other formats are in and those of glTF never are. Read here and not by a library,
// since those that there are fill what a cut file lacks with black, or leave out run-length codes.
namespace candela::foreign {

/// Largest side of such a picture, as of all textures.
inline constexpr int kMostTexels = 16384;

/// Whether it is a TGA: they have no mark, so that all that their header says must make sense.
bool is_tga(std::span<const std::byte> bytes);
bool is_bmp(std::span<const std::byte> bytes);

/// Truevision TGA, "File Format Specification, Version 2.0" (1991): mapped, true colour and grey, plain or run-length
/// coded, of 8, 15, 16, 24 or 32 bits. Alpha counts where the header says how many bits it has and some are set. Throws
/// Error(…, where) where the file is cut short, claims more than it can hold or is beyond kMostTexels.
TextureImage decode_tga(std::span<const std::byte> bytes, const std::string& where);

/// Windows and OS/2 bitmaps of 1, 4, 8, 16, 24 or 32 bits, plain, run-length coded or with masks, either way up. Alpha
/// counts where the header has a mask for it and some is set. Throws likewise, also for a JPEG or a PNG in it.
TextureImage decode_bmp(std::span<const std::byte> bytes, const std::string& where);

/// The picture where it is one of these.
std::optional<TextureImage> decode_old_picture(std::span<const std::byte> bytes, const std::string& where);

}  // namespace candela::foreign
