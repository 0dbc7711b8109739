#include "math/distribution.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include "support/random.h"
#include "support/statistics.h"

namespace candela {
namespace {

using test::Pcg32;

constexpr float kAlmostOne = 0x1.fffffep-1f;

struct Named {
  const char* name;
  std::vector<float> weights;
};

std::vector<Named> weight_tables() {
  std::vector<Named> tables = {{"one", {3.0f}},
                               {"two", {1.0f, 3.0f}},
                               {"zero ends", {0.0f, 0.0f, 1.0f, 2.0f, 0.0f, 5.0f, 0.0f, 0.0f}},
                               {"only the last", {0.0f, 0.0f, 0.0f, 7.0f}},
                               {"only the first", {7.0f, 0.0f, 0.0f, 0.0f}},
                               {"tiny and huge", {1e-30f, 2e-30f, 3e-30f}},
                               {"huge", {1e37f, 3e37f, 0.0f, 2e37f}},
                               {"denormal", {1e-42f, 0.0f, 3e-42f}}};
  Pcg32 random(1);
  std::vector<float> many(1000);
  for (std::size_t i = 0; i < many.size(); ++i) many[i] = i % 7 == 0 ? 0.0f : random.next_float() * random.next_float();
  tables.push_back({"a thousand", many});
  many[500] = 1e4f;
  tables.push_back({"a sun among a thousand", many});
  return tables;
}

std::vector<double> expected_counts(const std::vector<float>& weights, double samples) {
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  std::vector<double> expected;
  expected.reserve(weights.size());
  for (const float w : weights) expected.push_back(static_cast<double>(w) / total * samples);
  return expected;
}

using Pick = std::function<int(float u)>;

double frequency_p_value(const Pick& pick, const std::vector<float>& weights) {
  constexpr int kSamples = 50000;
  Pcg32 random(9);
  std::vector<double> observed(weights.size(), 0.0);
  for (int i = 0; i < kSamples; ++i) observed[static_cast<std::size_t>(pick(random.next_float()))] += 1.0;
  return test::chi_square_test(observed, expected_counts(weights, kSamples)).p_value;
}

TEST(unit_math_distribution, frequency_matches_the_weights) {
  const auto tables = weight_tables();
  const double threshold = test::sidak_threshold(tables.size());
  for (const Named& table : tables) {
    const Distribution1D d(table.weights);
    EXPECT_GT(frequency_p_value([&](float u) { return d.sample(u).index; }, table.weights), threshold) << table.name;
    EXPECT_NEAR(d.total() / std::accumulate(table.weights.begin(), table.weights.end(), 0.0), 1.0, 1e-12);
  }
}

TEST(unit_math_distribution, frequency_check_catches_mutants) {
  std::vector<float> weights = weight_tables().back().weights;
  weights[500] = 1.0f;
  const Distribution1D d(weights);
  const int n = d.size();
  EXPECT_LT(frequency_p_value([&](float u) { return std::min(d.sample(u).index + 1, n - 1); }, weights), 1e-6);
  EXPECT_LT(frequency_p_value([&](float u) { return static_cast<int>(u * static_cast<float>(n)); }, weights), 1e-6);
  EXPECT_LT(frequency_p_value([&](float u) { return d.sample(u * u).index; }, weights), 1e-6);
  // The start of the guide table without the walk to the right interval.
  std::vector<float> guide_only = {1.0f, 3.0f};
  EXPECT_LT(frequency_p_value([&](float u) { return u < 0.5f ? 0 : 1; }, guide_only), 1e-6);
}

TEST(unit_math_distribution, weight_zero_is_never_chosen) {
  for (const Named& table : weight_tables()) {
    const Distribution1D d(table.weights);
    // Every edge of the intervals and its neighbours, beside a fine grid.
    std::vector<float> us = {0.0f, kAlmostOne};
    double sum = 0.0;
    const double total = d.total();
    for (const float w : table.weights) {
      sum += static_cast<double>(w) / total;
      const float edge = std::min(static_cast<float>(sum), kAlmostOne);
      us.insert(us.end(), {edge, std::nextafter(edge, 0.0f), std::min(std::nextafter(edge, 1.0f), kAlmostOne)});
    }
    for (int i = 0; i < 4096; ++i) us.push_back(static_cast<float>(i) / 4096.0f);
    for (const float u : us) {
      const auto s = d.sample(u);
      ASSERT_GE(s.index, 0);
      ASSERT_LT(s.index, d.size());
      EXPECT_GT(table.weights[static_cast<std::size_t>(s.index)], 0.0f) << table.name << " u " << u;
      EXPECT_GT(s.pmf, 0.0f) << table.name << " u " << u;
      EXPECT_EQ(s.pmf, d.pmf(s.index));
      EXPECT_GE(s.u, 0.0f);
      EXPECT_LT(s.u, 1.0f);
    }
  }
}

TEST(unit_math_distribution, pmf_sums_to_one_and_follows_the_weights) {
  for (const Named& table : weight_tables()) {
    const Distribution1D d(table.weights);
    const auto expected = expected_counts(table.weights, 1.0);
    double sum = 0.0;
    for (int i = 0; i < d.size(); ++i) {
      const auto pmf = static_cast<double>(d.pmf(i));
      sum += pmf;
      EXPECT_NEAR(pmf, expected[static_cast<std::size_t>(i)], 1.2e-7)
          << table.name << ' ' << i;  // two roundings near 1
    }
    EXPECT_NEAR(sum, 1.0, 1e-7) << table.name;
  }
}

TEST(unit_math_distribution, all_zero_weights_are_uniform) {
  const std::vector<float> zeros(5, 0.0f);
  const Distribution1D d(zeros);
  EXPECT_EQ(d.total(), 0.0);
  for (int i = 0; i < 5; ++i) {
    EXPECT_NEAR(d.pmf(i), 0.2f, 1e-6f);
    EXPECT_EQ(d.sample((static_cast<float>(i) + 0.5f) / 5.0f).index, i);
  }
  EXPECT_EQ(d.sample(0.0f).index, 0);
  EXPECT_EQ(d.sample(kAlmostOne).index, 4);
}

TEST(unit_math_distribution, inversion_keeps_the_order_of_u) {
  const Distribution1D d(weight_tables().back().weights);
  int previous = 0;
  for (int i = 0; i < 10000; ++i) {
    const int index = d.sample(static_cast<float>(i) / 10000.0f).index;
    EXPECT_GE(index, previous);
    previous = index;
  }
}

double remainder_p_value(const std::function<float(float u)>& remainder) {
  constexpr int kSamples = 50000;
  Pcg32 random(3);
  std::vector<double> observed(64, 0.0);
  for (int i = 0; i < kSamples; ++i) observed[static_cast<std::size_t>(remainder(random.next_float()) * 64.0f)] += 1.0;
  return test::chi_square_test(observed, std::vector<double>(64, kSamples / 64.0)).p_value;
}

TEST(unit_math_distribution, what_is_left_of_u_is_uniform) {
  const std::vector<float> weights = {0.1f, 0.0f, 2.0f, 1.0f, 0.5f, 0.0f};
  const Distribution1D d(weights);
  EXPECT_GT(remainder_p_value([&](float u) { return d.sample(u).u; }), test::kFamilySignificance);
  EXPECT_LT(remainder_p_value([&](float u) { return u * d.sample(u).pmf; }), 1e-6);
  // Nothing is lost: interval start + remainder × width is u again.
  double start = 0.0;
  for (int i = 0; i < d.size(); ++i) {
    const auto width = static_cast<double>(d.pmf(i));
    if (width > 0.0) {
      const auto u = static_cast<float>(start + 0.37 * width);
      EXPECT_EQ(d.sample(u).index, i);
      EXPECT_NEAR(d.sample(u).u, 0.37f, 1e-4f);
    }
    start += width;
  }
}

// ----- two dimensions

std::vector<float> picture(int width, int height) {
  std::vector<float> weights;
  Pcg32 random(8);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool dark = y == 2 || (x * y) % 5 == 4;
      weights.push_back(dark ? 0.0f : random.next_float() * (y == 4 && x == 3 ? 200.0f : 1.0f));
    }
  }
  return weights;
}

TEST(unit_math_distribution_2d, pdf_integrates_to_one_and_follows_the_weights) {
  constexpr int kWidth = 12;
  constexpr int kHeight = 7;
  const auto weights = picture(kWidth, kHeight);
  const Distribution2D d(weights, kWidth, kHeight);
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  EXPECT_NEAR(d.total() / total, 1.0, 1e-6);
  double sum = 0.0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto pdf = static_cast<double>(d.pdf({x, y}));
      const auto weight = static_cast<double>(weights[static_cast<std::size_t>(y * kWidth + x)]);
      EXPECT_NEAR(pdf, weight / total * kWidth * kHeight, 1e-5 * kWidth * kHeight);
      sum += pdf / (kWidth * kHeight);
    }
  }
  EXPECT_NEAR(sum, 1.0, 1e-6);
}

using Pick2D = std::function<vec2(vec2 u)>;

// Counts in cells of half the size, so that the place within a cell is judged as well.
double frequency_2d_p_value(const Pick2D& pick, const std::vector<float>& weights, int width, int height) {
  constexpr int kSamples = 200000;
  Pcg32 random(10);
  const auto w = static_cast<std::size_t>(2 * width);
  std::vector<double> observed(4 * weights.size(), 0.0);
  std::vector<float> fine(observed.size());
  for (std::size_t i = 0; i < fine.size(); ++i) {
    fine[i] = weights[(i / w / 2) * static_cast<std::size_t>(width) + (i % w) / 2];
  }
  for (int i = 0; i < kSamples; ++i) {
    const vec2 uv = pick(random.next_vec2());
    const auto x = static_cast<std::size_t>(uv.x * static_cast<float>(2 * width));
    const auto y = static_cast<std::size_t>(uv.y * static_cast<float>(2 * height));
    observed[y * w + x] += 1.0;
  }
  return test::chi_square_test(observed, expected_counts(fine, kSamples)).p_value;
}

TEST(unit_math_distribution_2d, samples_follow_the_pdf) {
  const auto weights = picture(12, 7);
  const Distribution2D d(weights, 12, 7);
  EXPECT_GT(frequency_2d_p_value([&](vec2 u) { return d.sample(u).uv; }, weights, 12, 7), test::kFamilySignificance);
  EXPECT_LT(frequency_2d_p_value([&](vec2 u) { return d.sample({u.y, u.y}).uv; }, weights, 12, 7), 1e-6);
  EXPECT_LT(frequency_2d_p_value([&](vec2 u) { return vec2(d.sample(u).cell) / vec2(12, 7); }, weights, 12, 7), 1e-6);
}

TEST(unit_math_distribution_2d, sample_agrees_with_pdf_and_cell) {
  // 4096 columns: there a float has 12 bits left for the place inside a cell.
  const std::array<std::array<int, 2>, 4> sizes = {{{12, 7}, {1, 1}, {4096, 3}, {3, 4096}}};
  for (const auto [width, height] : sizes) {
    const auto weights = picture(width, height);
    const Distribution2D d(weights, width, height);
    Pcg32 random(11);
    for (int i = 0; i < 20000; ++i) {
      const std::array<float, 3> corners = {0.0f, kAlmostOne, random.next_float()};
      const vec2 u = i < 9 ? vec2(corners[static_cast<std::size_t>(i % 3)], corners[static_cast<std::size_t>(i / 3)])
                           : random.next_vec2();
      const auto s = d.sample(u);
      ASSERT_EQ(s.pdf, d.pdf(s.cell));
      ASSERT_GT(s.pdf, 0.0f);
      ASSERT_GT(weights[static_cast<std::size_t>(s.cell.y * width + s.cell.x)], 0.0f);
      ASSERT_GE(std::min(s.uv.x, s.uv.y), 0.0f);
      ASSERT_LT(std::max(s.uv.x, s.uv.y), 1.0f) << "u " << u.x << ' ' << u.y;
      // Inside its cell, up to the rounding of a place near 4096.
      const vec2 place = s.uv * vec2(width, height) - vec2(s.cell);
      ASSERT_GE(std::min(place.x, place.y), -1e-3f);
      ASSERT_LE(std::max(place.x, place.y), 1.0f + 1e-3f);
    }
  }
}

TEST(unit_math_distribution_2d, a_black_picture_is_sampled_uniformly) {
  const std::vector<float> zeros(6, 0.0f);
  const Distribution2D d(zeros, 3, 2);
  EXPECT_EQ(d.total(), 0.0);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 3; ++x) {
      EXPECT_NEAR(d.pdf({x, y}), 1.0f, 1e-6f);
      const auto s = d.sample({(static_cast<float>(x) + 0.5f) / 3.0f, (static_cast<float>(y) + 0.5f) / 2.0f});
      EXPECT_EQ(s.cell, ivec2(x, y));
    }
  }
}

TEST(unit_math_distribution, a_default_one_is_empty) {
  EXPECT_TRUE(Distribution1D().empty());
  EXPECT_EQ(Distribution1D().size(), 0);
  EXPECT_TRUE(Distribution2D().empty());
}

}  // namespace
}  // namespace candela
