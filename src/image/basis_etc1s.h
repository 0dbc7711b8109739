#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "image/basis_bits.h"

// ETC1S under BasisLZ: each block of 4x4 texels names a colour with a table of brightness and a pattern, both from
// books that all images of the file share. Khronos Group, "KTX File Format Specification" 2.0, appendices "BasisLZ
// Global Data" and "BasisLZ/ETC1S Bitstream Specification"; ETC1S itself in "Khronos Data Format Specification" 1.4.
// Private to this folder. All throw Error("damaged: …", where).
namespace candela::codec {

/// Where an image lies in its level; alpha_length 0 where there is one slice.
struct Etc1sImage {
  bool is_p_frame = false;  ///< built on the image before: video
  std::uint32_t rgb_offset = 0, rgb_length = 0, alpha_offset = 0, alpha_length = 0;
};

/// What the images share.
struct Etc1sBook {
  std::vector<std::array<std::uint32_t, 4>> colors;  ///< the four RGBA texels of each endpoint
  std::vector<std::uint32_t> patterns;               ///< two bits a texel, the first texel lowest
  HuffmanTable endpoint_prediction, endpoint_delta, pattern, pattern_run;
  std::uint32_t history = 0;  ///< patterns that can be named again
};

/// The descriptions of `count` images at the beginning of the file's global data, in the order of the file. A slice
/// that is empty where there must be one is refused here; where it ends is for the reader of levels to see.
std::vector<Etc1sImage> read_etc1s_images(std::span<const std::byte> global_data, std::size_t count,
                                          const std::string& where);
Etc1sBook read_etc1s_book(std::span<const std::byte> global_data, std::size_t image_count, const std::string& where);

/// What the second slice is, from the format's descriptor.
enum class Etc1sSecond { none, alpha, green };

/// Both slices of an image to RGBA texels. Where `second` is green, blue is 0.
void decode_etc1s(const Etc1sBook& book, std::span<const std::byte> rgb, std::span<const std::byte> second_slice,
                  Etc1sSecond second, int width, int height, std::span<std::uint8_t> rgba, const std::string& where);

}  // namespace candela::codec
