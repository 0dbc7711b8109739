#include "scene/framing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "base/error.h"

namespace candela {
namespace {

Mesh cloud(unsigned seed, int count, vec3 size) {
  std::mt19937 generator(seed);
  std::normal_distribution<float> normal;
  Primitive p;
  for (int i = 0; i < count; ++i)
    p.positions.push_back(size * vec3(normal(generator), normal(generator), normal(generator)));
  for (unsigned i = 0; i + 2 < static_cast<unsigned>(count); ++i) p.triangles.emplace_back(i, i + 1, i + 2);
  return {.name = "cloud", .primitives = {p}};
}

/// Two meshes, one of them at three places, mirrored in one.
Scene clouds() {
  Scene scene;
  scene.materials.emplace_back();
  scene.meshes = {cloud(1, 500, {1, 2, 0.5f}), cloud(2, 300, {0.3f, 0.1f, 0.7f})};
  const auto place = [&](int mesh, const mat4& world) {
    Node node;
    node.mesh = mesh;
    node.world_from_node = world;
    scene.nodes.push_back(node);
  };
  mat4 moved(1.0f);
  moved[3] = vec4(4, 1, -2, 1);
  place(0, moved);
  for (int i = 0; i < 3; ++i) {
    mat4 m = glm::mat4_cast(glm::angleAxis(0.7f * static_cast<float>(i), glm::normalize(vec3(1, 2, 3))));
    if (i == 1) m[0] = -m[0];
    m[3] = vec4(3.0f + static_cast<float>(i), -1, 0, 1);
    place(1, m);
  }
  return scene;
}

std::vector<vec3> points_of(const Scene& scene) {
  std::vector<vec3> points;
  for (const Node& node : scene.nodes) {
    if (node.mesh < 0 || is_lamp(scene, node)) continue;
    for (const Primitive& p : scene.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
      for (const vec3 q : p.positions) points.push_back(transform_point(node.world_from_node, q));
    }
  }
  return points;
}

struct Bounds2 {
  vec2 lower{kInfinity}, upper{-kInfinity};
  void extend(vec2 p) { lower = glm::min(lower, p), upper = glm::max(upper, p); }
};

/// Of the points in the picture, in units of its half-size.
Bounds2 silhouette(const View& view, float aspect, const std::vector<vec3>& points) {
  Bounds2 bounds;
  for (const vec3 p : points) {
    const vec3 c = transform_point(glm::inverse(view.world_from_camera), p);
    EXPECT_LT(c.z, 0.0f) << "behind the camera";
    if (const auto* o = std::get_if<OrthographicCamera>(&view.projection)) {
      bounds.extend({c.x / o->xmag, c.y / o->ymag});
    } else {
      const float tan_y = std::tan(0.5f * std::get<PerspectiveCamera>(view.projection).yfov);
      bounds.extend(vec2(c.x / aspect, c.y) / (-c.z * tan_y));
    }
  }
  return bounds;
}

TEST(unit_scene_framing, reach_is_that_of_the_farthest_vertex) {
  const Scene scene = clouds();
  const Extent extent(scene);
  const std::vector<vec3> points = points_of(scene);
  std::mt19937 generator(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const dvec3 d = glm::normalize(dvec3(normal(generator), normal(generator), normal(generator)));
    double expected = -1e30;
    for (const vec3 p : points) expected = std::max(expected, glm::dot(dvec3(p), d));
    EXPECT_NEAR(extent.reach(d), expected, 2e-6);
  }
}

TEST(unit_scene_framing, two_extents_together_reach_as_far_as_the_farther) {
  const Scene scene = clouds();
  const Box3 box{vec3(-9, -1, -1), vec3(-8, 6, 9)};
  Extent both(scene);
  {
    const Extent other(box);
    both.add(other);
  }
  std::mt19937 generator(4);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const dvec3 d = glm::normalize(dvec3(normal(generator), normal(generator), normal(generator)));
    EXPECT_EQ(both.reach(d), std::max(Extent(scene).reach(d), Extent(box).reach(d)));
  }
  EXPECT_EQ(both.bounds().lower.x, -9.0f);
}

TEST(unit_scene_framing, who_goes_around_comes_back_to_the_same_view) {
  const Scene scene = clouds();
  const Extent extent(scene);
  const vec3 center = extent.bounds().center();
  const Orbit front = named_orbit("front");
  const View view = frame(extent, {.orbit = front, .aspect = 1.5f});
  const View same = moved_to(view, center, front);
  for (int c = 0; c < 4; ++c) {
    EXPECT_LT(glm::length(same.world_from_camera[c] - view.world_from_camera[c]), 1e-5f) << c;
  }
  const Orbit turned{.azimuth = 2.0f, .elevation = -0.7f, .distance_scale = 0.5f};
  const View other = moved_to(view, center, turned);
  const auto center_in = [&](const View& v) { return transform_point(glm::inverse(v.world_from_camera), center); };
  const vec3 before = center_in(view), after = center_in(other);
  EXPECT_LT(glm::length(vec3(before.x, before.y, 0.5f * before.z) - after), 1e-4f) << "as much aside, half as far";
  const vec3 back(std::sin(2.0f) * std::cos(-0.7f), std::sin(-0.7f), std::cos(2.0f) * std::cos(-0.7f));
  EXPECT_LT(glm::length(vec3(other.world_from_camera[2]) - back), 1e-6f);
}

TEST(unit_scene_framing, lamps_are_no_part_of_the_subject) {
  Scene scene = clouds();
  const double before = Extent(scene).reach({0, 1, 0});
  scene.materials.emplace_back().is_lamp = true;
  scene.meshes.push_back(scene.meshes[0]);
  scene.meshes.back().primitives[0].material = 1;
  scene.nodes.emplace_back().mesh = 2;
  scene.nodes.back().world_from_node[3] = vec4(0, 50, 0, 1);
  EXPECT_EQ(Extent(scene).reach({0, 1, 0}), before);
}

TEST(unit_scene_framing, margins_are_equal_and_the_tight_ones_are_as_asked) {
  const Scene scene = clouds();
  const Extent extent(scene);
  const std::vector<vec3> points = points_of(scene);
  for (const float aspect : {0.4f, 1.0f, 16.0f / 9.0f, 4.0f}) {
    for (const NamedView& named : kNamedViews) {
      for (const float margin : {0.0f, 0.08f, 0.2f}) {
        for (const bool is_orthographic : {false, true}) {
          const Framing framing{.orbit = named_orbit(named.name),
                                .aspect = aspect,
                                .yfov = radians(35.0f),
                                .is_orthographic = is_orthographic,
                                .margin = margin};
          const Bounds2 b = silhouette(frame(extent, framing), aspect, points);
          EXPECT_NEAR(b.lower.x, -b.upper.x, 1e-4f) << named.name << ' ' << aspect;
          EXPECT_NEAR(b.lower.y, -b.upper.y, 1e-4f) << named.name << ' ' << aspect;
          EXPECT_NEAR(std::max(b.upper.x, b.upper.y), 1.0f - 2.0f * margin, 1e-4f) << named.name << ' ' << aspect;
        }
      }
    }
  }
}

TEST(unit_scene_framing, all_pictures_of_a_turntable_fit_and_one_touches) {
  const Scene scene = clouds();
  const std::vector<vec3> points = points_of(scene);
  const Extent extent(scene);
  constexpr int kTurns = 12;
  const View view = frame(extent, {.aspect = 1.5f, .turns = kTurns});
  Bounds2 all;
  for (int i = 0; i < kTurns; ++i) {
    View turned = view;
    const vec3 center = extent.bounds().center();
    mat4 there(1.0f), back(1.0f);
    there[3] = vec4(center, 1.0f), back[3] = vec4(-center, 1.0f);
    const float angle = 2.0f * kPi * static_cast<float>(i) / kTurns;
    turned.world_from_camera =
        there * glm::mat4_cast(glm::angleAxis(angle, vec3(0, 1, 0))) * back * view.world_from_camera;
    const Bounds2 b = silhouette(turned, 1.5f, points);
    all.extend(b.lower), all.extend(b.upper);
  }
  EXPECT_NEAR(std::max({all.upper.x, -all.lower.x, all.upper.y, -all.lower.y}), 0.84f, 1e-4f);
  EXPECT_NEAR(all.upper.y, -all.lower.y, 1e-4f);
}

TEST(unit_scene_framing, an_outline_reaches_as_far_as_the_whole) {
  const Scene scene = clouds();
  const Extent extent(scene);
  const std::vector<vec3> points = extent.outline(2000);
  EXPECT_LT(points.size(), 800u);
  const Extent outline(points);
  for (const dvec3 d : {dvec3(1, 0, 0), dvec3(0.3, -0.5, 0.2), dvec3(-1, -1, -1)}) {
    EXPECT_NEAR(outline.reach(d), extent.reach(d), 0.01 * glm::length(extent.bounds().size()));
    EXPECT_LE(outline.reach(d), extent.reach(d) + 1e-6);
  }
}

/// A rectangle with a thickness, whose front faces along `axis`.
Scene board(int axis, float thickness, bool faces_back) {
  Scene scene;
  scene.materials.emplace_back();
  Primitive p;
  for (int i = 0; i < 4; ++i) {
    vec3 q(0.0f);
    q[(axis + 1) % 3] = i == 1 || i == 2 ? 2.0f : 0.0f;
    q[(axis + 2) % 3] = i >= 2 ? 1.0f : 0.0f;
    p.positions.push_back(q);
  }
  vec3 top = p.positions[2];
  top[axis] += thickness;
  p.positions.push_back(top);
  p.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 2, 4}};
  if (faces_back) {
    for (uvec3& t : p.triangles) std::swap(t.y, t.z);
  }
  scene.meshes = {{.name = "board", .primitives = {p}}};
  scene.nodes.emplace_back().mesh = 0;
  return scene;
}

TEST(unit_scene_framing, what_is_flat_is_seen_from_its_front) {
  const auto azimuth = [](const Scene& scene) {
    const Orbit orbit = default_orbit(scene, world_bounds(scene));
    return std::pair(std::round(degrees(orbit.azimuth)), std::round(degrees(orbit.elevation)));
  };
  EXPECT_EQ(azimuth(board(2, 0.0f, false)), std::pair(0.0f, 0.0f));
  EXPECT_EQ(azimuth(board(2, 0.02f, true)), std::pair(180.0f, 0.0f));
  EXPECT_EQ(azimuth(board(0, 0.0f, false)), std::pair(90.0f, 0.0f));
  EXPECT_EQ(azimuth(board(0, 0.0f, true)), std::pair(-90.0f, 0.0f));
  EXPECT_EQ(azimuth(board(1, 0.0f, false)), std::pair(0.0f, 90.0f));
  EXPECT_EQ(azimuth(board(1, 0.02f, false)), std::pair(35.0f, 20.0f)) << "a landscape";
  EXPECT_EQ(azimuth(board(2, 0.2f, false)), std::pair(35.0f, 20.0f));
  Scene mirrored = board(2, 0.0f, false);
  mirrored.nodes[0].world_from_node[0] = vec4(-1, 0, 0, 0);
  EXPECT_EQ(azimuth(mirrored), std::pair(0.0f, 0.0f)) << "its front stays its front";
}

TEST(unit_scene_framing, views_that_do_not_exist_are_told_with_those_that_do) {
  try {
    named_orbit("sideways");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("\"sideways\" (known: front, back, left, right, top, bottom, iso"));
  }
}

TEST(unit_scene_framing, what_is_tiny_or_far_away_fills_its_picture_too) {
  for (const float size : {1e-7f, 1e-6f, 1.0f, 1e6f}) {
    for (const float far : {0.0f, 1e3f}) {
      const vec3 center(far * size, 0, -far * size);
      const Extent extent(Box3{center - 0.5f * size, center + 0.5f * size});
      const View view = frame(extent, {});
      const float distance = -transform_point(glm::inverse(view.world_from_camera), center).z;
      EXPECT_LT(distance, 4.0f * size) << size << " at " << far;
      EXPECT_GT(distance, 1.0f * size) << size << " at " << far;
    }
  }
}

TEST(unit_scene_framing, a_point_and_nothing_have_a_place_to_be_seen_from) {
  for (const Extent& extent : {Extent(std::vector<vec3>{}), Extent(std::vector<vec3>{vec3(3, 4, 5)})}) {
    for (const bool is_orthographic : {false, true}) {
      const View view = frame(extent, {.is_orthographic = is_orthographic});
      for (int c = 0; c < 4; ++c) {
        for (int r = 0; r < 4; ++r) EXPECT_TRUE(std::isfinite(view.world_from_camera[c][r]));
      }
      const vec3 center = extent.empty() ? vec3(0) : vec3(3, 4, 5);
      EXPECT_LT(transform_point(glm::inverse(view.world_from_camera), center).z, 0.0f);
    }
  }
}

}  // namespace
}  // namespace candela
