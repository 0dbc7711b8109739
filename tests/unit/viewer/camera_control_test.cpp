#include "viewer/camera_control.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace candela::viewer {
namespace {

vec3 eye_of(const CameraControl& camera) { return vec3(camera.view().world_from_camera[3]); }
float distance_of(const CameraControl& camera) { return glm::distance(eye_of(camera), camera.pivot()); }

CameraControl camera_before(vec3 eye, vec3 center) {
  CameraControl camera;
  camera.set(look_at(eye, center, 0.8f), center);
  return camera;
}

TEST(unit_viewer_camera_control, turning_keeps_the_distance_and_the_pivot_in_the_middle) {
  CameraControl camera = camera_before({1, 2, 5}, {1, 0.5f, 0});
  const float distance = distance_of(camera);
  for (int i = 0; i < 50; ++i) {
    camera.orbit({0.3f, i % 7 == 0 ? 0.9f : -0.25f});
    EXPECT_NEAR(distance_of(camera), distance, 1e-3f);
    const vec3 seen = transform_point(glm::inverse(camera.view().world_from_camera), camera.pivot());
    EXPECT_NEAR(seen.x, 0.0f, 1e-3f);
    EXPECT_NEAR(seen.y, 0.0f, 1e-3f);
    EXPECT_GT(camera.view().world_from_camera[1].y, 0.0f) << "upside down";
  }
}

TEST(unit_viewer_camera_control, dragging_to_the_right_and_down_moves_the_eye_left_and_up) {
  CameraControl camera = camera_before({0, 0, 4}, vec3(0.0f));
  camera.orbit({0.2f, 0.3f});
  EXPECT_LT(eye_of(camera).x, -0.1f);
  EXPECT_GT(eye_of(camera).y, 0.1f);
}

TEST(unit_viewer_camera_control, what_is_at_the_pivot_follows_a_move) {
  CameraControl camera = camera_before({0, 1, 4}, vec3(0.0f));
  const vec3 before = camera.pivot();
  camera.pan({0.25f, -0.1f});
  // In shares of the picture's height, whose half is tan(0.4) at the distance 1.
  const vec3 seen = transform_point(glm::inverse(camera.view().world_from_camera), before);
  EXPECT_NEAR(seen.x / -seen.z / (2.0f * std::tan(0.4f)), 0.25f, 1e-4f);
  EXPECT_NEAR(seen.y / -seen.z / (2.0f * std::tan(0.4f)), -0.1f, 1e-4f);
}

TEST(unit_viewer_camera_control, five_steps_halve_the_distance_or_what_an_orthographic_camera_sees) {
  CameraControl camera = camera_before({0, 0, 4}, vec3(0.0f));
  camera.zoom(5.0f);
  EXPECT_NEAR(distance_of(camera), 2.0f, 1e-4f);
  camera.zoom(1e9f);
  EXPECT_GT(distance_of(camera), 0.0f);
  View view = look_at({0, 0, 4}, vec3(0.0f), 0.8f);
  view.projection = OrthographicCamera{2.0f, 1.0f};
  camera.set(view, vec3(0.0f));
  camera.zoom(-5.0f);
  EXPECT_NEAR(std::get<OrthographicCamera>(camera.view().projection).xmag, 4.0f, 1e-4f);
  EXPECT_NEAR(std::get<OrthographicCamera>(camera.view().projection).ymag, 2.0f, 1e-4f);
}

TEST(unit_viewer_camera_control, fitting_keeps_the_side_and_shows_the_whole) {
  CameraControl camera = camera_before({30, 20, 10}, vec3(0.0f));
  const vec3 back = glm::normalize(vec3(camera.view().world_from_camera[2]));
  Box3 box;
  box.extend(vec3(-1, -2, -1));
  box.extend(vec3(1, 3, 1));
  camera.fit(Extent(box), 1.5f);
  EXPECT_NEAR(glm::distance(glm::normalize(vec3(camera.view().world_from_camera[2])), back), 0.0f, 1e-3f);
  const float half = std::tan(0.4f);
  float widest = 0.0f;
  for (int i = 0; i < 8; ++i) {
    const vec3 corner((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 3 : -2, (i & 4) != 0 ? 1 : -1);
    const vec3 seen = transform_point(glm::inverse(camera.view().world_from_camera), corner);
    ASSERT_LT(seen.z, 0.0f);
    const vec2 ndc = vec2(seen.x / (1.5f * half), seen.y / half) / -seen.z;
    widest = std::max({widest, std::abs(ndc.x), std::abs(ndc.y)});
  }
  EXPECT_LE(widest, 1.0f);
  EXPECT_GT(widest, 0.7f);
}

}  // namespace
}  // namespace candela::viewer
