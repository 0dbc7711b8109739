#include "base/text.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace candela {
namespace {

const std::array<std::string, 5> kNames{"render", "info", "bake", "--size", "--spp"};

TEST(unit_base_text, the_nearest_name_is_what_was_mistyped) {
  EXPECT_EQ(nearest_name("redner", kNames), "render");
  EXPECT_EQ(nearest_name("inof", kNames), "info");       // swapped
  EXPECT_EQ(nearest_name("rendr", kNames), "render");    // left out
  EXPECT_EQ(nearest_name("--sizze", kNames), "--size");  // inserted
  EXPECT_EQ(nearest_name("--sise", kNames), "--size");   // exchanged
  EXPECT_EQ(nearest_name("RENDER", kNames), "render");
  EXPECT_EQ(nearest_name("bak", kNames), "bake");
}

TEST(unit_base_text, nothing_is_near_what_means_nothing) {
  for (const char* text : {"", "x", "helmet.glb", "--frobnicate", "zzzzzz"}) EXPECT_EQ(nearest_name(text, kNames), "");
  EXPECT_EQ(nearest_name(std::string(100000, 'r'), kNames), "");
  EXPECT_EQ(did_you_mean("zzzzzz", kNames), "");
  EXPECT_EQ(did_you_mean("inof", kNames), ": did you mean info?");
}

TEST(unit_base_text, one_thing_is_counted_as_one) {
  EXPECT_EQ(counted(0, "texel"), "0 texels");
  EXPECT_EQ(counted(1, "texel"), "1 texel");
  EXPECT_EQ(counted(21, "texel"), "21 texels");
}

TEST(unit_base_text, a_decimal_has_the_digits_that_the_float_needs) {
  EXPECT_EQ(decimal_of(0.1f), 0.1);
  EXPECT_EQ(decimal_of(-1.0e-10f), -1.0e-10);
  EXPECT_EQ(decimal_of(16777216.0f), 16777216.0);
  EXPECT_EQ(decimal_of(std::numeric_limits<float>::infinity()), std::numeric_limits<double>::infinity());
  for (const float value : {0.1f, 1.0f / 3.0f, 1e-45f, 3.4028235e38f, 0.7853982f}) {
    EXPECT_EQ(static_cast<float>(decimal_of(value)), value);
  }
}

}  // namespace
}  // namespace candela
