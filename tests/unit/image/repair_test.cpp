#include "image/repair.h"

#include <gtest/gtest.h>

#include <limits>

namespace candela {
namespace {

TEST(unit_image_repair, repairs_are_counted_and_placed) {
  Image image(4, 2, 3);
  image.set_rgb(0, 0, vec3(2.0f));
  image.set_rgb(2, 0, vec3(std::numeric_limits<float>::infinity(), 1.0f, 1.0f));
  image.set_rgb(3, 1, vec3(std::numeric_limits<float>::quiet_NaN(), 1.0f, -3.0f));
  const Repairs found = repair(image);
  EXPECT_EQ(found.not_finite, 2U);
  EXPECT_EQ(found.first_not_finite, ivec2(2, 0));
  EXPECT_EQ(found.negative, 1U);
  EXPECT_EQ(found.first_negative, ivec2(3, 1));
  EXPECT_EQ(image.rgb(2, 0), vec3(2.0f, 1.0f, 1.0f));
  EXPECT_EQ(image.rgb(3, 1), vec3(0.0f, 1.0f, 0.0f));
  EXPECT_EQ(repair(image).not_finite, 0U);
}

TEST(unit_image_repair, each_kind_is_one_warning_that_names_the_place) {
  std::vector<Diagnostic> warnings;
  tell_repairs({}, "sky.exr", warnings);
  EXPECT_TRUE(warnings.empty());
  tell_repairs({2, {3, 1}, 5, {4, 0}}, "sky.exr", warnings);
  ASSERT_EQ(warnings.size(), 2U);
  for (const Diagnostic& warning : warnings) EXPECT_EQ(warning.where, "sky.exr");
  EXPECT_NE(warnings[0].message.find("2 texels are not finite, the first at 3,1"), std::string::npos);
  EXPECT_NE(warnings[1].message.find("5 texels are negative, the first at 4,0"), std::string::npos);
}

}  // namespace
}  // namespace candela
