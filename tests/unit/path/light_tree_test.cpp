#include "path/light_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "math/frame.h"
#include "support/random.h"
#include "support/statistics.h"

namespace candela::path {
namespace {

using namespace test;
using shade::LightCut;

vec3 direction(Pcg32& random) {
  const float z = 2.0f * random.next_float() - 1.0f, phi = 2.0f * kPi * random.next_float();
  const float r = std::sqrt(std::max(1.0f - z * z, 0.0f));
  return {r * std::cos(phi), r * std::sin(phi), z};
}

/// A lamp that the tests know all about.
struct Lamp {
  enum class Kind { point, spot, triangle, leaf } kind = Kind::point;
  vec3 p0{0.0f}, p1{0.0f}, p2{0.0f};
  vec3 axis{0, 0, 1};
  float outer = 0.5f;
  float range = kInfinity;
  float power = 1.0f;

  LightBounds bounds() const {
    if (kind == Kind::triangle || kind == Kind::leaf) {
      return triangle_light_bounds(p0, p1, p2, axis, kind == Kind::leaf, power);
    }
    LightBounds b = cone_light_bounds(p0, axis, 0.5f * outer, kind == Kind::spot ? outer : kPi, power);
    if (kind == Kind::point) b.cos_spread = -1.0f;
    b.range = range;
    b.is_exact = kind == Kind::point && range == kInfinity;
    return b;
  }

  /// Illuminance of the part near `b` (barycentric), whether any of it counts.
  float reaches(const LightReceiver& receiver, vec3 b) const {
    const bool has_surface = kind == Kind::triangle || kind == Kind::leaf;
    const vec3 at = has_surface ? p0 * b.x + p1 * b.y + p2 * b.z : p0;
    const vec3 d = at - receiver.position;
    const float distance = glm::length(d);
    const float cos_receiver = receiver.side == shade::kReceiverSpace ? 1.0f
                               : receiver.side == shade::kReceiverBoth
                                   ? std::abs(glm::dot(receiver.normal, d)) / distance
                                   : glm::dot(receiver.normal, d) / distance;
    if (!(cos_receiver > 0.0f) || distance > range) return 0.0f;
    float intensity = power / (4.0f * kPi);
    float cos_lamp = -glm::dot(axis, d) / distance;
    if (kind == Kind::leaf) cos_lamp = std::abs(cos_lamp);
    if (has_surface) intensity *= 4.0f * std::max(cos_lamp, 0.0f);
    if (kind == Kind::spot && !(cos_lamp > std::cos(outer))) return 0.0f;
    return intensity * cos_receiver / (distance * distance);
  }
};

std::vector<Lamp> scattered_lamps(std::size_t count, std::uint64_t seed, float size = 0.1f) {
  Pcg32 random(seed);
  std::vector<Lamp> lamps(count);
  for (std::size_t i = 0; i < count; ++i) {
    Lamp& lamp = lamps[i];
    lamp.kind = static_cast<Lamp::Kind>(i % 4);
    lamp.p0 = 10.0f * random.next_vec3();
    lamp.p1 = lamp.p0 + size * direction(random);
    lamp.p2 = lamp.p0 + size * direction(random);
    lamp.power = std::exp(4.0f * random.next_float());
    lamp.outer = 0.1f + 1.4f * random.next_float();
    lamp.axis = direction(random);
    if (lamp.kind == Lamp::Kind::point && random.next_float() < 0.5f) lamp.range = 1.0f + 4.0f * random.next_float();
    if (i % 4 >= 2) lamp.axis = glm::normalize(glm::cross(lamp.p1 - lamp.p0, lamp.p2 - lamp.p0));
  }
  return lamps;
}

LightTree tree_of(const std::vector<Lamp>& lamps) {
  std::vector<LightBounds> bounds;
  bounds.reserve(lamps.size());
  for (const Lamp& lamp : lamps) bounds.push_back(lamp.bounds());
  return LightTree(bounds);
}

LightReceiver random_receiver(Pcg32& random, int side) {
  return {12.0f * random.next_vec3() - 1.0f, direction(random), side};
}

/// A tree together with what it asks its lamps, used as Lights does.
struct Chooser {
  const std::vector<Lamp>& lamps;
  LightTree tree = tree_of(lamps);

  float operator()(std::uint32_t lamp, const LightReceiver& at) const { return lamps[lamp].reaches(at, vec3(1, 0, 0)); }

  LightCut cut(const LightReceiver& receiver, int most = shade::kLightCut) const {
    LightCut cut;
    tree.find_cut(receiver, most, *this, cut);
    const float sum = std::accumulate(cut.shares, cut.shares + cut.size, 0.0f);
    for (int i = 0; i < cut.size; ++i) cut.shares[i] /= sum;
    return cut;
  }
  double pmf(const LightCut& cut, const LightReceiver& receiver, std::uint32_t lamp) const {
    double sum = 0.0;
    for (int i = 0; i < cut.size; ++i) {
      if (!tree.holds(cut.nodes[i], tree.rank(lamp))) continue;
      sum += static_cast<double>(cut.shares[i] * tree.pmf(cut.nodes[i], receiver, tree.rank(lamp), *this));
    }
    return sum;
  }
  LightTree::Choice choose(const LightCut& cut, const LightReceiver& receiver, Pcg32& random) const {
    float u = random.next_float();
    int i = 0;
    while (i + 1 < cut.size && u >= cut.shares[i]) u -= cut.shares[i++];
    LightTree::Choice c = tree.choose(cut.nodes[i], receiver, random.next_float(), *this);
    c.pmf *= cut.shares[i];
    return c;
  }
};

TEST(light_tree, chances_of_all_lamps_add_up_to_one) {
  for (const std::size_t count : {1U, 2U, 3U, 37U, 500U}) {
    const std::vector<Lamp> lamps = scattered_lamps(count, count);
    const Chooser chooser{lamps};
    Pcg32 random(11);
    for (int i = 0; i < 60; ++i) {
      const LightReceiver receiver = random_receiver(random, i % 3);
      const LightCut cut = chooser.cut(receiver, i % 2 == 0 ? 1 : shade::kLightCut);
      double sum = 0.0;
      for (std::uint32_t lamp = 0; lamp < count; ++lamp) sum += chooser.pmf(cut, receiver, lamp);
      // A node may promise light that its children know not to come: then nothing is chosen.
      EXPECT_LT(sum, 1.0 + 1e-5);
      if (receiver.side == shade::kReceiverSpace && count > 3) {
        EXPECT_GT(sum, 0.5) << count;
      }
    }
  }
}

TEST(light_tree, points_without_a_surface_are_lit_by_some_lamp_for_certain) {
  std::vector<Lamp> lamps = scattered_lamps(400, 5);
  std::erase_if(lamps, [](const Lamp& lamp) { return lamp.kind != Lamp::Kind::point || lamp.range < kInfinity; });
  const Chooser chooser{lamps};
  Pcg32 random(12);
  for (int i = 0; i < 50; ++i) {
    const LightReceiver receiver = random_receiver(random, shade::kReceiverSpace);
    const LightCut cut = chooser.cut(receiver);
    double sum = 0.0;
    for (std::uint32_t lamp = 0; lamp < lamps.size(); ++lamp) sum += chooser.pmf(cut, receiver, lamp);
    EXPECT_NEAR(sum, 1.0, 1e-5);
  }
}

TEST(light_tree, lamps_are_chosen_as_often_as_their_chance_says) {
  const std::vector<Lamp> lamps = scattered_lamps(120, 3);
  const Chooser chooser{lamps};
  Pcg32 random(4);
  constexpr int kReceivers = 12;
  for (int i = 0; i < kReceivers; ++i) {
    const LightReceiver receiver = random_receiver(random, i % 3);
    const LightCut cut = chooser.cut(receiver, i % 2 == 0 ? 3 : shade::kLightCut);
    if (cut.size == 0) continue;
    constexpr int kTrials = 20000;
    std::vector<double> found(lamps.size() + 1), expected(lamps.size() + 1);
    for (int k = 0; k < kTrials; ++k) {
      const LightTree::Choice c = chooser.choose(cut, receiver, random);
      if (c.pmf <= 0.0f) {
        ++found.back();
        continue;
      }
      ++found[c.lamp];
      EXPECT_NEAR(static_cast<double>(c.pmf), chooser.pmf(cut, receiver, c.lamp), 1e-5 * static_cast<double>(c.pmf));
      EXPECT_TRUE(c.u >= 0.0f && c.u < 1.0f);
    }
    double rest = 1.0;
    for (std::uint32_t lamp = 0; lamp < lamps.size(); ++lamp) {
      const double pmf = chooser.pmf(cut, receiver, lamp);
      expected[lamp] = kTrials * pmf;
      rest -= pmf;
    }
    expected.back() = rest > 1e-5 ? kTrials * rest : 0.0;
    EXPECT_GT(chi_square_test(found, expected).p_value, sidak_threshold(kReceivers)) << i;
  }
}

TEST(light_tree, no_lamp_that_reaches_a_point_is_without_a_chance) {
  // Large ones, too, so that receivers stand within the bounds of groups and of lamps.
  // Beams that nearly agree in their direction bound each other narrowly.
  for (const float size : {0.1f, 3.0f, 1.0f}) {
    const bool are_beams = size == 1.0f;
    std::vector<Lamp> lamps = scattered_lamps(160, 8, size);
    for (Lamp& lamp : lamps) {
      if (!are_beams) break;
      lamp.kind = Lamp::Kind::spot;
      lamp.axis = glm::normalize(vec3(0, -1, 0) + 0.1f * lamp.axis);
      lamp.outer = 0.6f;
      lamp.range = kInfinity;
    }
    const Chooser chooser{lamps};
    Pcg32 random(9);
    for (int i = 0; i < 400; ++i) {
      LightReceiver receiver = random_receiver(random, i % 3);
      // Some see a lamp just above their horizon.
      if (i % 4 == 3) {
        const vec3 to_lamp = lamps[static_cast<std::size_t>(i) % lamps.size()].p0 - receiver.position;
        const Frame frame = frame_from_normal(glm::normalize(to_lamp));
        receiver.normal = glm::normalize(frame.t + 1e-3f * frame.n);
      }
      const LightCut cut = chooser.cut(receiver, i % 2 == 0 ? 1 : shade::kLightCut);
      for (std::uint32_t lamp = 0; lamp < lamps.size(); ++lamp) {
        const vec3 b = random.next_vec3();
        if (lamps[lamp].reaches(receiver, b / (b.x + b.y + b.z)) <= 0.0f) continue;
        EXPECT_GT(chooser.pmf(cut, receiver, lamp), 0.0) << i << ' ' << lamp % 4;
      }
    }
  }
}

/// Mean over receivers on a floor of the variance of light / chance, over its squared mean: of one sample.
double noise_per_sample(const std::vector<Lamp>& lamps) {
  const Chooser chooser{lamps};
  Pcg32 random(21);
  Moments noise;
  for (int i = 0; i < 200; ++i) {
    const LightReceiver receiver{
        {10.0f * random.next_float(), -0.5f, 10.0f * random.next_float()}, {0, 1, 0}, shade::kReceiverFront};
    const LightCut cut = chooser.cut(receiver);
    double sum = 0.0, squares = 0.0;
    for (std::uint32_t lamp = 0; lamp < lamps.size(); ++lamp) {
      const auto light = static_cast<double>(lamps[lamp].reaches(receiver, vec3(1.0f / 3.0f)));
      if (light <= 0.0) continue;
      sum += light;
      squares += light * light / chooser.pmf(cut, receiver, lamp);
    }
    if (sum > 0.0) noise.add(squares / (sum * sum) - 1.0);
  }
  return noise.mean();
}

TEST(light_tree, thousands_of_lamps_add_little_noise) {
  for (const std::size_t count : {8U, 4000U}) {
    std::vector<Lamp> lamps = scattered_lamps(count, 17);
    for (Lamp& lamp : lamps) lamp.kind = Lamp::Kind::point, lamp.range = kInfinity;
    EXPECT_LT(noise_per_sample(lamps), count == 8 ? 1e-5 : 0.25) << "points";
    for (Lamp& lamp : lamps) lamp.kind = Lamp::Kind::triangle, lamp.axis = {0, -1, 0};
    EXPECT_LT(noise_per_sample(lamps), count == 8 ? 0.05 : 0.5) << "triangles";
  }
}

TEST(light_tree, lamps_at_one_place_or_in_a_row_make_a_tree) {
  for (const bool is_row : {false, true}) {
    std::vector<Lamp> lamps(300);
    for (std::size_t i = 0; i < lamps.size(); ++i) {
      // Ever nearer to each other, down to the least distance that there is.
      lamps[i].p0 = vec3(is_row ? std::ldexp(1.0f, -static_cast<int>(i)) : 0.5f, 0.0f, 0.0f);
    }
    const Chooser chooser{lamps};
    const LightReceiver receiver{{0.0f, -1.0f, 0.0f}, {0, 1, 0}, shade::kReceiverFront};
    const LightCut cut = chooser.cut(receiver);
    double sum = 0.0;
    for (std::uint32_t lamp = 0; lamp < lamps.size(); ++lamp) sum += chooser.pmf(cut, receiver, lamp);
    EXPECT_NEAR(sum, 1.0, 1e-5);
    EXPECT_EQ(chooser.tree.node_count(), 2 * lamps.size() - 1);
  }
}

TEST(light_tree, very_many_lamps_share_leaves) {
  const std::vector<Lamp> lamps = scattered_lamps(200'000, 2, 0.01f);
  const Chooser chooser{lamps};
  EXPECT_LT(chooser.tree.node_count(), lamps.size() / 2);
  Pcg32 random(3);
  const LightReceiver receiver = random_receiver(random, shade::kReceiverSpace);
  const LightCut cut = chooser.cut(receiver);
  double sum = 0.0;
  for (std::uint32_t lamp = 0; lamp < lamps.size(); ++lamp) sum += chooser.pmf(cut, receiver, lamp);
  EXPECT_LT(sum, 1.0 + 1e-4);
  EXPECT_GT(sum, 0.5);
  for (int i = 0; i < 1000; ++i) {
    const LightTree::Choice c = chooser.choose(cut, receiver, random);
    if (c.pmf <= 0.0f) continue;
    EXPECT_NEAR(static_cast<double>(c.pmf), chooser.pmf(cut, receiver, c.lamp), 1e-5 * static_cast<double>(c.pmf));
  }
}

}  // namespace
}  // namespace candela::path
