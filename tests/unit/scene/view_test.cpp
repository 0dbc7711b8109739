#include "scene/view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include "base/error.h"
#include "scene/framing.h"

namespace candela {
namespace {

View frame_box(const Box3& box, float aspect, float yfov, const Orbit& orbit = {}) {
  return frame(Extent(box), {.orbit = orbit, .aspect = aspect, .yfov = yfov, .margin = 0.04f});
}

/// Position in the picture in units of its half-size, y up; z is the depth along the viewing axis.
vec3 project(const View& view, float aspect, vec3 p) {
  const vec3 c = transform_point(glm::inverse(view.world_from_camera), p);
  const float tan_y = std::tan(0.5f * std::get<PerspectiveCamera>(view.projection).yfov);
  return {c.x / (-c.z * tan_y * aspect), c.y / (-c.z * tan_y), -c.z};
}

std::vector<vec3> corners(const Box3& box) {
  std::vector<vec3> result;
  result.reserve(8);
  for (int i = 0; i < 8; ++i)
    result.emplace_back(i & 1 ? box.upper.x : box.lower.x, i & 2 ? box.upper.y : box.lower.y,
                        i & 4 ? box.upper.z : box.lower.z);
  return result;
}

void expect_rigid(const mat4& m) {
  const mat3 r(m);
  const mat3 unit = glm::transpose(r) * r;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(unit[i][k], i == k ? 1.0f : 0.0f, 1e-5f);
  EXPECT_NEAR(glm::determinant(r), 1.0f, 1e-5f);
}

TEST(unit_scene_view, framed_boxes_fill_the_picture_up_to_the_margin) {
  const std::vector<Box3> boxes{{vec3(-1), vec3(1)},
                                {vec3(3, -2, 8), vec3(4, 5, 8.5f)},
                                {vec3(-10, 0, -1), vec3(10, 0.1f, 1)},
                                {vec3(0.001f), vec3(0.004f, 0.002f, 0.009f)},
                                {vec3(-500, -1, -500), vec3(500, 1, 700)}};
  for (const Box3& box : boxes) {
    for (const float aspect : {0.5f, 1.0f, 16.0f / 9.0f, 4.0f}) {
      for (const float fov_deg : {10.0f, 35.0f, 90.0f}) {
        for (const Orbit orbit : {Orbit{}, Orbit{.azimuth = 2.5f, .elevation = -0.9f}, Orbit{.elevation = 1.5707963f},
                                  Orbit{.azimuth = -1.5707963f, .elevation = 0.0f}}) {
          const View view = frame_box(box, aspect, radians(fov_deg), orbit);
          float tightest = 0.0f;
          for (const vec3 corner : corners(box)) {
            const vec3 p = project(view, aspect, corner);
            EXPECT_GT(p.z, 0.0f);
            tightest = std::max({tightest, std::abs(p.x), std::abs(p.y)});
          }
          EXPECT_GE(tightest, 0.80f) << aspect << ' ' << fov_deg << ' ' << orbit.azimuth << ' ' << orbit.elevation;
          EXPECT_LE(tightest, 0.97f) << aspect << ' ' << fov_deg << ' ' << orbit.azimuth << ' ' << orbit.elevation;
          expect_rigid(view.world_from_camera);
        }
      }
    }
  }
}

TEST(unit_scene_view, rays_start_a_hair_beyond_the_near_plane_and_before_the_far_one) {
  View view = look_at(vec3(0, 0, 5), vec3(0), 1.0f);
  EXPECT_EQ(start_of_rays(view), 0.0f);
  for (const float far_away : {0.0f, 10.0f, 1e5f}) {
    view.world_from_camera[3].x = far_away;
    for (const float near : {1e-3f, 3.0f, 100.0f}) {
      view.near_plane = near, view.far_plane = kInfinity;
      EXPECT_GT(start_of_rays(view), near);
      EXPECT_LE(start_of_rays(view), near + 1e-6f * (far_away + near + 5.0f));
      view.far_plane = near * (1.0f + 0x1p-20f);
      EXPECT_LE(start_of_rays(view), view.far_plane);
    }
  }
}

TEST(unit_scene_view, cameras_are_known_by_the_number_that_their_file_gives_them) {
  Scene scene;
  for (const int number : {2, 0}) {
    Camera camera;
    camera.file_index = number;
    scene.cameras.push_back(camera);
    Node node;
    node.camera = static_cast<int>(scene.cameras.size()) - 1;
    node.world_from_node[3] = vec4(0, 0, number, 1);
    scene.nodes.push_back(node);
  }
  EXPECT_EQ(scene_camera(scene, "2", 1.0f).world_from_camera[3].z, 2.0f);
  EXPECT_EQ(scene_camera(scene, "0", 1.0f).world_from_camera[3].z, 0.0f);
  try {
    scene_camera(scene, "1", 1.0f);
    FAIL() << "the file has it, and this scene has not";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "no camera \"1\" (known: 2, 0)");
  }
  // Of a scene made in memory the place is the number.
  for (Camera& camera : scene.cameras) camera.file_index = -1;
  EXPECT_EQ(scene_camera(scene, "1", 1.0f).world_from_camera[3].z, 0.0f);
}

TEST(unit_scene_view, framed_boxes_stand_in_the_middle) {
  const Box3 box{vec3(-1, 0, -2), vec3(2, 5, 1)};
  const View view = frame_box(box, 1.5f, radians(40.0f));
  vec2 lower(kInfinity), upper(-kInfinity);
  for (const vec3 corner : corners(box)) {
    const vec2 p(project(view, 1.5f, corner));
    lower = glm::min(lower, p), upper = glm::max(upper, p);
  }
  EXPECT_NEAR(lower.x, -upper.x, 1e-4f);
  EXPECT_NEAR(lower.y, -upper.y, 1e-4f);
}

TEST(unit_scene_view, orbit_angles_turn_the_right_way) {
  const Box3 box{vec3(-1), vec3(1)};
  const auto eye = [&](const Orbit& orbit) {
    return vec3(frame_box(box, 1.0f, radians(35.0f), orbit).world_from_camera[3]);
  };
  const vec3 front = eye({.azimuth = 0.0f, .elevation = 0.0f});
  EXPECT_NEAR(front.x, 0.0f, 1e-4f);
  EXPECT_NEAR(front.y, 0.0f, 1e-4f);
  EXPECT_GT(front.z, 1.0f) << "azimuth 0 sees the +z sides";
  EXPECT_GT(eye({.azimuth = radians(90.0f), .elevation = 0.0f}).x, 1.0f) << "positive azimuth moves towards +x";
  EXPECT_GT(eye({.azimuth = 0.0f, .elevation = radians(60.0f)}).y, 1.0f) << "positive elevation looks from above";
  // From straight above the picture's top is -z, as it is arriving there from azimuth 0.
  const View above = frame_box(box, 1.0f, radians(35.0f), {.azimuth = 0.0f, .elevation = radians(90.0f)});
  EXPECT_NEAR(above.world_from_camera[1].z, -1.0f, 1e-5f);
}

TEST(unit_scene_view, half_the_distance_is_twice_as_close) {
  const Box3 box{vec3(4, 4, 4), vec3(6, 6, 6)};
  const View whole = frame_box(box, 1.0f, radians(35.0f), {.azimuth = 0.3f, .elevation = 0.2f});
  const View half = frame_box(box, 1.0f, radians(35.0f), {.azimuth = 0.3f, .elevation = 0.2f, .distance_scale = 0.5f});
  const vec3 back(whole.world_from_camera[2]);
  const auto depth = [&](const View& view) { return glm::dot(vec3(view.world_from_camera[3]) - box.center(), back); };
  EXPECT_NEAR(depth(half), 0.5f * depth(whole), 1e-4f);
  EXPECT_NEAR(whole.lens.focus_distance, depth(whole), 1e-4f) << "sharp at the subject's middle";
  EXPECT_EQ(whole.lens.radius, 0.0f);
}

TEST(unit_scene_view, a_point_or_nothing_is_framed_without_harm) {
  for (const Box3& box : {Box3{}, Box3{vec3(7), vec3(7)}, Box3{vec3(0, 0, -3), vec3(0, 0, 3)}}) {
    const View view = frame_box(box, 1.0f, radians(35.0f), {.azimuth = 0.0f, .elevation = 0.0f});
    expect_rigid(view.world_from_camera);
    EXPECT_TRUE(is_finite(vec3(view.world_from_camera[3])));
    EXPECT_GT(view.lens.focus_distance, 0.0f);
    if (!box.empty()) {
      EXPECT_GT(project(view, 1.0f, box.center()).z, 0.0f);
    }
  }
}

TEST(unit_scene_view, look_at_puts_the_target_in_the_middle) {
  const vec3 eye(1, 5, -2), target(-3, 0.5f, 4);
  const View view = look_at(eye, target, radians(40.0f));
  expect_rigid(view.world_from_camera);
  const vec3 p = project(view, 1.0f, target);
  EXPECT_NEAR(p.x, 0.0f, 1e-5f);
  EXPECT_NEAR(p.y, 0.0f, 1e-5f);
  EXPECT_NEAR(p.z, glm::length(target - eye), 1e-4f);
  EXPECT_NEAR(view.lens.focus_distance, p.z, 1e-4f);
  EXPECT_NEAR(view.world_from_camera[0].y, 0.0f, 1e-6f) << "the horizon is level";
  EXPECT_GT(view.world_from_camera[1].y, 0.0f);
  expect_rigid(look_at(vec3(0, 3, 0), vec3(0), 1.0f).world_from_camera);
  expect_rigid(look_at(vec3(0, -3, 0), vec3(0), 1.0f).world_from_camera);
  EXPECT_THROW(look_at(eye, eye, 1.0f), Error);
}

Scene scene_with_cameras() {
  Scene scene;
  scene.cameras.push_back({.name = "wide", .projection = PerspectiveCamera{.yfov = 1.0f, .aspect_ratio = 1.5f}});
  scene.cameras.push_back({.name = "plan", .projection = OrthographicCamera{.xmag = 2.0f, .ymag = 1.0f}});
  Node node;
  node.name = "tripod";
  node.camera = 0;
  node.parent_from_node = node.world_from_node = glm::rotate(
      glm::scale(glm::translate(mat4(1.0f), vec3(1, 2, 3)), vec3(5, 0.5f, 2)), radians(90.0f), vec3(0, 1, 0));
  scene.nodes.push_back(node);
  Node other;
  other.name = "crane";
  other.camera = 1;
  scene.nodes.push_back(other);
  return scene;
}

TEST(unit_scene_view, a_camera_is_found_by_index_and_by_either_name) {
  const Scene scene = scene_with_cameras();
  for (const char* name : {"0", "wide", "tripod"})
    EXPECT_TRUE(std::holds_alternative<PerspectiveCamera>(scene_camera(scene, name, 1.5f).projection)) << name;
  for (const char* name : {"1", "plan", "crane"})
    EXPECT_TRUE(std::holds_alternative<OrthographicCamera>(scene_camera(scene, name, 1.5f).projection)) << name;
  for (const char* name : {"2", "-1", "", "Wide", "0x"}) {
    try {
      scene_camera(scene, name, 1.5f);
      ADD_FAILURE() << name << " was found";
    } catch (const Error& error) {
      EXPECT_NE(error.message().find("wide"), std::string::npos) << error.message();
      EXPECT_NE(error.message().find("crane"), std::string::npos) << error.message();
    }
  }
  EXPECT_THROW(scene_camera(Scene{}, "0", 1.0f), Error);
}

TEST(unit_scene_view, a_camera_keeps_the_rotation_of_its_node_and_loses_the_scale) {
  const View view = scene_camera(scene_with_cameras(), "0", 1.5f);
  expect_rigid(view.world_from_camera);
  EXPECT_EQ(vec3(view.world_from_camera[3]), vec3(1, 2, 3));
  EXPECT_NEAR(view.world_from_camera[2].x, 1.0f, 1e-6f) << "turned by 90° about +y it looks along -x";

  Scene flat = scene_with_cameras();
  flat.nodes[0].world_from_node = glm::scale(mat4(1.0f), vec3(1, 0, 1));
  EXPECT_THROW(scene_camera(flat, "0", 1.0f), Error);
}

TEST(unit_scene_view, another_aspect_ratio_shows_more_never_less) {
  const Scene scene = scene_with_cameras();
  const auto half_angles = [&](float aspect) {
    const float tan_y =
        std::tan(0.5f * std::get<PerspectiveCamera>(scene_camera(scene, "wide", aspect).projection).yfov);
    return vec2(tan_y * aspect, tan_y);
  };
  const vec2 wished(1.5f * std::tan(0.5f), std::tan(0.5f));
  EXPECT_NEAR(half_angles(1.5f).x, wished.x, 1e-5f);
  EXPECT_NEAR(half_angles(1.5f).y, wished.y, 1e-5f);
  EXPECT_NEAR(half_angles(3.0f).y, wished.y, 1e-5f) << "wider: the height stays";
  EXPECT_NEAR(half_angles(0.7f).x, wished.x, 1e-5f) << "narrower: the width stays";

  const auto plan = [&](float aspect) {
    return std::get<OrthographicCamera>(scene_camera(scene, "plan", aspect).projection);
  };
  EXPECT_FLOAT_EQ(plan(4.0f).xmag, 4.0f);
  EXPECT_FLOAT_EQ(plan(4.0f).ymag, 1.0f);
  EXPECT_FLOAT_EQ(plan(1.0f).xmag, 2.0f);
  EXPECT_FLOAT_EQ(plan(1.0f).ymag, 2.0f);
}

TEST(unit_scene_view, planes_are_the_cameras_and_framing_has_none) {
  Scene scene;
  scene.cameras.emplace_back();
  scene.cameras[0].near_plane = 0.5f, scene.cameras[0].far_plane = 7.0f;
  Node& node = scene.nodes.emplace_back();
  node.camera = 0;
  node.world_from_node = glm::scale(mat4(1.0f), vec3(3.0f));
  const View view = scene_camera(scene, node, 1.0f);
  EXPECT_EQ(view.near_plane, 0.5f) << "metres, whatever the scale of its node";
  EXPECT_EQ(view.far_plane, 7.0f);
  EXPECT_TRUE(view.is_clipped());
  EXPECT_FALSE(frame_box({vec3(-1), vec3(1)}, 1.0f, 0.8f).is_clipped());
  EXPECT_FALSE(look_at({0, 0, 5}, vec3(0), 0.8f).is_clipped());
}

TEST(unit_scene_view, a_camera_with_an_f_number_has_a_lens) {
  Scene scene = scene_with_cameras();
  EXPECT_EQ(scene_camera(scene, "0", 1.5f).lens.radius, 0.0f);
  scene.cameras[0].f_number = 2.8f;
  scene.cameras[0].focus_distance = 0.7f;
  const Lens lens = scene_camera(scene, "0", 1.5f).lens;
  EXPECT_FLOAT_EQ(lens.focus_distance, 0.7f);
  EXPECT_FLOAT_EQ(lens.radius, aperture_radius(2.8f, 1.0f));
  // 26.99° on 24 mm is a 50 mm lens: f/2 opens 25 mm wide.
  EXPECT_NEAR(aperture_radius(2.0f, 2.0f * std::atan(12.0f / 50.0f)), 0.0125f, 1e-7f);
  EXPECT_THROW(aperture_radius(0.0f, 1.0f), Error);
}

}  // namespace
}  // namespace candela
