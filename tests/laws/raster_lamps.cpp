#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "raster/render.h"
#include "unit/gl/gl_fixture.h"
#include "unit/path/scenes.h"

// What lights a scene: lamps are where the surface glows, however a file packs it.

namespace candela {
namespace {

using namespace test;

class law_raster_lamps : public NeedsGl {};  // NOLINT(readability-identifier-naming): a suite is named as its laws

constexpr int kSize = 48;

raster::Settings drawn() {
  raster::Settings s;
  s.width = s.height = kSize;
  s.msaa = 1;
  return s;
}

Image draw(const Scene& scene, const View& view, const raster::Settings& settings = drawn(),
           const Environment& environment = dark_environment()) {
  raster::Statistics statistics;
  Image image = raster::render(scene, environment, view, settings, {}, &statistics).beauty;
  EXPECT_EQ(statistics.non_finite_pixels, 0u);
  return image;
}

double difference(const Image& expected, const Image& found) {
  double sum = 0.0, weight = 0.0;
  for (int y = 0; y < expected.height; ++y) {
    for (int x = 0; x < expected.width; ++x) {
      sum += static_cast<double>(luminance(glm::abs(expected.rgb(x, y) - found.rgb(x, y))));
      weight += static_cast<double>(luminance(expected.rgb(x, y)));
    }
  }
  return sum / weight;
}

Primitive joined(Primitive a, const Primitive& b) {
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  a.normals.insert(a.normals.end(), b.normals.begin(), b.normals.end());
  for (std::size_t set = 0; set < 2; ++set) {
    a.uvs[set].insert(a.uvs[set].end(), b.uvs[set].begin(), b.uvs[set].end());
  }
  for (const uvec3& t : b.triangles) a.triangles.push_back(t + first);
  return a;
}

Primitive with_uv(Primitive p, vec2 uv, std::size_t set = 0) {
  if (set == 1) p.uvs[0].assign(p.positions.size(), vec2(0.0f));
  p.uvs[set].assign(p.positions.size(), uv);
  return p;
}

/// Faces down.
Primitive ceiling_panel(vec3 corner, float side) { return quad(corner, {side, 0, 0}, {0, 0, side}); }

View floor_view() { return look_at({0.0f, 3.0f, 4.0f}, vec3(0.0f), 0.8f); }

TEST_F(law_raster_lamps, panels_of_one_primitive_are_lamps_of_their_own) {
  const Primitive left = ceiling_panel({-2.2f, 1.0f, -0.2f}, 0.4f), right = ceiling_panel({1.8f, 1.0f, -0.2f}, 0.4f);
  SceneBuilder one, two;
  for (SceneBuilder* b : {&one, &two}) b->add(plane(vec3(0.0f), 3.0f), matte(vec3(0.8f)));
  one.add(joined(left, right), lamp(vec3(10.0f)));
  two.add(left, lamp(vec3(10.0f)));
  two.add(right, lamp(vec3(10.0f)));
  const View view = from_above(0.9f, 2.5f);
  const Image expected = draw(two.build(), view), found = draw(one.build(), view);
  EXPECT_LT(difference(expected, found), 0.005);
  EXPECT_GT(found.rgb(6, kSize / 2).x, 8.0f * found.rgb(kSize / 2, kSize / 2).x) << "between them it is dark";
}

/// A leaf before a panel, seen from the other side: mean over the leaf.
Scene leaf_before_panel(float transmission) {
  Material leaf = matte(vec3(0.8f));
  leaf.double_sided = true;
  leaf.diffuse_transmission = transmission;
  SceneBuilder b;
  b.add(quad({-0.5f, -0.5f, 0.0f}, {1, 0, 0}, {0, 1, 0}), leaf);
  b.add(quad({-1.0f, -1.0f, -2.0f}, {2, 0, 0}, {0, 2, 0}), lamp(vec3(5.0f)));
  return b.build();
}

TEST_F(law_raster_lamps, of_lamps_at_one_place_one_shines) {
  const Material floor = matte(vec3(0.8f));
  const Primitive panel = ceiling_panel({-0.3f, 1.0f, -0.3f}, 0.6f);
  const auto lit_by = [&](const std::vector<Primitive>& lamps, const std::vector<float>& strengths) {
    SceneBuilder b;
    b.add(quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}), floor);
    for (std::size_t i = 0; i < lamps.size(); ++i) b.add(lamps[i], lamp(vec3(strengths[i])));
    return draw(b.build(), floor_view());
  };
  const Image one = lit_by({panel}, {4.0f});
  EXPECT_GT(mean_luminance(one), 0.01);
  EXPECT_LT(difference(one, lit_by({panel, panel}, {4.0f, 4.0f})), 1e-3);
  EXPECT_LT(difference(one, lit_by({panel, panel}, {20.0f, 4.0f})), 1e-3) << "the later one is seen";
  EXPECT_LT(difference(one, lit_by({joined(panel, panel)}, {4.0f})), 1e-3);
  // One that is seen from the other side is another lamp.
  const vec3 below = one.rgb(kSize / 2, kSize - 1);
  const vec3 found = lit_by({panel, turned_inside_out(panel)}, {4.0f, 9.0f}).rgb(kSize / 2, kSize - 1);
  EXPECT_NEAR(luminance(found), luminance(below), 1e-3f * luminance(below));
  EXPECT_GT(difference(one, lit_by({panel, moved(panel, {0.7f, 0, 0})}, {4.0f, 4.0f})), 0.3);
}

TEST_F(law_raster_lamps, a_panel_shines_through_a_leaf_as_in_the_path_tracer) {
  const View view = look_at({0.0f, 0.0f, 3.0f}, vec3(0.0f), 0.2f);
  const auto middle = [](const Image& image) { return luminance(image.rgb(image.width / 2, image.height / 2)); };
  for (const float transmission : {0.5f, 1.0f}) {
    const Scene scene = leaf_before_panel(transmission);
    const float expected = middle(path::render(scene, dark_environment(), view, test::settings(15, 256, 2)).beauty);
    EXPECT_GT(expected, 0.1f);
    EXPECT_NEAR(middle(draw(scene, view)) / expected, 1.0f, 0.1f) << transmission;
  }
  // And none through what lets none pass.
  EXPECT_EQ(middle(draw(leaf_before_panel(0.0f), view)), 0.0f);
}

/// A bulb that stands on a foot, above a floor: of two materials, or of one whose texture says what glows.
SceneBuilder bulb_on_foot(const std::function<int(SceneBuilder&)>& palette, const TextureSlot& slot, vec2 lit,
                          vec2 dark, std::size_t set = 0) {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 2.0f), matte(vec3(0.8f)));
  const Primitive bulb = sphere({0, 1.0f, 0}, 0.2f, 3, false), foot = box({0.3f, 0.2f, -0.4f}, {0.5f, 0.6f, 0.4f});
  if (!palette) {
    b.add(bulb, lamp(vec3(20.0f)));
    b.add(foot, lamp(vec3(0.0f)));
  } else {
    Material m = lamp(vec3(20.0f));
    m.emissive_texture = slot;
    m.emissive_texture.texture = palette(b);
    b.add(joined(with_uv(bulb, lit, set), with_uv(foot, dark, set)), m);
  }
  return b;
}

TEST_F(law_raster_lamps, a_texture_that_says_what_glows_lights_as_two_materials_do) {
  const Image expected = draw(bulb_on_foot({}, {}, {}, {}).build(), floor_view());
  // Two texels: dark, lit.
  const auto bytes = [](SceneBuilder& b) {
    return b.add_texture(2, 1, {0, 0, 0, 255, 255, 255, 255, 255}, Filter::nearest);
  };
  const auto clamped = [](SceneBuilder& b) {
    return b.add_texture(2, 1, {0, 0, 0, 255, 255, 255, 255, 255}, Filter::nearest, Wrap::clamp_to_edge);
  };
  const auto mirrored = [](SceneBuilder& b) {
    return b.add_texture(2, 1, {0, 0, 0, 255, 255, 255, 255, 255}, Filter::nearest, Wrap::mirrored_repeat);
  };
  const auto words = [](SceneBuilder& b) {
    return b.add_texture_16(2, 1, {0, 0, 0, 65535, 65535, 65535, 65535, 65535}, Filter::nearest, Wrap::repeat);
  };
  TextureSlot moved, second;
  moved.transform = {vec2(1, 0), vec2(0, 1), vec2(0.5f, 0)};
  second.uv_set = 1;
  const vec2 lit(0.75f, 0.5f), dark(0.25f, 0.5f);
  EXPECT_LT(difference(expected, draw(bulb_on_foot(bytes, {}, lit, dark).build(), floor_view())), 0.02);
  EXPECT_LT(difference(expected, draw(bulb_on_foot(words, {}, lit, dark).build(), floor_view())), 0.02);
  EXPECT_LT(difference(expected, draw(bulb_on_foot(bytes, moved, dark, lit).build(), floor_view())), 0.02);
  EXPECT_LT(difference(expected, draw(bulb_on_foot(bytes, second, lit, dark, 1).build(), floor_view())), 0.02);
  EXPECT_LT(difference(expected, draw(bulb_on_foot(clamped, {}, {1.25f, 0.5f}, {-0.75f, 0.5f}).build(), floor_view())),
            0.02);
  EXPECT_LT(difference(expected, draw(bulb_on_foot(mirrored, {}, {1.25f, 0.5f}, {1.75f, 0.5f}).build(), floor_view())),
            0.02);
  // The twin: all of it glows, or nothing.
  EXPECT_GT(difference(expected, draw(bulb_on_foot(bytes, {}, lit, lit).build(), floor_view())), 0.1);
  EXPECT_GT(difference(expected, draw(bulb_on_foot(bytes, {}, dark, dark).build(), floor_view())), 0.5);
}

TEST_F(law_raster_lamps, what_is_painted_counts_where_the_sky_does_not_drown_it) {
  const auto bytes = [](SceneBuilder& b) {
    return b.add_texture(2, 1, {0, 0, 0, 255, 255, 255, 255, 255}, Filter::nearest);
  };
  SceneBuilder b = bulb_on_foot(bytes, {}, {0.75f, 0.5f}, {0.25f, 0.5f});
  const Scene scene = b.build();
  raster::Settings direct = drawn();
  direct.quantity = raster::Quantity::direct;
  const auto lit = [&](float sky) { return draw(scene, floor_view(), direct, constant_environment(vec3(sky))); };
  EXPECT_GT(mean_luminance(lit(0.0f)), 0.05);
  EXPECT_LT(difference(lit(0.0f), lit(0.1f)), 1e-3);
  EXPECT_EQ(mean_luminance(lit(1e3f)), 0.0);
}

TEST_F(law_raster_lamps, what_a_mask_cuts_out_of_a_panel_lights_nothing) {
  const auto scene = [](bool is_masked, float share) {
    SceneBuilder b;
    b.add(plane(vec3(0.0f), 2.0f), matte(vec3(0.8f)));
    Material m = lamp(vec3(10.0f));
    if (is_masked) {
      m.alpha_mode = AlphaMode::mask;
      m.base_color_texture = slot(b.add_texture(2, 1, {0, 0, 0, 0, 0, 0, 0, 255}, Filter::nearest));
    }
    Primitive panel = quad({-0.2f, 1.5f, -0.2f}, {0.4f * share, 0, 0}, {0, 0, 0.4f});
    panel.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    b.add(panel, m);
    return b.build();
  };
  const View view = look_at({0.0f, 1.0f, 4.0f}, vec3(0.0f), 0.8f);
  const Image half = draw(scene(false, 0.5f), view), masked = draw(scene(true, 1.0f), view);
  EXPECT_LT(difference(half, masked), 0.15) << "it lies about the middle of the whole";
  EXPECT_GT(difference(half, draw(scene(false, 1.0f), view)), 0.5);
}

TEST_F(law_raster_lamps, many_lamps_keep_their_power) {
  for (const bool is_panel : {true, false}) {
    SceneBuilder b;
    b.add(plane(vec3(0.0f), 3.0f), matte(vec3(0.8f)));
    Primitive all;
    for (int i = 0; i < 36; ++i) {
      const int row = i / 6, column = i % 6;
      const vec3 at(0.5f * static_cast<float>(column) - 1.25f, 2.0f, 0.5f * static_cast<float>(row) - 1.25f);
      const Primitive one = is_panel ? ceiling_panel(at, 0.1f) : sphere(at, 0.05f, 2, false);
      all = i == 0 ? one : joined(all, one);
    }
    b.add(all, lamp(vec3(30.0f)));
    const View view = from_above(1.8f, 1.5f);
    const Image expected = shoot(b.build(), dark_environment(), view, settings(kSize, 64, 1)).beauty;
    const Image found = draw(b.build(), view);
    EXPECT_NEAR(mean_luminance(found) / mean_luminance(expected), 1.0, 0.08) << is_panel;
    EXPECT_LT(difference(expected, found), 0.15) << is_panel;
  }
}

TEST_F(law_raster_lamps, a_long_lamp_lights_along_its_length) {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 3.0f), matte(vec3(0.8f)));
  Primitive tube;
  for (int i = 0; i < 16; ++i) {
    const float x = -2.0f + 0.25f * static_cast<float>(i);
    const Primitive piece = box({x, 0.6f, -0.05f}, {x + 0.25f, 0.7f, 0.05f});
    tube = i == 0 ? piece : joined(tube, piece);
  }
  b.add(tube, lamp(vec3(20.0f)));
  const View view = from_above(0.55f, 2.5f);
  const Image expected = shoot(b.build(), dark_environment(), view, settings(kSize, 64, 1)).beauty;
  EXPECT_LT(difference(expected, draw(b.build(), view)), 0.2);
}

TEST_F(law_raster_lamps, a_directional_light_is_sharp_beside_what_glows) {
  const auto scene = [](bool has_glow) {
    SceneBuilder b;
    b.add(plane(vec3(0.0f), 2.0f), matte(vec3(0.8f)));
    b.add(box({-0.5f, 0.8f, -0.5f}, {0.5f, 1.0f, 0.5f}), matte(vec3(0.5f)));
    b.add_light(sunlight(vec3(1.0f), 3.0f), aimed({1, 4, 1}, vec3(0.0f)));
    b.add_light(point_light(vec3(1.0f), 30.0f), translation({-1, 3, 1}));
    if (has_glow) b.add(quad({5, 5, 5}, {0.1f, 0, 0}, {0, 0, 0.1f}), lamp(vec3(1e-3f)));
    return b.build();
  };
  const Image sharp = draw(scene(false), floor_view());
  EXPECT_LT(difference(sharp, draw(scene(true), floor_view())), 1e-3);
  raster::Settings soft = drawn();
  soft.light_radius = 1.0f;
  EXPECT_LT(difference(sharp, draw(scene(true), floor_view(), soft)), 1e-3) << "a radius alone asks for nothing";
  soft.has_soft_shadows = true;
  EXPECT_GT(difference(sharp, draw(scene(true), floor_view(), soft)), 5e-3) << "the twin: the point's shadow is soft";
  soft.light_radius = 0.0f;
  EXPECT_LT(difference(sharp, draw(scene(true), floor_view(), soft)), 1e-3) << "a direction has no size";
}

TEST_F(law_raster_lamps, sheen_is_read_from_the_levels_of_its_probe) {
  const Environment sky =
      mapped_environment(128, 64, [](vec3 d) { return vec3(0.5f) + 0.45f * vec3(d.y > 0.5f ? 1.0f : -1.0f); });
  SceneBuilder b;
  Material cloth = matte(vec3(0.0f));
  cloth.sheen_color = vec3(1.0f);
  cloth.sheen_roughness = 0.8f;  // far from the first level
  b.add(sphere(vec3(0.0f), 1.0f, 5, false), cloth);
  const Scene scene = b.build();
  const raster::BakedLight whole = raster::bake_light(sky, true, {});
  ASSERT_GT(whole.sheen.levels.size(), 3u);
  const raster::Probe probe{vec3(0.0f), {vec3(-1e4f), vec3(1e4f)}, whole};
  const auto device = std::make_shared<raster::Device>();
  raster::Settings settings = drawn();
  settings.quantity = raster::Quantity::sheen;
  const View view = look_at({1.7f, 1.3f, 2.6f}, vec3(0.0f), 0.9f);
  const auto shown = [&](const std::vector<raster::Probe>& probes, const Environment& environment) {
    raster::Drawer drawer(borrowed(scene), environment, shade::shading_model_candela(), device);
    drawer.set_probes(probes);
    return drawer.render(view, settings).beauty;
  };
  const Image expected = shown({}, sky);
  EXPECT_GT(mean_luminance(expected), 2e-3);
  EXPECT_LT(difference(expected, shown({probe}, sky)), 0.01);
  // Nothing else has told how many levels there are.
  EXPECT_LT(difference(expected, shown({probe}, dark_environment())), 0.01);
}

}  // namespace
}  // namespace candela
