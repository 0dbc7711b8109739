#include "image/bloom.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"

namespace candela {

namespace {

constexpr int kMostLevels = 10;
constexpr int kSmallestSide = 4;

int half(int n) { return (n + 1) / 2; }

/// Calls f(y) for every row of an image, side by side.
template <class F>
void for_rows(const Image& image, const F& f) {
  parallel_for(0, static_cast<std::size_t>(image.height), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) f(static_cast<int>(y));
  });
}

Image finite(const Image& image) {
  Image result = image;
  for (float& x : result.pixels) {
    if (!std::isfinite(x)) x = 0.0f;
  }
  return result;
}

/// Half the size, by (1 3 3 1) / 8 along either axis: neighbouring pixels of the result share what lies between them.
Image halved(const Image& image) {
  constexpr std::array<float, 4> kWeights = {0.125f, 0.375f, 0.375f, 0.125f};
  Image result(half(image.width), half(image.height), image.channels);
  for_rows(result, [&](int y) {
    for (int x = 0; x < result.width; ++x) {
      float* out = result.at(x, y).data();
      for (int j = 0; j < 4; ++j) {
        const int sy = std::clamp(2 * y + j - 1, 0, image.height - 1);
        for (int i = 0; i < 4; ++i) {
          const float* in = image.at(std::clamp(2 * x + i - 1, 0, image.width - 1), sy).data();
          const float w = kWeights[static_cast<std::size_t>(i)] * kWeights[static_cast<std::size_t>(j)];
          for (int c = 0; c < image.channels; ++c) out[c] += w * in[c];
        }
      }
    }
  });
  return result;
}

/// `image` becomes (1 - share) of itself and `share` of a level half as large, seen linearly between its pixels.
void mix_in(const Image& level, float share, Image& image) {
  for_rows(image, [&](int y) {
    const float v = 0.5f * (static_cast<float>(y) - 0.5f);
    const int y0 = static_cast<int>(std::floor(v));
    const float ty = v - static_cast<float>(y0);
    const int rows[2] = {std::clamp(y0, 0, level.height - 1), std::clamp(y0 + 1, 0, level.height - 1)};
    for (int x = 0; x < image.width; ++x) {
      const float u = 0.5f * (static_cast<float>(x) - 0.5f);
      const int x0 = static_cast<int>(std::floor(u));
      const float tx = u - static_cast<float>(x0);
      const int left = std::clamp(x0, 0, level.width - 1), right = std::clamp(x0 + 1, 0, level.width - 1);
      const float *a = level.at(left, rows[0]).data(), *b = level.at(right, rows[0]).data();
      const float *c = level.at(left, rows[1]).data(), *d = level.at(right, rows[1]).data();
      float* out = image.at(x, y).data();
      for (int k = 0; k < image.channels; ++k) {
        const float wide = (a[k] * (1 - tx) + b[k] * tx) * (1 - ty) + (c[k] * (1 - tx) + d[k] * tx) * ty;
        out[k] = (1.0f - share) * out[k] + share * wide;
      }
    }
  });
}

}  // namespace

Image bloomed(const Image& image, float share) {
  std::vector<Image> levels = {finite(image)};
  while (static_cast<int>(levels.size()) < kMostLevels &&
         std::min(levels.back().width, levels.back().height) > kSmallestSide) {
    levels.push_back(halved(levels.back()));
  }
  // From small to large, what is below counts as often as it has levels.
  for (std::size_t i = levels.size() - 1; i > 1; --i) {
    const auto below = static_cast<float>(levels.size() - i);
    mix_in(levels[i], below / (below + 1.0f), levels[i - 1]);
  }
  if (levels.size() == 1) return image;
  Image result = image;
  mix_in(levels[1], share, result);
  return result;
}

}  // namespace candela
