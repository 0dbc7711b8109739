#include "scene/material_table.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "scene/surface_params.h"

namespace candela {
namespace {

TEST(unit_material_table, names_and_places_are_those_of_one_row) {
  std::set<std::string_view> names;
  std::set<std::string> sources;
  for (const MaterialProperty& row : kMaterialProperties) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_EQ(property_of(row.member).name, row.name);
    if (row.source.is_special()) continue;
    const std::string source =
        std::string(row.source.place) + '/' + std::string(row.source.key) + '/' + std::to_string(row.source.first);
    EXPECT_TRUE(sources.insert(source).second) << source;
  }
  std::set<std::string_view> slots, keys;
  for (std::size_t i = 0; i < kTextureSlots; ++i) {
    EXPECT_TRUE(slots.insert(kTextureRows[i].name).second) << kTextureRows[i].name;
    EXPECT_TRUE(keys.insert(kTextureRows[i].source.key).second) << kTextureRows[i].source.key;
    EXPECT_EQ(texture_slot_index(kTextureRows[i].slot), i);
  }
}

TEST(unit_material_table, a_material_is_in_range_unless_it_says_otherwise) {
  const Material m;
  for (const MaterialProperty& row : kMaterialProperties) {
    for (int i = 0; i < row.member.size(); ++i) EXPECT_TRUE(row.range.contains(row.member.at(m, i))) << row.name;
  }
}

TEST(unit_material_table, each_lobe_has_one_switch_and_a_name) {
  int switched = 0;
  for (const MaterialProperty& row : kMaterialProperties) {
    if (!row.lobe.is_switch) continue;
    EXPECT_EQ(switched & row.lobe.bit, 0) << row.name;
    switched |= row.lobe.bit;
    Material m;
    row.member.at(m, 0) = 0.5f;
    EXPECT_EQ(lobes_of(m), row.lobe.bit) << row.name;
  }
  int named = 0;
  for (const LobeRow& lobe : kLobes) named |= lobe.bit;
  EXPECT_EQ(named, switched);
  EXPECT_EQ(lobes_of(Material{}), 0);
}

TEST(unit_material_table, every_number_of_a_surface_is_the_materials_own) {
  Material m;
  float value = 0.1f;
  for (const MaterialProperty& row : kMaterialProperties) {
    for (int i = 0; i < row.member.size(); ++i) row.member.at(m, i) = value += 0.01f;
  }
  shade::SurfaceParams p = surface_params(m, shade::shading_model_candela());
  for (const MaterialProperty& row : kMaterialProperties) {
    for (int i = 0; row.param && i < row.member.size(); ++i) {
      EXPECT_EQ(row.param.at(p, i), row.member.at(m, i)) << row.name;
    }
  }
}

TEST(unit_material_table, a_texel_is_a_factor_of_what_its_rows_say) {
  Material m;
  m.iridescence_thickness_min_nm = 200.0f, m.iridescence_thickness_max_nm = 600.0f;
  const vec4 texel(0.2f, 0.25f, 0.3f, 0.4f);
  const auto after = [&](auto slot) {
    shade::SurfaceParams p = surface_params(m, shade::shading_model_candela());
    p.specular = p.sheen_roughness = 1.0f;
    apply_texel<slot>(texel, m, p);
    return p;
  };
  using std::integral_constant;
  const auto rough = after(integral_constant<std::size_t, texture_slot_index(&Material::metallic_roughness_texture)>());
  EXPECT_EQ(rough.roughness, 0.25f);
  EXPECT_EQ(rough.metallic, 0.3f);
  EXPECT_EQ(after(integral_constant<std::size_t, texture_slot_index(&Material::specular_texture)>()).specular, 0.4f);
  EXPECT_EQ(after(integral_constant<std::size_t, texture_slot_index(&Material::base_color_texture)>()).base_color,
            vec3(texel));
  // From one end to the other.
  EXPECT_EQ(
      after(integral_constant<std::size_t, texture_slot_index(&Material::iridescence_thickness_texture)>()).film_nm,
      300.0f);
}

TEST(unit_material_table, a_texture_is_hidden_by_zeros_and_by_absent_lobes) {
  const auto shows = [](const Material& m, TextureSlot Material::*slot) {
    return has_effect(m, texture_slot_index(slot));
  };
  Material m;
  EXPECT_TRUE(shows(m, &Material::metallic_roughness_texture));
  EXPECT_FALSE(shows(m, &Material::clearcoat_texture));
  m.clearcoat_roughness = 0.5f;
  EXPECT_FALSE(shows(m, &Material::clearcoat_roughness_texture));
  m.clearcoat = 1.0f;
  EXPECT_TRUE(shows(m, &Material::clearcoat_roughness_texture));
  m.clearcoat_normal_scale = 0.0f;
  EXPECT_FALSE(shows(m, &Material::clearcoat_normal_texture));
  // One of two factors is enough.
  m.metallic = 0.0f;
  EXPECT_TRUE(shows(m, &Material::metallic_roughness_texture));
  m.roughness = 0.0f;
  EXPECT_FALSE(shows(m, &Material::metallic_roughness_texture));
  // Alpha counts where something may show through.
  m.base_color = vec3(0.0f);
  EXPECT_FALSE(shows(m, &Material::base_color_texture));
  m.alpha_mode = AlphaMode::blend;
  EXPECT_TRUE(shows(m, &Material::base_color_texture));
  // The thinnest place of a film is where its texture is black.
  m.iridescence = 1.0f, m.iridescence_thickness_max_nm = 0.0f;
  EXPECT_TRUE(shows(m, &Material::iridescence_thickness_texture));
  m.iridescence_thickness_min_nm = 0.0f;
  EXPECT_FALSE(shows(m, &Material::iridescence_thickness_texture));
  // No number of its own, and always read.
  EXPECT_TRUE(shows(m, &Material::specular_glossiness_texture));
  // Scattering needs a body, or a sheet that scatters.
  m.multiscatter_color = vec3(0.5f);
  EXPECT_FALSE(shows(m, &Material::multiscatter_color_texture));
  m.thickness = 1.0f;
  EXPECT_TRUE(shows(m, &Material::multiscatter_color_texture));
}

}  // namespace
}  // namespace candela
