#include "path/origin.h"

#include <gtest/gtest.h>

#include "path/direct_light.h"
#include "path/pixel_paths.h"
#include "path/pixel_surface.h"
#include "unit/path/scenes.h"

// A scene looks the same wherever in the world it stands, and what is said of it says where.

namespace candela {
namespace {

using namespace test;

const vec3 kPlaces[] = {{0, 1e5f, 0}, {-3e5f, 0, 1e5f}, {5e5f, 4e6f, 0}};

enum class Lamp { directional, point, spot, area };

/// A floor and a sheet a quarter of a metre above it, whose shadow is seen. All numbers are multiples of ½, which
/// single precision has there too.
Scene shadow_scene(Lamp kind, vec3 place) {
  SceneBuilder b;
  Material m = matte(vec3(0.2f));
  m.double_sided = true;
  b.add(plane(vec3(0.0f), 4.0f), matte(vec3(0.8f)), translation(place));
  b.add(plane({0, 0.25f, 0}, 1.0f), m, translation(place));
  const mat4 at = translation(place) * aimed({0, 4, 2}, vec3(0.0f));
  switch (kind) {
    case Lamp::directional:
      b.add_light(sunlight(vec3(1.0f), kPi), at);
      break;
    case Lamp::point:
      b.add_light(point_light(vec3(1.0f), 60.0f), at);
      break;
    case Lamp::spot:
      b.add_light(spot_light(vec3(1.0f), 60.0f, 0.3f, 0.8f), at);
      break;
    case Lamp::area:
      b.add(turned_inside_out(plane({0, 4, 0}, 0.5f)), lamp(vec3(20.0f)), translation(place));
      break;
  }
  return b.build();
}

View view_of(vec3 place) { return look_at(place + vec3(0, 1.5f, 6), place, 0.7f); }

double share_that_differs(const Image& a, const Image& b) {
  int count = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) count += max_component(glm::abs(a.rgb(x, y) - b.rgb(x, y))) > 0.06f ? 1 : 0;
  }
  return static_cast<double>(count) / (a.width * a.height);
}

TEST(unit_path_origin, shadows_are_the_same_wherever_a_scene_stands) {
  for (const Lamp kind : {Lamp::directional, Lamp::point, Lamp::spot, Lamp::area}) {
    const path::Settings s = settings(48, 64, 1);
    const Image near = shoot(shadow_scene(kind, vec3(0.0f)), dark_environment(), view_of(vec3(0.0f)), s).beauty;
    for (const vec3 place : kPlaces) {
      const Image far = shoot(shadow_scene(kind, place), dark_environment(), view_of(place), s).beauty;
      EXPECT_LT(share_that_differs(near, far), 0.02) << static_cast<int>(kind) << " at " << place.x << " " << place.y;
    }
  }
}

TEST(unit_path_origin, a_ground_and_a_pane_are_the_same_wherever_a_scene_stands) {
  const auto picture = [](vec3 place) {
    SceneBuilder b;
    Material m;
    m.metallic = 0.0f;
    m.roughness = 0.0f;
    m.ior = 1.0f;
    m.transmission = 1.0f;
    m.thickness = 1.0f;
    m.attenuation_color = vec3(0.5f, 0.25f, 1.0f);
    m.attenuation_distance = 0.01f;
    b.add(box({-1, 0, -0.005f}, {1, 2, 0.005f}), m, translation(place));
    b.scene().ground = Ground{.height = place.y};
    return shoot(b.build(), constant_environment(vec3(1.0f)), view_of(place), settings(48, 64, 2)).beauty;
  };
  const Image near = picture(vec3(0.0f));
  for (const vec3 place : kPlaces) EXPECT_LT(share_that_differs(near, picture(place)), 0.02) << place.y;
}

TEST(unit_path_origin, what_is_said_of_a_far_scene_is_of_the_world) {
  const vec3 place(5e5f, 4e6f, 0);
  constexpr float kRounding = 0.5f;
  const path::Tracer tracer(shadow_scene(Lamp::point, place), dark_environment());
  const path::Tracer near(shadow_scene(Lamp::point, vec3(0.0f)), dark_environment());
  const ivec2 size(16), pixel(8, 12);
  path::Settings s = settings(16, 16, 2);
  s.layers = {Layer::position};
  const vec3 seen = tracer.render(view_of(place), s).layers.at(Layer::position).rgb(pixel.x, pixel.y);
  const vec3 seen_near = near.render(view_of(vec3(0.0f)), s).layers.at(Layer::position).rgb(pixel.x, pixel.y);
  EXPECT_LE(max_component(glm::abs(seen - place - seen_near)), kRounding);

  const auto surface = path::find_pixel_surface(tracer, view_of(place), size, pixel);
  const auto surface_near = path::find_pixel_surface(near, view_of(vec3(0.0f)), size, pixel);
  ASSERT_TRUE(surface && surface_near);
  EXPECT_LE(max_component(glm::abs(surface->where.position - place - surface_near->where.position)), kRounding);
  EXPECT_NEAR(surface->distance, surface_near->distance, 1e-3f);
  ASSERT_EQ(surface->lamps.size(), 1u);
  EXPECT_NEAR(surface->lamps[0].distance, surface_near->lamps[0].distance, 1e-3f);
  EXPECT_NEAR(surface->lamps[0].irradiance.x, surface_near->lamps[0].irradiance.x, 1e-3f);

  s.layers.clear();
  const path::PixelEstimate paths = path::trace_pixel(tracer, view_of(place), s, pixel, {}, {});
  ASSERT_FALSE(paths.brightest.empty());
  const path::LightPath& brightest = paths.brightest.front();
  EXPECT_EQ(brightest.source.kind, path::LightKind::lamp);
  EXPECT_EQ(brightest.source.index, 2);
  EXPECT_LE(max_component(glm::abs(brightest.vertices.front().position - surface->where.position)), 2.0f);
}

TEST(unit_path_origin, direct_light_is_the_same_wherever_a_scene_stands) {
  const path::Settings s = settings(16, 64, 1);
  const auto light = [&](vec3 place) {
    const path::Tracer tracer(shadow_scene(Lamp::directional, place), dark_environment());
    return path::trace_direct_light(tracer, view_of(place), s, {}).lamps.arriving;
  };
  const Image near = light(vec3(0.0f));
  for (const vec3 place : kPlaces) EXPECT_LT(share_that_differs(near, light(place)), 0.02) << place.y;
}

// ----- which origin

TEST(unit_path_origin, is_the_worlds_for_what_stands_near_it) {
  for (const vec3 place : {vec3(0.0f), vec3(0, 0, 50), vec3(3, -20, 7)}) {
    EXPECT_EQ(path::tracing_origin(shadow_scene(Lamp::point, place)), vec3(0.0f));
  }
  SceneBuilder wide;
  wide.add(plane({300, 0, 0}, 1000.0f), matte(vec3(1.0f)));
  EXPECT_EQ(path::tracing_origin(wide.build()), vec3(0.0f));
  EXPECT_EQ(path::tracing_origin(Scene{}), vec3(0.0f));
}

TEST(unit_path_origin, is_amid_what_stands_far_away_whatever_else_there_is) {
  SceneBuilder b;
  const int mesh = b.add_mesh(box(vec3(-0.5f), vec3(0.5f)), b.add_material(matte(vec3(1.0f))));
  b.add_node(mesh);
  for (int i = 0; i < 4; ++i) b.add_node(mesh, translation({1e6f, 0.25f, static_cast<float>(i)}));
  const vec3 origin = path::tracing_origin(b.build());
  EXPECT_EQ(vec2(origin), vec2(1e6f, 0));
  EXPECT_NEAR(origin.z, 1.5f, 1.5f);
}

}  // namespace
}  // namespace candela
