#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "image/movie.h"

// GIF89a, CompuServe 1990. The pictures wait, compressed, until the colours of all of them are known.

namespace candela::movie {

namespace {

constexpr std::uint8_t kTransparent = 255;
constexpr int kOpaque = 128;  ///< alpha from which a pixel is there

/// LZW with codes of 9 to 12 bits, as GIF packs them: from the lowest bit on.
class LzwWriter {
 public:
  explicit LzwWriter(std::string& out) : out_(out), next_of_(std::size_t{kMostCodes} * 256, 0) { clear(); }

  void write(const std::vector<std::uint8_t>& indices) {
    put(kClear);
    int prefix = indices[0];
    for (std::size_t i = 1; i < indices.size(); ++i) {
      std::uint16_t& known = next_of_[static_cast<std::size_t>(prefix) * 256 + indices[i]];
      if (known != 0) {
        prefix = known;
        continue;
      }
      put(prefix);
      if (next_code_ < kMostCodes) {
        known = static_cast<std::uint16_t>(next_code_);
        if (next_code_++ == 1 << bits_) ++bits_;
      } else {
        put(kClear);
        clear();
      }
      prefix = indices[i];
    }
    put(prefix);
    if (next_code_ == 1 << bits_ && bits_ < 12) ++bits_;  // readers have one code more by now
    put(kEnd);
    if (used_ > 0) byte(static_cast<std::uint8_t>(buffer_));
    flush();
    out_ += '\0';
  }

 private:
  static constexpr int kClear = 256, kEnd = 257, kMostCodes = 4096;

  void clear() {
    std::fill(next_of_.begin(), next_of_.end(), std::uint16_t{0});
    next_code_ = kEnd + 1;
    bits_ = 9;
  }
  void put(int code) {
    buffer_ |= static_cast<std::uint32_t>(code) << used_;
    for (used_ += bits_; used_ >= 8; used_ -= 8, buffer_ >>= 8) byte(static_cast<std::uint8_t>(buffer_ & 255u));
  }
  void byte(std::uint8_t value) {
    block_ += static_cast<char>(value);
    if (block_.size() == 255) flush();
  }
  void flush() {
    if (block_.empty()) return;
    out_ += static_cast<char>(block_.size());
    out_ += block_;
    block_.clear();
  }

  std::string& out_;
  std::vector<std::uint16_t> next_of_;  ///< the code of a code and a byte after it; 0 = none
  int next_code_ = 0;
  int bits_ = 9;
  std::uint32_t buffer_ = 0;
  int used_ = 0;  ///< bits of it
  std::string block_;
};

void put_u16(std::string& out, int value) {
  out += static_cast<char>(value & 255);
  out += static_cast<char>(value >> 8);
}

/// Bayer's pattern of 4×4, -7.5 … 7.5: it stands still while pictures move, as diffused errors do not.
float bayer(int x, int y) {
  constexpr std::array<int, 16> kPattern = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
  return static_cast<float>(kPattern[static_cast<std::size_t>(y % 4 * 4 + x % 4)]) - 7.5f;
}

class GifWriter : public MovieWriter {
 public:
  GifWriter(const std::filesystem::path& path, const MovieSettings& settings)
      : path_(path), settings_(settings), counts_(Palette::kBins, 0) {}

  void add(const DisplayImage& picture) override;
  void finish() override;

 private:
  void write_head(const Palette& palette, std::string& out) const;
  void write_picture(const std::vector<std::uint8_t>& rgba, const Palette& palette, int delay, std::string& out) const;

  std::filesystem::path path_;
  MovieSettings settings_;
  std::vector<std::uint64_t> counts_;
  std::vector<std::vector<Bytef>> packed_;
};

void GifWriter::add(const DisplayImage& picture) {
  if (ivec2(picture.width, picture.height) != settings_.size) throw Error("a picture has another size", path_.string());
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    const std::uint8_t* p = &picture.rgba[i];
    if (settings_.has_alpha && p[3] < kOpaque) continue;
    ++counts_[static_cast<std::size_t>((p[0] * 31 + 127) / 255 * 1024 + (p[1] * 31 + 127) / 255 * 32 +
                                       (p[2] * 31 + 127) / 255)];
  }
  uLongf size = compressBound(static_cast<uLong>(picture.rgba.size()));
  std::vector<Bytef> packed(size);
  if (compress2(packed.data(), &size, picture.rgba.data(), static_cast<uLong>(picture.rgba.size()), 1) != Z_OK) {
    throw Error("out of memory", path_.string());
  }
  packed.resize(size);
  packed.shrink_to_fit();
  packed_.push_back(std::move(packed));
}

void GifWriter::write_head(const Palette& palette, std::string& out) const {
  out += "GIF89a";
  put_u16(out, settings_.size.x);
  put_u16(out, settings_.size.y);
  out +=
      {static_cast<char>(0xf7), static_cast<char>(kTransparent), '\0'};  // 256 colours, the background is none of them
  for (std::size_t i = 0; i < 256; ++i) {
    for (std::size_t c = 0; c < 3; ++c)
      out += static_cast<char>(i < palette.colors().size() ? palette.colors()[i][c] : 0);
  }
  out += std::string("!\xff\x0bNETSCAPE2.0\x03\x01\0\0\0", 19);  // again and again
}

void GifWriter::write_picture(const std::vector<std::uint8_t>& rgba, const Palette& palette, int delay,
                              std::string& out) const {
  constexpr float kSpread = 0.8f;  // code values of a step: about the distance of two of 255 colours
  std::vector<std::uint8_t> indices(rgba.size() / 4);
  for (int y = 0; y < settings_.size.y; ++y) {
    for (int x = 0; x < settings_.size.x; ++x) {
      const std::size_t i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(settings_.size.x) + static_cast<std::size_t>(x);
      const std::uint8_t* p = &rgba[4 * i];
      const int dither = static_cast<int>(std::lround(kSpread * bayer(x, y)));
      const bool is_clear = settings_.has_alpha && p[3] < kOpaque;
      indices[i] = is_clear ? kTransparent : palette.nearest(p[0] + dither, p[1] + dither, p[2] + dither);
    }
  }
  // What is transparent is cleared before the next picture comes.
  out += std::string("!\xf9\x04", 3) + static_cast<char>(settings_.has_alpha ? 0x09 : 0x04);
  put_u16(out, delay);
  out += {static_cast<char>(settings_.has_alpha ? kTransparent : 0), '\0', ','};
  put_u16(out, 0);
  put_u16(out, 0);
  put_u16(out, settings_.size.x);
  put_u16(out, settings_.size.y);
  out += {'\0', '\x08'};
  LzwWriter(out).write(indices);
}

void GifWriter::finish() {
  if (packed_.empty()) throw Error("there is no picture for the film", path_.string());
  const Palette palette(counts_);
  std::string out;
  write_head(palette, out);
  std::vector<std::uint8_t> rgba(4 * static_cast<std::size_t>(settings_.size.x) *
                                 static_cast<std::size_t>(settings_.size.y));
  // Delays are hundredths: their sum stays right.
  const auto moment = [&](std::size_t i) {
    return static_cast<int>(std::lround(100.0 * static_cast<double>(i) / settings_.frame_rate));
  };
  for (std::size_t i = 0; i < packed_.size(); ++i) {
    auto size = static_cast<uLongf>(rgba.size());
    if (uncompress(rgba.data(), &size, packed_[i].data(), static_cast<uLong>(packed_[i].size())) != Z_OK) {
      throw Error("out of memory", path_.string());
    }
    write_picture(rgba, palette, std::min(moment(i + 1) - moment(i), 65535), out);
    packed_[i] = {};
  }
  out += ';';
  write_file(path_, out);
}

}  // namespace

std::unique_ptr<MovieWriter> open_gif(const std::filesystem::path& path, const MovieSettings& settings) {
  return std::make_unique<GifWriter>(path, settings);
}

}  // namespace candela::movie
