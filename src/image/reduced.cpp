#include "image/reduced.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "shade/color.glsl.h"

namespace candela {

namespace {

/// From codes of one channel to what is added up, and back.
class Codes {
 public:
  Codes(int bits, TexelKind kind) : largest_(bits == 16 ? 65535.0f : 255.0f), kind_(kind) {
    decode_.resize(static_cast<std::size_t>(largest_) + 1);
    for (std::size_t i = 0; i < decode_.size(); ++i) {
      const float code = static_cast<float>(i) / largest_;
      decode_[i] = kind == TexelKind::color ? shade::srgb_decode_channel(code) : code;
    }
  }
  /// Of a colour; alpha is always a plain number.
  float color(std::uint32_t code) const { return decode_[code]; }
  float number(std::uint32_t code) const { return static_cast<float>(code) / largest_; }
  std::uint32_t code(float value, bool is_alpha) const {
    if (kind_ == TexelKind::color && !is_alpha) value = shade::srgb_encode_channel(value);
    return static_cast<std::uint32_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * largest_));
  }

 private:
  float largest_;
  TexelKind kind_;
  std::vector<float> decode_;
};

/// What of `from` texels each of `to` covers along one axis.
struct Cover {
  int begin, end;
  double first, last;  ///< parts of the texels at both ends

  Cover(int index, int from, int to) {
    // Whole numbers, in units of 1 / to of a texel.
    const std::int64_t low = std::int64_t{index} * from, high = std::int64_t{index + 1} * from;
    begin = static_cast<int>(low / to);
    end = static_cast<int>((high + to - 1) / to);
    first = static_cast<double>(std::int64_t{begin + 1} * to - low) / to;
    last = static_cast<double>(high - std::int64_t{end - 1} * to) / to;
    if (end == begin + 1) first = last = static_cast<double>(high - low) / to;
  }
  double weight(int i) const { return i == begin ? first : i == end - 1 ? last : 1.0; }
};

template <class Word>
void add_row(const TextureImage& image, int y, double weight, const std::vector<Cover>& columns, const Codes& codes,
             std::vector<double>& sums) {
  const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width);
  for (std::size_t x = 0; x < columns.size(); ++x) {
    const Cover& cover = columns[x];
    std::array<double, 4> sum{};
    for (int i = cover.begin; i < cover.end; ++i) {
      std::array<Word, 4> texel;
      std::memcpy(texel.data(), image.pixels.data() + (row + static_cast<std::size_t>(i)) * sizeof texel, sizeof texel);
      const double w = cover.weight(i);
      for (std::size_t c = 0; c < 3; ++c) sum[c] += w * static_cast<double>(codes.color(texel[c]));
      sum[3] += w * static_cast<double>(codes.number(texel[3]));
    }
    for (std::size_t c = 0; c < 4; ++c) sums[4 * x + c] += weight * sum[c];
  }
}

/// Of a mean of codes between 0 and 1.
vec3 of_unit_length(vec3 mean) {
  const vec3 n = 2.0f * mean - 1.0f;
  const float length = glm::length(n);
  return length > 1e-4f ? 0.5f * (n / length) + 0.5f : vec3(0.5f, 0.5f, 1.0f);
}

template <class Word>
TextureImage reduce(const TextureImage& image, ivec2 size, TexelKind kind) {
  const Codes codes(image.bits, kind);
  TextureImage result{size.x, size.y, image.bits, image.has_alpha, {}};
  result.pixels.resize(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * 4 * sizeof(Word));
  std::vector<Cover> columns;
  columns.reserve(static_cast<std::size_t>(size.x));
  for (int x = 0; x < size.x; ++x) columns.emplace_back(x, image.width, size.x);
  const double area = static_cast<double>(image.width) / size.x * image.height / size.y;
  std::vector<double> sums(columns.size() * 4);
  std::uint8_t* out = result.pixels.data();
  for (int y = 0; y < size.y; ++y) {
    std::fill(sums.begin(), sums.end(), 0.0);
    const Cover rows(y, image.height, size.y);
    for (int i = rows.begin; i < rows.end; ++i) add_row<Word>(image, i, rows.weight(i), columns, codes, sums);
    for (std::size_t x = 0; x < columns.size(); ++x) {
      const auto mean = [&](std::size_t c) { return static_cast<float>(sums[4 * x + c] / area); };
      vec3 rgb(mean(0), mean(1), mean(2));
      if (kind == TexelKind::normal) rgb = of_unit_length(rgb);
      const std::array<Word, 4> texel{
          static_cast<Word>(codes.code(rgb.x, false)), static_cast<Word>(codes.code(rgb.y, false)),
          static_cast<Word>(codes.code(rgb.z, false)), static_cast<Word>(codes.code(mean(3), true))};
      std::memcpy(out, texel.data(), sizeof texel);
      out += sizeof texel;
    }
  }
  return result;
}

}  // namespace

ivec2 size_of_level(ivec2 size, int level) {
  const auto side = [level](int n) { return level < 31 ? std::max(n >> level, 1) : 1; };
  return {side(size.x), side(size.y)};
}

TextureImage reduced(const TextureImage& image, int level, TexelKind kind) {
  const ivec2 size = size_of_level({image.width, image.height}, level);
  return image.bits == 16 ? reduce<std::uint16_t>(image, size, kind) : reduce<std::uint8_t>(image, size, kind);
}

}  // namespace candela
