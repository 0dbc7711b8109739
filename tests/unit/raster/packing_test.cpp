#include "raster/packing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "unit/path/scenes.h"

namespace candela::raster {
namespace {

using namespace test;

/// Texels that tell of their image and channel.
std::vector<std::uint8_t> texels(int size, int seed) {
  std::vector<std::uint8_t> rgba(static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * 4);
  for (std::size_t i = 0; i < rgba.size(); ++i)
    rgba[i] = static_cast<std::uint8_t>(10 * seed + static_cast<int>(i % 4));
  return rgba;
}

class packing : public testing::Test {  // NOLINT(readability-identifier-naming): as its suite
 protected:
  packing() {
    material_.emission = vec3(1.0f);
    for (int i = 0; i < 5; ++i) textures_.push_back(builder_.add_texture(4, 4, texels(4, i + 1)));
    for (std::size_t i = 0; i < 5; ++i) *texture_slots(material_)[i] = slot(textures_[i]);
  }

  std::vector<PackedMaterial> pack(const std::vector<Material>& materials) {
    for (const Material& m : materials) builder_.add_material(m);
    return pack_textures(builder_.scene());
  }
  PackedMaterial pack() { return pack({material_})[0]; }

  /// How many textures are read.
  static std::ptrdiff_t count(const PackedMaterial& m) {
    return std::count_if(m.slots.begin(), m.slots.end(), [](const TextureSource& s) { return s.image >= 0; });
  }

  /// The number that a material finds in a channel: 10 times the image, counted from 1, and the component it was.
  int found(const PackedMaterial& m, const Channel& channel) {
    const TextureSource& source = m.slots[static_cast<std::size_t>(channel.slot)];
    const Scene& scene = builder_.scene();
    const std::vector<std::uint8_t> rgba = source.is_packed()
                                               ? packed_texels(scene, source)
                                               : scene.images[static_cast<std::size_t>(source.image)]->pixels;
    return rgba[static_cast<std::size_t>(4 * 5 + channel.component)];
  }

  void expect_numbers(const PackedMaterial& m) {
    EXPECT_EQ(found(m, m.channels.roughness), 21);
    EXPECT_EQ(found(m, m.channels.metallic), 22);
    EXPECT_EQ(found(m, m.channels.occlusion), 40);
    for (const Slot host : {base_color_slot, normal_slot, emissive_slot}) {
      for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(found(m, {static_cast<int>(host), c}), 10 * (static_cast<int>(host) + 1) + c);
      }
    }
  }

  SceneBuilder builder_;
  Material material_;
  std::vector<int> textures_;
};

TEST_F(packing, five_textures_of_one_size_become_three) {
  const PackedMaterial m = pack();
  EXPECT_EQ(count(m), 3);
  expect_numbers(m);
}

TEST_F(packing, without_light_of_its_own_five_become_four) {
  material_.emission = vec3(0.0f);
  const PackedMaterial m = pack();
  EXPECT_EQ(count(m), 4);  // the emissive texture, which nobody reads, among them
  expect_numbers(m);
}

TEST_F(packing, occlusion_beside_roughness_is_read_with_it) {
  material_.occlusion_texture = material_.metallic_roughness_texture;
  material_.emissive_texture = {};
  const PackedMaterial m = pack();
  EXPECT_EQ(count(m), 3);
  EXPECT_FALSE(m.slots[metallic_roughness_slot].is_packed());
  EXPECT_EQ(m.channels.occlusion, (Channel{metallic_roughness_slot, 0}));
}

TEST_F(packing, occlusion_moves_in_with_roughness_where_alphas_are_few) {
  material_.emission = vec3(0.0f);
  material_.alpha_mode = AlphaMode::mask;
  const PackedMaterial m = pack();
  EXPECT_EQ(count(m), 4);
  EXPECT_EQ(m.channels.occlusion, (Channel{metallic_roughness_slot, 0}));
  expect_numbers(m);
}

TEST_F(packing, alpha_that_is_read_stays) {
  for (const AlphaMode mode : {AlphaMode::mask, AlphaMode::blend}) {
    material_.alpha_mode = mode;
    builder_.scene().materials.clear();
    const PackedMaterial m = pack();
    EXPECT_FALSE(m.slots[base_color_slot].is_packed());
    EXPECT_EQ(found(m, {base_color_slot, 3}), 13);
    expect_numbers(m);
  }
}

TEST_F(packing, only_textures_that_are_read_alike_share) {
  const auto is_apart = [&](const Material& m) {
    builder_.scene().materials.clear();
    const PackedMaterial packed = pack({m})[0];
    return packed.channels.roughness.slot == metallic_roughness_slot &&
           packed.channels.occlusion.slot == occlusion_slot;
  };
  Material other_size = material_;
  for (TextureSlot* s : {&other_size.metallic_roughness_texture, &other_size.occlusion_texture}) {
    *s = slot(builder_.add_texture(8, 4, std::vector<std::uint8_t>(128)));
  }
  other_size.occlusion_texture.transform[2] = vec2(0.25f, 0.0f);
  EXPECT_TRUE(is_apart(other_size));
  Material other_set = material_;
  other_set.metallic_roughness_texture.uv_set = 1;
  other_set.occlusion_texture.transform[0] = vec2(2.0f, 0.0f);
  EXPECT_TRUE(is_apart(other_set));
  Material other_filter = material_;
  other_filter.metallic_roughness_texture = slot(builder_.add_texture(4, 4, texels(4, 2), Filter::nearest));
  other_filter.occlusion_texture = slot(builder_.add_texture(4, 4, texels(4, 4)));
  builder_.scene().textures.back().wrap_v = Wrap::clamp_to_edge;
  EXPECT_TRUE(is_apart(other_filter));
  Material other_wrap = other_filter;
  other_wrap.metallic_roughness_texture = slot(builder_.add_texture(4, 4, texels(4, 2)));
  builder_.scene().textures.back().wrap_u = Wrap::mirrored_repeat;
  EXPECT_TRUE(is_apart(other_wrap));
  Material deep = material_;
  for (TextureSlot* s : {&deep.metallic_roughness_texture, &deep.occlusion_texture}) {
    *s = slot(builder_.add_texture_16(4, 4, std::vector<std::uint16_t>(64), Filter::linear, Wrap::repeat));
  }
  deep.occlusion_texture.uv_set = 1;
  EXPECT_TRUE(is_apart(deep));
  Material deep_host = material_;
  for (TextureSlot* s : {&deep_host.base_color_texture, &deep_host.normal_texture, &deep_host.emissive_texture}) {
    *s = slot(builder_.add_texture_16(4, 4, std::vector<std::uint16_t>(64), Filter::linear, Wrap::repeat));
  }
  deep_host.occlusion_texture.uv_set = 1;
  EXPECT_TRUE(is_apart(deep_host));
}

TEST_F(packing, an_image_that_two_materials_want_in_two_ways_is_left_alone) {
  Material other = material_;
  other.metallic_roughness_texture = slot(builder_.add_texture(4, 4, texels(4, 7)));
  const std::vector<PackedMaterial> disputed = pack({material_, other});
  for (const PackedMaterial& m : disputed) EXPECT_EQ(count(m), 5);
  expect_numbers(disputed[0]);
  // Two that want the same share it.
  SceneBuilder fresh;
  std::swap(builder_, fresh);
  for (int i = 0; i < 5; ++i) builder_.add_texture(4, 4, texels(4, i + 1));
  other = material_;
  other.roughness = 0.5f;
  const std::vector<PackedMaterial> agreed = pack({material_, other});
  EXPECT_EQ(agreed[0].slots, agreed[1].slots);
  EXPECT_EQ(count(agreed[0]), 3);
}

TEST_F(packing, unlit_materials_are_as_they_were) {
  material_.unlit = true;
  EXPECT_EQ(count(pack()), 5);
}

}  // namespace
}  // namespace candela::raster
