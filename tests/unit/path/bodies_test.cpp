#include "path/bodies.h"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/path/scenes.h"

// Bodies: where they begin and end, whatever their faces are made of.

namespace candela {
namespace {

using namespace test;

const vec3 kTint{0.5f, 1.0f, 0.25f};  // of white light after 1 m

/// Glass that does not bend: index 1.
Material tinted(vec3 color = kTint) {
  Material m;
  m.metallic = 0.0f;
  m.roughness = 0.0f;
  m.ior = 1.0f;
  m.transmission = 1.0f;
  m.thickness = 1.0f;
  m.attenuation_color = color;
  m.attenuation_distance = 1.0f;
  return m;
}

/// The faces of a box that `keep` wants, by number: -x +x -y +y -z +z.
template <class Keep>
Primitive faces(vec3 lower, vec3 upper, const Keep& keep) {
  Primitive all = box(lower, upper);
  std::vector<uvec3> kept;
  const vec3 middle = 0.5f * (lower + upper);
  for (const uvec3& t : all.triangles) {
    const vec3 n = glm::cross(all.positions[t.y] - all.positions[t.x], all.positions[t.z] - all.positions[t.x]);
    const int axis = std::abs(n.x) > std::max(std::abs(n.y), std::abs(n.z)) ? 0 : std::abs(n.y) > std::abs(n.z) ? 1 : 2;
    const vec3 p = (all.positions[t.x] + all.positions[t.y] + all.positions[t.z]) / 3.0f;
    if (keep(2 * axis + (p[axis] > middle[axis] ? 1 : 0))) kept.push_back(t);
  }
  all.triangles = kept;
  return all;
}

constexpr int kFar = 4;  // the face that looks away from the camera

View along_z(float from, float half) {
  View view;
  view.world_from_camera = translation({0, 0, from});
  view.projection = OrthographicCamera{.xmag = half, .ymag = half};
  return view;
}

/// Paths of many boundaries end by chance: their mean is right to a percent.
vec3 seen(SceneBuilder& b, const View& view, int samples = 64, int bounces = 64) {
  b.add(quad({-400, -400, -60}, {800, 0, 0}, {0, 800, 0}), unlit(vec3(1.0f)));
  const Scene scene = b.build();
  const vec3 full(mean_of(shoot(scene, dark_environment(), view, settings(8, samples, bounces)).beauty));
  path::Settings s = settings(8, samples, bounces);
  s.integrator = path::Integrator::minimal;
  const vec3 minimal(mean_of(shoot(scene, dark_environment(), view, s).beauty));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(full[c], minimal[c], 0.08f) << "minimal";
  return full;
}

void expect_color(vec3 measured, vec3 expected, float tolerance, const std::string& what) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(measured[c], expected[c], tolerance) << what << ", channel " << c;
}

const vec3 kLower(-0.5f), kUpper(0.5f);

// ----- closed by several parts

TEST(unit_path_bodies, a_body_of_several_materials_primitives_and_nodes_ends) {
  const auto is_far = [](int face) { return face == kFar; };
  const auto is_not_far = [](int face) { return face != kFar; };
  const mat4 here = translation({0.01f, 0.02f, 0.3f});
  Material other = tinted();
  other.base_color = vec3(0.999f);
  {
    SceneBuilder b;
    b.add(faces(kLower, kUpper, is_not_far), tinted(), here);
    b.add(faces(kLower, kUpper, is_far), other, here);
    expect_color(seen(b, along_z(5, 0.4f)), kTint, 5e-3f, "another node and material");
  }
  {
    SceneBuilder b;
    const int mesh = b.add_mesh(faces(kLower, kUpper, is_not_far), b.add_material(tinted()));
    Primitive back = faces(kLower, kUpper, is_far);
    back.material = b.add_material(other);
    b.scene().meshes[static_cast<std::size_t>(mesh)].primitives.push_back(back);
    b.add_node(mesh, here);
    expect_color(seen(b, along_z(5, 0.4f)), kTint, 5e-3f, "another primitive");
    b.add_node(mesh, translation({30, 0, 0}) * scaling({-1, 1, 1}));
    expect_color(seen(b, along_z(5, 0.4f)), kTint, 5e-3f, "an instance");
    View view = along_z(5, 0.4f);
    view.world_from_camera = translation({30, 0, 5});
    expect_color(seen(b, view), kTint, 5e-3f, "a mirrored instance");
  }
  {
    // Three slices of different tints; the one entered counts.
    SceneBuilder b;
    b.add(faces(kLower, kUpper, [](int face) { return face == 5; }), tinted(), here);
    b.add(faces(kLower, kUpper, [](int face) { return face < 4; }), tinted({0.9f, 0.2f, 0.2f}), here);
    b.add(faces(kLower, kUpper, is_far), tinted({0.1f, 0.1f, 0.9f}), here);
    expect_color(seen(b, along_z(5, 0.4f)), kTint, 5e-3f, "three tints");
  }
  {
    // No edge joins front and back.
    SceneBuilder b;
    b.add(faces(kLower, kUpper, [](int face) { return face == 5; }), tinted(), here);
    b.add(faces(kLower, kUpper, is_far), other, here);
    expect_color(seen(b, along_z(5, 0.4f)), kTint, 5e-3f, "front and back without sides");
  }
}

TEST(unit_path_bodies, a_lid_of_another_kind_ends_a_body) {
  const auto is_far = [](int face) { return face == kFar; };
  const auto is_not_far = [](int face) { return face != kFar; };
  const float inside = 0.2f;  // what a lamp lid shows
  Material sheet = tinted();
  sheet.thickness = 0.0f;
  sheet.base_color = {1.0f, 0.5f, 1.0f};
  SceneBuilder b;
  b.add(faces(kLower, kUpper, is_not_far), tinted());
  b.add(faces(kLower, kUpper, is_far), sheet);
  expect_color(seen(b, along_z(5, 0.4f)), kTint * sheet.base_color, 0.02f, "a thin sheet");
  SceneBuilder c;
  c.add(faces(kLower, kUpper, is_not_far), tinted());
  Material opaque = lamp(vec3(inside));
  opaque.double_sided = true;
  c.add(faces(kLower, kUpper, is_far), opaque);
  expect_color(seen(c, along_z(5, 0.4f)), inside * kTint, 5e-3f, "an opaque lid");
}

TEST(unit_path_bodies, the_wall_of_a_hollow_is_its_bodys_whatever_it_is_made_of) {
  // Two metres of wall, whether the hollow is a node or a material of its own, and mirrored or not.
  const Primitive outer = box(vec3(-2.0f), vec3(2.0f)), inner = turned_inside_out(box(vec3(-1.0f), vec3(1.0f)));
  const vec3 expected(kTint * kTint);
  Material other = tinted();
  other.name = "other";
  for (const bool has_other_material : {false, true}) {
    for (const bool is_first : {false, true}) {
      SceneBuilder b;
      const Material& of_hollow = has_other_material ? other : tinted();
      if (is_first) b.add(inner, of_hollow);
      b.add(outer, tinted());
      if (!is_first) b.add(inner, of_hollow);
      expect_color(seen(b, along_z(5, 0.5f)), expected, 0.02f, "a hollow");
    }
  }
  SceneBuilder mirrored;
  mirrored.add(outer, tinted());
  mirrored.add(box(vec3(-1.0f), vec3(1.0f)), tinted(), scaling({-1, -1, -1}));  // an even box, not inside out
  expect_color(seen(mirrored, along_z(5, 0.5f)), glm::pow(kTint, vec3(4.0f)), 0.02f, "a body in a body");
  // In the hollow there may be another body, and in that a hollow: the smallest around it has it.
  SceneBuilder nested;
  nested.add(outer, tinted());
  nested.add(inner, tinted());
  nested.add(box(vec3(-0.75f), vec3(0.75f)), tinted());
  nested.add(turned_inside_out(box(vec3(-0.5f), vec3(0.5f))), tinted());
  expect_color(seen(nested, along_z(5, 0.25f)), glm::pow(kTint, vec3(2.5f)), 0.03f, "a hollow in a body in a hollow");
  // Beside a body an inside-out one is nobody's wall.
  SceneBuilder apart;
  apart.add(box({-2, -2, -1}, {-0.5f, 2, 1}), tinted());
  apart.add(turned_inside_out(box({0.5f, -0.5f, -0.5f}, {1.5f, 0.5f, 0.5f})), tinted());
  const Scene scene = apart.build();
  const path::Geometry geometry(scene);
  EXPECT_NE(geometry.placements()[0].body, geometry.placements()[1].body);
}

TEST(unit_path_bodies, parts_of_a_body_are_found_by_their_edges) {
  const auto is_far = [](int face) { return face == kFar; };
  const auto is_not_far = [](int face) { return face != kFar; };
  const auto bodies_of = [](const SceneBuilder& b) {
    const Scene scene = b.build();
    const path::Geometry geometry(scene);
    int open = 0;
    for (const path::Body& body : geometry.bodies()) open += body.is_open ? 1 : 0;
    return ivec2(static_cast<int>(geometry.bodies().size()) - 1, open);
  };
  SceneBuilder two;
  two.add(faces(kLower, kUpper, is_not_far), tinted());
  two.add(faces(kLower, kUpper, is_far), tinted());
  EXPECT_EQ(bodies_of(two), ivec2(1, 0));
  // Corners that exporters rounded.
  SceneBuilder rounded;
  rounded.add(faces(kLower, kUpper, is_not_far), tinted());
  rounded.add(faces(kLower - 2e-6f, kUpper + 2e-6f, is_far), tinted(), translation({0, 0, 1e-6f}));
  EXPECT_EQ(bodies_of(rounded), ivec2(1, 0));
  SceneBuilder apart;
  apart.add(faces(kLower, kUpper, is_not_far), tinted());
  apart.add(faces(kLower, kUpper, is_far), tinted(), translation({0, 0, -0.01f}));
  EXPECT_EQ(bodies_of(apart), ivec2(2, 2));
  // Whole ones that touch at all their corners stay two.
  SceneBuilder touching;
  touching.add(box(kLower, kUpper), tinted());
  touching.add(box(kLower, kUpper), tinted(vec3(0.5f)), translation({0, 0, 1}));
  EXPECT_EQ(bodies_of(touching), ivec2(2, 0));
  // Half a box, and its mirror image by a negative scale.
  SceneBuilder halves;
  const int mesh = halves.add_mesh(faces(kLower + vec3(0.5f, 0, 0), kUpper, [](int face) { return face != 0; }),
                                   halves.add_material(tinted()));
  halves.add_node(mesh, translation({3, 1, 2}));
  halves.add_node(mesh, translation({3, 1, 2}) * scaling({-1, 1, 1}));
  EXPECT_EQ(bodies_of(halves), ivec2(1, 0));
}

TEST(unit_path_bodies, no_medium_lasts_to_infinity) {
  // An open pane with a volume, before nothing but the environment.
  for (const vec3 scattering : {vec3(0.0f), vec3(0.8f)}) {
    SceneBuilder b;
    Material m = tinted(vec3(0.01f));
    m.multiscatter_color = scattering;
    b.add(quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), m);
    const Film film = shoot(b.build(), constant_environment(vec3(1.0f)), along_z(3, 0.4f), settings(8, 16, 64));
    EXPECT_NEAR(mean_luminance(film.beauty), 1.0, 1e-4);
  }
}

/// A pane that takes the tint twice over, far from the origin, where rays start a good part of it off its faces or step
/// over it whole.
void add_pane(SceneBuilder& b, float thickness, float at, const mat4& turn, vec3 scattering = vec3(0.0f)) {
  Material m = tinted();
  m.attenuation_distance = 0.5f * thickness;
  m.multiscatter_color = scattering;
  b.add(box({-2, -2, -0.5f * thickness}, {2, 2, 0.5f * thickness}), m, translation({0, 0, at}) * turn);
}

vec3 seen_through_pane(float thickness, float at, const mat4& turn) {
  SceneBuilder b;
  add_pane(b, thickness, at, turn);
  return seen(b, along_z(at + 5.0f, 0.4f));
}

TEST(unit_path_bodies, the_way_through_a_pane_counts_from_its_faces) {
  const mat4 turn = rotation({0.2f, 1, 0}, 0.3f);
  // Corners are rounded to 2⁻²⁴ of where they are, which is up to 5 % of the pane.
  for (const auto& [thickness, at] :
       {std::pair(1.0f, 1e4f), {0.1f, 1e3f}, {0.1f, 1e4f}, {0.01f, 1e3f}, {0.01f, 5e3f}}) {
    const std::string what = std::to_string(thickness) + " m at " + std::to_string(at);
    expect_color(seen_through_pane(thickness, at, mat4(1.0f)), kTint * kTint, 0.02f, what);
    expect_color(seen_through_pane(thickness, at, turn), glm::pow(kTint, vec3(2.0f / turn[2].z)), 0.02f,
                 what + ", turned");
  }
}

TEST(unit_path_bodies, light_scatters_in_a_pane_alike_wherever_it_stands) {
  const auto scattered = [](float at) {
    SceneBuilder b;
    add_pane(b, 0.01f, at, mat4(1.0f), vec3(0.8f));
    // What comes back tells the depth it was scattered in.
    b.add(quad({-3.0f, -3.0f, at - 0.5f}, {6, 0, 0}, {0, 6, 0}), unlit(vec3(0.0f)));
    // Specks, so that most of the scene stands at the world's origin, and what is traced is told from there.
    for (const float x : {-1e-3f, 0.0f, 1e-3f}) b.add(quad({x, -3.0f, 0.0f}, {1e-4f, 0, 0}, {0, 1e-4f, 0}), Material{});
    const Film film =
        shoot(b.build(), constant_environment(vec3(1.0f)), along_z(at + 5.0f, 0.4f), settings(8, 1024, 64));
    return vec3(mean_of(film.beauty));
  };
  const vec3 here = scattered(0.0f);
  expect_color(scattered(1e3f), here, 0.03f, "at 1 km");
  expect_color(scattered(5e3f), here, 0.03f, "at 5 km, where rays step over the pane");
}

// ----- touching, nested, overlapping

TEST(unit_path_bodies, touching_bodies_cross_all_their_boundaries) {
  for (const bool is_clear_first : {true, false}) {
    for (const bool is_turned : {false, true}) {
      SceneBuilder b;
      Material clear = tinted(vec3(1.0f));
      clear.attenuation_distance = kInfinity;
      const mat4 turn = is_turned ? rotation({0.2f, 1, 0}, 0.3f) : mat4(1.0f);
      const Primitive front = box({-2, -2, 0}, {2, 2, 1});
      const Primitive back = box({-2, -2, -1}, {2, 2, 0});
      if (is_clear_first) b.add(front, clear, turn);
      b.add(back, tinted(), turn);
      if (!is_clear_first) b.add(front, clear, turn);
      const float length = is_turned ? 1.0f / (turn[2].z) : 1.0f;
      expect_color(seen(b, along_z(5, 0.4f)), glm::pow(kTint, vec3(length)), 0.02f, is_turned ? "turned" : "straight");
    }
  }
}

TEST(unit_path_bodies, bodies_that_touch_have_no_air_between_them) {
  // Glass on glass of one index: nothing reflects between them, at any angle; with a gap light is reflected totally.
  const auto through = [](float gap) {
    SceneBuilder b;
    Material glass = tinted(vec3(1.0f));
    glass.attenuation_distance = kInfinity;
    glass.ior = 1.5f;
    b.add(box({-50, -50, 0}, {50, 50, 1}), glass);
    // A prism's face would be needed to see total reflection; the loss of two boundaries shows as well.
    b.add(box({-50, -50, -1}, {50, 50, -gap}), glass);
    b.add(quad({-400, -400, -60}, {800, 0, 0}, {0, 800, 0}), unlit(vec3(1.0f)));
    return mean_luminance(shoot(b.build(), dark_environment(), along_z(5, 0.4f), settings(8, 256, 64)).beauty);
  };
  // Of a pile of m plates (1 - R) / (1 + (2m - 1) R) is let through, R = 0.04.
  EXPECT_NEAR(through(0.0f), 0.96 / 1.04, 0.01);
  EXPECT_NEAR(through(0.01f), 0.96 / 1.12, 0.01);
}

TEST(unit_path_bodies, a_liquid_on_the_wall_of_its_glass_absorbs_its_own_way) {
  // Wall 0.1 m, liquid 0.8 m, wall: at the same place, or overlapping a little.
  for (const float overlap : {0.0f, 1e-5f, 0.02f}) {
    for (const bool is_one_mesh : {false, true}) {
      SceneBuilder b;
      Material glass = tinted(vec3(1.0f));
      glass.attenuation_distance = kInfinity;
      const vec3 inner(0.4f);
      const Primitive outer = box(kLower, kUpper);
      const Primitive wall = turned_inside_out(box(-inner, inner));
      const Primitive liquid = box(-inner - overlap, inner + overlap);
      const int mesh = b.add_mesh(outer, b.add_material(glass));
      std::vector<Primitive>& primitives = b.scene().meshes[static_cast<std::size_t>(mesh)].primitives;
      primitives.push_back(wall);
      primitives.back().material = primitives.front().material;
      if (is_one_mesh) {
        primitives.push_back(liquid);
        primitives.back().material = b.add_material(tinted());
      } else {
        b.add(liquid, tinted());
      }
      b.add_node(mesh);
      // What was entered last counts: the liquid from its first face to its last but where glass is entered again.
      expect_color(seen(b, along_z(5, 0.3f)), glm::pow(kTint, vec3(0.8f + overlap)), 0.02f,
                   std::to_string(overlap) + " m");
    }
  }
}

// ----- blended

TEST(unit_path_bodies, a_blended_body_absorbs_inside_only) {
  for (const bool is_double : {false, true}) {
    Material m = tinted();
    m.alpha_mode = AlphaMode::blend;
    m.opacity = 0.5f;
    m.double_sided = is_double;
    SceneBuilder b;
    b.add(box(kLower, kUpper), m);
    // Half of the rays enter it.
    expect_color(seen(b, along_z(5, 0.4f), 256), 0.5f * kTint + vec3(0.5f), 0.02f, "half there");
    m.opacity = 1.0f;
    SceneBuilder c;
    c.add(box(kLower, kUpper), m);
    expect_color(seen(c, along_z(5, 0.4f)), kTint, 5e-3f, "all there");
    m.opacity = 0.0f;
    SceneBuilder d;
    d.add(box(kLower, kUpper), m);
    expect_color(seen(d, along_z(5, 0.4f)), vec3(1.0f), 1e-4f, "not there");
  }
}

// ----- the eye within

TEST(unit_path_bodies, the_eye_may_be_inside) {
  const vec3 two = kTint * kTint;
  for (const bool is_double : {false, true}) {
    for (const float ior : {1.0f, 1.33f}) {
      Material m = tinted();
      m.double_sided = is_double;
      m.ior = ior;
      SceneBuilder b;
      b.add(box(vec3(-2.0f), vec3(2.0f)), m, rotation({1, 2, 3}, 0.0f));
      const Scene scene = b.build();
      // Radiance in dense matter is n² times that outside; a camera's port takes it back, and shows what is there. What
      // the boundary reflects is another 4 m of tint, of 2 % of the light.
      View pinhole = look_at(vec3(0.0f), {0, 0, -1}, 0.1f);
      View lens = pinhole;
      lens.lens = {.radius = 0.01f, .focus_distance = 1.0f, .blades = 0, .vignetting = 0.0f};
      for (const View& view : {pinhole, along_z(0, 0.05f), lens}) {
        for (const auto integrator : {path::Integrator::full, path::Integrator::minimal}) {
          path::Settings s = settings(8, 64, 64);
          s.integrator = integrator;
          const vec3 c(mean_of(shoot(scene, constant_environment(vec3(1.0f)), view, s).beauty));
          expect_color(c, two, ior == 1.0f ? 5e-3f : 0.03f, "inside");
        }
      }
    }
  }
}

TEST(unit_path_bodies, the_eye_is_in_what_surrounds_it) {
  const auto inside_of = [](const Scene& scene, vec3 point) {
    const path::Geometry geometry(scene);
    const path::MediumStack stack = path::bodies_around(geometry, point);
    return stack.empty() ? 0.0f : stack.current()->ior;
  };
  Material glass = tinted();
  glass.ior = 1.5f;
  Material water = tinted();
  water.ior = 1.25f;
  SceneBuilder b;
  b.add(sphere(vec3(0.0f), 1.0f, 3, false), water);
  b.add(box(vec3(-3.0f), vec3(3.0f)), glass, rotation({1, 1, 0}, 0.7f));
  const Scene scene = b.build();
  EXPECT_EQ(inside_of(scene, vec3(0.0f)), 1.25f);
  EXPECT_EQ(inside_of(scene, vec3(0.9f, 0, 0)), 1.25f);
  EXPECT_EQ(inside_of(scene, vec3(1.5f, 0, 0)), 1.5f);
  EXPECT_EQ(inside_of(scene, vec3(9.0f, 0, 0)), 0.0f);
  EXPECT_EQ(inside_of(scene, vec3(0.0f, 3.9f, 0)), 0.0f);  // within its bounds
  // An instance, mirrored.
  SceneBuilder c;
  const int mesh = c.add_mesh(box(kLower, kUpper), c.add_material(glass));
  c.add_node(mesh, translation({10, 0, 0}) * scaling({-2, 1, 1}));
  c.add_node(mesh, translation({-10, 0, 0}));
  EXPECT_EQ(inside_of(c.build(), vec3(10.8f, 0.1f, 0.1f)), 1.5f);
  EXPECT_EQ(inside_of(c.build(), vec3(-10.8f, 0.1f, 0.1f)), 0.0f);
  EXPECT_EQ(inside_of(c.build(), vec3(-10.3f, 0.1f, 0.1f)), 1.5f);
}

TEST(unit_path_bodies, an_eye_that_is_wide_is_inside_where_it_is) {
  // Half of an orthographic picture starts in the body.
  SceneBuilder b;
  b.add(box({-4, -4, -1}, {0, 4, 1}), tinted());
  b.add(quad({-400, -400, -60}, {800, 0, 0}, {0, 800, 0}), unlit(vec3(1.0f)));
  const Image image = shoot(b.build(), dark_environment(), along_z(0, 1.0f), settings(16, 4, 8)).beauty;
  for (int y = 0; y < 16; ++y) {
    expect_color(image.rgb(3, y), kTint, 2e-3f, "inside");
    expect_color(image.rgb(12, y), vec3(1.0f), 2e-3f, "outside");
  }
}

}  // namespace
}  // namespace candela
