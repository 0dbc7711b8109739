#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

// ASTC blocks of 4x4 to 12x12 texels, by Arm's decoder (libastcenc). Private to this folder.
namespace candela::codec {

inline constexpr std::size_t kAstcBlockBytes = 16;

enum class AstcProfile {
  linear,
  srgb,  ///< codes are rounded as for sRGB; they stay encoded
  hdr
};

/// Decodes images that have one block size. Blocks that have no meaning become magenta, or NaN in HDR.
class AstcDecoder {
 public:
  /// Throws Error(…, where) for a block size that ASTC has not.
  AstcDecoder(int block_width, int block_height, AstcProfile profile, const std::string& where);
  ~AstcDecoder();
  AstcDecoder(const AstcDecoder&) = delete;
  AstcDecoder& operator=(const AstcDecoder&) = delete;

  /// `blocks` in rows to RGBA texels; 8 bits for the low dynamic range, floats for the high one.
  void decode(std::span<const std::byte> blocks, int width, int height, std::span<std::uint8_t> rgba);
  void decode(std::span<const std::byte> blocks, int width, int height, std::span<float> rgba);

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

}  // namespace candela::codec
