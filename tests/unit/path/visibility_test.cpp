#include <gtest/gtest.h>

#include <cmath>

#include "unit/path/scenes.h"

// Who is seen, who shades, and that surfaces do not shade themselves.

namespace candela {
namespace {

using namespace test;

// ----- backs

/// A square in z = 0 that turns its back to the camera, in front of a wall that glows with 2.
Image back_of(const Material& material) {
  SceneBuilder b;
  b.add(turned_inside_out(quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0})), material);
  b.add(quad({-5, -5, -2}, {10, 0, 0}, {0, 10, 0}), lamp(vec3(2.0f)));
  View view;
  view.world_from_camera = translation({0, 0, 3});
  view.projection = OrthographicCamera{.xmag = 0.5f, .ymag = 0.5f};
  return shoot(b.build(), dark_environment(), view, settings(8, 4, 4)).beauty;
}

TEST(unit_path_visibility, camera_looks_through_single_sided_backs) {
  Material m = unlit(vec3(0.5f));
  for (int y = 0; y < 8; ++y) {
    EXPECT_EQ(back_of(m).rgb(3, y), vec3(2.0f));
  }
  m.double_sided = true;
  EXPECT_EQ(back_of(m).rgb(3, 3), vec3(0.5f));
}

TEST(unit_path_visibility, backs_of_mirrored_bodies_are_backs_too) {
  for (const bool shared : {false, true}) {
    for (const float factor : {1.0f, -1.0f}) {
      SceneBuilder b;
      const int mesh = b.add_mesh(quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), b.add_material(unlit(vec3(0.5f))));
      b.add_node(mesh, scaling({factor, 1, 1}));
      if (shared) b.add_node(mesh, translation({0, 0, 50}));
      // It keeps facing +z, whatever happens to x.
      const Image front =
          shoot(b.build(), dark_environment(), look_at({0, 0, 3}, vec3(0.0f), 0.2f), settings(4, 1, 1)).beauty;
      EXPECT_EQ(front.rgb(2, 2), vec3(0.5f)) << shared << factor;
      const Image back =
          shoot(b.build(), dark_environment(), look_at({0, 0, -3}, vec3(0.0f), 0.2f), settings(4, 1, 1)).beauty;
      EXPECT_EQ(back.rgb(2, 2), vec3(0.0f)) << shared << factor;
    }
  }
}

TEST(unit_path_visibility, backs_cast_shadows_and_reflect_in_mirrors) {
  // The sheet faces down to the ground: light from above meets its back.
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 5.0f), matte(vec3(1.0f)));
  b.add(quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}), matte(vec3(1.0f)));
  b.add_light(sunlight(vec3(1.0f), kPi), aimed({0, 1, 0}, vec3(0.0f)));
  const Image image = shoot(b.build(), dark_environment(), from_above(3.0f, 2.0f), centred(16, 1, 1)).beauty;
  EXPECT_NEAR(image.rgb(1, 1).x, 1.0f, 1e-5f);
  EXPECT_EQ(image.rgb(8, 8).x, 0.0f);  // the camera sees through the sheet to the shaded ground

  SceneBuilder c;
  c.add(plane(vec3(0.0f), 5.0f), metal(vec3(1.0f), 0.0f));
  c.add(turned_inside_out(quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2})), unlit(vec3(0.25f)));
  const Image mirror =
      shoot(c.build(), constant_environment(vec3(1.0f)), from_above(0.5f, 0.5f), centred(4, 1, 4)).beauty;
  EXPECT_EQ(mirror.rgb(2, 2), vec3(0.25f));
}

TEST(unit_path_visibility, camera_inside_many_shells_sees_out) {
  SceneBuilder b;
  for (int i = 1; i <= 40; ++i) b.add(sphere(vec3(0.0f), 0.1f * static_cast<float>(i), 1, true), matte(vec3(0.5f)));
  const Image image = shoot(b.build(), constant_environment(vec3(1.0f)), look_at(vec3(0.001f), {1, 0.2f, 0.3f}, 1.0f),
                            settings(16, 4, 2))
                          .beauty;
  for (const float v : image.pixels) EXPECT_EQ(v, 1.0f);
}

TEST(unit_path_visibility, skipping_backs_ends_on_slanting_planes_of_any_size) {
  for (const float size : {1e-3f, 1.0f, 1e4f, 1e6f}) {
    SceneBuilder b;
    Primitive p = turned_inside_out(quad({-size, -size, 0}, {2 * size, 0, 0.3f * size}, {0, 2 * size, 0.7f * size}));
    b.add(p, matte(vec3(0.5f)));
    const vec3 middle = 0.25f * (p.positions[0] + p.positions[1] + p.positions[2] + p.positions[3]);
    const Image image = shoot(b.build(), constant_environment(vec3(1.0f)),
                              look_at(middle + vec3(0, 0, 3.0f * size), middle, 0.3f), settings(32, 16, 2))
                            .beauty;
    for (const float v : image.pixels) ASSERT_EQ(v, 1.0f) << size;
  }
}

// ----- leaks

TEST(unit_path_visibility, closed_box_lets_no_light_in) {
  const Environment bright = constant_environment(vec3(1e4f));
  for (const Material& m : {matte(vec3(0.0f)), matte(vec3(0.8f)), plastic(vec3(0.8f), 0.2f)}) {
    SceneBuilder b;
    Material both = m;
    both.double_sided = true;
    b.add(box(vec3(-1.0f), vec3(1.3f)), both, rotation({1, 2, 3}, 0.5f));
    b.add_light(sunlight(vec3(1.0f), 1e4f), aimed({1, 2, 1}, vec3(0.0f)));
    const Image image =
        shoot(b.build(), bright, look_at({0.1f, 0.2f, 0.1f}, {1, 0.3f, 0.5f}, 2.0f), settings(32, 64, 4)).beauty;
    EXPECT_EQ(mean_luminance(image), 0.0);
  }
}

// ----- self-shadowing

/// Darkest and brightest pixel of a lit floor over what it should be; the camera and a grazing sun move with `offset`.
dvec2 lit_floor(vec3 offset, float elevation, const mat4& tilt, float half) {
  SceneBuilder b;
  const mat4 placement = translation(offset) * tilt;
  b.add(plane(vec3(0.0f), half), matte(vec3(1.0f)), placement);
  const vec3 towards(std::cos(elevation), std::sin(elevation), 0.0f);
  b.add_light(sunlight(vec3(1.0f), kPi), placement * aimed(towards, vec3(0.0f)));
  View view = look_at({0, 2, 3}, vec3(0.0f), 0.5f);
  view.world_from_camera = placement * view.world_from_camera;
  const Image image = shoot(b.build(), dark_environment(), view, settings(32, 4, 1)).beauty;
  dvec2 range(1e9, -1e9);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      const double v = static_cast<double>(image.rgb(x, y).x) / static_cast<double>(std::sin(elevation));
      range = {std::min(range.x, v), std::max(range.y, v)};
    }
  }
  return range;
}

TEST(unit_path_visibility, flat_floor_does_not_shade_itself_at_grazing_light_far_from_the_origin) {
  const vec3 diagonal = glm::normalize(vec3(1, -0.7f, 0.4f));
  for (const float distance : {0.0f, 1e3f, 1e5f}) {
    for (const mat4& tilt : {mat4(1.0f), rotation({1, 0.3f, 0.7f}, 0.9f)}) {
      for (const float elevation : {0.5f, 0.02f}) {
        const dvec2 range = lit_floor(distance * diagonal, elevation, tilt, 4.0f);
        // At 1e5 m single precision moves the corners by 4 mm, and with them the normal; on the light it shows by
        // 1 / tan(elevation).
        const double turn = 1e-4 + static_cast<double>(distance) * 2e-8 / std::tan(static_cast<double>(elevation));
        EXPECT_GT(range.x, 1.0 - turn) << distance << " m, elevation " << elevation;
        EXPECT_LT(range.y, 1.0 + turn) << distance << " m, elevation " << elevation;
      }
    }
  }
}

TEST(unit_path_visibility, huge_tilted_ground_does_not_shade_itself) {
  for (const float half : {1e2f, 1e4f, 1e5f}) {
    const dvec2 range = lit_floor(vec3(0.0f), 0.3f, rotation({1, 0.3f, 0.7f}, 0.9f), half);
    EXPECT_GT(range.x, 0.999) << half;
    EXPECT_LT(range.y, 1.001) << half;
  }
}

TEST(unit_path_visibility, tiny_bodies_keep_their_shadows) {
  // The same picture at every scale: a ball on a floor, the camera as near as the ball is small.
  const auto picture = [](float size) {
    SceneBuilder b;
    b.add(plane(vec3(0.0f), 4.0f * size), matte(vec3(0.8f)));
    b.add(sphere(vec3(0, 0.5f, 0) * size, 0.5f * size, 3, false), matte(vec3(0.8f)));
    b.add_light(sunlight(vec3(1.0f), kPi), aimed({1, 1.5f, 0.5f}, vec3(0.0f)));
    return shoot(b.build(), dark_environment(), look_at(vec3(1, 1.5f, 3) * size, vec3(0, 0.4f, 0) * size, 0.6f),
                 centred(48, 1, 1))
        .beauty;
  };
  const Image metre = picture(1.0f);
  for (const float size : {1e-4f, 1e-2f, 1e2f, 1e4f}) {
    const Image other = picture(size);
    int differ = 0;
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 48; ++x) differ += glm::length(metre.rgb(x, y) - other.rgb(x, y)) > 0.02f ? 1 : 0;
    }
    EXPECT_LE(differ, 12) << size;  // the rim of the shadow
  }
}

TEST(unit_path_visibility, lamps_do_not_shade_themselves_far_from_the_origin) {
  const auto light = [](vec3 offset) {
    SceneBuilder b;
    b.add(moved(plane(vec3(0.0f), 4.0f), offset), matte(vec3(1.0f)));
    b.add(moved(quad({-0.5f, 1, -0.5f}, {1, 0, 0}, {0, 0.1f, 1}), offset), lamp(vec3(1.0f)));
    View view = from_above(0.8f, 0.5f);
    view.world_from_camera = translation(offset) * view.world_from_camera;
    return mean_luminance(shoot(b.build(), dark_environment(), view, settings(8, 64, 1)).beauty);
  };
  const double here = light(vec3(0.0f));
  EXPECT_NEAR(light({1e3f, -7e2f, 4e2f}) / here, 1.0, 0.01);
  EXPECT_NEAR(light({1e4f, -7e3f, 4e3f}) / here, 1.0, 0.03);
}

TEST(unit_path_visibility, coarse_smooth_sphere_has_no_black_triangles_at_its_terminator) {
  // Not along an axis: the terminator must run across facets.
  const vec3 towards = glm::normalize(vec3(1.0f, 0.37f, 0.2f));
  for (const int levels : {2, 3}) {
    SceneBuilder b;
    b.add(sphere(vec3(0.0f), 1.0f, levels, false), matte(vec3(1.0f)));
    b.add_light(sunlight(vec3(1.0f), kPi), aimed(towards, vec3(0.0f)));
    path::Settings s = centred(64, 1, 1);
    s.layers = {Layer::normal};
    const Film film = shoot(b.build(), dark_environment(), look_at({0, 0, 5}, vec3(0.0f), 0.45f), s);
    // Light falls off with the shading normal alone, all the way; but at the rim normals are turned to the viewer.
    int checked = 0;
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const vec3 n = film.layers.at(Layer::normal).rgb(x, y);
        if (n.z < 0.2f) continue;
        ++checked;
        ASSERT_NEAR(film.beauty.rgb(x, y).x, std::max(glm::dot(n, towards), 0.0f), 2e-3f)
            << levels << " levels, " << x << " " << y;
      }
    }
    EXPECT_GT(checked, 1000);
  }
}

}  // namespace
}  // namespace candela
