#include "math/distribution.h"

#include <algorithm>

#include "base/check.h"

namespace candela {

Distribution1D::Distribution1D(std::span<const float> weights) {
  CANDELA_CHECK(!weights.empty());
  const std::size_t n = weights.size();
  for (const float w : weights) total_ += static_cast<double>(w);

  cdf_.resize(n + 1);
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    sum += total_ > 0.0 ? static_cast<double>(weights[i]) / total_ : 1.0 / static_cast<double>(n);
    cdf_[i + 1] = static_cast<float>(std::min(sum, 1.0));
  }
  // Intervals after the last weight stay empty, so that an index of weight 0 is never chosen.
  for (std::size_t i = n; i > 0 && cdf_[i] == cdf_[n]; --i) {
    if (cdf_[i - 1] == cdf_[n]) continue;
    std::fill(cdf_.begin() + static_cast<std::ptrdiff_t>(i), cdf_.end(), 1.0f);
    break;
  }

  guide_.resize(n);
  std::size_t index = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const float u = static_cast<float>(k) / static_cast<float>(n);
    while (index + 1 < n && cdf_[index + 1] <= u) ++index;
    guide_[k] = static_cast<std::uint32_t>(index);
  }
}

Distribution1D::Sample Distribution1D::sample(float u) const {
  const std::size_t n = guide_.size();
  std::size_t i = guide_[std::min(static_cast<std::size_t>(u * static_cast<float>(n)), n - 1)];
  // The guide was computed with the rounding of k / n; one step back makes up for it.
  while (i > 0 && cdf_[i] > u) --i;
  while (i + 1 < n && cdf_[i + 1] <= u) ++i;
  const float width = cdf_[i + 1] - cdf_[i];
  const float rest = width > 0.0f ? (u - cdf_[i]) / width : 0.0f;
  return {static_cast<int>(i), width, std::clamp(rest, 0.0f, 0x1.fffffep-1f)};
}

Distribution2D::Distribution2D(std::span<const float> weights, int width, int height) {
  const auto w = static_cast<std::size_t>(width);
  const auto h = static_cast<std::size_t>(height);
  CANDELA_CHECK_EQ(weights.size(), w * h);
  rows_.reserve(h);
  std::vector<float> sums(h);
  for (std::size_t y = 0; y < h; ++y) {
    rows_.emplace_back(weights.subspan(y * w, w));
    sums[y] = static_cast<float>(rows_[y].total());
  }
  marginal_ = Distribution1D(sums);
}

Distribution2D::Sample Distribution2D::sample(vec2 u) const {
  const auto row = marginal_.sample(u.y);
  const auto& distribution = rows_[static_cast<std::size_t>(row.index)];
  const auto column = distribution.sample(u.x);
  const auto w = static_cast<float>(distribution.size());
  const auto h = static_cast<float>(rows_.size());
  Sample s;
  s.cell = {column.index, row.index};
  s.uv = {(static_cast<float>(column.index) + column.u) / w, (static_cast<float>(row.index) + row.u) / h};
  s.pdf = row.pmf * column.pmf * w * h;
  return s;
}

float Distribution2D::pdf(ivec2 cell) const {
  const auto& row = rows_[static_cast<std::size_t>(cell.y)];
  return marginal_.pmf(cell.y) * row.pmf(cell.x) * static_cast<float>(row.size()) * static_cast<float>(rows_.size());
}

}  // namespace candela
