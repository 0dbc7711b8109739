#include "path/pixel_filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace candela::path {

namespace {

/// Profile over t in [-1, 1] (t = 1 at the radius).
double profile(PixelFilter filter, double t) {
  switch (filter) {
    case PixelFilter::box:
      return 1.0;
    // σ = radius / 3, minus its value at the radius, so that it ends at 0.
    case PixelFilter::gaussian:
      return std::exp(-4.5 * t * t) - std::exp(-4.5);
    // Harris 1978, "On the Use of Windows for Harmonic Analysis", table I, minimum 4-term.
    case PixelFilter::blackman_harris:
      return 0.35875 + 0.48829 * std::cos(std::numbers::pi * t) + 0.14128 * std::cos(2.0 * std::numbers::pi * t) +
             0.01168 * std::cos(3.0 * std::numbers::pi * t);
  }
  return 0.0;
}

}  // namespace

PixelFilterSampler::PixelFilterSampler(PixelFilter filter, float radius) : filter_(filter), radius_(radius) {
  if (radius_ <= 0.0f) radius_ = filter == PixelFilter::box ? 0.5f : 1.5f;
  constexpr int kSteps = 8192;
  std::vector<double> integral(kSteps + 1);  // from the middle outwards
  for (int i = 0; i < kSteps; ++i) {
    const auto k = static_cast<std::size_t>(i);
    integral[k + 1] = integral[k] + profile(filter, (i + 0.5) / kSteps);
  }
  int step = kSteps - 1;
  for (int k = 0; k <= kSize; ++k) {
    const double w = static_cast<double>(k) / kSize;
    const double target = integral.back() * (1.0 - w * w);
    while (step > 0 && integral[static_cast<std::size_t>(step)] > target) --step;
    const double a = integral[static_cast<std::size_t>(step)];
    const double b = integral[static_cast<std::size_t>(step + 1)];
    const double t = (step + (b > a ? (target - a) / (b - a) : 0.0)) / kSteps;
    inverse_[static_cast<std::size_t>(k)] = static_cast<float>(std::min(t, 1.0)) * radius_;
  }
}

float PixelFilterSampler::sample(float u) const {
  const float s = 2.0f * u - 1.0f;
  if (filter_ == PixelFilter::box) return s * radius_;
  const float x = std::sqrt(1.0f - std::abs(s)) * static_cast<float>(kSize);
  const int i = static_cast<int>(x);
  const auto k = static_cast<std::size_t>(i < kSize ? i : kSize - 1);
  return std::copysign(glm::mix(inverse_[k], inverse_[k + 1], x - static_cast<float>(k)), s);
}

}  // namespace candela::path
