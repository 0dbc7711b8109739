#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "image/develop.h"

/// Moving pictures: GIF and animated WebP by this program itself, MP4 and WebM through ffmpeg where that is installed.
namespace candela {

/// Whether the extension is that of moving pictures: .mp4, .webm, .gif, .webp (which may be a still one, too).
bool is_movie_name(const std::filesystem::path& path);

struct MovieSettings {
  ivec2 size{0};
  double frame_rate = 24.0;  ///< pictures per second
  /// Where the pictures are transparent the movie is: wholly or not at all in a GIF, not at all in an MP4, which shows
  /// black there.
  bool has_alpha = false;
};

/// Throws Error where the movie cannot be written: no such extension, no ffmpeg, a rate or a size that the format does
/// not have. To be called before hours of rendering.
void check_movie(const std::filesystem::path& path, const MovieSettings& settings);

/// A movie that grows picture by picture. It plays again and again where the format can say so. The file appears with
/// finish(), whole, or not at all.
class MovieWriter {
 public:
  virtual ~MovieWriter() = default;
  /// Throws Error for a picture of another size, and as finish().
  virtual void add(const DisplayImage& picture) = 0;
  /// Throws Error where nothing was added, the disk is full, or ffmpeg fails.
  virtual void finish() = 0;
};

/// Throws Error as check_movie() does.
std::unique_ptr<MovieWriter> open_movie(const std::filesystem::path& path, const MovieSettings& settings);

/// 256 colours for the pictures of a GIF: the median cut of Heckbert 1982, "Color Image Quantization for Frame Buffer
/// Display", on colours of five bits a channel, and the nearest of them for any colour.
class Palette {
 public:
  static constexpr std::size_t kColors = 255;  ///< the last of 256 is the transparent one
  static constexpr std::size_t kBins = std::size_t{32} * 32 * 32;

  /// `counts` of every bin r·1024 + g·32 + b, of channels over 8.
  explicit Palette(const std::vector<std::uint64_t>& counts);

  std::uint8_t nearest(int r, int g, int b) const;  ///< of channels 0 … 255
  const std::vector<std::array<std::uint8_t, 3>>& colors() const { return colors_; }

 private:
  std::vector<std::array<std::uint8_t, 3>> colors_;
  std::vector<std::uint8_t> nearest_;  ///< by bin
};

namespace movie {

// Of open_movie(), by format.
std::unique_ptr<MovieWriter> open_gif(const std::filesystem::path& path, const MovieSettings& settings);
std::unique_ptr<MovieWriter> open_webp(const std::filesystem::path& path, const MovieSettings& settings);
std::unique_ptr<MovieWriter> open_ffmpeg(const std::filesystem::path& path, const MovieSettings& settings);
/// Throws Error where it is not installed.
void check_ffmpeg(const std::filesystem::path& path);

}  // namespace movie

}  // namespace candela
