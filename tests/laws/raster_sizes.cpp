#include <gtest/gtest.h>

#include <cmath>

#include "laws/raster_draw.h"
#include "raster/render.h"
#include "unit/gl/gl_fixture.h"
#include "unit/path/scenes.h"

// A picture is of what is near the eye: neither what else there is in the scene, nor where the scene is, nor how large,
// changes it.

namespace candela {
namespace {

using namespace test;

class law_raster_sizes : public NeedsGl {};  // NOLINT(readability-identifier-naming): a suite is named as its laws

raster::Settings drawn(int size) {
  raster::Settings s;
  s.width = s.height = size;
  s.msaa = 1;
  return s;
}

using test::draw;

double share_of_wrong_pixels(const Image& expected, const Image& found) {
  double wrong = 0.0, count = 0.0;
  for (int y = 0; y < expected.height; ++y) {
    for (int x = 0; x < expected.width; ++x, ++count) {
      const float e = luminance(expected.rgb(x, y)), f = luminance(found.rgb(x, y));
      wrong += std::abs(e - f) > 0.1f * std::max(e, 0.1f) ? 1.0 : 0.0;
    }
  }
  return wrong / count;
}

/// What everything in a scene is placed by.
struct Placement {
  float scale = 1.0f;
  vec3 offset{0.0f};
  bool in_vertices = false;  ///< rather than in the nodes

  vec3 operator()(vec3 p) const { return p * scale + offset; }
  mat4 matrix() const { return translation(offset) * scaling(vec3(scale)); }
};

void add(SceneBuilder& b, Primitive primitive, const Material& material, const Placement& place) {
  if (!place.in_vertices) {
    b.add(std::move(primitive), material, place.matrix());
    return;
  }
  for (vec3& p : primitive.positions) p = place(p);
  b.add(std::move(primitive), material);
}

enum class Lamp { point, spot, sun, panel, bulb };
constexpr std::array kLamps = {Lamp::point, Lamp::spot, Lamp::sun, Lamp::panel, Lamp::bulb};

/// A plate close below a lamp, over a floor. All coordinates are multiples of 1/16, but those of the bulb.
SceneBuilder shaded_floor(Lamp kind, const Placement& place) {
  SceneBuilder b;
  add(b, plane(vec3(0.0f), 2.0f), matte(vec3(0.8f)), place);
  add(b, box({-0.25f, 1.25f, -0.25f}, {0.25f, 1.3125f, 0.25f}), matte(vec3(0.5f)), place);
  const vec3 at(0.5f, 2.0f, 0.25f);
  const float square = place.scale * place.scale;
  switch (kind) {
    case Lamp::point:
      b.add_light(point_light(vec3(1.0f), 10.0f * square), translation(place(at)));
      break;
    case Lamp::spot:
      b.add_light(spot_light(vec3(1.0f), 10.0f * square, 0.4f, 0.7f),
                  translation(place(at)) * aimed(vec3(0.0f), vec3(-0.25f, -1.0f, -0.125f)));
      break;
    case Lamp::sun:
      b.add_light(sunlight(vec3(1.0f), 3.0f), aimed(at, vec3(0.0f)));
      break;
    case Lamp::panel:
      add(b, quad({0.25f, 2.0f, 0.0f}, {0.5f, 0, 0}, {0, 0, 0.5f}), lamp(vec3(20.0f)), place);
      break;
    case Lamp::bulb:
      add(b, sphere(at, 0.125f, 2, false), lamp(vec3(50.0f)), place);
      break;
  }
  return b;
}

View view_of(const Placement& place) {
  View view = look_at({0.0f, 3.0f, 4.0f}, vec3(0.0f), 0.7f);
  view.world_from_camera[3] = vec4(place({0.0f, 3.0f, 4.0f}), 1.0f);
  return view;
}

TEST_F(law_raster_sizes, shadows_do_not_know_what_else_is_far_away) {
  const Placement here;
  for (const Lamp kind : kLamps) {
    SceneBuilder alone = shaded_floor(kind, here);
    const Image expected = draw(alone.build(), dark_environment(), view_of(here), drawn(64)).beauty;
    for (const float far : {1e3f, 1e5f}) {
      SceneBuilder b = shaded_floor(kind, here);
      for (const float side : {-1.0f, 1.0f}) {
        b.add(moved(box(vec3(-0.5f), vec3(0.5f)), {side * far, 0, 0}), matte(vec3(0.5f)));
      }
      const Image found = draw(b.build(), dark_environment(), view_of(here), drawn(64)).beauty;
      EXPECT_LT(share_of_wrong_pixels(expected, found), 0.005)
          << "lamp " << static_cast<int>(kind) << ", posts at " << far;
    }
    // The twin: without the plate the picture is another.
    SceneBuilder bare = shaded_floor(kind, here);
    bare.scene().nodes[1].world_from_node = translation({0, 0, 1e3f});
    const Image unshaded = draw(bare.build(), dark_environment(), view_of(here), drawn(64)).beauty;
    EXPECT_GT(share_of_wrong_pixels(expected, unshaded), 0.02) << static_cast<int>(kind);
  }
}

TEST_F(law_raster_sizes, a_scene_may_be_small_large_or_far_from_the_origin) {
  // 2^17 m, where floats are 1/64 m apart.
  const std::vector<Placement> places = {
      {1e-4f}, {1e3f}, {1.0f, vec3(131072.0f, 0.0f, 131072.0f)}, {1.0f, vec3(131072.0f, 0.0f, 131072.0f), true}};
  for (const Lamp kind : kLamps) {
    const Image expected = draw(shaded_floor(kind, {}).build(), dark_environment(), view_of({}), drawn(64)).beauty;
    for (const Placement& place : places) {
      const bool is_rough = kind == Lamp::bulb && place.in_vertices;  // its corners are at multiples of 1/64 m
      raster::Settings settings = drawn(64);
      settings.layers = {Layer::position, Layer::distance};
      const Film found = draw(shaded_floor(kind, place).build(), dark_environment(), view_of(place), settings);
      EXPECT_LT(share_of_wrong_pixels(expected, found.beauty), is_rough ? 0.02 : 0.005)
          << "lamp " << static_cast<int>(kind) << ", scale " << place.scale << ", at " << place.offset.x << ", "
          << place.in_vertices;
      // The floor beside the lamp, in the world's numbers.
      const vec3 p = found.layers.at(Layer::position).rgb(8, 48);
      EXPECT_NEAR(p.y, 0.0f, 1e-3f * place.scale);
      EXPECT_NEAR(found.layers.at(Layer::distance).pixels[48 * 64 + 8], glm::distance(p, place({0, 3, 4})),
                  0.02f * place.scale);
    }
  }
}

TEST_F(law_raster_sizes, a_node_far_away_puts_its_mesh_where_no_float_is) {
  // Floats of the world are 1/64 m apart there, which is a pixel.
  const auto scene = [](vec3 at) {
    SceneBuilder b;
    b.add(quad({-0.3f, -0.2f, 0.0f}, {0.307f, 0, 0}, {0, 0.409f, 0}), unlit(vec3(1.0f)), translation(at));
    b.add(quad({0.011f, -0.2f, 0.0f}, {0.3f, 0, 0}, {0, 0.409f, 0}), unlit({0, 1, 0}), translation(at));
    return b.build();
  };
  View view = look_at({0, 0, 1}, vec3(0.0f), 0.8f);
  const Image expected = draw(scene(vec3(0.0f)), dark_environment(), view, drawn(64)).beauty;
  EXPECT_GT(mean_luminance(expected), 0.1);
  const vec3 far(131072.0f, 65536.0f, 0.0f);
  view.world_from_camera = translation(far) * view.world_from_camera;
  EXPECT_EQ(largest_difference(expected, draw(scene(far), dark_environment(), view, drawn(64)).beauty), 0.0);
}

TEST_F(law_raster_sizes, what_only_the_rim_of_the_lens_sees_is_not_cut_off) {
  // Beside the pinhole's view, twenty times nearer than all else.
  SceneBuilder b;
  b.add(quad({0.0225f, -0.05f, -0.05f}, {0.05f, 0, 0}, {0, 0.1f, 0}), unlit(vec3(1.0f)));
  b.add(quad({-1.0f, -1.0f, -1.0f}, {2, 0, 0}, {0, 2, 0}), unlit(vec3(0.01f)));
  const Scene scene = b.build();
  View view = look_at(vec3(0.0f), {0, 0, -1}, 0.8f);
  view.lens.radius = 0.01f, view.lens.focus_distance = 1.0f;
  raster::Settings many = drawn(16);
  many.frames = 64;
  const Region right{8, 0, 16, 16};
  const double expected = mean_of(shoot(scene, dark_environment(), view, settings(16, 256, 1)).beauty, right).x;
  EXPECT_GT(expected, 0.05);
  EXPECT_NEAR(mean_of(draw(scene, dark_environment(), view, many).beauty, right).x, expected, 0.1 * expected);
}

TEST_F(law_raster_sizes, what_is_near_is_seen_in_a_dome_of_any_size) {
  const vec3 red(1, 0, 0);
  for (const float size : {1.0f, 1e-2f}) {
    for (const float dome : {0.0f, 1e3f, 2e4f}) {
      SceneBuilder b;
      b.add(quad(vec3(-0.1f, -0.1f, -0.5f) * size, {0.2f * size, 0, 0}, {0, 0.2f * size, 0}), unlit(red));
      b.add(quad(vec3(-0.1f, -0.1f, -0.51f) * size, {0.2f * size, 0, 0}, {0, 0.2f * size, 0}), unlit({0, 1, 0}));
      if (dome > 0.0f) b.add(turned_inside_out(box(vec3(-dome), vec3(dome))), unlit({0, 0, 1}));
      b.add(plane({0, -1.5f, 0}, std::max(dome, 1.0f)), unlit({0, 0, 0.5f}));
      const Scene scene = b.build();
      // What is far away is not covered by the sky.
      const Environment sky = constant_environment(vec3(0.0f, 1.0f, 1.0f));
      View view = look_at(vec3(0.0f), {0, 0, -1}, 0.8f);
      const Image picture = draw(scene, sky, view, drawn(32)).beauty;
      EXPECT_EQ(picture.rgb(16, 15), red) << dome;
      EXPECT_EQ(picture.rgb(16, 2), dome > 0.0f ? vec3(0, 0, 1) : vec3(0, 1, 1)) << dome;
      view.lens.radius = 0.01f * size, view.lens.focus_distance = 0.5f * size;
      raster::Settings many = drawn(32);
      many.frames = 4;
      EXPECT_NEAR(draw(scene, sky, view, many).beauty.rgb(16, 15).x, 1.0f, 1e-3f) << dome;
      // Along parallel rays floats tell apart a ten-millionth of the depth.
      if (dome * 1e-6f > 0.02f * size) continue;
      view.lens = {};
      view.projection = OrthographicCamera{size, size};
      EXPECT_EQ(draw(scene, sky, view, drawn(32)).beauty.rgb(16, 15), red) << dome;
    }
  }
}

TEST_F(law_raster_sizes, away_from_everything_there_is_the_sky) {
  const Environment sky = mapped_environment(128, 64, [](vec3 d) { return vec3(0.5f) + 0.4f * d; });
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 0.5f), matte(vec3(0.8f)));
  const Scene scene = b.build();
  // Beside the view, and right behind it.
  for (const auto& [eye, target] : {std::pair(vec3(3, 3, 0), vec3(9, 3, 0)),
                                    {vec3(3, 3, 0), vec3(3.0f, 9.0f, 0.01f)},
                                    {vec3(0, 3, 0), vec3(0.0f, 9.0f, 0.01f)}}) {
    for (const bool is_perspective : {true, false}) {
      View view = look_at(eye, target, 0.8f);
      if (!is_perspective) view.projection = OrthographicCamera{1.0f, 1.0f};
      const Image expected = shoot(scene, sky, view, centred(24, 1, 1)).beauty;
      const Image found = draw(scene, sky, view, drawn(24)).beauty;
      EXPECT_GT(mean_luminance(expected), 0.1);
      EXPECT_LT(largest_difference(expected, found), 0.01) << eye.x << ", " << target.x << ", " << is_perspective;
    }
  }
}

TEST_F(law_raster_sizes, an_orthographic_camera_sees_nothing_behind_it) {
  SceneBuilder b;
  b.add(quad({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}), unlit({1, 0, 0}));
  b.add(quad({-1, -1, -3}, {2, 0, 0}, {0, 2, 0}), unlit({0, 1, 0}));
  View view = look_at(vec3(0.0f), {0, 0, -1}, 0.8f);
  view.projection = OrthographicCamera{0.5f, 0.5f};
  EXPECT_EQ(draw(b.build(), dark_environment(), view, drawn(16)).beauty.rgb(8, 8), vec3(0, 1, 0));
}

TEST_F(law_raster_sizes, no_number_is_too_large_for_a_picture) {
  const auto wall = [](float scale) {
    SceneBuilder b;
    b.add(quad(vec3(-1e5f, -1e5f, -2e5f) * scale, {2e5f * scale, 0, 0}, {0, 2e5f * scale, 5e4f * scale}),
          lamp(vec3(1e7f)));
    return b.build();
  };
  const View view = look_at(vec3(0.0f), {0, 0, -1}, 0.8f);
  for (const raster::Quantity quantity :
       {raster::Quantity::light, raster::Quantity::position, raster::Quantity::depth}) {
    raster::Settings settings = drawn(16);
    settings.quantity = quantity;
    const Environment sky = constant_environment(vec3(1e6f));
    const Image large = draw(wall(1.0f), sky, view, settings).beauty;
    EXPECT_GT(mean_luminance(large), 0.1) << static_cast<int>(quantity);
    // Lengths are shown over the scene's size.
    EXPECT_LT(largest_difference(large, draw(wall(1e-4f), sky, view, settings).beauty), 1e-3);
  }
}

}  // namespace
}  // namespace candela
