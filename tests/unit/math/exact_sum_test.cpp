#include "math/exact_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace candela {
namespace {

TEST(unit_math_exact_sum, order_and_grouping_do_not_matter) {
  std::mt19937 random(3);
  std::vector<float> values;
  for (int i = 0; i < 4000; ++i) {
    const float magnitude = std::ldexp(1.0f, static_cast<int>(random() % 70) - 35);
    values.push_back(magnitude * (static_cast<float>(random()) * 0x1p-31f - 1.0f));
  }
  ExactSum forward;
  for (const float v : values) forward.add(v);
  std::shuffle(values.begin(), values.end(), random);
  ExactSum shuffled, parts[7];
  for (const float v : values) shuffled.add(v);
  for (std::size_t i = 0; i < values.size(); ++i) parts[i % 7].add(values[i]);
  ExactSum merged;
  for (const ExactSum& part : parts) merged.add(part);
  EXPECT_EQ(forward.value(), shuffled.value());
  EXPECT_EQ(forward.value(), merged.value());
  // The twin: double precision depends on it.
  double a = 0.0, b = 0.0;
  for (const float v : values) a += static_cast<double>(v);
  std::sort(values.begin(), values.end());
  for (const float v : values) b += static_cast<double>(v);
  EXPECT_NE(a, b);
}

TEST(unit_math_exact_sum, it_is_the_sum) {
  ExactSum sum;
  for (const float v : {1.5f, -0.25f, 1e10f, -1e10f, 0x1p-40f}) sum.add(v);
  EXPECT_EQ(sum.value(), 1.25 + 0x1p-40);
  ExactSum negative;
  for (int i = 0; i < 1000; ++i) negative.add(-0.125f);
  EXPECT_EQ(negative.value(), -125.0);
  ExactSum huge;
  for (int i = 0; i < 60000; ++i) huge.add(1e30f);
  EXPECT_EQ(huge.value(), 60000.0 * 0x1p46) << "what is too large counts as the largest";
  ExactSmallSum small;
  for (int i = 0; i < 3; ++i) small.add(0.3f);
  EXPECT_NEAR(small.value(), 0.9, 1e-7);
}

}  // namespace
}  // namespace candela
