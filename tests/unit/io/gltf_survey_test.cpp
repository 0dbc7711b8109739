#include "io/gltf_survey.h"

#include <gmock/gmock.h>

#include "unit/io/gltf_builder.h"

namespace candela::io::test {
namespace {

FileSurvey survey(const Builder& file, const SurveyOptions& options = {}) {
  return survey_gltf(file.glb(), {}, options);
}

TEST(unit_io_gltf_survey, a_right_triangle_has_no_oddity) {
  const FileSurvey result = survey(triangle());
  ASSERT_EQ(result.primitives.size(), 1);
  const FileSurvey::Primitive& p = result.primitives[0];
  EXPECT_EQ(p.triangles, 1);
  EXPECT_EQ(p.degenerate, 0);
  EXPECT_EQ(p.normals, 3);
  EXPECT_EQ(p.normals_off_unit, 0);
  EXPECT_FALSE(p.has_tangents);
  EXPECT_TRUE(p.missing_uv_sets.empty());
  EXPECT_THAT(p.where, testing::EndsWith("#/meshes/0/primitives/0"));
  EXPECT_TRUE(survey(triangle(), {.read_geometry = false}).primitives.empty());
}

TEST(unit_io_gltf_survey, normals_off_unit_are_counted_beyond_the_rounding_of_bytes) {
  Builder file = triangle();
  primitive(file)["attributes"]["NORMAL"] = file.vec3s({0, 0, 1.006f, 0, 0, 1.008f, 0, 0, 0.5f});
  const FileSurvey::Primitive p = survey(file).primitives.at(0);
  EXPECT_EQ(p.normals_off_unit, 2);
  EXPECT_EQ(p.worst_normal_length, 0.5f);
  // The largest error of rounding each component to signed bytes.
  primitive(file)["attributes"]["NORMAL"] =
      file.accessor<std::int8_t>({73, 73, 73, 73, 73, 73, 73, 73, 73}, "VEC3", 5120, 3, true);
  EXPECT_EQ(survey(file).primitives.at(0).normals_off_unit, 0);
}

TEST(unit_io_gltf_survey, triangles_without_area_are_counted_in_lists_alone) {
  Builder file = triangle();
  primitive(file)["indices"] = file.indices({0, 1, 2, 0, 0, 1, 1, 2, 1});
  EXPECT_EQ(survey(file).primitives.at(0).degenerate, 2);
  // Three places on a line, or two corners at one, however they are rounded.
  Builder line = triangle();
  primitive(line)["attributes"]["POSITION"] = line.vec3s({0.1f, 0.3f, 0.7f, 0.1f, 0.3f, 0.7f, 3, -2, 0.9f});
  EXPECT_EQ(survey(line).primitives.at(0).degenerate, 1);
  primitive(line)["attributes"]["POSITION"] = line.vec3s({0, 0, 0, 0.1f, 0.3f, 0.7f, 0.2f, 0.6f, 1.4f});
  EXPECT_EQ(survey(line).primitives.at(0).degenerate, 1);
  primitive(file)["mode"] = 5;
  EXPECT_EQ(survey(file).primitives.at(0).degenerate, 0);
  EXPECT_EQ(survey(file).primitives.at(0).triangles, 7);
  primitive(file)["mode"] = 1;
  EXPECT_TRUE(survey(file).primitives.empty());
}

TEST(unit_io_gltf_survey, what_no_node_shows_is_not_looked_at) {
  Builder file = triangle();
  file.root["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", 999}}}}}}});
  EXPECT_EQ(survey(file).primitives.size(), 1);
}

TEST(unit_io_gltf_survey, uv_sets_that_textures_need_and_images_that_fail_are_named) {
  Builder file = triangle();
  file.root["images"] = {{{"uri", "absent.png"}, {"name", "bark"}}, {{"uri", "data:image/png;base64,AAAA"}}};
  file.root["textures"] = {{{"source", 0}}, {{"source", 1}}};
  file.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                             {"occlusionTexture", {{"index", 1}, {"texCoord", 1}}}}};
  primitive(file)["material"] = 0;
  const FileSurvey result = survey(file);
  EXPECT_THAT(result.primitives.at(0).missing_uv_sets, testing::ElementsAre(1));
  ASSERT_EQ(result.images.size(), 2);
  EXPECT_EQ(result.images[0].name, "bark");
  EXPECT_THAT(result.images[0].error, testing::HasSubstr("absent.png"));
  EXPECT_EQ(result.images[1].format, "unknown");
  EXPECT_EQ(result.images[1].file_bytes, 3);
  EXPECT_FALSE(result.images[1].error.empty());
}

}  // namespace
}  // namespace candela::io::test
