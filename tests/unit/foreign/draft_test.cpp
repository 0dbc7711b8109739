#include "foreign/draft.h"

#include <gtest/gtest.h>

#include <set>

#include "base/error.h"
#include "foreign/material_writer.h"

namespace candela::foreign {
namespace {

Surroundings with(const std::set<std::string>& names) {
  return {[names](const std::string& name) { return names.contains(name); },
          [](const std::string&) -> std::vector<std::byte> { throw Error("not read here"); }};
}

TEST(unit_foreign_draft, references_of_other_machines_are_found_beside_the_scene) {
  const Surroundings around = with({"wood.png", "maps/a.png", "textures/b.png"});
  EXPECT_EQ(find_reference(around, "maps\\a.png"), "maps/a.png");
  EXPECT_EQ(find_reference(around, "./maps/a.png"), "maps/a.png");
  EXPECT_EQ(find_reference(around, "C:\\Users\\me\\wood.png"), "wood.png");
  EXPECT_EQ(find_reference(around, "/home/me/wood.png"), "wood.png");
  EXPECT_EQ(find_reference(around, "file:///home/me/wood.png"), "wood.png");
  EXPECT_EQ(find_reference(around, "../elsewhere/b.png"), "textures/b.png");
  EXPECT_EQ(find_reference(around, "../absent.png"), "../absent.png");
  EXPECT_EQ(find_reference(around, "/absent.png"), "absent.png");
}

TEST(unit_foreign_draft, names_become_uris) {
  EXPECT_EQ(uri_of("maps/wood grain#1%.png"), "maps/wood%20grain%231%25.png");
  EXPECT_EQ(uri_of("\xC3\xA4.png"), "%C3%A4.png");
}

TEST(unit_foreign_draft, comes_through_as_it_went_in) {
  Draft draft;
  draft.add_view(std::as_bytes(std::span("abc", 3)));
  draft.add_view(std::as_bytes(std::span("defg", 4)));
  draft.read = {"a.mtl"};
  draft.diagnostics.warn("odd", "here");
  draft.diagnostics.note("so");
  const Draft back = unpack(pack(draft));
  EXPECT_EQ(back.gltf, draft.gltf);
  EXPECT_EQ(back.gltf["bufferViews"][1]["byteOffset"], 4);
  EXPECT_EQ(back.buffer, draft.buffer);
  EXPECT_EQ(back.read, draft.read);
  EXPECT_EQ(back.diagnostics.warnings().at(0).text(), "here: odd");
  EXPECT_EQ(back.diagnostics.notes().at(0).text(), "so");
  EXPECT_THROW(unpack({}), Error);
}

nlohmann::json picture(const std::string& file) { return {{"uri", file}, {"name", file}}; }

nlohmann::json material_of(const Look& look, Draft& draft) {
  MaterialWriter writer(draft, picture);
  const std::size_t index = writer.add(look);
  return draft.gltf["materials"][index];
}

TEST(unit_foreign_draft, phong_becomes_metallic_roughness) {
  Draft draft;
  Look look;
  look.specular = vec3(0.5f);
  look.shininess = 30.0f;
  nlohmann::json m = material_of(look, draft);
  EXPECT_NEAR(m["pbrMetallicRoughness"]["roughnessFactor"].get<double>(), 0.5, 1e-6) << "(2 / 32)^(1/4)";
  EXPECT_EQ(m["pbrMetallicRoughness"]["metallicFactor"], 0.0);
  EXPECT_FALSE(m.contains("extensions")) << "a Ks of a half is F0 = 0.04";
  look.specular = vec3(0.0f);
  m = material_of(look, draft);
  EXPECT_EQ(m["extensions"]["KHR_materials_specular"]["specularFactor"], 0.0);
  look.specular = vec3(1.0f, 0.5f, 0.25f);
  m = material_of(look, draft);
  EXPECT_EQ(m["extensions"]["KHR_materials_specular"]["specularColorFactor"], (nlohmann::json{2.0, 1.0, 0.5}));
}

TEST(unit_foreign_draft, pictures_that_gltf_packs_otherwise_are_mixed) {
  Draft draft;
  MaterialWriter writer(draft, picture);
  const auto add = [&](const Look& l) { return draft.gltf["materials"][writer.add(l)]; };
  Look look;
  look.roughness_map.file = "r.png";
  look.metallic = 0.0f;
  add(look);
  EXPECT_TRUE(draft.mixtures.empty()) << "blue does not count where nothing is metal";
  look.metallic_map.file = "m.png";
  look.metallic.reset();
  const nlohmann::json m = add(look);
  ASSERT_EQ(draft.mixtures.size(), 1u);
  EXPECT_EQ(draft.mixtures[0]["kind"], "pack");
  EXPECT_EQ(m["pbrMetallicRoughness"]["metallicFactor"], 1.0);
  look.opacity_map = look.color_map = Map{.file = "c.png"};
  EXPECT_EQ(add(look)["alphaMode"], "BLEND");
  EXPECT_EQ(draft.mixtures.size(), 1u) << "one picture holds both";
  look.opacity_map.file = "d.png";
  add(look);
  EXPECT_EQ(draft.mixtures.size(), 2u);
}

}  // namespace
}  // namespace candela::foreign
