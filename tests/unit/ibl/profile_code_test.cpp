#include "ibl/profile_code.h"

#include <gtest/gtest.h>

namespace candela::ibl {
namespace {

TEST(unit_ibl_profile_code, every_engine_has_some_and_those_that_filter_take_a_panorama) {
  for (const Profile& profile : profiles()) {
    EXPECT_GT(loading_code(profile).size(), 100U) << profile.name;
    if (!profile.is_filtered) {
      EXPECT_FALSE(panorama_code(profile).empty()) << profile.name;
    }
  }
}

}  // namespace
}  // namespace candela::ibl
