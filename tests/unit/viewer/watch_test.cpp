#include "viewer/watch.h"

#include <gtest/gtest.h>

#include <fstream>

#include "unit/base/temp_folder.h"

namespace candela::viewer {
namespace {

using test::TempFolder;

TEST(unit_viewer_watch, a_file_that_changes_is_told_once_it_stands_still) {
  const TempFolder folder;
  const std::filesystem::path path = folder.path() / "a.txt";
  std::ofstream(path) << "one";
  FileWatch watch;
  watch.set({path});
  double now = 0.0;
  EXPECT_FALSE(watch.has_changed(now += 1.0));
  std::ofstream(path) << "one, two";
  EXPECT_FALSE(watch.has_changed(now += 1.0)) << "it may still be written";
  std::ofstream(path) << "one, two, three";
  EXPECT_FALSE(watch.has_changed(now += 1.0)) << "it may still be written";
  EXPECT_TRUE(watch.has_changed(now += 1.0));
  EXPECT_FALSE(watch.has_changed(now += 1.0));
}

TEST(unit_viewer_watch, a_new_file_of_a_folder_counts_and_looks_are_seldom) {
  const TempFolder folder;
  FileWatch watch;
  watch.set({folder.path()});
  EXPECT_FALSE(watch.has_changed(1.0));
  std::ofstream(folder.path() / "new.txt") << "new";
  EXPECT_FALSE(watch.has_changed(2.0));
  EXPECT_FALSE(watch.has_changed(2.01)) << "too early for another look";
  EXPECT_TRUE(watch.has_changed(3.0));
}

}  // namespace
}  // namespace candela::viewer
