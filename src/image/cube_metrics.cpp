#include "image/cube_metrics.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "image/cube_layout.h"

namespace candela {

namespace {

/// Body(face, x, y, solid angle) for every texel, in order. A quarter of a face gives the weights of all.
template <class Body>
void for_each_texel(int size, Body body) {
  std::vector<double> weights(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      weights[static_cast<std::size_t>(y) * static_cast<std::size_t>(size) + static_cast<std::size_t>(x)] =
          cube_texel_solid_angle(size, x, y);
  for (int face = 0; face < 6; ++face)
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x)
        body(face, x, y,
             weights[static_cast<std::size_t>(y) * static_cast<std::size_t>(size) + static_cast<std::size_t>(x)]);
}

CubeLevelDifference diff_level(const CubeFaces& other, const CubeFaces& reference) {
  CubeLevelDifference result;
  result.size = reference[0].width;
  const double floor = 1e-3 * measure_light(reference).mean;
  double sum = 0.0, sum_of_squares = 0.0, weight = 0.0;
  for_each_texel(result.size, [&](int face, int x, int y, double solid_angle) {
    const vec3 a = other[static_cast<std::size_t>(face)].rgb(x, y);
    const vec3 b = reference[static_cast<std::size_t>(face)].rgb(x, y);
    if (!is_finite(a) || !is_finite(b)) {
      ++result.non_finite;
      return;
    }
    for (int c = 0; c < 3; ++c) {
      const double difference = static_cast<double>(a[c]) - static_cast<double>(b[c]);
      const double scale = std::max({std::abs(static_cast<double>(a[c])), std::abs(static_cast<double>(b[c])), floor});
      const double relative = scale > 0.0 ? difference / scale : 0.0;
      result.max_absolute = std::max(result.max_absolute, std::abs(difference));
      if (std::abs(relative) > result.max_relative) {
        result.max_relative = std::abs(relative);
        result.face = face, result.x = x, result.y = y;
      }
      sum += solid_angle * relative;
      sum_of_squares += solid_angle * relative * relative;
      weight += solid_angle;
    }
  });
  if (weight > 0.0) {
    result.mean_relative = sum / weight;
    result.rms_relative = std::sqrt(sum_of_squares / weight);
  }
  return result;
}

}  // namespace

CubeLevelLight measure_light(const CubeFaces& level) {
  CubeLevelLight light;
  light.size = level[0].width;
  double sum = 0.0, weight = 0.0;
  bool is_first = true;
  for_each_texel(light.size, [&](int face, int x, int y, double solid_angle) {
    const vec3 color = level[static_cast<std::size_t>(face)].rgb(x, y);
    if (!is_finite(color)) {
      ++light.non_finite;
      return;
    }
    const auto value = static_cast<double>(luminance(color));
    light.least = is_first ? value : std::min(light.least, value);
    light.most = is_first ? value : std::max(light.most, value);
    is_first = false;
    sum += solid_angle * value;
    weight += solid_angle;
  });
  light.mean = weight > 0.0 ? sum / weight : 0.0;
  return light;
}

std::vector<CubeLevelDifference> diff_cubemaps(const Cubemap& other, const Cubemap& reference) {
  if (reference.empty() || other.levels.size() != reference.levels.size())
    throw Error("cube maps of " + std::to_string(other.levels.size()) + " and " +
                std::to_string(reference.levels.size()) + " levels cannot be compared");
  std::vector<CubeLevelDifference> result;
  for (std::size_t level = 0; level < reference.levels.size(); ++level) {
    if (other.size(level) != reference.size(level))
      throw Error("cube maps of " + std::to_string(other.size(level)) + " and " +
                  std::to_string(reference.size(level)) + " texels cannot be compared");
    result.push_back(diff_level(other.levels[level], reference.levels[level]));
  }
  return result;
}

}  // namespace candela
