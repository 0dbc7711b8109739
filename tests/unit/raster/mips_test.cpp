#include "raster/mips.h"

#include <gtest/gtest.h>

namespace candela::raster {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(unit_raster_mips, numbers_are_means) {
  const Bytes four = {0, 10, 100, 0, 255, 20, 101, 255, 0, 30, 102, 0, 255, 41, 103, 255};
  const MipLevel half = halved(four.data(), 2, 2, false);
  EXPECT_EQ(half.width, 1);
  EXPECT_EQ(half.height, 1);
  EXPECT_EQ(half.rgba, (Bytes{128, 25, 102, 128}));  // 127.5, 25.25, 101.5, rounded
}

TEST(unit_raster_mips, colours_are_means_of_light_and_alpha_is_none) {
  const Bytes four = {0, 255, 128, 0, 255, 255, 128, 255, 0, 255, 128, 0, 255, 255, 128, 255};
  // Half of the light of white is code 188, and what is alike stays as it is.
  EXPECT_EQ(halved(four.data(), 2, 2, true).rgba, (Bytes{188, 255, 128, 128}));
}

TEST(unit_raster_mips, every_code_that_is_alike_stays_as_it_is) {
  for (int code = 0; code < 256; ++code) {
    const Bytes alike(16, static_cast<std::uint8_t>(code));
    EXPECT_EQ(halved(alike.data(), 2, 2, true).rgba, Bytes(4, static_cast<std::uint8_t>(code)));
  }
}

TEST(unit_raster_mips, sides_are_rounded_down_to_one) {
  Bytes strip(12);
  for (std::size_t i = 0; i < strip.size(); ++i) strip[i] = static_cast<std::uint8_t>(10 * (i / 4));
  for (const bool is_wide : {true, false}) {
    const MipLevel half = halved(strip.data(), is_wide ? 3 : 1, is_wide ? 1 : 3, false);
    EXPECT_EQ(half.width, 1);
    EXPECT_EQ(half.height, 1);
    EXPECT_EQ(half.rgba, Bytes(4, 5)) << "of the first two";
  }
}

}  // namespace
}  // namespace candela::raster
