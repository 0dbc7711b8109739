#include <gtest/gtest.h>

#include <cmath>

#include "unit/path/scenes.h"

// Surfaces at the same place, or so near that rays step over what lies between: none is lost.

namespace candela {
namespace {

using namespace test;

View straight_down_z(float distance, float half) {
  View view;
  view.world_from_camera = translation({0, 0, distance});
  view.projection = OrthographicCamera{.xmag = half, .ymag = half};
  return view;
}

View from(float distance, float half, bool is_perspective) {
  if (!is_perspective) return straight_down_z(distance, half);
  return look_at({0, 0, distance}, vec3(0.0f), 2.0f * std::atan(half / distance));
}

Primitive square(float half, float z = 0.0f) { return quad({-half, -half, z}, {2 * half, 0, 0}, {0, 2 * half, 0}); }

Primitive joined(Primitive a, const Primitive& b) {
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  a.normals.insert(a.normals.end(), b.normals.begin(), b.normals.end());
  for (const uvec3& t : b.triangles) a.triangles.push_back(t + first);
  for (auto& [set, uv] : a.uvs) uv.clear();
  a.tangents.clear();
  return a;
}

/// A thin sheet of index 1, which does not reflect.
Material tinted_sheet(vec3 color) {
  Material m;
  m.base_color = color;
  m.metallic = 0.0f;
  m.roughness = 0.0f;
  m.ior = 1.0f;
  m.transmission = 1.0f;
  m.double_sided = true;
  return m;
}

Material blended(vec3 color, float opacity) {
  Material m = unlit(color);
  m.alpha_mode = AlphaMode::blend;
  m.opacity = opacity;
  m.double_sided = true;
  return m;
}

void expect_all(const Image& image, vec3 color, float tolerance, const std::string& what) {
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const vec3 d = glm::abs(image.rgb(x, y) - color);
      ASSERT_LE(max_component(d), tolerance) << what << " at " << x << " " << y << ": " << image.rgb(x, y).x << " "
                                             << image.rgb(x, y).y << " " << image.rgb(x, y).z;
    }
  }
}

enum class Doubling { one_primitive, two_nodes, instances, mirrored };

Scene doubled_sheet(Doubling how, bool is_front_first, const mat4& placement) {
  SceneBuilder b;
  const Primitive front = square(2.0f);
  const Primitive back = turned_inside_out(front);
  const Primitive& first = is_front_first ? front : back;
  const Primitive& second = is_front_first ? back : front;
  const Material m = unlit(vec3(1.0f));
  switch (how) {
    case Doubling::one_primitive:
      b.add(joined(first, second), m, placement);
      break;
    case Doubling::two_nodes:
      b.add(first, m, placement);
      b.add(second, m, placement);
      break;
    case Doubling::instances: {
      const int mesh = b.add_mesh(joined(first, second), b.add_material(m));
      b.add_node(mesh, placement);
      b.add_node(mesh, translation({0, 0, -500}));
      break;
    }
    case Doubling::mirrored: {
      // A mirror image keeps looking to +z, another looks to -z.
      const int mesh = b.add_mesh(front, b.add_material(m));
      b.add_node(mesh, placement * scaling(is_front_first ? vec3(-1, 1, 1) : vec3(1, 1, -1)));
      b.add_node(mesh, placement * scaling(is_front_first ? vec3(1, 1, -1) : vec3(-1, 1, 1)));
      break;
    }
  }
  return b.build();
}

TEST(unit_path_coincident, a_sheet_doubled_to_have_two_sides_is_whole) {
  for (const Doubling how : {Doubling::one_primitive, Doubling::two_nodes, Doubling::instances, Doubling::mirrored}) {
    for (const bool is_front_first : {true, false}) {
      for (const bool is_perspective : {true, false}) {
        for (const mat4& placement : {mat4(1.0f), rotation({1, 2, 0.3f}, 0.4f)}) {
          path::Settings s = settings(24, 4, 2);
          s.layers = {Layer::depth, Layer::object_id};
          const Film film = shoot(doubled_sheet(how, is_front_first, placement), dark_environment(),
                                  from(7.0f, 0.8f, is_perspective), s);
          expect_all(film.beauty, vec3(1.0f), 0.0f, std::to_string(static_cast<int>(how)));
          for (const float d : film.layers.at(Layer::depth).pixels) ASSERT_NEAR(d, 7.0f, 1.2f);
        }
      }
    }
  }
}

TEST(unit_path_coincident, the_back_of_a_sheet_near_another_is_looked_through_to_it) {
  // 0.1 mm at 200 m: six steps of single precision.
  for (const float gap : {0.0f, 1e-4f, 1e-3f, 1e-2f}) {
    SceneBuilder b;
    b.add(turned_inside_out(square(5.0f, gap)), unlit({1, 0, 0}));
    b.add(square(5.0f), unlit({0, 1, 0}));
    b.add(square(50.0f, -3.0f), unlit({0, 0, 1}));
    for (const float distance : {1.0f, 200.0f}) {
      const Image image = shoot(b.build(), dark_environment(), from(distance, 1.0f, true), settings(16, 4, 1)).beauty;
      expect_all(image, {0, 1, 0}, 0.0f, std::to_string(gap) + " m");
    }
  }
}

TEST(unit_path_coincident, the_floor_under_a_sheet_of_glass_is_seen) {
  for (const float gap : {0.0f, 1e-4f, 1e-3f}) {
    for (const bool is_sheet_first : {true, false}) {
      for (const float distance : {2.0f, 200.0f}) {
        SceneBuilder b;
        if (is_sheet_first) b.add(square(5.0f, gap), tinted_sheet(vec3(1.0f)));
        b.add(square(60.0f), unlit({0, 1, 0}));
        if (!is_sheet_first) b.add(square(5.0f, gap), tinted_sheet(vec3(1.0f)));
        b.add(square(60.0f, -1.0f), unlit({1, 0, 0}));
        for (const auto integrator : {path::Integrator::full, path::Integrator::minimal}) {
          path::Settings s = settings(16, 4, 4);
          s.integrator = integrator;
          expect_all(shoot(b.build(), dark_environment(), from(distance, 1.0f, true), s).beauty, {0, 1, 0}, 1e-5f,
                     std::to_string(gap) + " m");
        }
      }
    }
  }
}

TEST(unit_path_coincident, sheets_that_lie_on_each_other_all_tint_and_edges_tint_once) {
  // A camera ray through every corner and edge of the sheets' triangles as well.
  for (const bool is_joined : {true, false}) {
    SceneBuilder b;
    const Material m = tinted_sheet({0.5f, 1.0f, 0.8f});
    if (is_joined) {
      b.add(joined(square(4.0f), turned_inside_out(square(4.0f))), m);
    } else {
      b.add(square(4.0f), m);
      b.add(square(4.0f), m);
    }
    b.add(square(8.0f, -2.0f), unlit(vec3(1.0f)));
    const Image image = shoot(b.build(), dark_environment(), straight_down_z(3.0f, 1.0f), centred(15, 1, 8)).beauty;
    expect_all(image, {0.25f, 1.0f, 0.64f}, 1e-5f, "both sheets");
  }
}

TEST(unit_path_coincident, blended_sheets_at_one_place_each_show_their_share) {
  SceneBuilder b;
  b.add(square(4.0f), blended({1, 0, 0}, 0.5f));
  b.add(square(4.0f), tinted_sheet({1, 1, 0.5f}));
  b.add(square(4.0f), blended({1, 0, 0}, 0.5f));
  b.add(square(8.0f), unlit({0, 1, 0}));
  const Film film = shoot(b.build(), dark_environment(), straight_down_z(3.0f, 1.0f), settings(16, 256, 4));
  const dvec3 mean = mean_of(film.beauty);
  // The floor is under them all.
  EXPECT_NEAR(mean.x + mean.y, 1.0, 1e-5);
  EXPECT_NEAR(mean.y, 0.25, 0.01);
  EXPECT_EQ(mean.z, 0.0);
  // A quarter where both are in front.
  SceneBuilder c;
  c.add(square(4.0f), blended({1, 0, 0}, 0.5f));
  c.add(square(4.0f), blended({1, 0, 0}, 0.5f));
  c.add(square(4.0f), tinted_sheet(vec3(1.0f)));
  c.add(square(8.0f, -1.0f), unlit({0, 1, 0}));
  const Film apart = shoot(c.build(), dark_environment(), straight_down_z(3.0f, 1.0f), settings(16, 256, 4));
  EXPECT_NEAR(mean_of(apart.beauty).y, 0.25, 0.01);
}

TEST(unit_path_coincident, light_passes_a_sheet_on_a_floor_both_ways) {
  // The sun through the tint to the floor, and back through it to the eye, wherever the sheet is of what rays can tell
  // apart. With the sheet exactly on the floor it is seen or not, but never once only.
  const float tint = 0.5f;
  const auto floor = [&](float gap, float distance) {
    SceneBuilder b;
    b.add(square(60.0f), matte(vec3(1.0f)));
    b.add(square(20.0f, gap), tinted_sheet(vec3(tint)));
    b.add_light(sunlight(vec3(1.0f), kPi), aimed({0.3f, 0.2f, 1}, vec3(0.0f)));
    return shoot(b.build(), dark_environment(), from(distance, 1.0f, true), settings(16, 4, 1)).beauty;
  };
  const float lit = 1.0f / std::sqrt(1.13f);
  for (const float gap : {1e-4f, 1e-3f, 1e-2f}) {
    for (const float distance : {2.0f, 200.0f}) {
      expect_all(floor(gap, distance), vec3(lit * tint * tint), 5e-3f, std::to_string(gap) + " m");
    }
  }
  const Image together = floor(0.0f, 2.0f);
  for (int i = 0; i < 16 * 16; ++i) {
    const float v = together.rgb(i % 16, i / 16).x / lit;
    const float seen = (1.0f - v) / (1.0f - tint * tint);  // share of the samples that saw the sheet
    EXPECT_NEAR(4.0f * seen, std::round(4.0f * seen), 0.02f) << v;
  }
}

TEST(unit_path_coincident, the_eye_looks_through_backs_behind_glass_and_mirrors_and_shadows_do_not) {
  // A culled back behind a clear sheet and behind a blended one: culled still, since the direction is the eye's.
  for (const Material& m : {tinted_sheet(vec3(1.0f)), blended(vec3(0.0f), 0.0f)}) {
    for (const float gap : {0.0f, 1e-4f, 1.0f}) {
      SceneBuilder b;
      b.add(square(4.0f, gap), m);
      b.add(turned_inside_out(square(4.0f)), unlit({1, 0, 0}));
      b.add(square(8.0f, -1.0f), unlit({0, 1, 0}));
      for (const auto integrator : {path::Integrator::full, path::Integrator::minimal}) {
        path::Settings s = settings(8, 4, 4);
        s.integrator = integrator;
        expect_all(shoot(b.build(), dark_environment(), straight_down_z(3.0f, 1.0f), s).beauty, {0, 1, 0}, 1e-5f,
                   std::to_string(gap) + " m");
      }
    }
  }
  // Behind frosted glass the direction is another: the back is there.
  Material frosted = tinted_sheet(vec3(1.0f));
  frosted.roughness = 0.3f;
  frosted.ior = 1.5f;
  SceneBuilder b;
  b.add(square(4.0f, 1.0f), frosted);
  b.add(turned_inside_out(square(40.0f)), unlit({1, 0, 0}));
  b.add(square(80.0f, -1.0f), unlit({0, 1, 0}));
  const Film film = shoot(b.build(), dark_environment(), straight_down_z(3.0f, 1.0f), settings(8, 16, 4));
  EXPECT_GT(mean_of(film.beauty).x, 0.5);
  EXPECT_EQ(mean_of(film.beauty).y, 0.0);
}

// ----- several in one plane

/// A floor and a sheet in it, whose triangles are others.
Primitive floor_of_plane() { return quad({-1.3f, -1.1f, 0}, {3, 0, 0}, {0, 2.3f, 0}); }
Primitive sheet_of_plane() { return quad({-0.9f, -0.9f, 0}, {1.7f, 0, 0}, {0, 1.9f, 0}); }

Material seen_from_both_sides(Material m) {
  m.double_sided = true;
  return m;
}

TEST(unit_path_coincident, of_opaque_surfaces_in_one_plane_the_later_one_is_seen_and_named) {
  struct Case {
    const char* what;
    Primitive floor, sheet;
    bool is_double_sided;
  };
  for (const Case& c : {Case{"alike", floor_of_plane(), sheet_of_plane(), false},
                        Case{"both sides", floor_of_plane(), sheet_of_plane(), true},
                        Case{"back to back", turned_inside_out(floor_of_plane()), sheet_of_plane(), true},
                        Case{"the same triangles", sheet_of_plane(), sheet_of_plane(), false}}) {
    for (const bool is_sheet_last : {true, false}) {
      for (const bool is_instanced : {false, true}) {
        for (const mat4& turn : {mat4(1.0f), rotation({1, 2, 0.3f}, 0.4f)}) {
          SceneBuilder b;
          const auto add = [&](const Primitive& p, vec3 color) {
            Material m = unlit(color);
            m.double_sided = c.is_double_sided;
            const int mesh = b.add_mesh(p, b.add_material(m));
            b.add_node(mesh, turn);
            if (is_instanced) b.add_node(mesh, translation({0, 0, -500}));
          };
          if (!is_sheet_last) add(c.sheet, {1, 0, 0});
          add(c.floor, {0, 1, 0});
          if (is_sheet_last) add(c.sheet, {1, 0, 0});
          for (const auto integrator : {path::Integrator::full, path::Integrator::minimal}) {
            path::Settings s = settings(32, 4, 2);
            s.integrator = integrator;
            s.layers = {Layer::object_id};
            const Film film = shoot(b.build(), dark_environment(), from(5.0f, 0.5f, true), s);
            const bool is_red = is_sheet_last;
            expect_all(film.beauty, is_red ? vec3(1, 0, 0) : vec3(0, 1, 0), 0.0f, c.what);
            const float id = is_instanced ? 3.0f : 2.0f;
            for (const float v : film.layers.at(Layer::object_id).pixels) ASSERT_EQ(v, id) << c.what;
          }
        }
      }
    }
  }
}

TEST(unit_path_coincident, surfaces_that_an_edit_gives_two_sides_are_ordered_as_if_they_had_always_had_them) {
  const auto scene = [](bool is_double_sided) {
    SceneBuilder b;
    for (const auto& [surface, color] :
         {std::pair(sheet_of_plane(), vec3(1, 0, 0)), std::pair(turned_inside_out(floor_of_plane()), vec3(0, 1, 0))}) {
      Material m = unlit(color);
      m.double_sided = is_double_sided;
      b.add(surface, m);
    }
    return std::make_shared<const Scene>(b.build());
  };
  const path::FarLight light(dark_environment());
  path::Tracer tracer(scene(false), light);
  const auto picture = [&] { return tracer.render(from(5.0f, 0.5f, true), settings(32, 4, 2)).beauty; };
  expect_all(picture(), {1, 0, 0}, 0.0f, "the back of the floor is looked through");
  ASSERT_TRUE(tracer.take_materials(scene(true), light, shade::shading_model_candela()));
  expect_all(picture(), {0, 1, 0}, 0.0f, "the floor is the later one");
}

TEST(unit_path_coincident, a_lamp_that_another_covers_in_its_plane_lights_nothing) {
  for (const bool is_double_sided : {false, true}) {
    SceneBuilder b;
    Material green = lamp({0, 1, 0});
    Material red = lamp({1, 0, 0});
    green.double_sided = red.double_sided = is_double_sided;
    b.add(sheet_of_plane(), green);
    b.add(floor_of_plane(), red);
    b.add(turned_inside_out(square(1.0f, 2.0f)), matte(vec3(1.0f)));
    for (const auto integrator : {path::Integrator::full, path::Integrator::minimal}) {
      path::Settings s = settings(8, 64, 3);
      s.integrator = integrator;
      const dvec3 mean = mean_of(shoot(b.build(), dark_environment(), look_at({0, 0, 1}, {0, 0, 2}, 0.5f), s).beauty);
      EXPECT_GT(mean.x, 0.1);
      EXPECT_EQ(mean.y, 0.0);
    }
  }
}

TEST(unit_path_coincident, a_label_in_the_plane_of_a_clear_pane_is_seen_through_it) {
  for (const bool is_pane_last : {true, false}) {
    SceneBuilder b;
    if (is_pane_last) b.add(sheet_of_plane(), seen_from_both_sides(unlit({1, 1, 0})));
    b.add(floor_of_plane(), tinted_sheet({0.5f, 1.0f, 0.25f}));
    if (!is_pane_last) b.add(sheet_of_plane(), seen_from_both_sides(unlit({1, 1, 0})));
    path::Settings s = settings(24, 4, 4);
    s.layers = {Layer::object_id};
    const Film film = shoot(b.build(), dark_environment(), from(5.0f, 0.5f, true), s);
    expect_all(film.beauty, {0.5f, 1, 0}, 1e-5f, is_pane_last ? "pane last" : "label last");
    for (const float v : film.layers.at(Layer::object_id).pixels) ASSERT_EQ(v, is_pane_last ? 2.0f : 1.0f);
  }
}

TEST(unit_path_coincident, a_sheet_a_hair_above_a_floor_is_in_front_whatever_comes_later) {
  for (const float gap : {1e-5f, 1e-6f}) {
    for (const bool is_doubled : {false, true}) {  // which has the surfaces of its plane ordered
      SceneBuilder b;
      b.add(square(2.0f, gap), unlit({1, 0, 0}));
      if (is_doubled) b.add(square(1.9f, gap), unlit({1, 0, 0}));
      b.add(square(4.0f), unlit({0, 1, 0}));
      if (is_doubled) b.add(square(3.9f), unlit({0, 1, 0}));
      expect_all(shoot(b.build(), dark_environment(), from(2.0f, 0.5f, true), settings(16, 4, 1)).beauty, {1, 0, 0},
                 0.0f, std::to_string(1e3f * gap) + " mm");
    }
  }
}

// ----- layers

TEST(unit_path_coincident, layers_of_a_blended_surface_follow_its_opacity) {
  for (const float opacity : {0.1f, 0.49f, 0.5f, 0.6f, 0.9f}) {
    for (const bool is_twofold : {false, true}) {
      SceneBuilder b;
      b.add(square(8.0f, -1.0f), matte({0, 1, 0}));
      Material veil = matte({1, 0, 0});
      veil.alpha_mode = AlphaMode::blend;
      veil.opacity = opacity;
      b.add(square(4.0f, 1.0f), veil, rotation({0, 1, 0}, 0.1f));
      if (is_twofold) b.add(square(4.0f, 1.0f), veil, rotation({0, 1, 0}, 0.1f));
      path::Settings s = settings(16, 4, 1);
      s.layers = {Layer::depth, Layer::object_id, Layer::normal, Layer::albedo, Layer::position};
      const Film film = shoot(b.build(), constant_environment(vec3(1.0f)), straight_down_z(3.0f, 1.0f), s);
      const bool is_veil = opacity >= 0.5f;
      for (int i = 0; i < 16 * 16; ++i) {
        const int x = i % 16, y = i / 16;
        ASSERT_EQ(film.layers.at(Layer::object_id).at(x, y)[0] > 1.0f, is_veil) << opacity;
        ASSERT_EQ(film.layers.at(Layer::depth).at(x, y)[0] < 3.0f, is_veil) << opacity;
        ASSERT_EQ(film.layers.at(Layer::position).rgb(x, y).z > 0.0f, is_veil) << opacity;
        ASSERT_NEAR(film.layers.at(Layer::normal).rgb(x, y).x, is_veil ? std::sin(0.1f) : 0.0f, 1e-4f) << opacity;
        ASSERT_EQ(film.layers.at(Layer::albedo).rgb(x, y).x > 0.5f, is_veil) << opacity;
        ASSERT_EQ(film.layers.at(Layer::albedo).rgb(x, y).y > 0.5f, !is_veil) << opacity;
      }
    }
  }
}

}  // namespace
}  // namespace candela
