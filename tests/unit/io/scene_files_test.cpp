#include "io/scene_files.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/file.h"
#include "io/gltf_survey.h"
#include "unit/base/temp_folder.h"
#include "unit/io/gltf_builder.h"

namespace candela::io {
namespace {

namespace fs = std::filesystem;

std::string error_of(const fs::path& path, const fs::path& root) {
  try {
    Diagnostics diagnostics;
    load_gltf(path, diagnostics, {.root = root});
    survey_gltf(path, {.root = root});
    files_of_gltf(path, root);
  } catch (const Error& error) {
    return error.what();
  }
  return "read";
}

struct Folders : ::testing::Test {
  candela::test::TempFolder folder;

  Folders() {
    fs::create_directories(folder / "in/scene");
    fs::create_directories(folder / "inner");
    write_file(folder / "in/near.bin", std::string("12345678"));
    write_file(folder / "inner/far.bin", std::string("12345678"));
  }
  /// A scene that names this file, and needs it not.
  fs::path scene(const std::string& uri) {
    test::Builder b = test::triangle();
    b.root["images"].push_back({{"uri", uri}});
    write_file(folder / "in/scene/a.gltf", b.gltf());
    return folder / "in/scene/a.gltf";
  }
};
using unit_io_scene_files = Folders;

TEST_F(unit_io_scene_files, a_root_bounds_what_a_scene_names_needed_or_not) {
  EXPECT_EQ(error_of(scene("../near.bin"), {}), "read");
  EXPECT_EQ(error_of(scene("../near.bin"), folder / "in"), "read");
  EXPECT_EQ(error_of(scene("../near.bin"), folder.path()), "read");
  EXPECT_EQ(error_of(scene("../near.bin"), "/"), "read");
  EXPECT_NE(
      error_of(scene("../near.bin"), folder / "in/scene").find("a.gltf#/images/0/uri: '../near.bin' leads out of"),
      std::string::npos);
  // A folder whose name begins like the root's is another.
  EXPECT_NE(error_of(scene("../../inner/far.bin"), folder / "in").find("leads out of"), std::string::npos);
  EXPECT_EQ(error_of(scene("../../inner/far.bin"), {}), "read");
}

TEST_F(unit_io_scene_files, links_are_followed_before_it_is_decided) {
  fs::create_symlink(folder / "inner/far.bin", folder / "in/scene/link.bin");
  fs::create_directory_symlink("../..", folder / "in/scene/up");
  fs::create_directory_symlink(folder / "in", folder / "door");
  fs::create_symlink("loop.bin", folder / "in/scene/loop.bin");
  for (const char* name : {"link.bin", "up/inner/far.bin", "loop.bin"}) {
    EXPECT_NE(error_of(scene(name), folder / "in").find("leads out of"), std::string::npos) << name;
  }
  EXPECT_EQ(error_of(scene("up/in/near.bin"), folder / "in"), "read");
  EXPECT_EQ(error_of(scene("../near.bin"), folder / "door"), "read");
  scene("../near.bin");
  EXPECT_EQ(error_of(folder / "door/scene/a.gltf", folder / "in"), "read");
  EXPECT_EQ(error_of(folder / "door/scene/a.gltf", folder / "door"), "read");
}

TEST_F(unit_io_scene_files, the_scene_itself_and_the_root_are_looked_at) {
  const fs::path path = scene("../near.bin");
  EXPECT_NE(error_of(path, folder / "inner").find("a.gltf: leads out of"), std::string::npos);
  EXPECT_NE(error_of(path, folder / "nothing").find("no such folder"), std::string::npos);
  EXPECT_NE(error_of(path, path).find("no such folder"), std::string::npos);
}

TEST_F(unit_io_scene_files, memory_reads_within_bounds_too) {
  test::Builder b = test::triangle();
  b.root["images"].push_back({{"uri", "../near.bin"}});
  const std::string text = b.gltf();
  const auto bytes = test::as_bytes(text);
  Diagnostics diagnostics;
  EXPECT_NO_THROW(load_gltf(bytes, folder / "in/scene", diagnostics, {.root = folder / "in"}));
  EXPECT_THROW(load_gltf(bytes, folder / "in/scene", diagnostics, {.root = folder / "in/scene"}), Error);
}

TEST_F(unit_io_scene_files, a_survey_says_what_lies_outside_of_the_scenes_folder) {
  const auto outside = [&](const std::string& uri) { return survey_gltf(scene(uri), {}).outside; };
  ASSERT_EQ(outside("../near.bin").size(), 1u);
  EXPECT_EQ(outside("../near.bin")[0].name, "../near.bin");
  EXPECT_TRUE(outside("../near.bin")[0].where.ends_with("a.gltf#/images/0/uri"));
  EXPECT_TRUE(outside("near.bin").empty());
  EXPECT_TRUE(outside("../scene/near.bin").empty());
  EXPECT_EQ(outside("%2e%2e/near.bin").size(), 1u);
  fs::create_symlink("../near.bin", folder / "in/scene/link.bin");
  EXPECT_EQ(outside("link.bin").size(), 1u);
}

}  // namespace
}  // namespace candela::io
