#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "laws/raster_draw.h"
#include "raster/render.h"
#include "unit/gl/gl_fixture.h"
#include "unit/path/scenes.h"

// Surfaces that something shows through, and bodies that the eye is in: the path tracer is right about both.

namespace candela {
namespace {

using namespace test;

class law_raster_blended : public NeedsGl {};  // NOLINT(readability-identifier-naming): a suite is named as its laws

constexpr int kSize = 64;

raster::Settings drawn(int msaa = 1) {
  raster::Settings s;
  s.width = s.height = kSize;
  s.msaa = msaa;
  s.specular_antialiasing = false;
  return s;
}

using test::draw;

View ahead(float half) {
  View view = look_at({0, 0, 5}, vec3(0.0f), 1.0f);
  view.projection = OrthographicCamera{.xmag = half, .ymag = half};
  return view;
}

/// A square picture's pixels about a point, of a camera `ahead`.
Region about(vec2 point, float half_size, float half_picture) {
  const auto pixel = [&](float v) { return static_cast<int>(std::lround((v / half_picture + 1.0f) * 0.5f * kSize)); };
  return {pixel(point.x - half_size), pixel(-point.y - half_size), pixel(point.x + half_size),
          pixel(-point.y + half_size)};
}

void expect_near(dvec3 found, dvec3 expected, double most, const std::string& what) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], most) << what << ", channel " << c;
}

Primitive square(vec3 center, float half) {
  return quad(center - vec3(half, half, 0), {2 * half, 0, 0}, {0, 2 * half, 0});
}

Primitive joined(Primitive a, const Primitive& b) {
  const auto first = static_cast<unsigned>(a.positions.size());
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  append(a.positions, b.positions), append(a.normals, b.normals), append(a.colors, b.colors);
  append(a.uvs[0], b.uvs[0]), append(a.uvs[1], b.uvs[1]);
  for (const uvec3& t : b.triangles) a.triangles.push_back(t + first);
  return a;
}

Primitive colored(Primitive p, vec4 color) {
  p.colors.assign(p.positions.size(), color);
  return p;
}

Material blended(Material m, float opacity) {
  m.alpha_mode = AlphaMode::blend, m.opacity = opacity;
  return m;
}

/// A clear sheet, or a body that leaves (0.5, 1, 0.25) after a metre; nothing bends.
Material clear_glass(float thickness) {
  Material m = plastic(vec3(1.0f), 0.0f);
  m.ior = 1.0f, m.transmission = 1.0f, m.thickness = thickness;
  if (thickness > 0.0f) m.attenuation_color = {0.5f, 1.0f, 0.25f}, m.attenuation_distance = 1.0f;
  return m;
}

// ----- where alpha is 1

/// Ways to say that nothing shows through.
enum class Whole { factor, vertices, texture, words, part_of_a_texture };

/// A ball, two sheets of one primitive with the near one first, a lamp's panel and glass before a square, all of
/// materials that say `mode`.
Scene everything(AlphaMode mode, Whole whole) {
  SceneBuilder b;
  const auto material = [&](Material m) {
    m.alpha_mode = mode;
    const std::vector<std::uint8_t> white(16, 255);
    const std::vector<std::uint16_t> words(16, 65535);
    if (whole == Whole::texture) m.base_color_texture = slot(b.add_texture(2, 2, white));
    if (whole == Whole::words) {
      m.base_color_texture = slot(b.add_texture_16(2, 2, words, Filter::linear, Wrap::repeat));
    }
    if (whole == Whole::part_of_a_texture) {
      // Its right half, where nobody looks it up, shows everything.
      std::vector<std::uint8_t> half(std::size_t{4} * 8 * 8, 255);
      for (std::size_t i = 0; i < 64; ++i) half[4 * i + 3] = i % 8 < 4 ? 255 : 0;
      m.base_color_texture = slot(b.add_texture(8, 8, half));
      m.base_color_texture.transform = {vec2(0.1f, 0.0f), vec2(0.0f, 0.1f), vec2(0.15f)};
    }
    return m;
  };
  const auto add = [&](Primitive p, const Material& m) {
    if (whole == Whole::vertices && p.colors.empty()) p = colored(p, vec4(1.0f));
    b.add(p, material(m));
  };
  add(square({0, 0, -0.3f}, 2.0f), matte(vec3(0.8f)));
  add(sphere({-0.5f, 0.4f, 0.3f}, 0.25f, 3, false), matte({0.8f, 0.3f, 0.2f}));
  const Primitive sheets = joined(colored(square({0.5f, 0.4f, 0.4f}, 0.2f), {1, 0, 0, 1}),
                                  colored(square({0.5f, 0.4f, 0.1f}, 0.3f), {0, 1, 0, 1}));
  add(sheets, matte(vec3(0.9f)));
  add(square({0.5f, -0.5f, 0.2f}, 0.15f), lamp({2, 3, 4}));
  add(square({-0.5f, -0.5f, 0.0f}, 0.1f), matte({0.1f, 0.2f, 0.9f}));
  b.add(square({-0.5f, -0.5f, 0.4f}, 0.3f), clear_glass(0.0f));
  b.add_light(sunlight(vec3(1.0f), 3.0f), aimed({-2, 1, 3}, vec3(0.0f)));
  b.add_light(point_light(vec3(1.0f), 5.0f), translation({0.3f, -0.2f, 2.0f}));
  b.add_light(spot_light(vec3(1.0f), 5.0f, 0.3f, 0.8f), aimed({1, 1, 2}, vec3(0.0f)));
  return b.build();
}

TEST_F(law_raster_blended, what_nothing_shows_through_is_drawn_as_opaque) {
  raster::Settings settings = drawn(4);
  settings.occlusion_radius = 0.1f;
  settings.layers = {Layer::depth, Layer::object_id, Layer::normal, Layer::albedo};
  const Environment sky = constant_environment(vec3(0.2f));
  for (const Whole whole : {Whole::factor, Whole::vertices, Whole::texture, Whole::words, Whole::part_of_a_texture}) {
    const Film expected = draw(everything(AlphaMode::opaque, whole), sky, ahead(1.0f), settings);
    for (const AlphaMode mode : {AlphaMode::blend, AlphaMode::mask}) {
      if (mode == AlphaMode::mask && whole != Whole::part_of_a_texture) continue;
      const Film found = draw(everything(mode, whole), sky, ahead(1.0f), settings);
      // Where a part of the texture decides, surfaces are drawn by other shaders.
      EXPECT_LT(largest_difference(expected.beauty, found.beauty), whole == Whole::part_of_a_texture ? 2e-3 : 1e-6)
          << static_cast<int>(whole);
      for (const auto& [layer, image] : expected.layers) {
        EXPECT_LT(largest_difference(image, found.layers.at(layer)), 1e-5) << layer_name(layer);
      }
    }
  }
  // The twin: half as much does show.
  Scene half = everything(AlphaMode::blend, Whole::factor);
  for (Material& m : half.materials) m.opacity = 0.5f;
  const Film shown = draw(half, sky, ahead(1.0f), settings);
  EXPECT_GT(largest_difference(shown.beauty,
                               draw(everything(AlphaMode::opaque, Whole::factor), sky, ahead(1.0f), settings).beauty),
            0.1);
}

// ----- shadows

std::vector<std::pair<Light, mat4>> lamps() {
  return {{sunlight(vec3(1.0f), 3.0f), aimed({0.4f, 0.2f, 4.0f}, vec3(0.0f))},
          {point_light(vec3(1.0f), 60.0f), translation({0, 0, 4})},
          {spot_light(vec3(1.0f), 60.0f, 0.6f, 0.8f), aimed({0, 0, 4}, vec3(0.0f))}};
}

/// A wall below y = 0 that veils hang before, seen from between: only the wall is in the picture.
View below_the_veils() { return look_at({0, 0, 0.45f}, vec3(0.0f), 2.2f); }

/// Means of the wall behind: nothing, a veil of 0.6, one by its vertices, two of 0.5, a checkered texture whose mean is
/// 0.5, a veil with a square before it towards the lamp.
Scene veils(const std::vector<std::pair<Light, mat4>>& lights, bool has_panel) {
  SceneBuilder b;
  b.add(square(vec3(0.0f), 2.0f), matte(vec3(0.8f)));
  const auto veil = [&](vec2 at, float z, float opacity) {
    b.add(square({at, z}, 0.13f), blended(matte(vec3(0.5f)), opacity));
  };
  veil({-0.4f, 0.3f}, 0.6f, 0.6f);
  Material by_vertices = blended(matte(vec3(0.5f)), 1.0f);
  by_vertices.double_sided = true;
  b.add(colored(square({0.0f, 0.3f, 0.6f}, 0.13f), {1, 1, 1, 0.3f}), by_vertices);
  veil({0.4f, 0.3f}, 0.6f, 0.5f), veil({0.4f, 0.3f}, 0.7f, 0.5f);
  std::vector<std::uint8_t> checks;
  for (int i = 0; i < 64; ++i)
    checks.insert(checks.end(), {255, 255, 255, static_cast<std::uint8_t>((i + i / 8) % 2 * 255)});
  Material checkered = blended(matte(vec3(0.5f)), 1.0f);
  checkered.base_color_texture = slot(b.add_texture(8, 8, checks));
  checkered.base_color_texture.transform = {vec2(1.0f, 0.0f), vec2(0.0f, 1.0f), vec2(0.25f, 0.0f)};
  b.add(square({-0.4f, -0.3f, 0.6f}, 0.13f), checkered);
  veil({0.0f, -0.3f}, 0.6f, 0.6f);
  b.add(square({0.0f, -0.3f, 0.8f}, 0.04f), matte(vec3(0.5f)));
  for (const auto& [light, world] : lights) b.add_light(light, world);
  if (has_panel) b.add(quad({-0.1f, 0.1f, 4.0f}, {0.2f, 0, 0}, {0, -0.2f, 0}), lamp(vec3(1500.0f)));
  return b.build();
}

TEST_F(law_raster_blended, shadows_are_as_dark_as_what_casts_them_covers) {
  const auto agree = [](const Scene& scene, const std::string& what, int frames = 1) {
    const View view = below_the_veils();
    const Image expected = shoot(scene, dark_environment(), view, test::settings(kSize, 256, 1)).beauty;
    raster::Settings settings = drawn(frames == 1 ? 4 : 1);
    settings.frames = frames;
    const Image found = draw(scene, dark_environment(), view, settings).beauty;
    const double lit = mean_of(expected, {2, 2, 12, 12}).x;
    EXPECT_GT(lit, 0.1) << what;
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 8; ++x) {
        // Edges are soft by texels of the map, or by the panel's width as far as it is known.
        const Region r{8 * x, 8 * y, 8 * x + 8, 8 * y + 8};
        EXPECT_NEAR(mean_of(found, r).x / lit, mean_of(expected, r).x / lit, frames == 1 ? 0.04 : 0.05)
            << what << ' ' << x << ' ' << y;
      }
    }
    EXPECT_NEAR(mean_of(found).x / lit, mean_of(expected).x / lit, 0.01) << what;
    return mean_of(expected).x / lit;
  };
  int i = 0;
  for (const auto& lamp : lamps()) agree(veils({lamp}, false), "lamp " + std::to_string(i++));
  agree(veils({}, true), "panel", 16);  // each frame from another point of it
  // The twin: without veils more light arrives than the law allows for.
  Scene bare = veils({lamps()[0]}, false);
  for (Material& m : bare.materials) m.opacity = m.alpha_mode == AlphaMode::blend ? 0.0f : 1.0f;
  EXPECT_GT(agree(bare, "bare"), agree(veils({lamps()[0]}, false), "veils") + 0.05);
}

TEST_F(law_raster_blended, veils_dim_what_is_behind_them_alone) {
  // Between lamp and wall: a square, a veil, a square, a veil, a square; each a step to the right of the one before.
  for (const auto& [light, world] : lamps()) {
    SceneBuilder b;
    b.add(square({0, 0, 0}, 1.0f), matte(vec3(0.8f)));
    b.add(square({0.1f, 0, 0.30f}, 0.25f), blended(unlit(vec3(0.0f)), 0.5f));
    b.add(square({0.0f, 0, 0.35f}, 0.15f), matte(vec3(0.8f)));
    b.add(square({0.2f, 0, 0.40f}, 0.45f), blended(unlit(vec3(0.0f)), 0.4f));
    b.add(square({0.0f, 0.3f, 0.45f}, 0.1f), matte(vec3(0.8f)));
    b.add_light(light, world);
    const View view = ahead(1.0f);
    const Image expected = shoot(b.build(), dark_environment(), view, settings(kSize, 256, 1)).beauty;
    const Image found = draw(b.build(), dark_environment(), view, drawn(4)).beauty;
    for (const vec2 at : {vec2(0.0f), vec2(0.25f, 0.0f), vec2(0.5f, 0.0f), vec2(0.0f, 0.3f), vec2(-0.7f, 0.5f)}) {
      const Region r = about(at, 0.05f, 1.0f);
      EXPECT_NEAR(mean_of(found, r).x, mean_of(expected, r).x, 0.02 * mean_of(expected, r).x + 0.005) << at.x;
    }
  }
}

TEST_F(law_raster_blended, sheets_at_one_place_dim_as_many) {
  // A leaf of two sides, 10 µm thick or of no thickness, and a third sheet behind it for one half.
  for (const auto& [light, world] : lamps()) {
    for (const float apart : {0.0f, 1e-5f}) {
      SceneBuilder b;
      b.add(square({0, 0, 0}, 1.0f), matte(vec3(0.8f)));
      Primitive back = square({0.1f, 0, 0.40f + apart}, 0.3f);
      for (uvec3& t : back.triangles) std::swap(t.y, t.z);
      b.add(square({0.1f, 0, 0.40f}, 0.3f), blended(unlit(vec3(0.0f)), 0.5f));
      b.add(back, blended(unlit(vec3(0.0f)), 0.5f));
      b.add(square({0.1f, 0.25f, 0.30f}, 0.2f), blended(unlit(vec3(0.0f)), 0.4f));
      b.add_light(light, world);
      const View view = ahead(1.0f);
      const Image expected = shoot(b.build(), dark_environment(), view, settings(kSize, 256, 1)).beauty;
      const Image found = draw(b.build(), dark_environment(), view, drawn(4)).beauty;
      for (const vec2 at : {vec2(0.1f, -0.1f), vec2(0.1f, 0.2f), vec2(-0.7f, 0.5f)}) {
        const Region r = about(at, 0.05f, 1.0f);
        EXPECT_NEAR(mean_of(found, r).x, mean_of(expected, r).x, 0.02 * mean_of(expected, r).x + 0.005) << at.y;
      }
    }
  }
}

// ----- order

TEST_F(law_raster_blended, order_is_right_within_a_primitive_and_between) {
  Material half = blended(unlit(vec3(1.0f)), 0.5f);
  half.double_sided = true;
  SceneBuilder b;
  // Near triangles first; sheets that lean before a small one; sheets that cross; a ball; instances.
  Primitive p = joined(colored(square({-0.5f, -0.5f, 0.5f}, 0.4f), {1, 0, 0, 1}),
                       colored(square({-0.5f, -0.5f, -0.5f}, 0.4f), {0, 1, 0, 1}));
  p = joined(p, colored(square({0.5f, 0.3f, 0.2f}, 0.2f), {1, 0, 0, 1}));
  p = joined(p, colored(quad({0.1f, -0.3f, 3.6f}, {0.8f, 0, 0}, {0, 1.2f, -5.2f}), {0, 1, 0, 1}));
  p = joined(p, colored(quad({-0.9f, 0.1f, -0.5f}, {0.8f, 0, 1.0f}, {0, 0.8f, 0}), {1, 0, 0, 1}));
  p = joined(p, colored(quad({-0.9f, 0.1f, 0.5f}, {0.8f, 0, -1.0f}, {0, 0.8f, 0}), {0, 0, 1, 1}));
  b.add(p, half);
  b.add(colored(sphere({0.5f, -0.6f, 0.0f}, 0.25f, 3, false), {0.2f, 1, 0.2f, 1}), half);
  const int mesh = b.add_mesh(colored(square(vec3(0.0f), 0.1f), {1, 1, 0, 1}), b.add_material(half));
  for (int k = 0; k < 5; ++k)
    b.add_node(mesh, translation({0.4f + 0.05f * static_cast<float>(k), -0.6f, 0.5f - 0.25f * static_cast<float>(k)}));
  const Scene scene = b.build();
  const Environment sky = constant_environment({0.1f, 0.2f, 0.9f});
  const Image expected = shoot(scene, sky, ahead(1.0f), settings(kSize, 1024, 1)).beauty;
  for (const int msaa : {1, 4}) {
    const Image found = draw(scene, sky, ahead(1.0f), drawn(msaa)).beauty;
    int apart = 0;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        // Alpha by chance: 1 / √1024 of a unit, five times.
        apart += max_component(glm::abs(expected.rgb(x, y) - found.rgb(x, y))) > 0.09f ? 1 : 0;
      }
    }
    EXPECT_LT(apart, msaa == 1 ? 330 : 60) << "pixels at edges, " << msaa;
    for (const Region& r :
         {about({-0.5f, -0.5f}, 0.3f, 1.0f), about({0.5f, 0.3f}, 0.15f, 1.0f), about({-0.7f, 0.5f}, 0.15f, 1.0f),
          about({-0.3f, 0.5f}, 0.15f, 1.0f), about({0.5f, -0.6f}, 0.2f, 1.0f)}) {
      expect_near(mean_of(found, r), mean_of(expected, r), 0.01, "region of " + std::to_string(r.x0));
    }
  }
}

TEST_F(law_raster_blended, edges_of_sheets_are_as_smooth_as_others) {
  // A leaning sheet covers half of the pixels along its edge, before another.
  const auto picture = [](AlphaMode mode) {
    SceneBuilder b;
    Material red = unlit({1, 0, 0});
    red.alpha_mode = mode, red.opacity = mode == AlphaMode::blend ? 0.99f : 1.0f;
    b.add(quad({-1.2f, -1.0f, 0.5f}, {2.0f, 0.35f, 0.4f}, {0, 1.0f, 0}), red);
    Material green = unlit({0, 1, 0});
    green.alpha_mode = mode, green.opacity = red.opacity;
    b.add(square({0, 0, -1}, 0.8f), green);
    return draw(b.build(), dark_environment(), ahead(1.0f), drawn(4)).beauty;
  };
  EXPECT_LT(largest_difference(picture(AlphaMode::opaque), picture(AlphaMode::blend)), 0.03);
}

TEST_F(law_raster_blended, glass_shows_what_is_blended_behind_it_and_lies_behind_what_is_before_it) {
  for (const float thickness : {0.0f, 0.4f}) {
    SceneBuilder b;
    b.add(square({0, 0, -2}, 4.0f), unlit(vec3(0.8f)));
    Material glass = clear_glass(thickness);
    // It leans: at its far end a label's middle is farther than the glass's.
    const vec3 x{0.8f, 0, 0}, y{0, 1.6f, -2.4f};
    for (const float side : {-0.9f, 0.1f}) {
      b.add(quad({side, -0.8f, 1.2f}, x, y), glass);
      const float off = side < 0.0f ? 0.02f : -0.02f;
      for (const float at : {0.2f, 0.8f}) {
        b.add(quad(vec3(side, -0.8f, 1.2f + off) + x * 0.3f + y * at, x * 0.4f, y * 0.1f),
              blended(unlit({1, 0, 0}), 0.5f));
      }
    }
    b.add(square({0, 0, 1.5f}, 0.2f), blended(unlit({0, 0, 1}), 0.5f));
    const Image found = draw(b.build(), dark_environment(), ahead(1.0f), drawn(4)).beauty;
    // Without a body nothing but the labels' colours matters; a body tints what is behind it.
    const dvec3 tint = glm::pow(dvec3(0.5, 1.0, 0.25), dvec3(static_cast<double>(thickness)));
    const dvec3 wall(0.8), red(1.0, 0.0, 0.0);
    for (const float at : {-0.8f + 1.6f * 0.25f, -0.8f + 1.6f * 0.85f}) {
      expect_near(mean_of(found, about({-0.5f, at}, 0.05f, 1.0f)), 0.5 * red + 0.5 * tint * wall, 0.01, "before it");
      expect_near(mean_of(found, about({0.5f, at}, 0.05f, 1.0f)), tint * (0.5 * red + 0.5 * wall), 0.01, "behind it");
    }
    expect_near(mean_of(found, about({0.0f, 0.0f}, 0.05f, 1.0f)), 0.5 * dvec3(0, 0, 1) + 0.5 * wall, 0.01, "beside it");
  }
}

TEST_F(law_raster_blended, a_blended_lamp_lights_by_what_of_it_is_there) {
  for (const bool has_texture : {false, true}) {
    SceneBuilder b;
    b.add(plane(vec3(0.0f), 2.0f), matte(vec3(0.8f)));
    Material glow = blended(lamp(vec3(20.0f)), has_texture ? 1.0f : 0.4f);
    if (has_texture) {
      std::vector<std::uint8_t> halves(std::size_t{4} * 64, 255);
      for (std::size_t i = 0; i < 64; ++i) halves[4 * i + 3] = i % 2 == 0 ? 255 : 51;
      glow.base_color_texture = slot(b.add_texture(8, 8, halves));
    }
    b.add(quad({-0.3f, 1.0f, -0.3f}, {0.6f, 0, 0}, {0, 0, 0.6f}), glow);
    const View view = from_above(0.5f, 1.0f);
    const Image expected = shoot(b.build(), dark_environment(), view, settings(kSize, 256, 1)).beauty;
    raster::Settings many = drawn();
    many.frames = 8;
    const Image found = draw(b.build(), dark_environment(), view, many).beauty;
    EXPECT_NEAR(mean_of(found).x / mean_of(expected).x, 1.0, 0.03) << has_texture;
  }
}

// ----- masks

TEST_F(law_raster_blended, an_alpha_that_equals_its_cutoff_is_there) {
  for (const int msaa : {1, 4}) {
    for (const float above : {0.0f, 2.0f}) {  // texels beyond the cutoff, in steps of 8 bits
      SceneBuilder b;
      b.add(square({0, 0, -0.5f}, 2.0f), matte(vec3(0.8f)));
      const auto add = [&](float x, Material m, const Primitive& p) {
        m.alpha_mode = AlphaMode::mask;
        b.add(moved(p, {x, 0.2f, 0.0f}), m);
      };
      Material by_factor = unlit(vec3(1.0f));
      by_factor.opacity = 0.5f, by_factor.alpha_cutoff = 0.5f + above / 255.0f;
      add(-0.6f, by_factor, square(vec3(0.0f), 0.2f));
      Material by_texture = unlit(vec3(1.0f));
      by_texture.alpha_cutoff = (128.0f + above) / 255.0f;
      // Beside the texels there is one more that is cut out either way.
      std::vector<std::uint8_t> texels(std::size_t{4} * 64, 255);
      for (std::size_t i = 0; i < 64; ++i) texels[4 * i + 3] = i == 63 ? 0 : 128;
      by_texture.base_color_texture = slot(b.add_texture(8, 8, texels));
      by_texture.base_color_texture.transform = {vec2(0.1f, 0.0f), vec2(0.0f, 0.1f), vec2(0.4f)};
      add(0.0f, by_texture, square(vec3(0.0f), 0.2f));
      Material by_vertices = unlit(vec3(1.0f));
      by_vertices.alpha_cutoff = 0.3f + above / 255.0f;
      add(0.6f, by_vertices, colored(square(vec3(0.0f), 0.2f), {1, 1, 1, 0.3f}));
      b.add_light(sunlight(vec3(1.0f), 3.0f), aimed({0, 4, 2.5f}, vec3(0.0f)));
      raster::Settings settings = drawn(msaa);
      settings.layers = {Layer::object_id};
      const Film film = draw(b.build(), dark_environment(), ahead(1.0f), settings);
      for (const float x : {-0.6f, 0.0f, 0.6f}) {
        const bool is_there = above == 0.0f;
        EXPECT_NEAR(mean_of(film.beauty, about({x, 0.2f}, 0.12f, 1.0f)).x > 0.9, is_there, 0) << x << ' ' << msaa;
        EXPECT_EQ(film.layers.at(Layer::object_id)
                          .pixels[static_cast<std::size_t>(kSize / 2 - 6) * kSize +
                                  static_cast<std::size_t>(about({x, 0}, 0.0f, 1.0f).x0)] != 1.0f,
                  is_there);
        // The lamp is 58 degrees up: the shadow lies 0.8 below.
        EXPECT_EQ(mean_of(film.beauty, about({x, -0.6f}, 0.08f, 1.0f)).x < 0.01, is_there) << x << ' ' << msaa;
      }
    }
  }
}

TEST_F(law_raster_blended, a_cutoff_of_0_cuts_nothing) {
  SceneBuilder b;
  Material m = unlit(vec3(1.0f));
  m.alpha_mode = AlphaMode::mask, m.alpha_cutoff = 0.0f;
  std::vector<std::uint8_t> texels(std::size_t{4} * 64, 255);
  for (std::size_t i = 0; i < 64; ++i) texels[4 * i + 3] = static_cast<std::uint8_t>(i % 2 * 255);
  m.base_color_texture = slot(b.add_texture(8, 8, texels, Filter::nearest));
  b.add(square(vec3(0.0f), 1.83f), m);  // pixels lie across its texels
  for (const int msaa : {1, 4}) {
    EXPECT_EQ(largest_difference(draw(b.build(), dark_environment(), ahead(1.0f), drawn(msaa)).beauty,
                                 draw(b.build(), constant_environment(vec3(5.0f)), ahead(1.0f), drawn(msaa)).beauty),
              0.0);
    EXPECT_EQ(mean_of(draw(b.build(), dark_environment(), ahead(1.0f), drawn(msaa)).beauty), dvec3(1.0)) << msaa;
  }
}

// ----- layers

TEST_F(law_raster_blended, layers_are_of_the_first_surface_that_is_at_least_half_there) {
  raster::Settings settings = drawn(4);
  settings.layers = {Layer::depth, Layer::object_id, Layer::normal, Layer::albedo, Layer::position};
  for (const float opacity : {0.4f, 0.5f, 0.6f}) {
    SceneBuilder b;
    b.add(square({0, 0, -1}, 2.0f), matte({0, 1, 0}));
    Material veil = blended(matte({1, 0, 0}), opacity);
    b.add(quad({-2, -2, 2}, {4, 0, 0}, {0, 4, -2}), veil);
    const Film film = draw(b.build(), dark_environment(), ahead(1.0f), settings);
    const bool is_veil = opacity >= 0.5f;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const auto at = static_cast<std::size_t>(y * kSize + x);
        EXPECT_EQ(film.layers.at(Layer::object_id).pixels[at], is_veil ? 2.0f : 1.0f);
        EXPECT_EQ(film.layers.at(Layer::depth).pixels[at] < 5.5f, is_veil);
        EXPECT_EQ(film.layers.at(Layer::normal).rgb(x, y).z < 0.95f, is_veil);
        EXPECT_EQ(film.layers.at(Layer::albedo).rgb(x, y).x > 0.5f, is_veil);
        EXPECT_EQ(film.layers.at(Layer::position).rgb(x, y).z > -0.5f, is_veil);
      }
    }
  }
}

TEST_F(law_raster_blended, layers_are_of_what_the_picture_shows_where_surfaces_share_a_place) {
  raster::Settings settings = drawn(4);
  settings.layers = {Layer::object_id, Layer::albedo};
  Material glass = matte({1, 0, 0});
  glass.transmission = 1.0f;
  for (const Material& veil : {blended(matte({1, 0, 0}), 0.5f), glass}) {
    for (const bool is_first : {true, false}) {
      SceneBuilder b;
      if (is_first) b.add(square({0, 0, 0}, 2.0f), veil);
      b.add(square({0, 0, 0}, 2.0f), matte({0, 1, 0}));
      if (!is_first) b.add(square({0, 0, 0}, 2.0f), veil);
      const Film film = draw(b.build(), dark_environment(), ahead(1.0f), settings);
      EXPECT_EQ(film.layers.at(Layer::object_id).pixels[kSize * kSize / 2 + kSize / 2], is_first ? 1.0f : 2.0f);
      EXPECT_GT(film.layers.at(Layer::albedo).rgb(kSize / 2, kSize / 2).x, 0.5f);
    }
  }
}

// ----- the eye in a body

TEST_F(law_raster_blended, from_far_away_a_body_absorbs_as_much) {
  const Environment white = constant_environment(vec3(1.0f));
  for (const float far : {0.0f, 1e5f, 1e6f}) {
    for (const bool is_orthographic : {false, true}) {
      const vec3 middle(far, -far, far);
      View view = look_at(middle, middle + vec3(0, 0, -1), 0.1f);
      if (is_orthographic) view.projection = OrthographicCamera{.xmag = 0.05f, .ymag = 0.05f};
      view.near_plane = 0.5f;
      SceneBuilder b;
      b.add(box(vec3(-1.0f), vec3(1.0f)), clear_glass(2.0f), translation(middle));
      expect_near(mean_of(draw(b.build(), white, view, drawn(4)).beauty, {24, 24, 40, 40}),
                  glm::sqrt(dvec3(0.5, 1.0, 0.25)), 0.01, "half a metre beyond the near plane");
    }
  }
}

TEST_F(law_raster_blended, from_inside_a_body_absorbs_over_the_way_to_its_boundary) {
  const View perspective = look_at(vec3(0.0f), {0, 0, -1}, 0.1f);
  View orthographic = perspective;
  orthographic.projection = OrthographicCamera{.xmag = 0.05f, .ymag = 0.05f};
  View view = perspective;
  const Environment white = constant_environment(vec3(1.0f));
  const dvec3 metre(0.5, 1.0, 0.25);
  const Primitive cube = box(vec3(-1.0f), vec3(1.0f));
  const auto middle = [&](const SceneBuilder& b) {
    return mean_of(draw(b.build(), white, view, drawn(4)).beauty, {24, 24, 40, 40});
  };
  for (const int kind : {0, 1, 2, 3}) {
    Material glass = clear_glass(2.0f);
    glass.double_sided = kind % 2 == 1;
    view = kind < 2 ? perspective : orthographic;
    SceneBuilder b;
    b.add(cube, glass);
    expect_near(middle(b), metre, 0.01, "a cube");
    SceneBuilder mirrored;
    mirrored.add(cube, glass, scaling({-1, 1, 1}));
    expect_near(middle(mirrored), metre, 0.01, "a mirrored cube");
    SceneBuilder apart;  // a node for each face
    for (std::size_t i = 0; i < cube.triangles.size(); ++i) {
      Primitive face = cube;
      face.triangles = {cube.triangles[i]};
      apart.add(face, glass);
    }
    expect_near(middle(apart), metre, 0.01, "a cube of many nodes");
    // What stands in it, 0.5 m before the eye, and a wall of it that is no glass.
    SceneBuilder fish;
    fish.add(cube, glass);
    fish.add(square({0, 0, -0.5f}, 0.3f), unlit(vec3(1.0f)));
    expect_near(middle(fish), glm::sqrt(metre), 0.01, "what stands in it");
    SceneBuilder lid;
    Primitive sides = cube, back = cube;
    const auto is_back = [&](const uvec3& t) {
      return cube.positions[t.x].z < 0.0f && cube.positions[t.y].z < 0.0f && cube.positions[t.z].z < 0.0f;
    };
    std::erase_if(sides.triangles, is_back);
    std::erase_if(back.triangles, [&](const uvec3& t) { return !is_back(t); });
    Material white_lid = unlit(vec3(1.0f));
    white_lid.double_sided = true;
    const int mesh = lid.add_mesh(sides, lid.add_material(glass));
    back.material = lid.add_material(white_lid);
    lid.scene().meshes[static_cast<std::size_t>(mesh)].primitives.push_back(back);
    lid.add_node(mesh);
    expect_near(middle(lid), metre, 0.01, "a lid of it");
    // What is outside is absorbed up to the boundary.
    SceneBuilder outside;
    outside.add(cube, glass);
    outside.add(square({0, 0, -3}, 1.0f), unlit({0.6f, 0.3f, 0.8f}));
    expect_near(middle(outside), metre * dvec3(0.6, 0.3, 0.8), 0.01, "what is outside");
  }
  // Beside the body nothing is absorbed, also where an open sheet of it is seen from behind.
  SceneBuilder beside;
  beside.add(moved(cube, {3, 0, 0}), clear_glass(2.0f));
  beside.add(turned_inside_out(square({0, 0, -1}, 0.5f)), clear_glass(2.0f));
  for (const View& each : {perspective, orthographic}) {
    view = each;
    expect_near(middle(beside), dvec3(1.0), 1e-3, "beside it");
  }
}

TEST_F(law_raster_blended, an_orthographic_picture_wider_than_the_body_is_absorbed_where_the_body_is) {
  SceneBuilder b;
  b.add(box(vec3(-0.5f), vec3(0.5f)), clear_glass(2.0f));
  b.add(square({0, 0, -3}, 4.0f), unlit(vec3(1.0f)));
  View view = look_at(vec3(0.0f), {0, 0, -1}, 0.1f);
  view.projection = OrthographicCamera{.xmag = 2.0f, .ymag = 2.0f};
  const Image image = draw(b.build(), constant_environment(vec3(1.0f)), view, drawn(4)).beauty;
  expect_near(mean_of(image, {28, 28, 36, 36}), glm::sqrt(dvec3(0.5, 1.0, 0.25)), 0.01, "through it");
  expect_near(mean_of(image, {4, 4, 12, 60}), dvec3(1.0), 1e-3, "beside it");
}

// ----- the culled side

TEST_F(law_raster_blended, culling_is_for_the_eye_alone) {
  // A sheet that looks at the wall, from which the eye sees nothing but its shadow.
  const auto scene = [](std::size_t lamp_index, bool has_sheet) {
    SceneBuilder b;
    b.add(square(vec3(0.0f), 2.0f), matte(vec3(0.8f)));
    if (has_sheet) b.add(turned_inside_out(square({0, 0, 0.3f}, 0.3f)), matte({1, 0, 0}));
    if (lamp_index < lamps().size()) {
      b.add_light(lamps()[lamp_index].first, lamps()[lamp_index].second);
    } else {
      b.add(quad({-0.1f, 0.1f, 4.0f}, {0.2f, 0, 0}, {0, -0.2f, 0}), lamp(vec3(1500.0f)));
    }
    return b.build();
  };
  raster::Settings settings = drawn(4);
  settings.layers = {Layer::depth, Layer::object_id};
  for (std::size_t i = 0; i <= lamps().size(); ++i) {
    const Film lit = draw(scene(i, false), dark_environment(), ahead(1.0f), settings);
    const Film film = draw(scene(i, true), dark_environment(), ahead(1.0f), settings);
    const Region middle = about(vec2(0.0f), 0.15f, 1.0f), edge = about({0.8f, 0.8f}, 0.1f, 1.0f);
    EXPECT_GT(mean_of(lit.beauty, middle).x, 0.1) << i;
    EXPECT_LT(mean_of(film.beauty, middle).x, 1e-3) << i;
    EXPECT_NEAR(mean_of(film.beauty, edge).x, mean_of(lit.beauty, edge).x, 1e-3) << i;
    EXPECT_EQ(largest_difference(film.layers.at(Layer::depth), lit.layers.at(Layer::depth)), 0.0);
    EXPECT_EQ(largest_difference(film.layers.at(Layer::object_id), lit.layers.at(Layer::object_id)), 0.0);
  }
}

TEST_F(law_raster_blended, what_the_eye_does_not_see_takes_light_from_what_is_near) {
  const auto middle = [](bool has_sheet, bool is_double_sided, float height) {
    SceneBuilder b;
    b.add(square(vec3(0.0f), 2.0f), matte(vec3(0.8f)));
    Material m = matte(vec3(0.8f));
    m.double_sided = is_double_sided;
    if (has_sheet) b.add(turned_inside_out(square({0, 0, height}, 0.5f)), m);
    raster::Settings settings = drawn(4);
    settings.occlusion_radius = 0.2f;
    // Beside the sheet, which lies over the middle.
    return mean_of(draw(b.build(), constant_environment(vec3(1.0f)), ahead(1.0f), settings).beauty,
                   about({0.53f, 0.0f}, 0.03f, 1.0f));
  };
  const double open = middle(false, false, 0.2f).x;
  // The map that is blurred ends at a sheet that is seen, and goes on below one that is not.
  EXPECT_NEAR(middle(true, false, 0.2f).x, middle(true, true, 0.2f).x, 0.12 * open);
  EXPECT_LT(middle(true, false, 0.2f).x, 0.9 * open);
  // Far before it, as the wall of a room that is looked into from outside, it takes none.
  EXPECT_NEAR(middle(true, false, 3.0f).x, open, 0.01 * open);
}

}  // namespace
}  // namespace candela
