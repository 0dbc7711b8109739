#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "scene/metals.h"
#include "unit/io/gltf_builder.h"

/// The material extensions beside metallic-roughness: every number, every texture, every exclusion.
namespace candela::io::test {
namespace {

using ::testing::HasSubstr;

constexpr float kTiny = 1e-6f;
constexpr float kUnlimited = std::numeric_limits<float>::infinity();

struct NumberCase {
  const char* extension;
  const char* key;
  float Material::*field;
  float fallback;
  float lower;
  float upper;
};

const NumberCase kNumbers[] = {
    {"KHR_materials_ior", "ior", &Material::ior, 1.5f, 1, 1e6f},
    {"KHR_materials_specular", "specularFactor", &Material::specular, 1, 0, 1},
    {"KHR_materials_clearcoat", "clearcoatFactor", &Material::clearcoat, 0, 0, 1},
    {"KHR_materials_clearcoat", "clearcoatRoughnessFactor", &Material::clearcoat_roughness, 0, 0, 1},
    {"KHR_materials_sheen", "sheenRoughnessFactor", &Material::sheen_roughness, 0, 0, 1},
    {"KHR_materials_anisotropy", "anisotropyStrength", &Material::anisotropy, 0, 0, 1},
    {"KHR_materials_anisotropy", "anisotropyRotation", &Material::anisotropy_rotation, 0, -kUnlimited, kUnlimited},
    {"KHR_materials_iridescence", "iridescenceFactor", &Material::iridescence, 0, 0, 1},
    {"KHR_materials_iridescence", "iridescenceIor", &Material::iridescence_ior, 1.3f, 1, 1e6f},
    {"KHR_materials_iridescence", "iridescenceThicknessMinimum", &Material::iridescence_thickness_min_nm, 100, 0, 1e6f},
    {"KHR_materials_iridescence", "iridescenceThicknessMaximum", &Material::iridescence_thickness_max_nm, 400, 0, 1e6f},
    {"KHR_materials_transmission", "transmissionFactor", &Material::transmission, 0, 0, 1},
    {"KHR_materials_volume", "thicknessFactor", &Material::thickness, 0, 0, 1e9f},
    {"KHR_materials_volume", "attenuationDistance", &Material::attenuation_distance, kUnlimited, 1e-9f, kUnlimited},
    {"KHR_materials_dispersion", "dispersion", &Material::dispersion, 0, 0, 1e3f},
    {"KHR_materials_diffuse_transmission", "diffuseTransmissionFactor", &Material::diffuse_transmission, 0, 0, 1},
    {"KHR_materials_fuzz", "fuzzFactor", &Material::fuzz, 0, 0, 1},
    {"KHR_materials_fuzz", "fuzzRoughnessFactor", &Material::fuzz_roughness, 0.5f, 0, 1},
    {"KHR_materials_retroreflection", "retroreflectionFactor", &Material::retroreflection, 0, 0, 1},
    {"KHR_materials_diffuse_roughness", "diffuseRoughnessFactor", &Material::diffuse_roughness, 0, 0, 1},
    {"KHR_materials_volume_scatter", "scatterAnisotropy", &Material::scatter_anisotropy, 0, -0.999f, 0.999f},
    {"KHR_materials_scatter", "scatterAnisotropy", &Material::scatter_anisotropy, 0, -0.999f, 0.999f},
};

struct ColorCase {
  const char* extension;
  const char* key;
  vec3 Material::*field;
  float fallback;
  float lower = 0;
  float upper = 1;
};

const ColorCase kColors[] = {
    {"KHR_materials_specular", "specularColorFactor", &Material::specular_color, 1, 0, kUnlimited},
    {"KHR_materials_sheen", "sheenColorFactor", &Material::sheen_color, 0},
    {"KHR_materials_fuzz", "fuzzColorFactor", &Material::fuzz_color, 1},
    {"KHR_materials_volume", "attenuationColor", &Material::attenuation_color, 1, kTiny},
    {"KHR_materials_diffuse_transmission", "diffuseTransmissionColorFactor", &Material::diffuse_transmission_color, 1},
    {"KHR_materials_volume_scatter", "multiscatterColor", &Material::multiscatter_color, 0},
    {"KHR_materials_volume_scatter", "multiscatterColorFactor", &Material::multiscatter_color, 0},
    {"KHR_materials_pbrSpecularGlossiness", "diffuseFactor", &Material::base_color, 1},
    {"KHR_materials_pbrSpecularGlossiness", "specularFactor", &Material::specular_color, 1},
};

struct SlotCase {
  const char* extension;
  const char* key;
  TextureSlot Material::*slot;
};

const SlotCase kSlots[] = {
    {"KHR_materials_specular", "specularTexture", &Material::specular_texture},
    {"KHR_materials_specular", "specularColorTexture", &Material::specular_color_texture},
    {"KHR_materials_clearcoat", "clearcoatTexture", &Material::clearcoat_texture},
    {"KHR_materials_clearcoat", "clearcoatRoughnessTexture", &Material::clearcoat_roughness_texture},
    {"KHR_materials_clearcoat", "clearcoatNormalTexture", &Material::clearcoat_normal_texture},
    {"KHR_materials_sheen", "sheenColorTexture", &Material::sheen_color_texture},
    {"KHR_materials_sheen", "sheenRoughnessTexture", &Material::sheen_roughness_texture},
    {"KHR_materials_anisotropy", "anisotropyTexture", &Material::anisotropy_texture},
    {"KHR_materials_iridescence", "iridescenceTexture", &Material::iridescence_texture},
    {"KHR_materials_iridescence", "iridescenceThicknessTexture", &Material::iridescence_thickness_texture},
    {"KHR_materials_transmission", "transmissionTexture", &Material::transmission_texture},
    {"KHR_materials_volume", "thicknessTexture", &Material::thickness_texture},
    {"KHR_materials_diffuse_transmission", "diffuseTransmissionTexture", &Material::diffuse_transmission_texture},
    {"KHR_materials_diffuse_transmission", "diffuseTransmissionColorTexture",
     &Material::diffuse_transmission_color_texture},
    {"KHR_materials_retroreflection", "retroreflectionTexture", &Material::retroreflection_texture},
    {"KHR_materials_diffuse_roughness", "diffuseRoughnessTexture", &Material::diffuse_roughness_texture},
    {"KHR_materials_volume_scatter", "multiscatterColorTexture", &Material::multiscatter_color_texture},
};

/// A material of one extension, beside what that one may depend on.
json extended(const std::string& extension, const json& members) {
  json material = {
      {"name", "test"},
      {"extensions",
       {{"KHR_materials_transmission", json::object()}, {"KHR_materials_volume", {{"thicknessFactor", 1}}}}}};
  if (extension == "KHR_materials_pbrSpecularGlossiness") material["extensions"].clear();
  material["extensions"][extension] = members;
  return material;
}

Loaded load_extended(const std::string& extension, const json& members) {
  return load(with_material(extended(extension, members)));
}

Material material_of(const std::string& extension, const json& members) {
  const Loaded loaded = load_extended(extension, members);
  for (const Diagnostic& warning : loaded.warnings) ADD_FAILURE() << warning.text();
  return loaded.scene.materials.at(0);
}

TEST(unit_io_gltf_layers, every_number_arrives_has_its_default_and_is_kept_in_range) {
  for (const NumberCase& c : kNumbers) {
    SCOPED_TRACE(std::string(c.extension) + '.' + c.key);
    EXPECT_EQ(material_of(c.extension, json::object()).*c.field, c.fallback);
    EXPECT_EQ(Material().*c.field, c.fallback);
    const float inside = std::max(c.lower, 0.0f) + 0.25f;
    EXPECT_EQ(material_of(c.extension, {{c.key, inside}}).*c.field, inside);
    for (const float limit : {c.lower, c.upper}) {
      if (!std::isfinite(limit)) continue;
      EXPECT_EQ(material_of(c.extension, {{c.key, limit}}).*c.field, limit);
      const float outside = limit + (limit == c.lower ? -0.5f : limit);
      const Loaded loaded = load_extended(c.extension, {{c.key, outside}});
      EXPECT_EQ(loaded.scene.materials.at(0).*c.field, limit);
      EXPECT_TRUE(loaded.warned(std::string("material 'test': ") + c.key + ' '));
      EXPECT_EQ(loaded.warnings.size(), 1u);
    }
    EXPECT_THAT(error_of(with_material(extended(c.extension, {{c.key, "1"}}))), HasSubstr("must be a number"));
    EXPECT_THAT(error_of(with_material(extended(c.extension, {{c.key, 1e39}}))), HasSubstr("not finite"));
  }
}

TEST(unit_io_gltf_layers, every_colour_arrives_has_its_default_and_is_kept_in_range) {
  for (const ColorCase& c : kColors) {
    SCOPED_TRACE(std::string(c.extension) + '.' + c.key);
    const bool rgba = std::string(c.key) == "diffuseFactor";
    const auto color = [&](float r, float g, float b) {
      json value = {r, g, b};
      if (rgba) value.push_back(1);
      return json{{c.key, value}};
    };
    EXPECT_EQ(material_of(c.extension, json::object()).*c.field, vec3(c.fallback));
    EXPECT_EQ(material_of(c.extension, color(0.25f, 0.5f, 0.75f)).*c.field, vec3(0.25f, 0.5f, 0.75f));
    EXPECT_EQ(material_of(c.extension, color(0, 0, 0)).*c.field, vec3(c.lower));
    const Loaded loaded = load_extended(c.extension, color(-1, 0.5f, 2));
    EXPECT_EQ(loaded.scene.materials.at(0).*c.field, vec3(c.lower, 0.5f, std::min(c.upper, 2.0f)));
    EXPECT_TRUE(loaded.warned(std::string("material 'test': ") + c.key + " -1 becomes 0"));
    EXPECT_EQ(loaded.warnings.size(), std::isfinite(c.upper) ? 2u : 1u);
    EXPECT_THAT(error_of(with_material(extended(c.extension, {{c.key, {1, 1}}}))), HasSubstr("numbers, not 2"));
  }
}

TEST(unit_io_gltf_layers, every_texture_arrives_in_its_own_slot) {
  Builder b = with_material({{"name", "test"}});
  int count = 0;
  for (const SlotCase& c : kSlots) {
    add_texture(b);
    b.root["materials"][0]["extensions"][c.extension][c.key] = {
        {"index", count},
        {"texCoord", count % 2},
        {"extensions", {{"KHR_texture_transform", {{"offset", {count, 0}}}}}}};
    ++count;
  }
  primitive(b)["attributes"]["TEXCOORD_1"] = primitive(b)["attributes"]["TEXCOORD_0"];
  const Loaded loaded = load(b);
  EXPECT_TRUE(loaded.warnings.empty());
  EXPECT_EQ(loaded.scene.textures.size(), std::size(kSlots));
  EXPECT_EQ(loaded.scene.images.size(), std::size(kSlots));
  count = 0;
  for (const SlotCase& c : kSlots) {
    const TextureSlot& slot = loaded.scene.materials.at(0).*c.slot;
    EXPECT_EQ(slot.texture, count) << c.key;
    EXPECT_EQ(slot.uv_set, count % 2) << c.key;
    EXPECT_EQ(slot.apply(vec2(0)), vec2(count, 0)) << c.key;
    ++count;
  }
}

TEST(unit_io_gltf_layers, the_coats_normal_has_a_scale) {
  json material = extended("KHR_materials_clearcoat", {{"clearcoatNormalTexture", {{"index", 0}, {"scale", -3}}}});
  Builder b = with_material(material);
  add_texture(b);
  const Material m = load(b).scene.materials.at(0);
  EXPECT_EQ(m.clearcoat_normal_scale, -3);
  EXPECT_EQ(m.normal_scale, 1);
}

TEST(unit_io_gltf_layers, an_edge_color_is_switched_on_within_specular) {
  const auto edge = [](const json& members) {
    return material_of("KHR_materials_specular", {{"extensions", {{"EXT_materials_specular_edge_color", members}}}})
        .specular_edge_color;
  };
  EXPECT_EQ(edge({{"specularEdgeColorEnabled", true}}), 1.0f);
  EXPECT_EQ(edge({{"specularEdgeColorEnabled", false}}), 0.0f);
  EXPECT_EQ(edge(json::object()), 0.0f);
  EXPECT_THROW(edge({{"specularEdgeColorEnabled", 1}}), Error);
}

TEST(unit_io_gltf_layers, textures_of_fuzz_and_of_a_streaked_coat_arrive) {
  const auto texture = [](int index) { return json{{"index", index}}; };
  const json fuzz = {
      {"fuzzTexture", texture(0)}, {"fuzzColorTexture", texture(1)}, {"fuzzRoughnessTexture", texture(2)}};
  const json streaks = {{"clearcoatAnisotropyTexture", texture(3)}};
  const json coat = {{"extensions", {{"KHR_materials_clearcoat_anisotropy", streaks}}}};
  Builder b = with_material({{"extensions", {{"KHR_materials_fuzz", fuzz}, {"KHR_materials_clearcoat", coat}}}});
  for (int i = 0; i < 4; ++i) add_texture(b);
  const Material m = load(b).scene.materials.at(0);
  EXPECT_EQ(m.fuzz_texture.texture, 0);
  EXPECT_EQ(m.fuzz_color_texture.texture, 1);
  EXPECT_EQ(m.fuzz_roughness_texture.texture, 2);
  EXPECT_EQ(m.clearcoat_anisotropy_texture.texture, 3);
}

TEST(unit_io_gltf_layers, a_sheen_beside_fuzz_is_for_others) {
  const auto sheen_beside = [](const json& others) {
    json material = extended("KHR_materials_sheen", {{"sheenColorFactor", {1, 1, 1}}});
    material["extensions"].update(others);
    const Loaded loaded = load(with_material(material));
    EXPECT_TRUE(loaded.warnings.empty());
    return loaded.scene.materials.at(0).sheen_color;
  };
  EXPECT_EQ(sheen_beside(json::object()), vec3(1.0f));
  EXPECT_EQ(sheen_beside({{"KHR_materials_fuzz", {{"fuzzFactor", 0.5}}}}), vec3(0.0f));
  EXPECT_EQ(sheen_beside({{"KHR_materials_fuzz", json::object()}}), vec3(0.0f));
}

TEST(unit_io_gltf_layers, what_drafts_add_to_the_coat_stands_within_it) {
  const auto coat = [](const char* name, const json& members) {
    return material_of("KHR_materials_clearcoat", {{"clearcoatFactor", 1}, {"extensions", {{name, members}}}});
  };
  EXPECT_EQ(coat("KHR_materials_clearcoat_ior", {{"clearcoatIor", 1.8}}).clearcoat_ior, 1.8f);
  EXPECT_EQ(coat("KHR_materials_clearcoat_ior", json::object()).clearcoat_ior, 1.5f);
  EXPECT_EQ(coat("KHR_materials_clearcoat_color", {{"clearcoatColorFactor", {0.5, 0.25, 1}}}).clearcoat_color,
            vec3(0.5f, 0.25f, 1.0f));
  EXPECT_EQ(coat("KHR_materials_clearcoat_darkening", {{"clearcoatDarkeningFactor", 0.25}}).clearcoat_darkening, 0.25f);
  const Material streaked = coat("KHR_materials_clearcoat_anisotropy",
                                 {{"clearcoatAnisotropyStrength", 0.75}, {"clearcoatAnisotropyRotation", 1.5}});
  EXPECT_EQ(streaked.clearcoat_anisotropy, 0.75f);
  EXPECT_EQ(streaked.clearcoat_anisotropy_rotation, 1.5f);
  EXPECT_EQ(coat("KHR_materials_clearcoat_anisotropy", json::object()).clearcoat_anisotropy, 0.0f);
  // The ratified coat does not darken; one that names the draft does, unless it says by how much.
  EXPECT_EQ(coat("KHR_materials_clearcoat_darkening", json::object()).clearcoat_darkening, 1.0f);
  EXPECT_EQ(material_of("KHR_materials_clearcoat", json::object()).clearcoat_darkening, 0.0f);
}

TEST(unit_io_gltf_layers, refraction_may_be_switched_off_by_an_index_of_zero) {
  EXPECT_EQ(material_of("KHR_materials_ior", {{"ior", 0}}).ior, 0);
}

TEST(unit_io_gltf_layers, a_film_may_be_thickest_where_its_texture_is_black) {
  const Material m = material_of("KHR_materials_iridescence",
                                 {{"iridescenceThicknessMinimum", 800}, {"iridescenceThicknessMaximum", 200}});
  EXPECT_EQ(m.iridescence_thickness_min_nm, 800);
  EXPECT_EQ(m.iridescence_thickness_max_nm, 200);
}

TEST(unit_io_gltf_layers, what_hangs_on_another_extension_says_so_without_it) {
  const auto alone = [](const char* extension, const json& members) {
    return load(with_material({{"name", "test"}, {"extensions", {{extension, members}}}}));
  };
  Loaded loaded = alone("KHR_materials_dispersion", {{"dispersion", 0.5}});
  EXPECT_EQ(loaded.scene.materials.at(0).dispersion, 0);
  EXPECT_TRUE(loaded.noted("material 'test': KHR_materials_dispersion has no effect without"));
  loaded = alone("KHR_materials_volume_scatter", {{"multiscatterColor", {1, 1, 1}}});
  EXPECT_EQ(loaded.scene.materials.at(0).multiscatter_color, vec3(0));
  EXPECT_TRUE(loaded.noted("material 'test': KHR_materials_volume_scatter has no effect without"));
  EXPECT_TRUE(loaded.warnings.empty()) << "what changes no pixel is no warning";
  EXPECT_TRUE(alone("KHR_materials_dispersion", json::object()).notes.empty());
}

TEST(unit_io_gltf_layers, the_later_draft_of_scattering_means_the_same_inside_a_volume) {
  const json members = {
      {"scatterStrengthFactor", 0.5}, {"multiscatterColorFactor", {1, 0.5, 0.25}}, {"scatterAnisotropy", -0.25}};
  const Material m = material_of("KHR_materials_scatter", members);
  EXPECT_EQ(m.multiscatter_color, vec3(0.5f, 0.25f, 0.125f));
  EXPECT_EQ(m.scatter_anisotropy, -0.25f);
  EXPECT_EQ(material_of("KHR_materials_scatter", json::object()).multiscatter_color, vec3(0));

  EXPECT_TRUE(load_extended("KHR_materials_scatter", json::object()).noted("its scatterStrengthFactor is 0"));
  json both = extended("KHR_materials_scatter", members);
  both["extensions"]["KHR_materials_diffuse_transmission"] = json::object();
  EXPECT_TRUE(load(with_material(both)).warned("KHR_materials_scatter is ignored beside"));
}

TEST(unit_io_gltf_layers, scattering_of_a_thin_wall_and_its_textures_arrive) {
  json material = {{"name", "test"},
                   {"extensions",
                    {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                     {"KHR_materials_scatter",
                      {{"scatterStrengthFactor", 0.5},
                       {"multiscatterColorFactor", {1, 0.5, 0.25}},
                       {"scatterAnisotropy", -0.25},
                       {"scatterStrengthTexture", {{"index", 0}}},
                       {"multiscatterColorTexture", {{"index", 1}}}}}}}};
  const auto loaded = [&] {
    Builder b = with_material(material);
    add_texture(b), add_texture(b);
    return load(b);
  };
  const auto check = [&](bool is_sheet, vec3 color) {
    const Loaded one = loaded();
    EXPECT_TRUE(one.warnings.empty());
    const Material& m = one.scene.materials.at(0);
    EXPECT_EQ(m.scatters_as_sheet(), is_sheet);
    EXPECT_EQ(m.sheet_scatter, is_sheet ? 0.5f : 0.0f);
    EXPECT_EQ(m.multiscatter_color, color);
    EXPECT_EQ(m.scatter_anisotropy, -0.25f);
    EXPECT_EQ(m.scatter_strength_texture.texture, 0);
    EXPECT_EQ(m.multiscatter_color_texture.texture, 1);
  };
  check(true, {1, 0.5f, 0.25f});
  material["extensions"]["KHR_materials_volume"] = {{"thicknessFactor", 0}};
  check(true, {1, 0.5f, 0.25f});
  material["extensions"]["KHR_materials_volume"] = {{"thicknessFactor", 1}};
  check(false, {0.5f, 0.25f, 0.125f});
  material["extensions"].erase("KHR_materials_transmission");
  EXPECT_TRUE(loaded().noted("KHR_materials_scatter has no effect without KHR_materials_transmission"));
  EXPECT_EQ(loaded().scene.materials.at(0).multiscatter_color, vec3(0));
}

TEST(unit_io_gltf_layers, specular_glossiness_is_a_workflow_of_its_own) {
  Builder b = with_material({{"pbrMetallicRoughness",
                              {{"baseColorFactor", {0, 0, 0, 0}},
                               {"metallicFactor", 1},
                               {"roughnessFactor", 1},
                               {"metallicRoughnessTexture", {{"index", 0}}}}},
                             {"normalTexture", {{"index", 0}}},
                             {"extensions",
                              {{"KHR_materials_pbrSpecularGlossiness",
                                {{"diffuseFactor", {0.1, 0.2, 0.3, 0.4}},
                                 {"diffuseTexture", {{"index", 1}}},
                                 {"specularFactor", {0.5, 0.6, 0.7}},
                                 {"glossinessFactor", 0.75},
                                 {"specularGlossinessTexture", {{"index", 2}}}}}}}});
  for (int i = 0; i < 3; ++i) add_texture(b);
  const Loaded loaded = load(b);
  EXPECT_TRUE(loaded.warnings.empty());
  const Material& m = loaded.scene.materials.at(0);
  EXPECT_TRUE(m.specular_glossiness);
  EXPECT_EQ(m.base_color, vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(m.opacity, 0.4f);
  EXPECT_EQ(m.specular_color, vec3(0.5f, 0.6f, 0.7f));
  EXPECT_EQ(m.roughness, 0.25f);
  EXPECT_EQ(m.metallic, 0);
  EXPECT_EQ(m.ior, 0);
  EXPECT_EQ(m.normal_texture.texture, 0);
  EXPECT_EQ(m.base_color_texture.texture, 1);
  EXPECT_EQ(m.specular_glossiness_texture.texture, 2);
  EXPECT_FALSE(m.metallic_roughness_texture);

  const Material standard = material_of("KHR_materials_pbrSpecularGlossiness", json::object());
  EXPECT_EQ(standard.roughness, 0);
  EXPECT_EQ(standard.opacity, 1);
  EXPECT_FALSE(Material().specular_glossiness);
}

TEST(unit_io_gltf_layers, extras_may_name_a_measured_metal) {
  const auto extras = [](const json& value) { return load(with_material({{"name", "test"}, {"extras", value}})); };
  Loaded loaded = extras({{"candela", {{"conductor", "gold"}}}});
  EXPECT_TRUE(loaded.warnings.empty());
  const Metal* gold = find_metal("gold");
  ASSERT_NE(gold, nullptr);
  EXPECT_EQ(loaded.scene.materials.at(0).conductor_n, gold->n);
  EXPECT_EQ(loaded.scene.materials.at(0).conductor_k, gold->k);
  EXPECT_TRUE(loaded.scene.materials.at(0).is_conductor());

  loaded = extras({{"candela", {{"conductor", "mithril"}}}});
  EXPECT_TRUE(loaded.warned("material 'test': there is no measured metal 'mithril'"));
  EXPECT_FALSE(loaded.scene.materials.at(0).is_conductor());
  EXPECT_THAT(error_of(with_material({{"extras", {{"candela", {{"conductor", 79}}}}}})), HasSubstr("must be a string"));
  // What other programs keep there is theirs.
  for (const json& theirs : {json(3), json::array({1}), json{{"candela", 100}}, json{{"candela", json::object()}}}) {
    loaded = extras(theirs);
    EXPECT_TRUE(loaded.warnings.empty());
    EXPECT_FALSE(loaded.scene.materials.at(0).is_conductor());
  }
  loaded = load(with_material(
      {{"extras", {{"candela", {{"conductor", "gold"}}}}}, {"extensions", {{"KHR_materials_unlit", json::object()}}}}));
  EXPECT_TRUE(loaded.warned("conductor is ignored beside KHR_materials_unlit"));
  EXPECT_FALSE(loaded.scene.materials.at(0).is_conductor());
}

TEST(unit_io_gltf_layers, extras_may_have_a_height_map) {
  const auto extras = [](const json& height) {
    Builder b = with_material({{"name", "test"}, {"extras", {{"candela", {{"heightTexture", height}}}}}});
    b.root["images"] = {{{"uri", "data:image/png;base64," + base64(tiny_png())}}};
    b.root["textures"] = {{{"source", 0}}};
    return b;
  };
  const Loaded loaded = load(extras({{"index", 0}, {"scale", 0.25}, {"level", 0.5}}));
  EXPECT_TRUE(loaded.warnings.empty());
  const Material& m = loaded.scene.materials.at(0);
  EXPECT_TRUE(m.height_texture);
  EXPECT_EQ(m.height_scale, 0.25f);
  EXPECT_EQ(m.height_level, 0.5f);
  EXPECT_TRUE(load(extras({{"index", 0}})).warned("has no scale above 0"));
  EXPECT_FALSE(load(extras({{"index", 0}})).scene.materials.at(0).height_texture);
  EXPECT_TRUE(load(extras({{"index", 0}, {"scale", 1}, {"level", 2}})).warned("level 2 becomes 1"));
  EXPECT_THAT(error_of(extras({{"index", 3}, {"scale", 1}})), HasSubstr("texture 3 does not exist"));
}

TEST(unit_io_gltf_layers, what_extensions_exclude_is_left_out_and_told) {
  json material = {{"name", "test"},
                   {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.5, 0.5, 1}}}},
                   {"emissiveFactor", {1, 0, 0}},
                   {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 2}}}}}};
  std::set<std::string> layers;
  for (const NumberCase& c : kNumbers) {
    if (std::string(c.extension) == "KHR_materials_scatter") continue;
    layers.insert(c.extension);
    material["extensions"][c.extension][c.key] = c.lower <= 0 ? 0.5 : 2.0;
  }

  material["extensions"]["KHR_materials_pbrSpecularGlossiness"] = json::object();
  Loaded loaded = load(with_material(material));
  for (const std::string& layer : layers) {
    EXPECT_TRUE(loaded.warned("material 'test': " + layer + " is ignored beside KHR_materials_pbrSpecularGlossiness"));
  }
  EXPECT_EQ(loaded.warnings.size(), layers.size());
  EXPECT_EQ(material_lobes(loaded.scene.materials.at(0)), std::vector<std::string_view>{"specular-glossiness"});
  EXPECT_EQ(loaded.scene.materials.at(0).ior, 0);

  material["extensions"]["KHR_materials_unlit"] = json::object();
  loaded = load(with_material(material));
  // For viewers that do not know the extension.
  EXPECT_TRUE(loaded.warnings.empty());
  EXPECT_EQ(loaded.notes.size(), layers.size() + 1);
  EXPECT_TRUE(loaded.noted("KHR_materials_pbrSpecularGlossiness is ignored beside KHR_materials_unlit"));
  const Material& m = loaded.scene.materials.at(0);
  EXPECT_EQ(material_lobes(m), std::vector<std::string_view>{"unlit"});
  EXPECT_FALSE(m.specular_glossiness);
  EXPECT_EQ(m.base_color, vec3(0.5f));
  EXPECT_EQ(m.clearcoat, 0);
  EXPECT_EQ(m.emission, vec3(2, 0, 0));
}

TEST(unit_io_gltf_layers, files_that_require_them_load) {
  Builder b = triangle();
  for (const SlotCase& c : kSlots) b.root["extensionsRequired"].push_back(c.extension);
  for (const NumberCase& c : kNumbers) b.root["extensionsRequired"].push_back(c.extension);
  for (const char* name : {"KHR_materials_pbrSpecularGlossiness", "KHR_materials_variants"}) {
    b.root["extensionsRequired"].push_back(name);
  }
  b.root["extensionsUsed"] = b.root["extensionsRequired"];
  EXPECT_TRUE(load(b).warnings.empty());
}

// ---- what the mesh owes the layers

const Primitive& first(const Loaded& loaded) { return loaded.scene.meshes.at(0).primitives.at(0); }

TEST(unit_io_gltf_layers, uvs_that_a_layer_reads_are_present) {
  for (const SlotCase& c : kSlots) {
    Builder b = with_material({{"extensions", {{c.extension, {{c.key, {{"index", 0}, {"texCoord", 1}}}}}}}});
    b.root["materials"][0]["extensions"].emplace("KHR_materials_volume", json::object());
    add_texture(b);
    const Loaded loaded = load(b);
    EXPECT_EQ(first(loaded).uvs[1].size(), 3u) << c.key;
    EXPECT_TRUE(loaded.warned("TEXCOORD_1, which is missing")) << c.key;
  }
}

TEST(unit_io_gltf_layers, tangents_are_there_when_a_layer_needs_them) {
  for (const SlotCase& c : kSlots) {
    Builder b = with_material({{"extensions", {{c.extension, {{c.key, {{"index", 0}}}}}}}});
    add_texture(b);
    const std::string key = c.key;
    const bool needed = key == "clearcoatNormalTexture" || key == "anisotropyTexture";
    EXPECT_EQ(first(load(b)).tangents.size(), needed ? 3u : 0u) << key;
  }
  const auto strength = [](double value) {
    return first(load(with_material({{"extensions", {{"KHR_materials_anisotropy", {{"anisotropyStrength", value}}}}}})))
        .tangents;
  };
  EXPECT_EQ(strength(0.5), std::vector<vec4>(3, vec4(1, 0, 0, 1)));
  EXPECT_TRUE(strength(0).empty());
}

TEST(unit_io_gltf_layers, tangents_follow_the_normal_then_the_coat_then_the_anisotropy) {
  // Each slot turns its uvs by another quarter: the tangent tells which one was followed.
  const auto turned = [](int quarters) {
    return json{{"index", 0},
                {"extensions", {{"KHR_texture_transform", {{"rotation", quarters * 1.5707963267948966}}}}}};
  };
  json material = {{"normalTexture", turned(0)},
                   {"extensions",
                    {{"KHR_materials_clearcoat", {{"clearcoatNormalTexture", turned(1)}}},
                     {"KHR_materials_anisotropy", {{"anisotropyStrength", 1}, {"anisotropyTexture", turned(2)}}}}}};
  const auto tangent = [&] {
    Builder b = with_material(material);
    add_texture(b);
    return vec3(first(load(b)).tangents.at(0));
  };
  const vec3 normal = tangent();
  EXPECT_NEAR(glm::dot(normal, vec3(1, 0, 0)), 1, 1e-6);
  material.erase("normalTexture");
  const vec3 coat = tangent();
  EXPECT_NEAR(glm::dot(coat, normal), 0, 1e-6);
  material["extensions"].erase("KHR_materials_clearcoat");
  EXPECT_NEAR(glm::dot(tangent(), normal), -1, 1e-6);
  // And the file's own tangents before any of them.
  Builder b = with_material(material);
  add_texture(b);
  primitive(b)["attributes"]["TANGENT"] = b.vec4s({0, -1, 0, -1, 0, -1, 0, -1, 0, -1, 0, -1});
  EXPECT_EQ(first(load(b)).tangents, std::vector<vec4>(3, vec4(0, -1, 0, -1)));
}

TEST(unit_io_gltf_layers, anisotropy_without_uvs_runs_along_circles_of_latitude) {
  Builder b = with_material({{"extensions", {{"KHR_materials_anisotropy", {{"anisotropyStrength", 1}}}}}});
  primitive(b)["attributes"].erase("TEXCOORD_0");
  primitive(b)["attributes"]["NORMAL"] = b.vec3s({0, 0.6f, 0.8f, 1, 0, 0, 0, 1, 0});
  const Loaded loaded = load(b);
  EXPECT_TRUE(loaded.warnings.empty());
  const Primitive& p = first(loaded);
  ASSERT_EQ(p.tangents.size(), 3u);
  EXPECT_TRUE(p.uvs[0].empty());
  EXPECT_EQ(p.tangents[0], vec4(1, 0, 0, 1));
  EXPECT_EQ(p.tangents[1], vec4(0, 0, -1, 1));
  // At the pole any direction will do.
  EXPECT_NEAR(p.tangents[2].y, 0, 1e-6);
  EXPECT_NEAR(glm::length(vec3(p.tangents[2])), 1, 1e-6);
}

// ---- KHR_materials_variants

/// Two primitives and three materials: variant "day" changes the first primitive, "night" both.
Builder variants() {
  Builder b = triangle();
  b.root["materials"] = {{{"name", "plain"}}, {{"name", "sun"}}, {{"name", "moon"}}};
  json& primitives = b.root["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  primitives[0]["material"] = 0;
  primitives[0]["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 1}, {"variants", {0}}},
                                                                       {{"material", 2}, {"variants", {1}}}};
  primitives[1]["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 2}, {"variants", {1, 2}}}};
  b.root["extensions"]["KHR_materials_variants"]["variants"] = {
      {{"name", "day"}}, {{"name", "night"}}, {{"name", "day"}}};
  return b;
}

/// What the primitives wear, and which materials the scene holds.
std::vector<std::string> worn(const Builder& b, const std::string& variant) {
  const Loaded loaded = load(b, LoadOptions{.variant = variant});
  EXPECT_TRUE(loaded.warnings.empty());
  std::vector<std::string> names;
  for (const Primitive& p : loaded.scene.meshes.at(0).primitives) {
    names.push_back(loaded.scene.materials.at(static_cast<std::size_t>(p.material)).name);
  }
  names.push_back(std::to_string(loaded.scene.materials.size()));
  return names;
}

TEST(unit_io_gltf_layers, a_variant_dresses_the_primitives_that_it_maps_and_leaves_the_others) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(worn(variants(), ""), (Names{"plain", "", "2"}));
  EXPECT_EQ(worn(variants(), "day"), (Names{"sun", "", "2"}));
  EXPECT_EQ(worn(variants(), "night"), (Names{"moon", "moon", "1"}));
}

TEST(unit_io_gltf_layers, variants_are_listed_and_an_unknown_one_is_an_error_that_lists_them) {
  Diagnostics diagnostics;
  FileInfo info;
  const auto bytes = variants().glb();
  load_gltf(bytes, {}, diagnostics, LoadOptions(), &info);
  EXPECT_EQ(info.variants, (std::vector<std::string>{"day", "night", "day"}));
  const auto error = [](const Builder& b, const std::string& variant) -> std::string {
    try {
      load(b, LoadOptions{.variant = variant});
    } catch (const Error& e) {
      return e.what();
    }
    return "loaded";
  };
  EXPECT_THAT(error(variants(), "dusk"), HasSubstr("there is no variant 'dusk'; the file has: day, night, day"));
  EXPECT_THAT(error(triangle(), "day"), HasSubstr("there is no variant 'day'; the file has: none"));
  Builder b = variants();
  json& mapping = primitive(b)["extensions"]["KHR_materials_variants"]["mappings"][0];
  mapping["variants"] = {3};
  EXPECT_THAT(error(b, "day"), HasSubstr("/mappings/0/variants/0: variant 3 does not exist (there are 3)"));
  mapping = {{"variants", {0}}, {"material", 9}};
  EXPECT_THAT(error(b, "day"), HasSubstr("/mappings/0/material: material 9 does not exist (there are 3)"));
  EXPECT_EQ(error(b, ""), "loaded");
}

TEST(unit_io_gltf_layers, an_open_file_shows_each_variant_as_a_fresh_one_does_and_reads_its_meshes_once) {
  Builder b = variants();
  json& primitives = b.root["meshes"][0]["primitives"];
  json points = primitives[0];
  points["mode"] = 0;
  primitives.insert(primitives.begin(), points);  // is not read: the others are not counted from 0
  b.root["materials"][2]["extensions"]["KHR_materials_anisotropy"]["anisotropyStrength"] = 1;  // wants tangents
  Diagnostics diagnostics;
  GltfFile file(b.glb(), {}, "test", diagnostics);
  std::vector<std::shared_ptr<const void>> identities;
  for (const char* variant : {"day", "night", "day", "day"}) {
    const Scene scene = file.scene(diagnostics, std::nullopt, variant);
    const Scene fresh = load_gltf(b.glb(), {}, diagnostics, LoadOptions{.variant = variant});
    ASSERT_EQ(scene.meshes.at(0).primitives.size(), 2u);
    for (std::size_t p = 0; p < 2; ++p) {
      const Primitive& one = scene.meshes[0].primitives[p];
      const Primitive& other = fresh.meshes.at(0).primitives.at(p);
      EXPECT_EQ(scene.materials.at(static_cast<std::size_t>(one.material)).name,
                fresh.materials.at(static_cast<std::size_t>(other.material)).name);
      EXPECT_EQ(one.positions, other.positions);
      EXPECT_EQ(one.tangents, other.tangents) << variant;
      EXPECT_EQ(one.triangles, other.triangles);
    }
    identities.push_back(scene.meshes[0].identity);
  }
  EXPECT_NE(identities[0], identities[1]) << "who knows the first must not take the second for it";
  EXPECT_EQ(identities[2], identities[3]);
  EXPECT_NE(identities[3], nullptr);
}

}  // namespace
}  // namespace candela::io::test
