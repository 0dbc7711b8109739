#include "candela/scene_keep.h"

#include <gtest/gtest.h>

namespace candela {
namespace {

struct Counted {
  SceneKeep keep;
  int made = 0;
  std::shared_ptr<const Scene> scene(const std::string& key, Diagnostics* diagnostics = nullptr) {
    const auto make = [&] {
      ++made;
      if (diagnostics != nullptr) diagnostics->warn("odd", key);
      return Scene();
    };
    return keep.scene(key, make, diagnostics);
  }
};

TEST(unit_candela_scene_keep, keeps_the_last_ones_and_none_unless_asked) {
  Counted none;
  EXPECT_NE(none.scene("a"), none.scene("a"));
  EXPECT_EQ(none.made, 2);
  Counted two;
  two.keep.set_capacity(2);
  const auto a = two.scene("a");
  two.scene("b");
  EXPECT_EQ(two.scene("a"), a);
  EXPECT_EQ(two.made, 2);
  two.scene("c");  // b was used longest ago
  EXPECT_EQ(two.scene("a"), a);
  EXPECT_EQ(two.made, 3);
  two.scene("b");
  EXPECT_EQ(two.made, 4);
}

TEST(unit_candela_scene_keep, a_kept_scene_warns_again) {
  Counted one;
  one.keep.set_capacity(1);
  Diagnostics first, second;
  one.scene("a", &first);
  one.scene("a", &second);
  EXPECT_EQ(one.made, 1);
  ASSERT_EQ(first.warnings().size(), 1U);
  ASSERT_EQ(second.warnings().size(), 1U);
  EXPECT_EQ(second.warnings()[0].where, "a");
}

TEST(unit_candela_scene_keep, a_key_is_that_of_the_options) {
  const io::LoadOptions plain;
  io::LoadOptions dressed;
  dressed.variant = "midnight";
  io::LoadOptions small;
  small.texture_memory = 1000;
  EXPECT_EQ(scene_key({}, "a.glb", plain), scene_key({}, "a.glb", plain));
  EXPECT_NE(scene_key({}, "a.glb", plain), scene_key({}, "b.glb", plain));
  EXPECT_NE(scene_key({}, "a.glb", plain), scene_key({}, "a.glb", dressed));
  EXPECT_NE(scene_key({}, "a.glb", plain), scene_key({}, "a.glb", small));
}

}  // namespace
}  // namespace candela
