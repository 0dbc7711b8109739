#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

// UASTC LDR 4x4: blocks of 16 bytes, each in one of 19 modes that are a subset of ASTC. Khronos Group, "Khronos Data
// Format Specification" 1.4, chapter "Universal ASTC Compressed Texture Images". Private to this folder.
namespace candela::codec {

inline constexpr std::size_t kUastcBlockBytes = 16;

/// How endpoints are widened before they are mixed: sRGB data is rounded to other codes, by one at most.
enum class UastcRounding { linear, srgb };

/// One block to 16 RGBA texels in rows. A block that has no meaning becomes magenta, as the specification asks.
/// Returns the mode, 0 to 18, or -1 for such a block.
int decode_uastc_block(std::span<const std::byte, kUastcBlockBytes> block, UastcRounding rounding,
                       std::span<std::uint32_t, 16> texels);

/// The blocks of an image in rows, ceil(width / 4) x ceil(height / 4) of them, to `width` x `height` RGBA texels.
void decode_uastc(std::span<const std::byte> blocks, int width, int height, UastcRounding rounding,
                  std::span<std::uint8_t> rgba);

}  // namespace candela::codec
