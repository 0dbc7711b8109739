#include <gtest/gtest.h>

#include <cmath>

#include "support/random.h"
#include "unit/path/scenes.h"

// Odd numbers, legal all of them, must give a picture: finite, not negative.

namespace candela {
namespace {

using namespace test;

/// Numbers that break formulas, and ordinary ones.
class Oddities {
 public:
  explicit Oddities(std::uint64_t seed) : random_(seed) {}

  bool chance(float p) { return random_.next_float() < p; }
  float unit() { return pick({0.0f, 1.0f, 1e-6f, 1e-3f, 0.031f, 0.032f, 0.5f, 0.999999f, random_.next_float()}); }
  float size() { return pick({1.0f, 1.0f, 0.5f, 1e-3f, 1e3f, 2.0f * random_.next_float() + 0.1f}); }
  float bright() { return pick({0.0f, 0.0f, 1.0f, 1e-20f, 1e6f, 1e12f, random_.next_float()}); }
  float pick(std::initializer_list<float> values) {
    return values.begin()[random_.next() % static_cast<std::uint32_t>(values.size())];
  }
  vec3 color() { return {unit(), unit(), unit()}; }
  vec3 direction() { return glm::normalize(random_.next_vec3() * 2.0f - 1.0f + vec3(1e-3f, 0, 0)); }
  std::uint32_t below(std::uint32_t n) { return random_.next() % n; }

 private:
  Pcg32 random_;
};

int random_texture(SceneBuilder& b, Oddities& o) {
  std::vector<std::uint8_t> rgba(24);
  for (std::uint8_t& code : rgba)
    code = static_cast<std::uint8_t>(o.chance(0.3f) ? 0 : o.chance(0.3f) ? 255 : o.below(256));
  return b.add_texture(3, 2, rgba, o.chance(0.5f) ? Filter::linear : Filter::nearest,
                       o.chance(0.5f) ? Wrap::repeat : Wrap::mirrored_repeat);
}

Material random_material(SceneBuilder& b, Oddities& o) {
  Material m;
  m.base_color = o.color();
  m.opacity = o.unit();
  m.metallic = o.unit();
  m.roughness = o.unit();
  m.ior = o.pick({0.0f, 1.0f, 1.000001f, 1.5f, 3.0f, 100.0f});
  m.specular = o.unit();
  m.specular_color = o.chance(0.3f) ? vec3(50.0f) : o.color();
  if (o.chance(0.3f)) m.emission = o.color() * o.bright();
  m.normal_scale = o.pick({1.0f, 0.0f, -1.0f, 30.0f});
  m.alpha_mode = o.chance(0.6f) ? AlphaMode::opaque : o.chance(0.5f) ? AlphaMode::mask : AlphaMode::blend;
  m.alpha_cutoff = o.unit();
  m.double_sided = o.chance(0.5f);
  m.unlit = o.chance(0.1f);
  for (TextureSlot* s : {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture, &m.emissive_texture,
                         &m.specular_texture, &m.specular_color_texture}) {
    if (!o.chance(0.3f)) continue;
    *s = slot(random_texture(b, o), o.chance(0.3f) ? 1 : 0);
    if (o.chance(0.3f)) s->transform = {vec2(o.pick({0.0f, 3.0f, -1e4f}), 0), vec2(0.3f, 1), vec2(o.unit(), -5)};
  }
  return m;
}

Primitive random_shape(Oddities& o) {
  Primitive p;
  switch (o.below(4)) {
    case 0:
      p = sphere(vec3(0.0f), 1.0f, 2, false);
      break;
    case 1:
      p = box(vec3(-0.7f), vec3(0.7f));
      break;
    case 2:
      p = quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
      break;
    default:  // a needle, and a triangle without area
      p = quad({-1, 0, 0}, {2, 0, 0}, {0, 1e-6f, 0});
      p.triangles.emplace_back(0, 0, 1);
  }
  if (o.chance(0.2f)) {
    for (vec3& n : p.normals) n = o.direction();  // nothing to do with the facets
  }
  for (const vec3 n : p.normals) p.tangents.emplace_back(o.chance(0.1f) ? n : o.direction(), o.chance(0.5f) ? 1 : -1);
  if (o.chance(0.3f)) p.uvs[1] = p.uvs[0];
  if (o.chance(0.3f)) {
    for (std::size_t i = 0; i < p.positions.size(); ++i) p.colors.emplace_back(o.color(), o.unit());
  }
  return p;
}

mat4 random_place(Oddities& o) {
  const vec3 scale = o.chance(0.6f) ? vec3(1.0f) : vec3(o.size(), o.pick({1.0f, -1.0f, 0.0f, 1e-8f}), o.size());
  return translation(2.0f * o.direction()) * rotation(o.direction(), 6.0f * o.unit()) * scaling(scale);
}

Scene random_scene(Oddities& o) {
  SceneBuilder b;
  const int bodies = 1 + static_cast<int>(o.below(4));
  for (int i = 0; i < bodies; ++i) {
    const int mesh = b.add_mesh(random_shape(o), b.add_material(random_material(b, o)));
    const int copies = o.chance(0.3f) ? 2 : 1;
    for (int k = 0; k < copies; ++k) b.add_node(mesh, random_place(o));
  }
  for (std::uint32_t i = o.below(3); i > 0; --i) {
    Light l = spot_light(o.color(), o.bright(), 0.0f, 0.01f + 1.5f * o.unit());
    l.type = static_cast<LightType>(o.below(3));
    if (l.type == LightType::spot) l.inner_cone = l.outer_cone * o.pick({0.0f, 0.5f, 0.9999f});
    if (o.chance(0.3f)) l.range = o.pick({1e-6f, 1.0f, 1e6f});
    b.add_light(l, random_place(o));
  }
  return b.build();
}

Environment random_environment(Oddities& o) {
  Environment e;
  if (o.chance(0.5f)) {
    const float peak = o.bright();
    e = mapped_environment(8, 4, [&](vec3) { return o.chance(0.1f) ? vec3(peak) : o.color(); });
  }
  if (o.chance(0.3f)) e.constant = o.color() * o.bright();
  if (o.chance(0.3f)) {
    SunDisc sun;
    sun.direction = o.direction();
    sun.angular_radius = o.pick({1e-6f, 0.00465f, 0.3f, 1.5f});
    sun.radiance = vec3(o.bright());
    e.suns.push_back(sun);
  }
  e.rotation = o.pick({0.0f, 1.0f, -100.0f});
  e.intensity = o.pick({1.0f, 1.0f, 0.0f, 1e3f});
  return e;
}

TEST(unit_path_robustness, odd_scenes_give_finite_pictures) {
  double light = 0.0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Oddities o(seed);
    const Scene scene = random_scene(o);
    const Environment environment = random_environment(o);
    View view = look_at(4.0f * o.direction(), vec3(0.0f), 0.8f);
    if (o.chance(0.3f)) view.lens = {.radius = 0.3f, .focus_distance = 3.0f, .blades = 5, .vignetting = 1.0f};
    path::Settings s = settings(8, 16, o.chance(0.5f) ? 3 : 20);
    s.seed = static_cast<std::uint32_t>(seed);
    s.layers = {Layer::albedo, Layer::normal, Layer::position};
    s.integrator = o.chance(0.3f) ? path::Integrator::minimal : path::Integrator::full;
    const Film film = shoot(scene, environment, view, s);
    ASSERT_TRUE(is_finite_and_not_negative(film.beauty));
    EXPECT_TRUE(is_finite_and_not_negative(film.layers.at(Layer::albedo)));
    for (const Layer layer : {Layer::normal, Layer::position}) {
      for (const float v : film.layers.at(layer).pixels) ASSERT_TRUE(std::isfinite(v));
    }
    light += std::min(mean_luminance(film.beauty), 1.0);
  }
  EXPECT_GT(light, 50.0);  // most of them show something
}

TEST(unit_path_robustness, bodies_of_any_size_do_not_stop_the_machine) {
  // Vertices near the limits of single precision: nothing sensible to see, but an answer.
  for (const float size : {1e-30f, 1e-15f, 1e-12f, 1e-6f, 1e6f, 1e10f, 1e14f}) {
    SceneBuilder b;
    const int mesh = b.add_mesh(sphere(vec3(0.0f), size, 2, false), b.add_material(plastic(vec3(0.8f), 0.3f)));
    b.add_node(mesh);
    b.add_node(mesh, translation(vec3(2.0f * size, 0, 0)));
    Primitive cube = box(vec3(-1.0f), vec3(1.0f));
    for (vec3& p : cube.positions) p *= size;
    b.add(cube, matte(vec3(0.5f)), translation(vec3(0, 0, -3.0f * size)));
    b.add_light(point_light(vec3(1.0f), 1.0f), translation(vec3(0, 3.0f * size, 0)));
    View view;
    view.world_from_camera = translation(vec3(0, 0, 5.0f * size));
    const Film film = shoot(b.build(), constant_environment(vec3(1.0f)), view, settings(8, 8, 6));
    EXPECT_TRUE(is_finite_and_not_negative(film.beauty)) << size;
  }
}

TEST(unit_path_robustness, empty_scenes_show_the_environment) {
  SceneBuilder b;
  b.add_mesh({}, b.add_material(matte(vec3(1.0f))));
  b.add_node(0);
  b.add_node(0);
  const Film film =
      shoot(b.build(), constant_environment({1, 2, 3}), look_at({0, 0, 1}, vec3(0.0f), 1.0f), settings(5, 2, 2));
  for (int i = 0; i < 25; ++i) EXPECT_EQ(film.beauty.rgb(i % 5, i / 5), vec3(1, 2, 3));
}

}  // namespace
}  // namespace candela
