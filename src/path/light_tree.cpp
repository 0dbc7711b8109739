#include "path/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/check.h"

namespace candela::path {

namespace {

constexpr float kCosineRoom = 1e-4f;  // for what rounding does to angles on their way up the tree
constexpr std::size_t kBins = 12;
constexpr std::size_t kManyLamps = std::size_t{1} << 17;  // from here on leaves hold several
constexpr std::size_t kMostInLeaf = 8;

/// Directions within an angle of an axis.
struct Cone {
  vec3 axis{0, 0, 1};
  float cos_spread = -1.0f;
  bool is_two_sided = false;
};

constexpr Cone kAllDirections{};

/// cos(a + b), -1 from π on; both within 0 … π.
float cos_sum(float cos_a, float cos_b) {
  if (cos_a + cos_b <= 0.0f) return -1.0f;
  return cos_a * cos_b - shade::light_sine(cos_a) * shade::light_sine(cos_b);
}

/// About the mean of both axes: not the least cone, but one found without angles.
Cone merge(Cone a, float weight_a, const Cone& b, float weight_b) {
  if (a.is_two_sided != b.is_two_sided || a.cos_spread <= -1.0f || b.cos_spread <= -1.0f) return kAllDirections;
  const vec3 axis_b = a.is_two_sided && glm::dot(a.axis, b.axis) < 0.0f ? -b.axis : b.axis;
  const vec3 sum = a.axis * weight_a + axis_b * weight_b;
  const float length = glm::length(sum);
  if (!(length > 0.0f) || !std::isfinite(length)) return kAllDirections;
  Cone c{.axis = sum / length, .is_two_sided = a.is_two_sided};
  c.cos_spread =
      std::min(cos_sum(glm::dot(c.axis, a.axis), a.cos_spread), cos_sum(glm::dot(c.axis, axis_b), b.cos_spread));
  c.cos_spread = std::max(c.cos_spread - 1e-6f, -1.0f);
  // Two opposite caps that reach beyond their equator are the sphere.
  if (c.cos_spread <= (c.is_two_sided ? 0.0f : -1.0f)) return kAllDirections;
  return c;
}

/// ∫ over the sphere of the model in LightBounds, sr: what makes candela along the axis of lumens. 2π (1 - cos s) for
/// the spread s and 2π ∫ cos t sin(s + t) dt over the emission t beyond it.
float solid_angle(float cos_spread, float cos_emission, bool is_two_sided) {
  const double s = std::acos(std::clamp(static_cast<double>(cos_spread), -1.0, 1.0));
  const double e = std::min(std::acos(std::clamp(static_cast<double>(cos_emission), -1.0, 1.0)), M_PI - s);
  const double beyond = 0.5 * (e * std::sin(s) + 0.5 * (std::cos(s) - std::cos(s + 2.0 * e)));
  const double one = 2.0 * M_PI * (1.0 - std::cos(s) + beyond);
  return static_cast<float>(std::clamp(is_two_sided ? 2.0 * one : one, 1e-6, 4.0 * M_PI));
}

}  // namespace

LightBounds triangle_light_bounds(vec3 p0, vec3 p1, vec3 p2, vec3 normal, bool is_two_sided, float power) {
  LightBounds bounds;
  bounds.box.extend(p0), bounds.box.extend(p1), bounds.box.extend(p2);
  bounds.axis = normal;
  bounds.cos_spread = 1.0f;
  bounds.is_two_sided = is_two_sided;
  bounds.power = power;
  bounds.is_exact = true;
  return bounds;
}

LightBounds cone_light_bounds(vec3 position, vec3 axis, float inner, float outer, float power) {
  LightBounds bounds;
  bounds.box.extend(position);
  bounds.axis = axis;
  // Full strength also where a cosine would have come to its end.
  const float spread = std::max(inner, outer - 0.5f * kPi);
  bounds.cos_spread = std::cos(spread);
  bounds.cos_emission = std::cos(outer - spread);
  bounds.power = power;
  return bounds;
}

/// What the splits look at.
struct LightTree::Item {
  vec3 center;
  float power;
  std::uint32_t lamp;
};

/// Nodes of a range of items, and what only their parents need of them.
struct LightTree::Build {
  struct Extent {
    Box3 box;
    float power = 0.0f;
  };

  std::span<const LightBounds> lamps;
  std::span<Item> items;
  std::size_t leaf = 1;
  std::vector<Node>& nodes;

  Node& at(int index) const { return nodes[static_cast<std::size_t>(index)]; }
  Extent fill(int index, std::size_t begin, std::size_t end);
  Extent fill_leaf(Node& node, std::size_t begin, std::size_t end) const;
  std::size_t split(std::size_t begin, std::size_t end);
  static void finish(Node& node, const Extent& extent, const Cone& cone);
};

void LightTree::Build::finish(Node& node, const Extent& extent, const Cone& cone) {
  node.center = extent.box.center();
  const vec3 half = extent.box.upper - node.center;
  node.radius = glm::length(half);
  node.axis = cone.axis;
  node.cos_spread = cone.cos_spread;
  node.is_two_sided = cone.is_two_sided;
  node.strength = extent.power / solid_angle(node.cos_spread, node.cos_emission, cone.is_two_sided);
}

LightTree::Build::Extent LightTree::Build::fill_leaf(Node& node, std::size_t begin, std::size_t end) const {
  Extent extent;
  Cone cone;
  node.cos_emission = 1.0f;
  node.range = 0.0f;
  for (std::size_t i = begin; i < end; ++i) {
    const LightBounds& lamp = lamps[items[i].lamp];
    const Cone own{lamp.axis, lamp.cos_spread, lamp.is_two_sided};
    cone = i == begin ? own : merge(cone, extent.power, own, lamp.power);
    extent.box.extend(lamp.box.lower), extent.box.extend(lamp.box.upper);
    extent.power += lamp.power;
    node.cos_emission = std::min(node.cos_emission, lamp.cos_emission - kCosineRoom);
    node.range = std::max(node.range, lamp.range);
  }
  node.is_exact = end - begin > 1 || lamps[items[begin].lamp].is_exact;
  finish(node, extent, cone);
  return extent;
}

LightTree::Build::Extent LightTree::Build::fill(int index, std::size_t begin, std::size_t end) {
  at(index).first = static_cast<int>(begin);
  at(index).end = static_cast<int>(end);
  if (end - begin <= leaf) return fill_leaf(at(index), begin, end);
  const std::size_t middle = split(begin, end);
  const auto left = static_cast<int>(nodes.size());
  at(index).children = left;
  nodes.resize(nodes.size() + 2);
  const Extent a = fill(left, begin, middle);
  const Extent b = fill(left + 1, middle, end);
  const Node &l = at(left), &r = at(left + 1);
  Node& node = at(index);
  node.is_exact = true;
  node.cos_emission = std::min(l.cos_emission, r.cos_emission);
  node.range = std::max(l.range, r.range);
  Extent extent{a.box, a.power + b.power};
  extent.box.extend(b.box.lower), extent.box.extend(b.box.upper);
  finish(node, extent,
         merge({l.axis, l.cos_spread, l.is_two_sided}, a.power, {r.axis, r.cos_spread, r.is_two_sided}, b.power));
  return extent;
}

/// Divides a range of items in two where Σ power × extent² is least: the variance of 1/d² within a group grows so.
std::size_t LightTree::Build::split(std::size_t begin, std::size_t end) {
  struct Bin {
    Box3 box;
    float power = 0.0f;
    std::size_t count = 0;

    void add(const Bin& other) {
      if (other.count == 0) return;
      box.extend(other.box.lower), box.extend(other.box.upper);
      power += other.power;
      count += other.count;
    }
    float cost() const { return count == 0 ? 0.0f : power * glm::dot(box.size(), box.size()); }
  };
  const std::size_t half = begin + (end - begin) / 2;
  Box3 box;
  for (std::size_t i = begin; i < end; ++i) box.extend(items[i].center);
  const vec3 size = box.size();
  int axis = size.x >= size.y ? 0 : 1;
  if (size.z > size[axis]) axis = 2;
  if (!(size[axis] > 0.0f)) return half;
  const float scale = static_cast<float>(kBins) / size[axis];
  const auto bin_of = [&](const Item& item) {
    const float bin = (item.center[axis] - box.lower[axis]) * scale;
    return bin < static_cast<float>(kBins) ? static_cast<std::size_t>(bin) : kBins - 1;
  };
  std::array<Bin, kBins> bins;
  for (std::size_t i = begin; i < end; ++i) {
    Bin& bin = bins[bin_of(items[i])];
    bin.box.extend(items[i].center);
    bin.power += items[i].power;
    ++bin.count;
  }
  std::array<float, kBins> left_costs;
  Bin left, right;
  for (std::size_t k = 0; k + 1 < kBins; ++k) {
    left.add(bins[k]);
    left_costs[k] = left.cost();
  }
  std::size_t best = 0;
  float least = kInfinity;
  for (std::size_t k = kBins - 1; k > 0; --k) {
    right.add(bins[k]);
    const float cost = left_costs[k - 1] + right.cost();
    if (cost < least && right.count < end - begin) {
      least = cost;
      best = k;
    }
  }
  const auto middle = std::partition(items.begin() + static_cast<std::ptrdiff_t>(begin),
                                     items.begin() + static_cast<std::ptrdiff_t>(end),
                                     [&](const Item& item) { return bin_of(item) < best; });
  const auto at = static_cast<std::size_t>(middle - items.begin());
  return at > begin && at < end ? at : half;
}

LightTree::LightTree(std::span<const LightBounds> lamps) {
  if (lamps.empty()) return;
  std::vector<Item> items(lamps.size());
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    CANDELA_CHECK(lamps[i].power > 0.0f && std::isfinite(lamps[i].power));
    items[i] = {lamps[i].box.center(), lamps[i].power, static_cast<std::uint32_t>(i)};
  }
  const std::size_t leaf = lamps.size() <= kManyLamps ? 1 : kMostInLeaf;
  nodes_.reserve(2 * lamps.size() / leaf);
  nodes_.resize(1);
  Build build{lamps, items, leaf, nodes_};
  build.fill(0, 0, items.size());
  order_.resize(items.size());
  ranks_.resize(items.size());
  if (leaf > 1) powers_.resize(items.size());
  for (std::uint32_t rank = 0; rank < order_.size(); ++rank) {
    order_[rank] = items[rank].lamp;
    ranks_[items[rank].lamp] = rank;
    if (leaf > 1) powers_[rank] = items[rank].power;
  }
}

}  // namespace candela::path
