#include "math/distribution.h"

#include <algorithm>

#include "base/check.h"
#include "base/large_pages.h"

namespace candela {

namespace {

constexpr float kAlmostOne = 0x1.fffffep-1f;  // the last float below 1

/// Fills `cdf` (weights.size() + 1 values from 0 to 1); returns the sum of the weights.
double fill_cdf(std::span<const float> weights, std::span<float> cdf) {
  const std::size_t n = weights.size();
  double total = 0.0;
  for (const float w : weights) total += static_cast<double>(w);
  double sum = 0.0;
  cdf[0] = 0.0f;
  for (std::size_t i = 0; i < n; ++i) {
    sum += total > 0.0 ? static_cast<double>(weights[i]) / total : 1.0 / static_cast<double>(n);
    cdf[i + 1] = static_cast<float>(std::min(sum, 1.0));
  }
  // Intervals after the last weight stay empty, so that an index of weight 0 is never chosen.
  const float last = cdf[n];
  for (std::size_t i = n; i > 0 && cdf[i] == last; --i) cdf[i] = 1.0f;
  return total;
}

/// guide[k] = the interval of `cdf` that u = k / size lies in; one entry more than `size`, so that k + 1 bounds a
/// search.
template <class Index>
void fill_guide(std::span<const float> cdf, std::span<Index> guide) {
  const std::size_t n = cdf.size() - 1;
  const std::size_t size = guide.size() - 1;
  std::size_t index = 0;
  for (std::size_t k = 0; k <= size; ++k) {
    const float u = static_cast<float>(k) / static_cast<float>(size);
    while (index + 1 < n && cdf[index + 1] <= u) ++index;
    guide[k] = static_cast<Index>(index);
  }
}

/// The i with cdf[i] ≤ u < cdf[i + 1]. The guide's entries are widened by one for the rounding of k / size.
template <class Index>
std::size_t find_interval(const float* cdf, std::size_t n, const Index* guide, std::size_t guide_size, float u) {
  const std::size_t k = std::min(static_cast<std::size_t>(u * static_cast<float>(guide_size)), guide_size - 1);
  const std::size_t first = guide[k] > 0 ? guide[k] - std::size_t{1} : 0;
  const std::size_t last = std::min<std::size_t>(guide[k + 1] + std::size_t{2}, n);
  const float* found = std::upper_bound(cdf + first + 1, cdf + last, u);
  return static_cast<std::size_t>(found - cdf) - 1;
}

float remainder(const float* cdf, std::size_t i, float u) {
  const float width = cdf[i + 1] - cdf[i];
  return width > 0.0f ? std::clamp((u - cdf[i]) / width, 0.0f, kAlmostOne) : 0.0f;
}

}  // namespace

Distribution1D::Distribution1D(std::span<const float> weights) : cdf_(weights.size() + 1), guide_(weights.size() + 1) {
  CANDELA_CHECK(!weights.empty());
  total_ = fill_cdf(weights, cdf_);
  fill_guide<std::uint32_t>(cdf_, guide_);
}

Distribution1D::Sample Distribution1D::sample(float u) const {
  const std::size_t n = cdf_.size() - 1;
  const std::size_t i = find_interval(cdf_.data(), n, guide_.data(), n, u);
  return {static_cast<int>(i), cdf_[i + 1] - cdf_[i], remainder(cdf_.data(), i, u)};
}

Distribution2D::Distribution2D(std::span<const float> weights, int width, int height)
    : width_(static_cast<std::size_t>(width)), height_(static_cast<std::size_t>(height)) {
  CANDELA_CHECK_EQ(weights.size(), width_ * height_);
  CANDELA_CHECK(width_ > 0 && width_ <= 65536);
  guide_size_ = std::max<std::size_t>(width_ / kGuideCells, 1);
  resize_large(cdf_, height_ * (width_ + 1));
  guide_.resize(height_ * (guide_size_ + 1));
  std::vector<float> sums(height_);
  for (std::size_t y = 0; y < height_; ++y) {
    const std::span<float> cdf(cdf_.data() + y * (width_ + 1), width_ + 1);
    sums[y] = static_cast<float>(fill_cdf(weights.subspan(y * width_, width_), cdf));
    fill_guide<std::uint16_t>(cdf, std::span(guide_.data() + y * (guide_size_ + 1), guide_size_ + 1));
  }
  marginal_ = Distribution1D(sums);
}

Distribution2D::Sample Distribution2D::sample(vec2 u) const {
  const auto row = marginal_.sample(u.y);
  const auto y = static_cast<std::size_t>(row.index);
  const float* cdf = row_cdf(y);
  const std::size_t x = find_interval(cdf, width_, guide_.data() + y * (guide_size_ + 1), guide_size_, u.x);
  const auto w = static_cast<float>(width_);
  const auto h = static_cast<float>(height_);
  Sample s;
  s.cell = {static_cast<int>(x), row.index};
  // Far from 0 the sum rounds up to the next cell, and in the last one to 1.
  s.uv = {std::min((static_cast<float>(x) + remainder(cdf, x, u.x)) / w, kAlmostOne),
          std::min((static_cast<float>(row.index) + row.u) / h, kAlmostOne)};
  s.pdf = row.pmf * (cdf[x + 1] - cdf[x]) * w * h;
  return s;
}

void Distribution2D::prefetch(vec2 u) const {
  const auto y = static_cast<std::size_t>(marginal_.sample(u.y).index);
  const std::size_t k = std::min(static_cast<std::size_t>(u.x * static_cast<float>(guide_size_)), guide_size_ - 1);
  __builtin_prefetch(row_cdf(y) + guide_[y * (guide_size_ + 1) + k]);
}

float Distribution2D::pdf(ivec2 cell) const {
  const float* cdf = row_cdf(static_cast<std::size_t>(cell.y));
  const float pmf = cdf[cell.x + 1] - cdf[cell.x];
  return marginal_.pmf(cell.y) * pmf * static_cast<float>(width_) * static_cast<float>(height_);
}

}  // namespace candela
