#include <gtest/gtest.h>

#include <cmath>

#include "unit/path/scenes.h"

// A mesh placed once is stored in world space, one placed often is instanced: nobody may see which.

namespace candela {
namespace {

using namespace test;

path::Settings with_layers(path::Settings s) {
  s.layers = {Layer::albedo, Layer::normal, Layer::depth, Layer::position, Layer::object_id};
  return s;
}

/// A bump map whose normals lean to +u and +v, unevenly.
int add_normal_map(SceneBuilder& b) {
  std::vector<std::uint8_t> rgba;
  for (int i = 0; i < 16; ++i) {
    const vec3 n = glm::normalize(vec3(0.5f, i % 4 == 0 ? 0.4f : 0.15f, 1.0f));
    const auto byte = [](float v) { return static_cast<std::uint8_t>(std::lround(127.5f * (v + 1.0f))); };
    rgba.insert(rgba.end(), {byte(n.x), byte(n.y), byte(n.z), 255});
  }
  return b.add_texture(4, 4, rgba);
}

Primitive with_tangents(Primitive p, vec3 tangent, float handedness) {
  for (const vec3 n : p.normals) {
    const vec3 t = tangent - n * glm::dot(tangent, n);
    p.tangents.emplace_back(glm::length(t) > 1e-3f ? glm::normalize(t) : vec3(0, 0, 1), handedness);
  }
  return p;
}

Material bumpy(SceneBuilder& b) {
  Material m = plastic({0.8f, 0.5f, 0.3f}, 0.4f);
  m.normal_texture = slot(add_normal_map(b));
  return m;
}

std::vector<mat4> places() {
  return {translation({-1.1f, 0.2f, 0}) * rotation({1, 2, 3}, 0.7f) * scaling({0.7f, 1.1f, 0.9f}),
          translation({1.1f, 0, 0.2f}) * rotation({0, 1, 0}, 0.4f) * scaling({-0.8f, 0.8f, 0.8f}),
          translation({0, 0.1f, -1}) * scaling({1.0f, -1.2f, 0.6f})};
}

Scene three_bodies(bool shared, const Primitive& shape) {
  SceneBuilder b;
  const int material = b.add_material(bumpy(b));
  int mesh = -1;
  for (const mat4& m : places()) {
    if (mesh < 0 || !shared) mesh = b.add_mesh(with_tangents(shape, {1, 0.3f, 0}, 1.0f), material);
    b.add_node(mesh, m);
  }
  b.add(plane({0, -1, 0}, 5.0f), matte(vec3(0.6f)));
  b.add_light(point_light(vec3(1.0f), 40.0f), translation({1, 3, 3}));
  return b.build();
}

TEST(unit_path_instances, instances_look_like_baked_copies) {
  for (const Primitive& shape : {sphere(vec3(0.0f), 0.8f, 2, false), box(vec3(-0.5f), vec3(0.5f))}) {
    path::Settings s = with_layers(centred(48, 1, 1));
    const View view = look_at({0.5f, 1, 5}, vec3(0.0f), 0.6f);
    const Film instanced = shoot(three_bodies(true, shape), dark_environment(), view, s);
    const Film baked = shoot(three_bodies(false, shape), dark_environment(), view, s);
    // Direct light of one lamp: nothing is random but rounding, which decides who is hit at edges and where a ray
    // grazes.
    int differ = 0;
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 48; ++x) {
        const bool same =
            glm::length(instanced.beauty.rgb(x, y) - baked.beauty.rgb(x, y)) < 1e-3f &&
            glm::length(instanced.layers.at(Layer::normal).rgb(x, y) - baked.layers.at(Layer::normal).rgb(x, y)) <
                2e-3f &&
            glm::length(instanced.layers.at(Layer::position).rgb(x, y) - baked.layers.at(Layer::position).rgb(x, y)) <
                1e-3f &&
            instanced.layers.at(Layer::object_id).rgb(x, y) == baked.layers.at(Layer::object_id).rgb(x, y);
        differ += same ? 0 : 1;
      }
    }
    EXPECT_LE(differ, 4);
    EXPECT_GT(mean_luminance(baked.beauty), 0.1);
  }
}

TEST(unit_path_instances, instances_have_the_global_illumination_of_baked_copies) {
  const View view = look_at({0.5f, 1, 5}, vec3(0.0f), 0.6f);
  const Environment e = constant_environment(vec3(0.5f));
  const Primitive shape = sphere(vec3(0.0f), 0.8f, 2, false);
  const auto a = mean_over_seeds(8, three_bodies(true, shape), e, view, settings(12, 32, 4));
  const auto b = mean_over_seeds(8, three_bodies(false, shape), e, view, settings(12, 32, 4));
  for (std::size_t i = 0; i < 3; ++i) {
    const double error = std::hypot(a[i].standard_error(), b[i].standard_error());
    EXPECT_GT(normal_p_value((a[i].mean() - b[i].mean()) / error), sidak_threshold(3));
    EXPECT_LT(error, 0.005 * b[i].mean());
  }
}

/// Three squares side by side, white but for what their nodes say, or of those colours themselves.
Scene coloured_squares(bool by_node, const std::vector<vec4>& colors) {
  SceneBuilder b;
  Material white = matte(vec3(1.0f));
  white.unlit = true;
  white.alpha_mode = AlphaMode::mask;
  const int shared = b.add_mesh(quad({-0.4f, -0.4f, 0}, {0.8f, 0, 0}, {0, 0.8f, 0}), b.add_material(white));
  Scene scene;
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const mat4 place = translation({static_cast<float>(i) - 1.0f, 0, 0});
    if (by_node) {
      b.add_node(shared, place);
    } else {
      Material own = white;
      own.base_color = vec3(colors[i]);
      own.opacity = colors[i].w;
      b.add_node(b.add_mesh(quad({-0.4f, -0.4f, 0}, {0.8f, 0, 0}, {0, 0.8f, 0}), b.add_material(own)), place);
    }
  }
  scene = b.build();
  for (std::size_t i = 0; by_node && i < colors.size(); ++i) scene.nodes[i].color = colors[i];
  return scene;
}

TEST(unit_path_instances, colours_of_nodes_are_those_of_materials_of_their_own) {
  const std::vector<vec4> colors = {vec4(1, 0.1f, 0.1f, 1), vec4(0.1f, 1, 0.1f, 1), vec4(0.1f, 0.1f, 1, 1)};
  // Of opacity 0.2 a mask leaves nothing; of 0.8 all.
  const std::vector<vec4> faded = {vec4(1, 0.1f, 0.1f, 0.2f), vec4(0.1f, 1, 0.1f, 0.8f), vec4(1, 1, 1, 0.2f)};
  const View view = look_at({0, 0, 5}, vec3(0.0f), 0.6f);
  for (const auto& list : {colors, faded}) {
    path::Statistics statistics;
    const Film by_node =
        path::render(coloured_squares(true, list), dark_environment(), view, centred(48, 1, 1), {}, &statistics);
    const Film by_material = shoot(coloured_squares(false, list), dark_environment(), view, centred(48, 1, 1));
    EXPECT_LT(glm::length(by_node.beauty.rgb(24, 24) - vec3(list[1])), 1e-6f);
    // At their edges instances are rounded another way.
    std::size_t different = 0;
    for (std::size_t i = 0; i < by_node.beauty.pixels.size(); ++i) {
      different += by_node.beauty.pixels[i] != by_material.beauty.pixels[i] ? 1 : 0;
    }
    EXPECT_LT(different, by_node.beauty.pixels.size() / 100);
    // What differs in colour alone is stored once.
    EXPECT_EQ(statistics.triangles, list == colors ? 2U : 4U);
  }
}

TEST(unit_path_instances, statistics_count_what_is_stored_and_placed) {
  for (const bool shared : {true, false}) {
    path::Statistics statistics;
    path::render(three_bodies(shared, box(vec3(-0.5f), vec3(0.5f))), dark_environment(),
                 look_at({0, 0, 5}, vec3(0.0f), 0.6f), settings(4, 1, 1), {}, &statistics);
    EXPECT_EQ(statistics.triangles, shared ? 14U : 38U);
    EXPECT_EQ(statistics.instances, shared ? 3U : 0U);
  }
}

/// A body, lit from the side; the whole world mirrored at x = 0 when `factor` is -1. `copies` > 1 makes it an instance.
Film lit_body(float factor, int copies, const Primitive& shape, bool flat_handedness) {
  SceneBuilder b;
  const mat4 mirror = scaling({factor, 1, 1});
  const int mesh =
      b.add_mesh(with_tangents(shape, {1, 0.3f, 0}, flat_handedness ? 1.0f : -1.0f), b.add_material(bumpy(b)));
  b.add_node(mesh, mirror * translation({0.3f, 0.1f, 0}) * rotation({1, 2, 0.5f}, 0.6f));
  for (int i = 1; i < copies; ++i) b.add_node(mesh, translation({0, 0, 100.0f}));  // behind the camera
  b.add_light(point_light({1, 0.9f, 0.8f}, 20.0f), translation({factor * 2.0f, 1.5f, 2.5f}));
  path::Settings s = with_layers(centred(40, 1, 1));
  return shoot(b.build(), dark_environment(), look_at({0, 0, 4}, vec3(0.0f), 0.6f), s);
}

TEST(unit_path_instances, negative_scale_is_the_mirror_image) {
  for (const Primitive& shape : {sphere(vec3(0.0f), 0.8f, 3, false), box(vec3(-0.5f), vec3(0.5f))}) {
    for (const bool right_handed : {true, false}) {
      for (const int copies : {1, 2}) {
        const Film plain = lit_body(1.0f, copies, shape, right_handed);
        const Film mirrored = lit_body(-1.0f, copies, shape, right_handed);
        const Image light = mirrored_left_to_right(mirrored.beauty);
        const Image n = mirrored_left_to_right(mirrored.layers.at(Layer::normal));
        int differ = 0;
        for (int y = 0; y < 40; ++y) {
          for (int x = 0; x < 40; ++x) {
            const vec3 normal = plain.layers.at(Layer::normal).rgb(x, y) * vec3(-1, 1, 1);
            const bool same = glm::length(n.rgb(x, y) - normal) < 2e-3f &&
                              glm::length(light.rgb(x, y) - plain.beauty.rgb(x, y)) < 2e-3f;
            differ += same ? 0 : 1;
          }
        }
        EXPECT_LE(differ, 4);
        // The picture is no mirror image of itself, or this would prove nothing.
        const Image itself = mirrored_left_to_right(plain.beauty);
        EXPECT_GT(largest_difference(itself, plain.beauty), 0.05);
      }
    }
  }
}

TEST(unit_path_instances, handedness_of_tangents_turns_the_map_upside_down) {
  const Primitive shape = box(vec3(-0.5f), vec3(0.5f));
  EXPECT_GT(largest_difference(lit_body(1.0f, 1, shape, true).layers.at(Layer::normal),
                               lit_body(1.0f, 1, shape, false).layers.at(Layer::normal)),
            0.1);
}

TEST(unit_path_instances, normal_map_leans_along_tangent_and_bitangent) {
  SceneBuilder b;
  Material m = matte(vec3(1.0f));
  const vec3 n = glm::normalize(vec3(0.3f, 0.2f, 1.0f));
  const auto byte = [](float v) { return static_cast<std::uint8_t>(std::lround(127.5f * (v + 1.0f))); };
  m.normal_texture = slot(b.add_texture(1, 1, {byte(n.x), byte(n.y), byte(n.z), 255}));
  Primitive p = quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  for (int i = 0; i < 4; ++i) p.tangents.emplace_back(1, 0, 0, 1);
  for (const float scale : {1.0f, 0.5f}) {
    m.normal_scale = scale;
    SceneBuilder c = b;
    c.add(p, m);
    path::Settings s = with_layers(centred(4, 1, 1));
    const Film film = shoot(c.build(), dark_environment(), look_at({0, 0, 4}, vec3(0.0f), 0.2f), s);
    const vec3 expected = glm::normalize(vec3(scale * n.x, scale * n.y, n.z));
    EXPECT_LT(glm::length(film.layers.at(Layer::normal).rgb(2, 2) - expected), 0.01f);
  }
}

TEST(unit_path_instances, flattened_instances_stay_finite) {
  SceneBuilder b;
  const int mesh = b.add_mesh(sphere(vec3(0.0f), 0.8f, 2, false), b.add_material(plastic(vec3(0.8f), 0.3f)));
  b.add_node(mesh, translation({-1, 0, 0}) * scaling({1, 1, 0}));
  b.add_node(mesh, translation({1, 0, 0}) * scaling({1, 0, 0}));
  b.add_node(b.add_mesh(sphere(vec3(0.0f), 0.8f, 2, false), 0), scaling({0, 1, 1}));
  path::Settings s = with_layers(settings(16, 8, 4));
  const Film film = shoot(b.build(), constant_environment(vec3(1.0f)), look_at({0.4f, 0.6f, 4}, vec3(0.0f), 0.6f), s);
  EXPECT_TRUE(is_finite_and_not_negative(film.beauty));
  for (const float v : film.layers.at(Layer::normal).pixels) EXPECT_TRUE(std::isfinite(v));
}

}  // namespace
}  // namespace candela
