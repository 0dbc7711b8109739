// Owen-scrambled Sobol' points: stratification, independence between pixels and dimensions, and the error they buy.

#include "math/sobol.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "support/random.h"
#include "support/statistics.h"

namespace candela {
namespace {

using test::Pcg32;

// `count` points of call `dimension` from sample `first` on.
std::vector<vec2> sobol_points(std::uint32_t seed, std::uint32_t first, std::uint32_t count, int dimension) {
  std::vector<vec2> points;
  points.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    SobolSampler sampler(seed, first + i);
    for (int d = 0; d < dimension; ++d) sampler.next_2d();
    points.push_back(sampler.next_2d());
  }
  return points;
}

std::vector<vec2> random_points(std::uint32_t seed, std::uint32_t count) {
  Pcg32 random(seed);
  std::vector<vec2> points;
  points.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) points.push_back(random.next_vec2());
  return points;
}

// A (0,k,2)-net in base 2 has one point in every interval of 2^-a × 2^-(k-a) (Niederreiter 1987).
bool is_net(const std::vector<vec2>& points, int k) {
  for (int a = 0; a <= k; ++a) {
    std::vector<int> hits(points.size(), 0);
    for (const vec2 p : points) {
      const auto x = static_cast<std::size_t>(std::ldexp(p.x, a));
      const auto y = static_cast<std::size_t>(std::ldexp(p.y, k - a));
      if (++hits[(x << (k - a)) + y] > 1) return false;
    }
  }
  return true;
}

TEST(unit_math_sobol, every_pair_is_a_net_at_every_power_of_two) {
  for (const std::uint32_t seed : {0U, 1U, 2U, 12345U, 0x9e3779b9U, 0xffffffffU}) {
    for (int dimension = 0; dimension < 8; ++dimension) {
      for (int k = 0; k <= 8; ++k) {
        const std::uint32_t n = 1U << k;
        for (const std::uint32_t block : {0U, 1U, 5U}) {
          EXPECT_TRUE(is_net(sobol_points(seed, block * n, n, dimension), k))
              << "seed " << seed << " dimension " << dimension << " block " << block << " of " << n;
        }
      }
    }
  }
}

TEST(unit_math_sobol, the_net_check_sees_points_that_are_none) {
  for (int k = 3; k <= 8; ++k) EXPECT_FALSE(is_net(random_points(3, 1U << k), k));
  // Each coordinate scrambled by itself but the second shuffled away: fine alone, no net together.
  std::vector<vec2> apart = sobol_points(1, 0, 64, 0);
  const std::vector<vec2> other = sobol_points(1, 0, 64, 1);
  for (std::size_t i = 0; i < apart.size(); ++i) apart[i].y = other[i].y;
  EXPECT_FALSE(is_net(apart, 6));
  // A block that does not start at a multiple of its length.
  EXPECT_FALSE(is_net(sobol_points(1, 3, 64, 0), 6));
}

TEST(unit_math_sobol, one_dimension_is_stratified) {
  const auto is_stratified = [](const std::function<float(std::uint32_t)>& value, std::uint32_t n) {
    std::vector<int> hits(n, 0);
    for (std::uint32_t i = 0; i < n; ++i) {
      if (++hits[static_cast<std::size_t>(value(i) * static_cast<float>(n))] > 1) return false;
    }
    return true;
  };
  for (const std::uint32_t seed : {0U, 7U, 0xdeadbeefU}) {
    for (int k = 1; k <= 12; ++k) {
      for (int skip = 0; skip < 3; ++skip) {
        const auto next_1d = [&](std::uint32_t i) {
          SobolSampler sampler(seed, i);
          for (int s = 0; s < skip; ++s) sampler.next_1d();
          return sampler.next_1d();
        };
        const auto third = [&](std::uint32_t i) { return SobolSampler(seed, i).next_3d().z; };
        EXPECT_TRUE(is_stratified(next_1d, 1U << k)) << "seed " << seed << " call " << skip << " of " << (1 << k);
        EXPECT_TRUE(is_stratified(third, 1U << k));
      }
    }
  }
  // What two cancelling bit reversals gave: the scrambled index, which is the same number for the first 256 samples.
  const auto not_inverted = [](std::uint32_t i) {
    return unit_float(reverse_bits(laine_karras(laine_karras(reverse_bits(i), 77U), 99U)));
  };
  EXPECT_FALSE(is_stratified(not_inverted, 64));
}

// Sobol' 1967: direction numbers of the polynomial x + 1, v_k = v_{k-1} ^ (v_{k-1} >> 1), v_0 = 2^31.
std::uint32_t sobol_by_direction_numbers(std::uint32_t index) {
  std::uint32_t v = 1U << 31;
  std::uint32_t result = 0;
  for (; index != 0; index >>= 1) {
    if (index & 1U) result ^= v;
    v ^= v >> 1;
  }
  return result;
}

TEST(unit_math_sobol, dimension_1_equals_the_product_with_direction_numbers) {
  for (std::uint32_t i = 0; i < 100000; ++i) {
    ASSERT_EQ(reverse_bits(sobol_dimension_1_reversed(i)), sobol_by_direction_numbers(i)) << i;
  }
  Pcg32 random(2);
  for (int i = 0; i < 100000; ++i) {
    const std::uint32_t index = random.next();
    ASSERT_EQ(reverse_bits(sobol_dimension_1_reversed(index)), sobol_by_direction_numbers(index)) << index;
  }
}

TEST(unit_math_sobol, reverse_bits_reverses) {
  for (unsigned k = 0; k < 32; ++k) EXPECT_EQ(reverse_bits(1U << k), 1U << (31U - k));
  EXPECT_EQ(reverse_bits(0x80000001U), 0x80000001U);
  EXPECT_EQ(reverse_bits(0x0000f00dU), 0xb00f0000U);
}

using Scramble = std::function<std::uint32_t(std::uint32_t x, std::uint32_t seed)>;

// Changing bit k must change bit k and nothing below it. This is what makes it an Owen scramble, and a permutation.
bool respects_bit_order(const Scramble& scramble) {
  Pcg32 random(4);
  for (int i = 0; i < 2000; ++i) {
    const std::uint32_t x = random.next();
    const std::uint32_t seed = random.next();
    for (unsigned k = 0; k < 32; ++k) {
      const std::uint32_t difference = scramble(x, seed) ^ scramble(x ^ (1U << k), seed);
      if ((difference & ((2U << k) - 1U)) != 1U << k) return false;
    }
  }
  return true;
}

TEST(unit_math_sobol, laine_karras_lets_a_bit_depend_on_lower_ones_only) {
  EXPECT_TRUE(respects_bit_order(laine_karras));
  EXPECT_FALSE(respects_bit_order([](std::uint32_t x, std::uint32_t seed) { return hash(x ^ seed); }));
  EXPECT_FALSE(respects_bit_order([](std::uint32_t x, std::uint32_t seed) {
    x = laine_karras(x, seed);
    return x ^ (x * 0x3d20adebU);  // an odd factor clears the lowest bit
  }));
}

TEST(unit_math_sobol, laine_karras_permutes_the_low_bits) {
  for (const std::uint32_t seed : {0U, 1U, 0x12345678U, 0xffffffffU}) {
    std::vector<bool> seen(1U << 16, false);
    for (std::uint32_t x = 0; x < 1U << 16; ++x) {
      const std::uint32_t low = laine_karras(x, seed) & 0xffffU;
      EXPECT_FALSE(seen[low]);
      seen[low] = true;
    }
  }
}

// Over many seeds every point is uniform: the scramble has no favourite places (χ² of 256 cells for each index).
TEST(unit_math_sobol, each_point_is_uniform_over_seeds) {
  const std::vector<std::uint32_t> indices = {0, 1, 2, 3, 17, 255, 1000};
  const double threshold = test::sidak_threshold(2 * indices.size());
  constexpr int kSeeds = 40000;
  for (const std::uint32_t index : indices) {
    std::vector<double> plane(256, 0.0);
    std::vector<double> line(256, 0.0);
    for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
      SobolSampler sampler(seed, index);
      const vec2 p = sampler.next_2d();
      plane[static_cast<std::size_t>(p.x * 16.0f) * 16 + static_cast<std::size_t>(p.y * 16.0f)] += 1.0;
      line[static_cast<std::size_t>(sampler.next_1d() * 256.0f)] += 1.0;
    }
    const std::vector<double> expected(256, kSeeds / 256.0);
    EXPECT_GT(test::chi_square_test(plane, expected).p_value, threshold) << "index " << index;
    EXPECT_GT(test::chi_square_test(line, expected).p_value, threshold) << "index " << index;
  }
}

// ----- independence: the correlation of two streams of n samples, in units of its standard deviation 1/√n

using Stream = std::function<float(std::uint32_t pixel, std::uint32_t index)>;

double independence_p_value(const Stream& a, const Stream& b) {
  constexpr std::uint32_t kPixels = 400;
  constexpr std::uint32_t kSamples = 256;
  test::Moments correlation;
  test::Moments square;
  for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    double sum = 0.0;
    for (std::uint32_t i = 0; i < kSamples; ++i) {
      sum += (static_cast<double>(a(pixel, i)) - 0.5) * (static_cast<double>(b(pixel, i)) - 0.5);
    }
    const double scaled = sum * 12.0 / std::sqrt(static_cast<double>(kSamples));
    correlation.add(scaled);
    square.add(scaled * scaled);
  }
  // The shuffle keeps neighbours 2m and 2m + 1 in opposite halves of [0, 1) in both streams, so the top bits (3/4 of
  // the variance of either) are paired by n/2 coins instead of n: the mean square is 1 + (3/4)² = 1.56, with 10 % of
  // slack.
  return std::min(test::z_test_p_value(correlation, 0.0), test::z_test_p_value(square, 1.5625, 0.16));
}

float coordinate(std::uint32_t seed, std::uint32_t index, int call, int axis) {
  SobolSampler sampler(seed, index);
  for (int c = 0; c < call; ++c) sampler.next_2d();
  return sampler.next_2d()[axis];
}

TEST(unit_math_sobol, pixels_and_calls_are_uncorrelated) {
  const auto stream = [](std::uint32_t offset, int call, int axis) -> Stream {
    return [=](std::uint32_t pixel, std::uint32_t i) { return coordinate(pixel + offset, i, call, axis); };
  };
  const auto hashed = [](std::uint32_t offset, int call, int axis) -> Stream {
    return [=](std::uint32_t pixel, std::uint32_t i) { return coordinate(hash(pixel + offset), i, call, axis); };
  };
  const auto single = [](int call) -> Stream {
    return [=](std::uint32_t pixel, std::uint32_t i) {
      SobolSampler sampler(hash(pixel), i);
      for (int c = 0; c < call; ++c) sampler.next_1d();
      return sampler.next_1d();
    };
  };
  const std::vector<std::pair<Stream, Stream>> pairs = {{stream(0, 0, 0), stream(1, 0, 0)},
                                                        {stream(0, 0, 1), stream(1, 0, 1)},
                                                        {stream(0, 3, 0), stream(1, 3, 0)},
                                                        {hashed(0, 0, 0), hashed(1, 0, 0)},
                                                        {hashed(0, 0, 0), hashed(0, 1, 0)},
                                                        {hashed(0, 0, 1), hashed(0, 1, 1)},
                                                        {hashed(0, 2, 0), hashed(0, 7, 1)},
                                                        {single(0), single(1)},
                                                        {single(1), single(4)}};
  const double threshold = test::sidak_threshold(2 * pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    EXPECT_GT(independence_p_value(pairs[i].first, pairs[i].second), threshold) << "pair " << i;
  }
  // Without a shuffle of the index, all first coordinates walk through the same sequence.
  const auto unshuffled = [](std::uint32_t offset) -> Stream {
    return [=](std::uint32_t pixel, std::uint32_t i) {
      return unit_float(reverse_bits(laine_karras(i, hash(pixel + offset))));
    };
  };
  EXPECT_LT(independence_p_value(unshuffled(0), unshuffled(1000)), threshold);
  EXPECT_LT(independence_p_value(stream(0, 0, 0), stream(0, 0, 0)), threshold);
}

TEST(unit_math_sobol, next_hash_does_not_repeat) {
  std::vector<std::uint32_t> all;
  for (std::uint32_t pixel = 0; pixel < 16; ++pixel) {
    for (std::uint32_t i = 0; i < 64; ++i) {
      SobolSampler sampler(hash(pixel), i);
      for (int d = 0; d < 16; ++d) all.push_back(sampler.next_hash());
    }
  }
  const std::size_t count = all.size();
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  EXPECT_GE(all.size() + 1, count);  // n²/2³³ = 0.03 coincidences are expected
}

// ----- error of the integral of a smooth function: log-log slope of the RMS over seeds

double convergence_rate(const std::function<std::vector<vec2>(std::uint32_t seed, std::uint32_t n)>& points) {
  const auto f = [](vec2 p) { return std::exp(static_cast<double>(p.x)) * std::cos(static_cast<double>(p.y)); };
  const double exact = (std::exp(1.0) - 1.0) * std::sin(1.0);
  test::Moments x;
  double xy = 0.0;
  double xx = 0.0;
  std::vector<std::array<double, 2>> rows;
  for (int k = 4; k <= 12; ++k) {
    double squares = 0.0;
    constexpr std::uint32_t kSeeds = 32;
    for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
      double sum = 0.0;
      const auto set = points(hash(seed + 100), 1U << k);
      for (const vec2 p : set) sum += f(p);
      const double error = sum / static_cast<double>(set.size()) - exact;
      squares += error * error;
    }
    rows.push_back({static_cast<double>(k), 0.5 * std::log2(squares / kSeeds)});
    x.add(rows.back()[0]);
  }
  for (const auto& row : rows) {
    xy += (row[0] - x.mean()) * row[1];
    xx += (row[0] - x.mean()) * (row[0] - x.mean());
  }
  return xy / xx;
}

TEST(unit_math_sobol, error_of_a_smooth_integral_falls_faster_than_random) {
  const auto sobol = [](std::uint32_t seed, std::uint32_t n) { return sobol_points(seed, 0, n, 2); };
  EXPECT_LT(convergence_rate(sobol), -0.9);  // -1.5 is the limit for Owen scrambling (Owen 1997)
  const double random = convergence_rate(random_points);
  EXPECT_LT(random, -0.35);
  EXPECT_GT(random, -0.65);
}

// ----- hashes

TEST(unit_math_hash, hash_is_a_permutation_with_avalanche) {
  // Each of its steps is invertible; undo them in reverse.
  const auto unhash = [](std::uint32_t x) {
    x ^= x >> 16;
    x *= 0x43021123U;
    x ^= x >> 15 ^ x >> 30;
    x *= 0x1d69e2a5U;
    x ^= x >> 16;
    return x;
  };
  Pcg32 random(6);
  std::array<std::array<int, 32>, 32> flips{};
  constexpr int kInputs = 4000;
  for (int i = 0; i < kInputs; ++i) {
    const std::uint32_t x = random.next();
    ASSERT_EQ(unhash(hash(x)), x);
    for (unsigned in = 0; in < 32; ++in) {
      const std::uint32_t difference = hash(x) ^ hash(x ^ (1U << in));
      for (unsigned out = 0; out < 32; ++out) flips[in][out] += static_cast<int>(difference >> out & 1U);
    }
  }
  // Half of the outputs flip; 6 % is the worst bias that a 4000-fold sample can pass as noise in 1024 pairs, and more.
  for (const auto& row : flips) {
    for (const int count : row) EXPECT_NEAR(static_cast<double>(count) / kInputs, 0.5, 0.06);
  }
}

TEST(unit_math_hash, hash_combine_depends_on_both) {
  EXPECT_NE(hash_combine(1, 2), hash_combine(2, 1));
  EXPECT_NE(hash_combine(0, 0), hash_combine(0, 1));
  EXPECT_NE(hash_combine(0, 0), hash_combine(1, 0));
}

TEST(unit_math_hash, unit_float_stays_below_one) {
  EXPECT_EQ(unit_float(0U), 0.0f);
  EXPECT_LT(unit_float(0xffffffffU), 1.0f);
  EXPECT_EQ(unit_float(0x80000000U), 0.5f);
}

}  // namespace
}  // namespace candela
