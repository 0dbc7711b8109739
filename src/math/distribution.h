#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "math/types.h"

namespace candela {

/// A discrete distribution over 0 … n-1, sampled by inversion (which keeps the order of u, and so its stratification)
/// with a guide table (Chen & Asau 1974), O(1) on average.
class Distribution1D {
 public:
  struct Sample {
    int index = 0;
    float pmf = 0.0f;
    float u = 0.0f;  ///< what is left of u inside the chosen interval, uniform in [0, 1)
  };

  Distribution1D() = default;
  /// Weights are ≥ 0 and finite; all zero means uniform.
  explicit Distribution1D(std::span<const float> weights);

  bool empty() const { return cdf_.empty(); }
  int size() const { return cdf_.empty() ? 0 : static_cast<int>(cdf_.size()) - 1; }
  double total() const { return total_; }
  Sample sample(float u) const;
  float pmf(int index) const {
    const auto i = static_cast<std::size_t>(index);
    return cdf_[i + 1] - cdf_[i];
  }

 private:
  std::vector<float> cdf_;  ///< size + 1 values from 0 to 1
  std::vector<std::uint32_t> guide_;
  double total_ = 0.0;
};

/// A piecewise constant density over [0,1)²; row-major weights of `width` × `height` cells, width at most 65536.
class Distribution2D {
 public:
  struct Sample {
    vec2 uv{0.0f};
    ivec2 cell{0};
    float pdf = 0.0f;  ///< with respect to uv
  };

  Distribution2D() = default;
  Distribution2D(std::span<const float> weights, int width, int height);

  bool empty() const { return cdf_.empty(); }
  double total() const { return marginal_.total(); }  ///< sum of the weights
  Sample sample(vec2 u) const;
  float pdf(ivec2 cell) const;
  /// Starts the memory access that sample(u) will wait for.
  void prefetch(vec2 u) const;

 private:
  static constexpr std::size_t kGuideCells = 16;  ///< cells per guide entry

  const float* row_cdf(std::size_t y) const { return cdf_.data() + y * (width_ + 1); }

  std::size_t width_ = 0;
  std::size_t height_ = 0;
  Distribution1D marginal_;
  std::vector<float> cdf_;            ///< height × (width + 1)
  std::vector<std::uint16_t> guide_;  ///< height × (guide_size_ + 1): stays in cache, unlike cdf_
  std::size_t guide_size_ = 0;
};

}  // namespace candela
