#include "foreign/mtl.h"

#include <gtest/gtest.h>

namespace candela::foreign {
namespace {

Look first(const char* text) {
  const std::vector<Look> looks = read_mtl(text);
  EXPECT_EQ(looks.size(), 1u);
  return looks.empty() ? Look() : looks.front();
}

TEST(unit_foreign_mtl, statements_of_phong) {
  const Look look =
      first("# a comment\nnewmtl red paint\nKd 0.8 0.2 0.1\nKs 0.5\nNs 30\nNi 1.45\nd 0.25\nKe 2 1 0\nillum 2\n");
  EXPECT_EQ(look.name, "red paint");
  EXPECT_EQ(look.color, vec3(0.8f, 0.2f, 0.1f));
  EXPECT_EQ(look.specular, vec3(0.5f));
  EXPECT_EQ(look.shininess, 30.0f);
  EXPECT_EQ(look.ior, 1.45f);
  EXPECT_EQ(look.opacity, 0.25f);
  EXPECT_EQ(look.emission, vec3(2, 1, 0));
  EXPECT_FALSE(look.is_physical());
}

TEST(unit_foreign_mtl, physical_statements) {
  const Look look =
      first("newmtl a\nPr 0.3\nPm 1\nPs 0.1\nPc 0.5\nPcr 0.2\naniso 0.4\nanisor 0.25\nnorm n.png\nmap_Pr r.png\n");
  EXPECT_EQ(look.roughness, 0.3f);
  EXPECT_EQ(look.metallic, 1.0f);
  EXPECT_EQ(look.sheen, 0.1f);
  EXPECT_EQ(look.clearcoat, 0.5f);
  EXPECT_EQ(look.clearcoat_roughness, 0.2f);
  EXPECT_EQ(look.anisotropy, 0.4f);
  EXPECT_EQ(look.anisotropy_turns, 0.25f);
  EXPECT_EQ(look.normal_map.file, "n.png");
  EXPECT_EQ(look.roughness_map.file, "r.png");
  EXPECT_TRUE(look.is_physical());
}

TEST(unit_foreign_mtl, maps_with_options_and_spaces_in_their_names) {
  const Look look = first(
      "newmtl a\nmap_Kd -s 2 3 1 -o 0.5 0.25 -clamp on -mm 0 1 -blendu off wood grain 2.png  \nbump -bm 0.5 -imfchan l "
      "b.png\n"
      "map_d -texres 512 -dash.png\n");
  EXPECT_EQ(look.color_map.file, "wood grain 2.png");
  EXPECT_EQ(look.color_map.scale, vec2(2, 3));
  EXPECT_EQ(look.color_map.offset, vec2(0.5f, 0.25f));
  EXPECT_TRUE(look.color_map.is_clamped);
  EXPECT_EQ(look.bump_map.file, "b.png");
  EXPECT_EQ(look.bump_map.strength, 0.5f);
  EXPECT_EQ(look.opacity_map.file, "-dash.png");
  EXPECT_EQ(first("newmtl a\nmap_Kd -s 2 wood.png\n").color_map.scale, vec2(2, 1)) << "v stays as it is";
}

TEST(unit_foreign_mtl, transparency_is_the_other_end_of_opacity) {
  EXPECT_FLOAT_EQ(first("newmtl a\nTr 0.25\n").opacity, 0.75f);
  EXPECT_FLOAT_EQ(first("newmtl a\nd -halo 0.5\n").opacity, 0.5f);
}

TEST(unit_foreign_mtl, what_is_malformed_changes_nothing) {
  const Look look = first("Kd 1 0 0\nnewmtl a\nKd red\nNs\nPr nan\nPm 1e999\nd\nmap_Kd\n\xFF\xFE\n");
  EXPECT_EQ(look.color, Look().color);
  EXPECT_FALSE(look.shininess);
  EXPECT_FALSE(look.roughness);
  EXPECT_FALSE(look.metallic);
  EXPECT_EQ(look.opacity, 1.0f);
  EXPECT_FALSE(look.color_map);
  EXPECT_TRUE(read_mtl("").empty());
}

TEST(unit_foreign_mtl, lines_end_as_anywhere_and_may_go_on) {
  const std::vector<Look> looks = read_mtl("newmtl a\r\nKd 1 0 0\r\nnewmtl b\rKd 0 1 \\\r\n 0\nnewmtl c");
  ASSERT_EQ(looks.size(), 3u);
  EXPECT_EQ(looks[0].name, "a");
  EXPECT_EQ(looks[0].color, vec3(1, 0, 0));
  EXPECT_EQ(looks[1].color, vec3(0, 1, 0));
  EXPECT_EQ(looks[2].name, "c");
}

TEST(unit_foreign_mtl, libraries_of_an_obj_are_found_where_they_are_statements) {
  const std::vector<std::string> found = material_libraries(
      "# mtllib no.mtl\nmtllib a b.mtl\r\nv 0 0 0\no mtllib\n  mtllib c.mtl\nmtllib a b.mtl\nmtllib");
  EXPECT_EQ(found, (std::vector<std::string>{"a b.mtl", "c.mtl"}));
}

}  // namespace
}  // namespace candela::foreign
