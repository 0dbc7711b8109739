#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "math/types.h"
#include "shade/light_choice.glsl.h"

namespace candela::path {

using shade::LightReceiver;

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
/// estimates of the parts are good (a cut), one part is chosen by these, and within it the tree is followed down at
/// random. The density can be had for any lamp. Estimates and steps are those of shade/light_choice.glsl.h.
class LightTree {
 public:
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
  void find_cut(const LightReceiver& receiver, int most, const Exact& exact, shade::LightCut& cut) const;
  template <class Exact>
  Choice choose(int node, const LightReceiver& receiver, float u, const Exact& exact) const;
  /// Of choose(node, …) for the lamp with `rank`, which the node holds.
  template <class Exact>
  float pmf(int node, const LightReceiver& receiver, std::uint32_t rank, const Exact& exact) const;
  bool holds(int node, std::uint32_t rank) const {
    return at(node).first <= static_cast<int>(rank) && static_cast<int>(rank) < at(node).end;
  }

 private:
  struct alignas(64) Node : shade::LightNode {};
  struct Build;
  struct Item;

  const Node& at(int node) const { return nodes_[static_cast<std::size_t>(node)]; }
  template <class Exact>
  shade::LightEstimate estimate(int index, const LightReceiver& receiver, const Exact& exact) const {
    const Node& node = at(index);
    if (node.is_exact) return shade::light_estimate(node, receiver);
    return shade::light_estimate_asked(exact(order_[static_cast<std::size_t>(node.first)], receiver));
  }

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;  ///< lamps by rank
  std::vector<std::uint32_t> ranks_;
  std::vector<float> powers_;  ///< by rank, where leaves hold several
};

template <class Exact>
void LightTree::find_cut(const LightReceiver& receiver, int most, const Exact& exact, shade::LightCut& cut) const {
  shade::light_cut_begin(cut, 0, estimate(0, receiver, exact));
  while (cut.size > 0 && cut.size < most) {
    const int worst = shade::light_cut_worst(cut);
    if (worst < 0) break;
    const int children = at(cut.nodes[worst]).children;
    shade::light_cut_split(cut, worst, children, estimate(children, receiver, exact),
                           estimate(children + 1, receiver, exact));
  }
}

template <class Exact>
LightTree::Choice LightTree::choose(int index, const LightReceiver& receiver, float u, const Exact& exact) const {
  float pmf = 1.0f;
  while (at(index).children != 0) {
    const int left = at(index).children;
    const shade::LightTurn turn = shade::light_turn(estimate(left, receiver, exact).importance,
                                                    estimate(left + 1, receiver, exact).importance, u);
    if (!(turn.pmf > 0.0f)) return {};
    u = turn.u;
    pmf *= turn.pmf;
    // Which way cannot be foretold: no jumps.
    index = left + static_cast<int>(!turn.is_left);
  }
  const Node& node = at(index);
  auto rank = static_cast<std::size_t>(node.first);
  const auto end = static_cast<std::size_t>(node.end);
  if (end - rank > 1) {
    float sum = 0.0f;
    for (std::size_t i = rank; i < end; ++i) sum += powers_[i];
    while (rank + 1 < end && u >= powers_[rank] / sum) u -= powers_[rank++] / sum;
    pmf *= powers_[rank] / sum;
  }
  return {order_[rank], pmf, u};
}

template <class Exact>
float LightTree::pmf(int index, const LightReceiver& receiver, std::uint32_t rank, const Exact& exact) const {
  float pmf = 1.0f;
  while (at(index).children != 0) {
    const int left = at(index).children;
    const bool is_left = static_cast<int>(rank) < at(left).end;
    pmf *= shade::light_turn_pmf(estimate(left, receiver, exact).importance,
                                 estimate(left + 1, receiver, exact).importance, is_left);
    if (!(pmf > 0.0f)) return 0.0f;
    index = is_left ? left : left + 1;
  }
  const Node& node = at(index);
  if (node.end - node.first <= 1) return pmf;
  float sum = 0.0f;
  for (int i = node.first; i < node.end; ++i) sum += powers_[static_cast<std::size_t>(i)];
  return pmf * powers_[rank] / sum;
}

}  // namespace candela::path
