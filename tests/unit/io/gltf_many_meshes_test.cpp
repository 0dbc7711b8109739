#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/io/gltf_builder.h"

// Meshes are read on all cores; nobody may notice.
namespace candela::io::test {
namespace {

using ::testing::HasSubstr;

constexpr int kMeshes = 40;

/// Triangles, each a mesh of its own with positions of its own: mesh i is so much farther along z.
Builder many() {
  Builder b = triangle();
  const json first = b.root["meshes"][0];
  b.root["meshes"] = json::array();
  b.root["nodes"] = json::array();
  b.root["scenes"][0]["nodes"] = json::array();
  for (int i = 0; i < kMeshes; ++i) {
    const auto z = static_cast<float>(i);
    json mesh = first;
    mesh["primitives"][0]["attributes"]["POSITION"] = b.vec3s({0, 0, z, 1, 0, z, 0, 1, z});
    b.root["meshes"].push_back(mesh);
    b.root["nodes"].push_back({{"mesh", i}});
    b.root["scenes"][0]["nodes"].push_back(i);
  }
  return b;
}

json& primitive(Builder& b, int mesh) { return b.root["meshes"][static_cast<std::size_t>(mesh)]["primitives"][0]; }
json& attributes(Builder& b, int mesh) { return primitive(b, mesh)["attributes"]; }

TEST(unit_io_gltf_many_meshes, each_is_read_in_its_place) {
  const Loaded loaded = load(many());
  ASSERT_EQ(loaded.scene.meshes.size(), static_cast<std::size_t>(kMeshes));
  for (int i = 0; i < kMeshes; ++i) {
    const Mesh& mesh = loaded.scene.meshes[static_cast<std::size_t>(i)];
    EXPECT_EQ(mesh.file_index, i);
    EXPECT_EQ(mesh.primitives[0].positions[1], vec3(1, 0, i));
  }
}

TEST(unit_io_gltf_many_meshes, the_first_that_cannot_be_read_is_the_error) {
  for (int turn = 0; turn < 20; ++turn) {
    Builder b = many();
    for (const int broken : {35, 11 + turn, 38}) {
      attributes(b, broken)["NORMAL"] = b.vec3s({0, 0, 1});
    }
    EXPECT_THAT(error_of(b), HasSubstr("/meshes/" + std::to_string(11 + turn) + "/"));
  }
}

TEST(unit_io_gltf_many_meshes, the_first_that_is_odd_is_the_warning) {
  Builder b = many();
  for (const int odd : {33, 7, 21}) attributes(b, odd)["COLOR_0"] = b.vec3s({2, 0, 0, 1, 0, 0, 1, 0, 0});
  for (const int line : {5, 6}) primitive(b, line)["mode"] = 1;
  for (int turn = 0; turn < 20; ++turn) {
    const Loaded loaded = load(b);
    ASSERT_EQ(loaded.warnings.size(), 2u);
    EXPECT_THAT(loaded.warnings[0].text(), HasSubstr("/meshes/7/"));
    EXPECT_THAT(loaded.warnings[1].text(), HasSubstr("2 primitives made of points or lines are ignored"));
  }
}

TEST(unit_io_gltf_many_meshes, all_together_may_not_outgrow_the_file) {
  // Each mesh claims a thirtieth of what a file of this size may become.
  Builder b = many();
  for (int i = 0; i < kMeshes; ++i) {
    const int zeros = b.add_accessor({{"componentType", 5126}, {"count", 400'000 + i}, {"type", "VEC3"}});
    attributes(b, i) = {{"POSITION", zeros}};
    primitive(b, i).erase("indices");
  }
  EXPECT_THAT(error_of(b), HasSubstr("far larger than the file"));
}

}  // namespace
}  // namespace candela::io::test
