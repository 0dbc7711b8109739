#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>

#include "scene/material_table.h"
#include "unit/base/temp_folder.h"
#include "unit/io/gltf_builder.h"

namespace candela::io::test {
namespace {

using ::testing::HasSubstr;

json texture(int index, int set = 0) { return {{"index", index}, {"texCoord", set}}; }

TEST(unit_io_gltf_material, defaults_are_those_of_the_specification) {
  const Loaded loaded = load(triangle());
  ASSERT_EQ(loaded.scene.materials.size(), 1u);
  const Material& m = loaded.scene.materials[0];
  EXPECT_EQ(m.base_color, vec3(1));
  EXPECT_EQ(m.metallic, 1);
  EXPECT_EQ(m.roughness, 1);
  EXPECT_EQ(m.emission, vec3(0));
  EXPECT_EQ(m.alpha_mode, AlphaMode::opaque);
  EXPECT_FALSE(m.double_sided);
  EXPECT_FALSE(m.base_color_texture);
}

TEST(unit_io_gltf_material, every_factor_and_slot_arrives) {
  Builder b = with_material({{"name", "all"},
                             {"pbrMetallicRoughness",
                              {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}},
                               {"metallicFactor", 0.5},
                               {"roughnessFactor", 0.6},
                               {"baseColorTexture", texture(0)},
                               {"metallicRoughnessTexture", texture(1)}}},
                             {"normalTexture", {{"index", 2}, {"scale", -2}}},
                             {"occlusionTexture", {{"index", 3}, {"strength", 0.7}, {"texCoord", 1}}},
                             {"emissiveTexture", texture(4)},
                             {"emissiveFactor", {0.5, 0.25, 1}},
                             {"alphaMode", "MASK"},
                             {"alphaCutoff", 0.25},
                             {"doubleSided", true},
                             {"extensions",
                              {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}},
                               {"KHR_materials_ior", {{"ior", 1.33}}},
                               {"KHR_materials_specular",
                                {{"specularFactor", 0.9},
                                 {"specularTexture", texture(5)},
                                 {"specularColorFactor", {2, 1, 0.5}},
                                 {"specularColorTexture", texture(6)}}}}}});
  for (int i = 0; i < 7; ++i) add_texture(b);
  primitive(b)["attributes"]["TEXCOORD_1"] = primitive(b)["attributes"]["TEXCOORD_0"];
  const Loaded loaded = load(b);
  EXPECT_TRUE(loaded.warnings.empty());
  const Material& m = loaded.scene.materials.at(0);
  EXPECT_EQ(m.name, "all");
  EXPECT_EQ(m.base_color, vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(m.opacity, 0.4f);
  EXPECT_EQ(m.metallic, 0.5f);
  EXPECT_EQ(m.roughness, 0.6f);
  EXPECT_EQ(m.normal_scale, -2);
  EXPECT_EQ(m.occlusion_strength, 0.7f);
  EXPECT_EQ(m.emission, vec3(4, 2, 8));
  EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
  EXPECT_EQ(m.alpha_cutoff, 0.25f);
  EXPECT_TRUE(m.double_sided);
  EXPECT_FALSE(m.unlit);
  EXPECT_EQ(m.ior, 1.33f);
  EXPECT_EQ(m.specular, 0.9f);
  EXPECT_EQ(m.specular_color, vec3(2, 1, 0.5f));
  EXPECT_EQ(m.base_color_texture.texture, 0);
  EXPECT_EQ(m.metallic_roughness_texture.texture, 1);
  EXPECT_EQ(m.normal_texture.texture, 2);
  EXPECT_EQ(m.occlusion_texture.texture, 3);
  EXPECT_EQ(m.occlusion_texture.uv_set, 1);
  EXPECT_EQ(m.emissive_texture.texture, 4);
  EXPECT_EQ(m.specular_texture.texture, 5);
  EXPECT_EQ(m.specular_color_texture.texture, 6);
}

TEST(unit_io_gltf_material, factors_out_of_range_are_clamped_and_told_with_the_materials_name) {
  const Loaded loaded =
      load(with_material({{"name", "loud"},
                          {"pbrMetallicRoughness",
                           {{"baseColorFactor", {2, 0, 0, -1}}, {"metallicFactor", 1.5}, {"roughnessFactor", -0.5}}},
                          {"emissiveFactor", {0, 3, 0}},
                          {"alphaCutoff", -1},
                          {"extensions", {{"KHR_materials_ior", {{"ior", 0.5}}}}}}));
  const Material& m = loaded.scene.materials.at(0);
  EXPECT_EQ(m.base_color, vec3(1, 0, 0));
  EXPECT_EQ(m.opacity, 0);
  EXPECT_EQ(m.metallic, 1);
  EXPECT_EQ(m.roughness, 0);
  EXPECT_EQ(m.emission, vec3(0, 3, 0));
  EXPECT_EQ(m.alpha_cutoff, 0);
  EXPECT_EQ(m.ior, 1);
  EXPECT_TRUE(loaded.warned("material 'loud': metallicFactor 1.5 becomes 1"));
  EXPECT_TRUE(loaded.warned("material 'loud': ior 0.5 becomes 1"));
  EXPECT_EQ(loaded.warnings.size(), 7u);
  EXPECT_EQ(load(with_material({{"extensions", {{"KHR_materials_ior", {{"ior", 0}}}}}})).scene.materials[0].ior, 0);
}

TEST(unit_io_gltf_material, an_emissive_factor_above_1_keeps_its_hue_and_strength) {
  json material = {{"emissiveFactor", {3, 2, 1}}};
  const Loaded loaded = load(with_material(material));
  EXPECT_EQ(loaded.scene.materials.at(0).emission, vec3(3, 2, 1));
  EXPECT_TRUE(loaded.warned("material 0: emissiveFactor 3 2 1 is above 1; kept"));
  material["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", 2}};
  EXPECT_EQ(load(with_material(material)).scene.materials.at(0).emission, vec3(6, 4, 2));
  const Loaded negative = load(with_material({{"emissiveFactor", {-1, 0.5, 0}}}));
  EXPECT_EQ(negative.scene.materials.at(0).emission, vec3(0, 0.5f, 0));
  EXPECT_EQ(negative.warnings.size(), 1u);
  EXPECT_TRUE(load(with_material({{"emissiveFactor", {1, 1, 1}}})).warnings.empty());
}

TEST(unit_io_gltf_material, wrong_types_and_values_are_errors) {
  EXPECT_THAT(error_of(with_material({{"alphaMode", "CUTOUT"}})), HasSubstr("#/materials/0/alphaMode: must be OPAQUE"));
  EXPECT_THAT(error_of(with_material({{"doubleSided", 1}})), HasSubstr("must be true or false, not number"));
  EXPECT_THAT(error_of(with_material({{"pbrMetallicRoughness", {{"metallicFactor", "0.5"}}}})),
              HasSubstr("/metallicFactor: must be a number, not string"));
  EXPECT_THAT(error_of(with_material({{"emissiveFactor", {1, 1}}})), HasSubstr("must have 3 numbers, not 2"));
  EXPECT_THAT(error_of(with_material({{"normalTexture", {{"index", 0}}}})),
              HasSubstr("texture 0 does not exist (there are 0)"));
  EXPECT_THAT(error_of(with_material({{"normalTexture", json::object()}})), HasSubstr("'index' is missing"));
  EXPECT_THAT(
      error_of(with_material({{"emissiveFactor", {1, 1, 1}},
                              {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 1e39}}}}}})),
      HasSubstr("not finite"));
  Builder b = with_material(json::object());
  primitive(b)["material"] = 3;
  EXPECT_THAT(error_of(b), HasSubstr("#/meshes/0/primitives/0/material: material 3 does not exist (there are 1)"));
}

TEST(unit_io_gltf_material, samplers_become_wrap_and_filter) {
  Builder b = with_material({{"pbrMetallicRoughness", {{"baseColorTexture", texture(0)}}}});
  add_texture(b);
  const auto sampled = [&](const json& sampler) {
    b.root["samplers"] = {sampler};
    b.root["textures"][0]["sampler"] = 0;
    return load(b);
  };
  const Texture t =
      sampled({{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}, {"minFilter", 9987}}).scene.textures.at(0);
  EXPECT_EQ(t.wrap_u, Wrap::clamp_to_edge);
  EXPECT_EQ(t.wrap_v, Wrap::mirrored_repeat);
  EXPECT_EQ(t.filter, Filter::nearest);
  const Texture standard = sampled(json::object()).scene.textures.at(0);
  EXPECT_EQ(standard.wrap_u, Wrap::repeat);
  EXPECT_EQ(standard.wrap_v, Wrap::repeat);
  EXPECT_EQ(standard.filter, Filter::linear);
  EXPECT_TRUE(sampled({{"wrapS", 5}}).warned("not a wrap mode"));
  EXPECT_TRUE(sampled({{"magFilter", 5}}).warned("magFilter 5"));
  b.root["textures"][0]["sampler"] = 2;
  EXPECT_THAT(error_of(b), HasSubstr("#/textures/0/sampler: sampler 2 does not exist"));
}

TEST(unit_io_gltf_material, texture_transforms_scale_then_rotate_then_move) {
  Builder b = with_material(
      {{"pbrMetallicRoughness",
        {{"baseColorTexture",
          {{"index", 0},
           {"texCoord", 0},
           {"extensions",
            {{"KHR_texture_transform",
              {{"offset", {10, 20}}, {"rotation", 1.5707963267948966}, {"scale", {2, 3}}, {"texCoord", 1}}}}}}}}}});
  add_texture(b);
  primitive(b)["attributes"]["TEXCOORD_1"] = primitive(b)["attributes"]["TEXCOORD_0"];
  const TextureSlot slot = load(b).scene.materials[0].base_color_texture;
  EXPECT_EQ(slot.uv_set, 1);
  // A quarter turn, counter-clockwise with v down: (u, v) → (v, -u).
  const vec2 uv = slot.apply(vec2(1, 1));
  EXPECT_NEAR(uv.x, 13, 1e-5);
  EXPECT_NEAR(uv.y, 18, 1e-5);
}

TEST(unit_io_gltf_material, texture_rotation_is_that_of_the_sample_asset) {
  // TextureTransformTest, quad "Rotation": the arrow's tip lies at uv 0.7778, 0.7778 of its image, and the green marker
  // that it has to meet stands at uv 0.4210, 1.0163 of the quad (the red one, for the opposite sense, at 1.0163,
  // 0.4210).
  Builder b = with_material(
      {{"emissiveTexture",
        {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"rotation", 0.39269908169872414}}}}}}}});
  add_texture(b);
  const vec2 uv = load(b).scene.materials[0].emissive_texture.apply(vec2(0.42095178f, 1.01626749f));
  EXPECT_NEAR(uv.x, 0.7778f, 1e-3f);
  EXPECT_NEAR(uv.y, 0.7778f, 1e-3f);
}

TEST(unit_io_gltf_material, textures_that_cannot_be_used_are_left_out_and_told) {
  Builder b = with_material({{"emissiveTexture", texture(0, 1000)}});
  add_texture(b);
  Loaded loaded = load(b);
  EXPECT_TRUE(loaded.warned("emissiveTexture uses TEXCOORD_1000"));
  EXPECT_TRUE(loaded.scene.textures.empty());
  b.root["materials"][0]["emissiveTexture"]["texCoord"] = 0;
  b.root["textures"][0] = {{"extensions", {{"MSFT_texture_dds", {{"source", 0}}}}}};
  loaded = load(b);
  EXPECT_TRUE(loaded.warned("has no image in a format that is read"));
  EXPECT_FALSE(loaded.scene.materials[0].emissive_texture);
}

TEST(unit_io_gltf_material, what_an_unreadable_texture_should_make_glow_is_dark) {
  Builder b = with_material({{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", texture(0)}});
  add_texture(b);
  EXPECT_EQ(load(b).scene.materials.at(0).emission, vec3(1));
  b.root["textures"][0] = {{"extensions", {{"MSFT_texture_dds", {{"source", 0}}}}}};
  EXPECT_EQ(load(b).scene.materials.at(0).emission, vec3(0)) << "a format that is not read";
  b.root["textures"][0] = {{"source", 0}};
  b.root["images"][0] = {{"uri", "absent.png"}};
  EXPECT_EQ(load(b).scene.materials.at(0).emission, vec3(0)) << "a file that is not there";
}

TEST(unit_io_gltf_material, images_are_decoded_once_from_views_and_data_uris) {
  Builder b =
      with_material({{"emissiveTexture", texture(2)}, {"occlusionTexture", texture(1)}, {"normalTexture", texture(3)}});
  for (int i = 0; i < 3; ++i) add_texture(b);
  b.root["images"].push_back({{"uri", "data:image/png;base64," + base64(tiny_png())}});
  b.root["textures"][2]["source"] = 1;
  b.root["textures"].push_back({{"source", 3}});
  const Loaded loaded = load(b);
  ASSERT_EQ(loaded.scene.textures.size(), 3u);
  ASSERT_EQ(loaded.scene.images.size(), 2u);
  EXPECT_EQ(loaded.scene.textures[0].image, loaded.scene.textures[1].image);
  for (const auto& image : loaded.scene.images) {
    EXPECT_EQ(image->width, 1);
    EXPECT_EQ(image->pixels, (std::vector<std::uint8_t>{200, 100, 50, 128}));
  }
}

TEST(unit_io_gltf_material, without_decoding_images_have_only_a_size) {
  Builder b = with_material({{"emissiveTexture", texture(0)}});
  add_texture(b);
  const Loaded loaded = load(b, LoadOptions{.decode_images = false});
  EXPECT_EQ(loaded.scene.images.at(0)->width, 1);
  EXPECT_EQ(loaded.scene.images.at(0)->height, 1);
  EXPECT_TRUE(loaded.scene.images.at(0)->pixels.empty());
}

TEST(unit_io_gltf_material, an_image_that_cannot_be_read_is_told_and_changes_nothing) {
  json material = {{"pbrMetallicRoughness",
                    {{"baseColorFactor", {0.5, 0.25, 1, 0.75}},
                     {"metallicFactor", 0.25},
                     {"roughnessFactor", 0.5},
                     {"baseColorTexture", texture(0)},
                     {"metallicRoughnessTexture", texture(0)}}},
                   {"normalTexture", texture(0)},
                   {"occlusionTexture", texture(0)},
                   {"emissiveTexture", texture(1)},
                   {"emissiveFactor", {0.5, 0.5, 0.5}},
                   {"extras", {{"candela", {{"heightTexture", {{"index", 0}, {"scale", 0.5}}}}}}}};
  Builder b = with_material(material);
  std::vector<std::byte> png = tiny_png(), jpeg(64, std::byte{0xFF}), ktx(64);
  png.resize(45);
  jpeg[1] = std::byte{0xD8};
  std::memcpy(ktx.data(), "\xABKTX 20\xBB\r\n\x1A\n", 12);
  add_texture(b);
  add_texture(b);
  const int short_view = b.view(png), jpeg_view = b.view(jpeg), ktx_view = b.view(ktx), far_view = b.view(png);
  b.root["bufferViews"][static_cast<std::size_t>(far_view)]["byteOffset"] = 1 << 30;
  const candela::test::TempFolder folder;
  std::filesystem::create_directory(folder.path() / "folder.png");

  struct Case {
    json image;
    const char* told;
  };
  const std::vector<Case> cases = {
      {{{"bufferView", short_view}, {"name", "wood"}}, "#/images/0 (wood): "},
      {{{"bufferView", jpeg_view}}, "#/images/0: "},
      {{{"bufferView", ktx_view}}, "a texture of 0 x 0 texels"},
      {{{"bufferView", far_view}}, "lie outside the buffer"},
      {{{"bufferView", 77}}, "buffer view 77 does not exist"},
      {{{"uri", "data:image/png;base64,AAAA"}}, "#/images/0: "},
      {{{"uri", "data:image/png;base64,****"}}, "not valid base64"},
      {{{"uri", "data:image/png"}}, "has no comma"},
      {{{"uri", "absent.png"}}, "#/images/0/uri: 'absent.png'"},
      {{{"uri", "folder.png"}}, "#/images/0/uri: 'folder.png'"},
      {{{"uri", "https://example.org/wood.png"}}, "is not a relative file name"},
      {{{"name", "nothing"}}, "neither a uri nor a bufferView"},
      {{{"uri", "a.png"}, {"bufferView", short_view}}, "both a uri and a bufferView"},
  };
  for (const bool decode : {true, false}) {
    for (const Case& c : cases) {
      b.root["images"][0] = c.image;
      Diagnostics diagnostics;
      const auto bytes = b.glb();
      const Scene scene = load_gltf(bytes, folder.path(), diagnostics, LoadOptions{.decode_images = decode});
      const bool is_whole = !decode && std::string(c.told) == "#/images/0 (wood): ";  // its header is
      ASSERT_EQ(diagnostics.warnings().size(), is_whole ? 0u : 1u) << c.image;
      if (is_whole) continue;
      EXPECT_THAT(diagnostics.warnings()[0].text(), HasSubstr(c.told));
      EXPECT_THAT(diagnostics.warnings()[0].text(), HasSubstr("shown without it"));
      const Material& m = scene.materials.at(0);
      EXPECT_EQ(m.base_color, vec3(0.5f, 0.25f, 1));
      EXPECT_EQ(m.opacity, 0.75f);
      EXPECT_EQ(m.metallic, 0.25f);
      EXPECT_EQ(m.roughness, 0.5f);
      EXPECT_EQ(m.height_scale, 0.0f);
      EXPECT_EQ(m.emission, vec3(0.5f)) << "its own texture is there";
      for (const TextureSlot* slot : texture_slots(m)) EXPECT_EQ(bool(*slot), slot == &m.emissive_texture);
      EXPECT_EQ(scene.images.size(), 2u);
      if (decode) {
        EXPECT_NO_THROW(validate(scene));
      }
    }
  }
}

TEST(unit_io_gltf_material, an_image_lost_at_one_moment_is_lost_at_all) {
  Builder b = with_material({{"pbrMetallicRoughness", {{"baseColorTexture", texture(0)}}}});
  b.root["images"] = {{{"uri", "absent.png"}}};
  b.root["textures"] = {{{"source", 0}}};
  Diagnostics diagnostics;
  GltfFile file(b.glb(), {}, "lost", diagnostics);
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(file.scene(diagnostics).materials.at(0).base_color_texture);
  EXPECT_EQ(diagnostics.warnings().size(), 1u);
}

}  // namespace
}  // namespace candela::io::test
