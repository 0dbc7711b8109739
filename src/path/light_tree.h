#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "math/types.h"

namespace candela::path {

/// Of an angle within 0 … π by its cosine, or the other way round up to π/2.
inline float sine_of(float cosine) { return std::sqrt(std::max(1.0f - cosine * cosine, 0.0f)); }

/// Where light is wanted, and from which side.
struct LightReceiver {
  enum class Side : std::uint8_t { front, both, none };

  vec3 position{0.0f};
  vec3 normal{0, 1, 0};     ///< of the shading, unit
  Side side = Side::front;  ///< `both` of a surface that lets light through, `none` without a surface

  /// What a cosine with `normal` is worth, if another may be larger by rounding. 0 only where no light can count.
  float facing(float cosine) const {
    if (side == Side::none) return 1.0f;
    if (side == Side::both) return std::max(std::abs(cosine), kLeastCosine);
    return cosine > -kLeastCosine ? std::max(cosine, kLeastCosine) : 0.0f;
  }

  /// Mean of the heights of a ball's points above the plane of the receiver, or of their distances from it: of points
  /// evenly spread along the normal. `height` is that of the middle.
  float mean_height(float height, float radius) const;

  static constexpr float kLeastCosine = 1e-4f;  ///< what rounding can make of a horizon, with room
};

/// What a lamp, or a group of lamps, can shine at: a ball, and the cone of its directions.
///
/// `axis` and `cos_spread` bound the directions in which it shines with full strength (the normals of surfaces), and
/// `cos_emission` the angle beyond those at which it ends; between the two it falls like a cosine.
struct LightBounds {
  Box3 box{};
  vec3 axis{0, 0, 1};
  float cos_spread = -1.0f;
  float cos_emission = 0.0f;
  bool is_two_sided = false;  ///< the same to -axis
  float power = 0.0f;         ///< lumens, above 0
  float range = kInfinity;    ///< beyond it there is no light
  bool is_exact = false;      ///< a small lamp gives just what these say
};

/// Of a triangle that glows on the side of `normal`, unit, or on both.
LightBounds triangle_light_bounds(vec3 p0, vec3 p1, vec3 p2, vec3 normal, bool is_two_sided, float power);
/// Of a small lamp that shines into a cone about `axis`, of full strength within `inner`, none beyond `outer`; radians.
LightBounds cone_light_bounds(vec3 position, vec3 axis, float inner, float outer, float power);

/// Lamps in a binary tree, from which one is chosen for a receiver by estimates of how much each group gives it.
///
/// After Conty Estévez & Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting". Where they take
/// several lamps, one of each part of a split, this takes one: the groups near the receiver are split until the
/// estimates of the parts are good (a Cut), one part is chosen by these, and within it the tree is followed down at
/// random. The density can be had for any lamp.
class LightTree {
 public:
  /// Nodes that together hold every lamp which can reach the receiver.
  struct Cut {
    static constexpr std::size_t kMost = 8;
    std::size_t size = 0;
    std::array<std::uint32_t, kMost> nodes;
    std::array<float, kMost> share;  ///< importance, or what is made of it
  };
  struct Choice {
    std::uint32_t lamp = 0;  ///< as numbered for the constructor
    float pmf = 0.0f;        ///< given the node; 0 = no lamp reaches the receiver
    float u = 0.0f;
  };

  LightTree() = default;
  /// Every power is finite and above 0.
  explicit LightTree(std::span<const LightBounds> lamps);

  bool empty() const { return nodes_.empty(); }
  std::size_t node_count() const { return nodes_.size(); }
  /// Of a lamp, for pmf().
  std::uint32_t rank(std::uint32_t lamp) const { return ranks_[lamp]; }

  /// `exact(lamp, receiver)` is the importance of a lamp that is alone in its leaf and not told exactly by its bounds;
  /// it must be 0 only where the lamp gives nothing.
  template <class Exact>
  void find_cut(const LightReceiver& receiver, std::size_t most, const Exact& exact, Cut& cut) const;
  template <class Exact>
  Choice choose(std::uint32_t node, const LightReceiver& receiver, float u, const Exact& exact) const;
  /// Of choose(node, …) for the lamp with `rank`, which the node holds.
  template <class Exact>
  float pmf(std::uint32_t node, const LightReceiver& receiver, std::uint32_t rank, const Exact& exact) const;
  bool holds(std::uint32_t node, std::uint32_t rank) const {
    return nodes_[node].first <= rank && rank < nodes_[node].end;
  }

 private:
  struct alignas(64) Node {
    vec3 center{0.0f};
    float radius = 0.0f;
    vec3 axis{0, 0, 1};
    float cos_spread = -1.0f;
    float cos_emission = 0.0f;
    float strength = 0.0f;  ///< candela along the axis
    float range = kInfinity;
    std::uint32_t first = 0, end = 0;  ///< ranks
    std::uint32_t children = 0;        ///< two, side by side; 0 = a leaf
    bool is_two_sided = false;
    bool is_exact = true;  ///< a leaf of one lamp: whether its estimate is all there is to say
  };
  struct Estimate {
    float importance = 0.0f;
    float error = 0.0f;  ///< how far the lamps within differ from it; 0 of a leaf
  };
  struct Build;
  struct Item;

  static float emission(const Node& node, float cos_axis, float sin_ball);
  /// Illuminance by the middle of the node's bounds. 0 only where none of its lamps gives any.
  static Estimate estimate(const Node& node, const LightReceiver& receiver);
  template <class Exact>
  Estimate estimate(std::uint32_t index, const LightReceiver& receiver, const Exact& exact) const {
    const Node& node = nodes_[index];
    if (node.is_exact) return estimate(node, receiver);
    return {std::min(exact(order_[node.first], receiver), kMostImportance), 0.0f};
  }

  static constexpr float kMostImportance = 1e35f;  // 32 of them are finite

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;  ///< lamps by rank
  std::vector<std::uint32_t> ranks_;
  std::vector<float> powers_;  ///< by rank, where leaves hold several
};

inline float LightReceiver::mean_height(float height, float radius) const {
  if (side == Side::both) {
    const float above = std::abs(height);
    return above >= radius ? above : 0.5f * (height * height + radius * radius) / radius;
  }
  if (height >= radius) return height;
  const float above = height + radius;
  return above > 0.0f ? 0.25f * above * above / radius : 0.0f;
}

/// Of the angle between a node's axis and the way from it to the receiver; below 0 where nothing arrives. `cos_axis` is
/// that of the middle, `sin_ball` of half the angle under which the node is seen.
inline float LightTree::emission(const Node& node, float cos_axis, float sin_ball) {
  if (node.is_two_sided) cos_axis = std::abs(cos_axis);
  if (cos_axis >= node.cos_spread) return 1.0f;
  // ----- the least angle beyond the spread, seen from anywhere in the node
  const float cos_ball = sine_of(sin_ball);
  const float sin_axis = sine_of(cos_axis), sin_spread = sine_of(node.cos_spread);
  const float cos_beyond = cos_axis * node.cos_spread + sin_axis * sin_spread;
  if (cos_beyond >= cos_ball) return 1.0f;
  const float sin_beyond = sin_axis * node.cos_spread - cos_axis * sin_spread;
  const float cosine = cos_beyond * cos_ball + sin_beyond * sin_ball;
  return cosine < node.cos_emission ? -1.0f : std::max(cosine, LightReceiver::kLeastCosine);
}

inline LightTree::Estimate LightTree::estimate(const Node& node, const LightReceiver& receiver) {
  const vec3 to_lamp = node.center - receiver.position;
  const float d2 = glm::dot(to_lamp, to_lamp);
  const float radius2 = node.radius * node.radius;
  // Inside a group its light comes from all around: nearer than half its size does not count as nearer.
  const float counted_d2 = std::max(d2, std::max(0.25f * radius2, 1e-12f));
  const float inverse = 1.0f / std::sqrt(counted_d2);
  float importance = std::min(node.strength * inverse * inverse, kMostImportance);
  // ----- the cosine at the receiver
  if (receiver.side != LightReceiver::Side::none) {
    const float cosine = inverse * receiver.mean_height(glm::dot(receiver.normal, to_lamp), node.radius);
    if (cosine >= LightReceiver::kLeastCosine) {
      importance *= cosine;
    } else {
      const float highest = inverse * (glm::dot(receiver.normal, to_lamp) + node.radius);
      importance *= receiver.facing(highest) > 0.0f ? LightReceiver::kLeastCosine : 0.0f;
    }
  }
  // ----- the cone of the lamps
  const bool is_inside = d2 <= radius2;
  if (node.cos_spread > -1.0f && !is_inside) {
    importance *= std::max(emission(node, -inverse * glm::dot(to_lamp, node.axis), node.radius * inverse), 0.0f);
  }
  // ----- the window of their range, from the nearest point
  if (node.range < kInfinity) {
    const float q = std::max(std::sqrt(d2) - node.radius, 0.0f) / node.range;
    importance *= q <= 1.0f + 1e-4f ? std::max(1.0f - q * q * q * q, 1e-4f) : 0.0f;
  }
  if (node.children == 0) return {importance, 0.0f};
  return {importance, is_inside ? importance : importance * radius2 * inverse * inverse};
}

template <class Exact>
void LightTree::find_cut(const LightReceiver& receiver, std::size_t most, const Exact& exact, Cut& cut) const {
  const Estimate root = estimate(0, receiver, exact);
  cut.size = root.importance > 0.0f ? 1 : 0;
  cut.nodes[0] = 0;
  cut.share[0] = root.importance;
  // The bits of a float that is not negative are in its order; the lowest say which node it is.
  static_assert(Cut::kMost == 8);
  std::array<std::int32_t, Cut::kMost> errors{};
  const auto key = [](float error, std::size_t place) {
    return static_cast<std::int32_t>((std::bit_cast<std::uint32_t>(error) & ~7U) | static_cast<std::uint32_t>(place));
  };
  errors[0] = key(root.error, 0);
  while (cut.size > 0 && cut.size < most) {
    std::int32_t largest = errors[0];
    for (std::size_t i = 1; i < Cut::kMost; ++i) largest = std::max(largest, errors[i]);
    if (largest < 8) break;  // leaves only
    const auto worst = static_cast<std::size_t>(largest & 7);
    const std::uint32_t children = nodes_[cut.nodes[worst]].children;
    std::size_t place = worst;
    for (std::uint32_t child = children; child < children + 2; ++child) {
      const Estimate e = estimate(child, receiver, exact);
      if (!(e.importance > 0.0f)) continue;
      cut.nodes[place] = child;
      cut.share[place] = e.importance;
      errors[place] = key(e.error, place);
      if (place == worst) {
        place = cut.size;
      } else {
        ++cut.size;
      }
    }
    if (place != worst) continue;
    // Neither reaches the receiver.
    --cut.size;
    cut.nodes[worst] = cut.nodes[cut.size];
    cut.share[worst] = cut.share[cut.size];
    errors[worst] = key(std::bit_cast<float>(errors[cut.size] & ~7), worst);
    errors[cut.size] = 0;
  }
}

template <class Exact>
LightTree::Choice LightTree::choose(std::uint32_t index, const LightReceiver& receiver, float u,
                                    const Exact& exact) const {
  constexpr float kAlmostOne = 0x1.fffffep-1f;
  float pmf = 1.0f;
  while (nodes_[index].children != 0) {
    const std::uint32_t left = nodes_[index].children;
    const float a = estimate(left, receiver, exact).importance;
    const float b = estimate(left + 1, receiver, exact).importance;
    if (!(a + b > 0.0f)) return {};
    // Which way cannot be foretold: no jumps.
    const float place = u * (a + b);
    const bool is_left = place < a;
    const float taken = is_left ? a : b;
    u = std::clamp((place - (is_left ? 0.0f : a)) / taken, 0.0f, kAlmostOne);
    pmf *= taken / (a + b);
    index = left + static_cast<std::uint32_t>(!is_left);
  }
  const Node& node = nodes_[index];
  std::uint32_t rank = node.first;
  if (node.end - node.first > 1) {
    float sum = 0.0f;
    for (std::uint32_t i = node.first; i < node.end; ++i) sum += powers_[i];
    while (rank + 1 < node.end && u >= powers_[rank] / sum) u -= powers_[rank++] / sum;
    pmf *= powers_[rank] / sum;
  }
  return {order_[rank], pmf, u};
}

template <class Exact>
float LightTree::pmf(std::uint32_t index, const LightReceiver& receiver, std::uint32_t rank, const Exact& exact) const {
  float pmf = 1.0f;
  while (nodes_[index].children != 0) {
    const std::uint32_t left = nodes_[index].children;
    const float a = estimate(left, receiver, exact).importance;
    const float b = estimate(left + 1, receiver, exact).importance;
    if (!(a + b > 0.0f)) return 0.0f;
    const bool is_left = rank < nodes_[left].end;
    pmf *= (is_left ? a : b) / (a + b);
    index = is_left ? left : left + 1;
  }
  const Node& node = nodes_[index];
  if (node.end - node.first <= 1) return pmf;
  float sum = 0.0f;
  for (std::uint32_t i = node.first; i < node.end; ++i) sum += powers_[i];
  return pmf * powers_[rank] / sum;
}

}  // namespace candela::path
