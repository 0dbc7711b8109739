#include "scene/posed_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "base/error.h"

namespace candela {
namespace {

using testing::HasSubstr;

std::string message_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

mat4 pose() {
  mat4 m = glm::mat4_cast(glm::angleAxis(0.8f, glm::normalize(vec3(1, -2, 0.5f))));
  m[3] = vec4(1, 2, 3, 1);
  return m;
}

CameraMatrix matrix() {
  CameraMatrix m;
  m.size = {640, 480};
  m.k = glm::dmat3(700, 0, 0, 3, 650, 0, 330.5, 201.25, 1);
  return m;
}

/// Pixels, as an engine has them: the picture's half-size at distance 1, through the inverse of the pose.
dvec2 pixel_of(const View& view, ivec2 size, dvec3 p) {
  const glm::dvec4 c = glm::inverse(glm::dmat4(view.world_from_camera)) * glm::dvec4(p, 1.0);
  const double half = std::tan(0.5 * static_cast<double>(std::get<PerspectiveCamera>(view.projection).yfov));
  const double aspect = static_cast<double>(size.x) / size.y;
  return {0.5 * size.x * (1.0 + c.x / (-c.z * half * aspect)), 0.5 * size.y * (1.0 - c.y / (-c.z * half))};
}

TEST(unit_scene_posed_camera, a_view_of_k_puts_points_where_k_does) {
  const CameraMatrix m = matrix();
  const View view = view_of_matrix(m, pose());
  for (const dvec3 in_camera : {dvec3(0, 0, -1), dvec3(0.3, -0.2, -2), dvec3(-1.5, 0.7, -4)}) {
    const dvec3 world(glm::dmat4(pose()) * glm::dvec4(in_camera, 1.0));
    // OpenCV's axes: right, down, forwards.
    const dvec3 projected = m.k * dvec3(in_camera.x, -in_camera.y, -in_camera.z);
    const dvec2 expected = dvec2(projected) / projected.z;
    const dvec2 found = pixel_of(view, m.size, world);
    EXPECT_NEAR(found.x, expected.x, 1e-2);
    EXPECT_NEAR(found.y, expected.y, 1e-2);
  }
}

TEST(unit_scene_posed_camera, k_and_pose_come_back_out_of_the_view) {
  const CameraMatrix m = matrix();
  const RigidCamera back = matrix_of_view(view_of_matrix(m, pose()), m.size);
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) EXPECT_NEAR(back.matrix.k[c][r], m.k[c][r], 1e-3) << c << ' ' << r;
  }
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) {
      EXPECT_NEAR(back.world_from_camera[c][r], static_cast<double>(pose()[c][r]), 1e-5) << c << ' ' << r;
    }
  }
}

TEST(unit_scene_posed_camera, square_pixels_and_an_axis_in_the_middle_are_an_ordinary_view) {
  CameraMatrix m;
  m.size = {640, 480};
  m.k = glm::dmat3(500, 0, 0, 0, 500, 0, 320, 240, 1);
  EXPECT_EQ(view_of_matrix(m, pose()).world_from_camera, pose());
}

TEST(unit_scene_posed_camera, matrices_that_are_no_cameras_are_refused) {
  const auto k = [](const glm::dmat3& value) {
    return message_of([&] { view_of_matrix({value, {64, 48}}, mat4(1.0f)); });
  };
  EXPECT_THAT(k(glm::dmat3(0, 0, 0, 0, 50, 0, 32, 24, 1)), HasSubstr("singular"));
  EXPECT_THAT(k(glm::dmat3(-5, 0, 0, 0, 50, 0, 32, 24, 1)), HasSubstr("negative"));
  EXPECT_THAT(k(glm::dmat3(50, 0, 1, 0, 50, 0, 32, 24, 1)), HasSubstr("no camera matrix"));
  const auto rigid = [](const std::function<void(glm::dmat4&)>& change) {
    glm::dmat4 m(pose());
    change(m);
    return message_of([&] { rigid_part(m); });
  };
  EXPECT_EQ(rigid([](auto& m) { m[3][0] = 7; }), "");
  EXPECT_EQ(rigid([](auto& m) { m[0] *= 2.0, m[1] *= 2.0, m[2] *= 2.0; }), "") << "a scale is left out";
  EXPECT_THAT(rigid([](auto& m) { m[1] = m[0]; }), HasSubstr("singular"));
  EXPECT_THAT(rigid([](auto& m) { m[0] = m[1] = m[2] = glm::dvec4(0.0); }), HasSubstr("singular"));
  EXPECT_THAT(rigid([](auto& m) { m[0] = -m[0]; }), HasSubstr("mirrors"));
  EXPECT_THAT(rigid([](auto& m) { m[0] += 0.1 * m[1]; }), HasSubstr("no rotation"));
  EXPECT_THAT(rigid([](auto& m) { m[2][3] = 1.0; }), HasSubstr("last row"));
  EXPECT_THAT(rigid([](auto& m) { m[2][1] = std::nan(""); }), HasSubstr("not finite"));
}

TEST(unit_scene_posed_camera, places_on_a_sphere_are_spread_evenly_and_turned_by_the_seed) {
  const std::vector<vec3> all = directions_on_sphere({.count = 100});
  vec3 sum(0.0f);
  for (const vec3 d : all) {
    EXPECT_NEAR(glm::length(d), 1.0f, 1e-6f);
    sum += d;
  }
  EXPECT_LT(glm::length(sum), 1.5f);
  for (const vec3 d : directions_on_sphere({.count = 10, .seed = 3, .is_upper_half = true})) EXPECT_GT(d.y, 0.0f);
  EXPECT_EQ(directions_on_sphere({.count = 5, .seed = 3}), directions_on_sphere({.count = 5, .seed = 3}));
  EXPECT_NE(directions_on_sphere({.count = 5, .seed = 3}), directions_on_sphere({.count = 5, .seed = 4}));
}

}  // namespace
}  // namespace candela
