#include "ibl/tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace candela::ibl {
namespace {

/// The lobe over a group of light whose t = 1 - c has a known mean: K(t) + ½ K''(t) var(t), where an even spread v of
/// directions makes var(t) = ½ v t (2 - t).
struct Expansion {
  double value = 0.0;
  double second = 0.0;  ///< K''
};

class Expander {
 public:
  explicit Expander(const Kernel& kernel)
      : kernel_(kernel), a2_(kernel.alpha() * kernel.alpha()), slope_(kernel.slope()), scale_(kernel.scale()) {}

  Expansion at(double t) const {
    const double c = 1.0 - t;
    if (c <= 0.0) return {};
    if (kernel_.lobe() == Lobe::charlie) return by_differences(t);
    const double w = 1.0 / (a2_ + slope_ * t);
    const double k = scale_ * w * w;
    return {k * c, k * slope_ * w * (4.0 + 6.0 * slope_ * c * w)};
  }

 private:
  Expansion by_differences(double t) const {
    constexpr double kStep = 1e-4;
    const double low = kernel_(std::max(t - kStep, 0.0)), middle = kernel_(t), high = kernel_(t + kStep);
    return {middle, (high - 2.0 * middle + low) / (kStep * kStep)};
  }

  const Kernel& kernel_;
  double a2_, slope_, scale_;
};

}  // namespace

TexelTree::TexelTree(const Source& source) : source_(source) {
  levels_.push_back(texels(source));
  while (levels_.back().width > 2 || levels_.back().height > 1) levels_.push_back(halved(levels_.back()));
  for (const SunDisc& sun : source.suns) {
    for (const Point& p : disc_points(sun)) points_.push_back(p);
  }
}

TexelTree::Level TexelTree::texels(const Source& source) const {
  Level level{source.map.width, source.map.height, {}};
  level.nodes.reserve(static_cast<std::size_t>(level.width) * static_cast<std::size_t>(level.height));
  const double step = std::numbers::pi / level.height;
  for (int y = 0; y < level.height; ++y) {
    const double solid_angle = texel_solid_angle(y, level.width, level.height);
    const double across = std::sin((y + 0.5) * step) * 2.0 * std::numbers::pi / level.width;
    const double spread = (step * step + across * across) / 12.0;
    for (int x = 0; x < level.width; ++x) {
      const vec3 flux = vec3(dvec3(source.map.rgb(x, y)) * solid_angle);
      // The mean of unit vectors is shorter than 1 by half their spread.
      const dvec3 centre = texel_direction(source, x, y) * (1.0 - 0.5 * spread);
      level.nodes.push_back({flux, vec3(centre), static_cast<float>(spread), flux.x + flux.y + flux.z});
    }
  }
  return level;
}

TexelTree::Level TexelTree::halved(const Level& fine) const {
  Level level{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
  level.nodes.reserve(static_cast<std::size_t>(level.width) * static_cast<std::size_t>(level.height));
  for (int y = 0; y < level.height; ++y) {
    for (int x = 0; x < level.width; ++x) {
      dvec3 flux(0.0), centre(0.0), middle(0.0);
      double weight = 0.0, spread = 0.0;
      std::array<const Node*, 4> children{};
      int count = 0;
      for (int k = 0; k < 4; ++k) {
        const int i = 2 * x + k % 2, j = 2 * y + k / 2;
        if (i >= fine.width || j >= fine.height) continue;
        const Node& child = fine.nodes[static_cast<std::size_t>(j) * static_cast<std::size_t>(fine.width) +
                                       static_cast<std::size_t>(i)];
        children[static_cast<std::size_t>(count++)] = &child;
        flux += dvec3(child.flux);
        middle += dvec3(child.centre);
        weight += static_cast<double>(child.weight);
        centre += dvec3(child.centre) * static_cast<double>(child.weight);
      }
      centre = weight > 0.0 ? centre / weight : middle / static_cast<double>(count);
      for (int k = 0; k < count && weight > 0.0; ++k) {
        const Node& child = *children[static_cast<std::size_t>(k)];
        const dvec3 chord = dvec3(child.centre) - centre;
        spread += (static_cast<double>(child.spread) + glm::dot(chord, chord)) * static_cast<double>(child.weight);
      }
      level.nodes.push_back({vec3(flux), vec3(centre), static_cast<float>(weight > 0.0 ? spread / weight : 0.0),
                             static_cast<float>(weight)});
    }
  }
  return level;
}

double TexelTree::extent(int level, int y) const {
  const double step = std::numbers::pi * static_cast<double>(1 << level) / levels_[0].height;
  const double top = y * step, bottom = std::min(top + step, std::numbers::pi);
  const bool on_equator = top < 0.5 * std::numbers::pi && bottom > 0.5 * std::numbers::pi;
  const double sine = on_equator ? 1.0 : std::max(std::sin(top), std::sin(bottom));
  const double across = std::min(2.0 * step * levels_[0].height / levels_[0].width, std::numbers::pi);
  return std::hypot(bottom - top, sine * across);
}

dvec3 TexelTree::sum_texel(const Kernel& kernel, int x, int y, dvec3 direction) const {
  // Points no further apart than a third of the lobe's width, as far as sixteen a side go.
  constexpr double kSpacing = 1.0 / 3.0;
  constexpr int kMostPoints = 16;
  const double height = std::numbers::pi / source_.map.height, width = 2.0 * std::numbers::pi / source_.map.width;
  const int side = std::clamp(static_cast<int>(std::ceil(height / (kSpacing * kernel.alpha()))), 2, kMostPoints);
  const double left = column_edge(source_, x), top = row_edge(y, source_.map.height);
  const double drop = top - row_edge(y + 1, source_.map.height);
  double sum = 0.0;
  for (int j = 0; j < side; ++j) {
    const double cosine = top - drop * (j + 0.5) / side;  // equal areas
    const double sine = std::sqrt(std::max(1.0 - cosine * cosine, 0.0));
    for (int i = 0; i < side; ++i) {
      const double azimuth = left + width * (i + 0.5) / side;
      const dvec3 chord = dvec3(sine * std::cos(azimuth), cosine, sine * std::sin(azimuth)) - direction;
      sum += kernel(0.5 * glm::dot(chord, chord));
    }
  }
  return dvec3(node(0, x, y).flux) * (sum / (side * side));
}

dvec3 TexelTree::descend(const Kernel& kernel, dvec3 direction, double allowance) const {
  struct Open {
    int level, x, y;
  };
  const Expander expander(kernel);
  std::array<Open, 128> stack{};
  std::size_t open = 0;
  const auto top = static_cast<int>(levels_.size()) - 1;
  for (int x = 0; x < levels_.back().width; ++x) stack[open++] = {top, x, 0};
  dvec3 sum(0.0);
  while (open > 0) {
    const Open at = stack[--open];
    const Node& n = node(at.level, at.x, at.y);
    const auto weight = static_cast<double>(n.weight);
    if (!(weight > 0.0)) continue;
    const auto spread = static_cast<double>(n.spread);
    const dvec3 chord = dvec3(n.centre) - direction;
    const double t = std::clamp(0.5 * (glm::dot(chord, chord) + spread), 0.0, 2.0);  // the mean of 1 - c, exactly
    const Expansion k = expander.at(t);
    const double variance = 0.5 * spread * t * (2.0 - t);
    // ----- how much the lobe can change over the group: at the place nearest to the axis, and at the horizon
    const double size = extent(at.level, at.y);
    const double distance = std::sqrt(2.0 * t);
    const double nearest = std::max(distance - size, 0.0);
    const bool near_horizon = std::abs(1.0 - t) < size;
    const Expansion most = expander.at(std::min(0.5 * nearest * nearest, 1.0));
    double error = most.value * weight;
    if (error > allowance && distance > 2.0 * size) {
      error = 0.5 * std::abs(most.second) * (variance + 0.25 * spread * spread) * weight;
      if (near_horizon) error += expander.at(std::max(1.0 - size, 0.0)).value * weight;
    }
    if (at.level > 0 && error > allowance) {
      const Level& fine = levels_[static_cast<std::size_t>(at.level) - 1];
      for (int c = 0; c < 4; ++c) {
        const int x = 2 * at.x + c % 2, y = 2 * at.y + c / 2;
        if (x < fine.width && y < fine.height) stack[open++] = {at.level - 1, x, y};
      }
      continue;
    }
    if (error > allowance) {
      sum += sum_texel(kernel, at.x, at.y, direction);
      continue;
    }
    sum += dvec3(n.flux) * (k.value + (near_horizon ? 0.0 : 0.5 * k.second * variance));
  }
  return sum;
}

dvec3 TexelTree::sum(const Kernel& kernel, dvec3 direction, double tolerance) const {
  // How large the result is is known only once it is: a rough pass tells what a fine one may neglect.
  constexpr double kShares = 24.0;  // groups whose errors might add up
  constexpr double kRough = 0.1;
  const auto size = [](dvec3 v) { return v.x + v.y + v.z; };
  double guess = 0.0;
  for (const Node& n : levels_.back().nodes) guess += static_cast<double>(n.weight) / (4.0 * std::numbers::pi);
  for (int pass = 0; pass < 8; ++pass) {
    const double rough = size(descend(kernel, direction, kRough * guess / kShares));
    const bool believed = rough > 0.5 * guess;
    guess = std::max(rough, 1e-3 * guess);
    if (believed) break;
  }
  dvec3 value = descend(kernel, direction, tolerance * guess / kShares);
  for (const Point& p : points_) {
    const dvec3 chord = p.direction - direction;
    value += p.flux * kernel(0.5 * glm::dot(chord, chord));
  }
  return value;
}

}  // namespace candela::ibl
