#include <gtest/gtest.h>

#include <cmath>

#include "unit/path/scenes.h"

namespace candela {
namespace {

using namespace test;

const std::set<Layer> kAllLayers = {Layer::albedo,   Layer::normal,   Layer::camera_normal, Layer::depth,
                                    Layer::distance, Layer::position, Layer::object_id};

/// A tilted square (node 1) and a ball (node 3); node 0 has no mesh, node 2 is a light.
Scene known_scene() {
  SceneBuilder b;
  b.add_node(-1);
  b.add(quad({-1, -1, 0}, {1, 0, 0}, {0, 2, 0}), matte({0.2f, 0.4f, 0.6f}), rotation({0, 1, 0}, 0.5f));
  b.add_light(point_light(vec3(1.0f), 10.0f), translation({0, 0, 3}));
  b.add(sphere({1, 0, 0}, 0.5f, 4, false), lamp(vec3(3.0f)));
  return b.build();
}

TEST(unit_path_layers, depth_position_normal_albedo_and_id_are_those_of_the_scene) {
  path::Settings s = settings(64, 16, 2);
  s.layers = kAllLayers;
  const View view = look_at({0, 0, 5}, vec3(0.0f), 0.6f);
  const Film film = shoot(known_scene(), constant_environment(vec3(1.0f)), view, s);
  ASSERT_EQ(film.layers.size(), kAllLayers.size());
  const auto at = [&](Layer layer, int x, int y) { return film.layers.at(layer).rgb(x, y); };
  const auto ray = [&](int x, int y) {
    const float t = std::tan(0.3f);
    return glm::normalize(vec3(t * ((static_cast<float>(x) + 0.5f) / 32.0f - 1.0f),
                               t * (1.0f - (static_cast<float>(y) + 0.5f) / 32.0f), -1.0f));
  };
  // ----- the square, whose front is (sin, 0, cos)
  {
    const int x = 20, y = 30;
    const vec3 n(std::sin(0.5f), 0, std::cos(0.5f)), d = ray(x, y), eye(0, 0, 5);
    const float distance = -glm::dot(eye, n) / glm::dot(d, n);
    EXPECT_NEAR(at(Layer::distance, x, y).x, distance, 1e-4f);
    EXPECT_NEAR(at(Layer::depth, x, y).x, distance * -d.z, 1e-4f);
    EXPECT_LT(glm::length(at(Layer::position, x, y) - (eye + d * distance)), 1e-4f);
    EXPECT_LT(glm::length(at(Layer::normal, x, y) - n), 1e-4f);
    EXPECT_LT(glm::length(at(Layer::camera_normal, x, y) - n), 1e-4f) << "of a camera that is not turned";
    EXPECT_LT(glm::length(at(Layer::albedo, x, y) - vec3(0.2f, 0.4f, 0.6f)), 1e-4f);
    EXPECT_EQ(at(Layer::object_id, x, y).x, 2.0f);
  }
  // ----- the ball: a lamp, whose albedo layer is 1
  {
    const int x = 52, y = 32;
    const vec3 p = at(Layer::position, x, y);
    EXPECT_NEAR(glm::length(p - vec3(1, 0, 0)), 0.5f, 5e-3f);
    EXPECT_LT(glm::length(at(Layer::normal, x, y) - glm::normalize(p - vec3(1, 0, 0))), 0.03f);
    EXPECT_EQ(at(Layer::albedo, x, y), vec3(1.0f));
    EXPECT_EQ(at(Layer::object_id, x, y).x, 4.0f);
  }
  // ----- nothing
  EXPECT_EQ(at(Layer::depth, 1, 1).x, kInfinity);
  EXPECT_EQ(at(Layer::normal, 1, 1), vec3(0.0f));
  EXPECT_EQ(at(Layer::object_id, 1, 1).x, 0.0f);
  EXPECT_EQ(film.beauty.at(1, 1)[3], 1.0f);
}

TEST(unit_path_layers, ids_are_the_numbers_that_the_file_gives_its_nodes) {
  Scene scene = known_scene();
  scene.nodes[1].file_index = 40;  // as of an instance: the ball's the same
  scene.nodes[3].file_index = 40;
  path::Settings s = settings(64, 1, 1);
  s.layers = {Layer::object_id};
  const Film film = shoot(scene, dark_environment(), look_at({0, 0, 5}, vec3(0.0f), 0.6f), s);
  EXPECT_EQ(film.layers.at(Layer::object_id).rgb(20, 30).x, 41.0f);
  EXPECT_EQ(film.layers.at(Layer::object_id).rgb(52, 32).x, 41.0f);
  EXPECT_EQ(film.layers.at(Layer::object_id).rgb(1, 1).x, 0.0f);
}

/// One ball before another, in the middle of a picture on which they are alone.
Scene two_balls() {
  SceneBuilder b;
  b.add(sphere({0, 0, 0}, 1.0f, 4, false), matte(vec3(0.5f)));
  b.add(sphere({0.4f, 0, 2}, 0.5f, 4, false), matte(vec3(0.2f)));
  return b.build();
}

TEST(unit_path_layers, mattes_sum_to_the_coverage) {
  path::Settings s = settings(24, 64, 1);
  s.background = Background::transparent;
  s.mattes = {MatteKind::object, MatteKind::material};
  View view = look_at({0, 0, 6}, vec3(0.0f), 0.5f);
  view.lens = {.radius = 0.1f, .focus_distance = 6.0f};
  const Film film = shoot(two_balls(), constant_environment(vec3(1.0f)), view, s);
  for (const auto& [kind, mattes] : film.mattes) {
    int shared = 0;
    for (std::size_t i = 0; i < film.beauty.pixels.size() / 4; ++i) {
      float sum = 0.0f;
      for (std::size_t r = 0; r < Mattes::kRanks; ++r) sum += mattes.at(i)[r].coverage;
      ASSERT_NEAR(sum, film.beauty.pixels[4 * i + 3], 1e-5f);
      shared += mattes.at(i)[1].coverage > 0.0f ? 1 : 0;
    }
    EXPECT_GT(shared, 10) << "some pixels have both";
    EXPECT_EQ(mattes.names.size(), 2u);
  }
  // What is sharp in a mask is soft in a matte: at the pixel's centre there is the one that covers most, but for edges.
  s.layers = {Layer::instance};
  const Film numbers = shoot(two_balls(), constant_environment(vec3(1.0f)), look_at({0, 0, 6}, vec3(0.0f), 0.5f), s);
  const Mattes& objects = numbers.mattes.at(MatteKind::object);
  int differing = 0;
  for (std::size_t i = 0; i < numbers.beauty.pixels.size() / 4; ++i) {
    const bool is_empty = objects.at(i)[0].coverage < 0.5f;
    const float most = is_empty ? 0.0f : static_cast<float>(objects.at(i)[0].number + 1);
    differing += most == numbers.layers.at(Layer::instance).pixels[i] ? 0 : 1;
  }
  EXPECT_LT(differing, 24 * 24 / 20);
}

TEST(unit_path_layers, half_opacity_between_vertices_is_there_at_every_pixel) {
  SceneBuilder b;
  Material veil = unlit(vec3(1.0f));
  veil.alpha_mode = AlphaMode::blend;
  Primitive front = quad({-2, -2, 1}, {4, 0, 0}, {0, 4, 0});
  front.colors.assign(front.positions.size(), vec4(1, 1, 1, 0.5f));
  b.add(front, veil);
  b.add(quad({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}), matte(vec3(0.5f)));
  path::Settings s = settings(64, 1, 1);
  s.layers = {Layer::instance};
  const Film film = shoot(b.build(), dark_environment(), look_at({0, 0, 5}, vec3(0.0f), 0.5f), s);
  for (const float number : film.layers.at(Layer::instance).pixels) ASSERT_EQ(number, 1.0f);
}

TEST(unit_path_layers, masks_reach_behind_what_hides_them) {
  path::Settings s = settings(48, 1, 1);
  s.has_masks = true;
  s.layers = {Layer::instance};
  const View view = look_at({0, 0, 6}, vec3(0.0f), 0.5f);
  const Film both = shoot(two_balls(), dark_environment(), view, s);
  ASSERT_EQ(both.masks->size(), 2u);
  for (int k = 0; k < 2; ++k) {
    // Each alone is seen where its mask is.
    Scene scene = two_balls();
    scene.nodes[static_cast<std::size_t>(1 - k)].mesh = -1;
    const Film alone = shoot(scene, dark_environment(), view, s);
    const InstanceMask& mask = both.masks->at(static_cast<std::size_t>(k));
    EXPECT_EQ(mask.node, k);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 48; ++x) {
        ASSERT_EQ(mask.covers({x, y}), alone.layers.at(Layer::instance).rgb(x, y).x == static_cast<float>(k + 1));
      }
    }
  }
}

TEST(unit_path_layers, only_what_was_asked_for_is_there) {
  path::Settings s = settings(4, 1, 1);
  EXPECT_TRUE(shoot(known_scene(), dark_environment(), look_at({0, 0, 5}, vec3(0.0f), 0.6f), s).layers.empty());
  for (const Layer layer : kAllLayers) {
    s.layers = {layer};
    const Film film = shoot(known_scene(), dark_environment(), look_at({0, 0, 5}, vec3(0.0f), 0.6f), s);
    ASSERT_EQ(film.layers.size(), 1U);
    EXPECT_TRUE(film.layers.contains(layer));
  }
}

TEST(unit_path_layers, centre_layers_of_a_lens_are_those_of_its_middle) {
  path::Settings s = settings(32, 4, 1);
  s.layers = {Layer::depth, Layer::position, Layer::object_id};
  View view = look_at({0, 0, 5}, vec3(0.0f), 0.6f);
  const Film sharp = shoot(known_scene(), dark_environment(), view, s);
  for (const int blades : {0, 5, 6}) {
    view.lens = {.radius = 0.4f, .focus_distance = 2.0f, .blades = blades, .vignetting = 0.0f};
    const Film blurred = shoot(known_scene(), dark_environment(), view, s);
    for (const auto& [layer, image] : sharp.layers) {
      for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        if (std::isinf(image.pixels[i])) continue;
        ASSERT_NEAR(image.pixels[i], blurred.layers.at(layer).pixels[i], 1e-3f) << blades << " blades";
      }
    }
  }
}

TEST(unit_path_layers, background_is_the_environment_or_nothing) {
  const View view = look_at({0, 0, 5}, vec3(0.0f), 0.6f);
  const Environment e = constant_environment({0.3f, 0.6f, 0.9f});
  path::Settings s = settings(32, 16, 2);
  const Film environment = shoot(known_scene(), e, view, s);
  EXPECT_LT(glm::length(environment.beauty.rgb(1, 1) - vec3(0.3f, 0.6f, 0.9f)), 1e-6f);
  s.background = Background::transparent;
  const Film transparent = shoot(known_scene(), e, view, s);
  EXPECT_EQ(transparent.beauty.rgb(1, 1), vec3(0.0f));
  EXPECT_EQ(transparent.beauty.at(1, 1)[3], 0.0f);
  EXPECT_EQ(transparent.beauty.at(10, 15)[3], 1.0f);
  // What is seen of the scene, and its light, does not depend on the background.
  EXPECT_EQ(environment.beauty.rgb(10, 15), transparent.beauty.rgb(10, 15));
}

TEST(unit_path_layers, alpha_of_a_transparent_background_is_the_coverage) {
  SceneBuilder b;
  Material half = unlit(vec3(0.8f));
  half.alpha_mode = AlphaMode::blend;
  half.opacity = 0.3f;
  b.add(quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), half);
  path::Settings s = settings(16, 256, 1);
  s.background = Background::transparent;
  const Film film = shoot(b.build(), dark_environment(), look_at({0, 0, 5}, vec3(0.0f), 0.2f), s);
  double alpha = 0.0;
  for (int i = 0; i < 256; ++i) alpha += static_cast<double>(film.beauty.at(i % 16, i / 16)[3]) / 256.0;
  EXPECT_NEAR(alpha, 0.3, 0.01);
  EXPECT_NEAR(mean_of(film.beauty).x, 0.8 * alpha, 1e-5);  // premultiplied

  // A square over half a pixel's width, by the box filter.
  SceneBuilder c;
  c.add(quad({-1, -1, 0}, {1.0f + 0.125f, 0, 0}, {0, 2, 0}), unlit(vec3(1.0f)));
  View view;
  view.world_from_camera = translation({0, 0, 3});
  view.projection = OrthographicCamera{.xmag = 1.0f, .ymag = 1.0f};
  s.width = s.height = 8;
  const Film edge = shoot(c.build(), dark_environment(), view, s);
  EXPECT_EQ(edge.beauty.at(3, 3)[3], 1.0f);
  EXPECT_NEAR(edge.beauty.at(4, 3)[3], 0.5f, 0.01f);
  EXPECT_EQ(edge.beauty.at(5, 3)[3], 0.0f);
}

TEST(unit_path_layers, unlit_shows_its_colour_whatever_the_light) {
  for (const float light : {0.0f, 1.0f, 1000.0f}) {
    SceneBuilder b;
    Material m = unlit({0.2f, 0.5f, 0.7f});
    m.emission = vec3(7.0f);  // not used by unlit materials
    Primitive p = quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    p.colors.assign(4, {0.5f, 1, 1, 1});
    b.add(p, m);
    b.add_light(point_light(vec3(1.0f), light), translation({0, 0, 1}));
    const Film film =
        shoot(b.build(), constant_environment(vec3(light)), look_at({0, 0, 5}, vec3(0.0f), 0.2f), settings(4, 4, 4));
    EXPECT_LT(glm::length(film.beauty.rgb(2, 2) - vec3(0.1f, 0.5f, 0.7f)), 1e-6f);
  }
}

}  // namespace
}  // namespace candela
