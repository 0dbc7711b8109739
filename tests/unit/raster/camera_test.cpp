#include "raster/camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace candela::raster {
namespace {

constexpr float kNearly = 1e-5f;

View perspective(float yfov) {
  View view;
  view.projection = PerspectiveCamera{.yfov = yfov, .aspect_ratio = {}};
  return view;
}

View orthographic(float xmag, float ymag) {
  View view;
  view.projection = OrthographicCamera{.xmag = xmag, .ymag = ymag};
  return view;
}

/// Where a point of the world is in the picture, and its depth: each -1 … 1.
vec3 projected(const FrameCamera& camera, vec3 point) {
  const vec4 clip = camera.clip_from_world * vec4(point, 1.0f);
  return vec3(clip) / clip.w;
}

void expect_near(vec3 found, vec3 expected, float most = kNearly) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], expected[i], most) << "axis " << i;
}

TEST(unit_raster_camera, the_field_of_view_reaches_the_corners) {
  const float half = std::tan(0.4f);
  const FrameCamera camera = frame_camera(perspective(0.8f), 200, 100, {.near = 1.0f, .far = 9.0f});
  for (const float x : {-1.0f, 1.0f}) {
    for (const float y : {-1.0f, 1.0f}) {
      const vec3 corner = camera.at_depth({x, y}, 3.0f);
      expect_near(corner, {3.0f * 2.0f * half * x, 3.0f * half * y, -3.0f});
      const vec3 there = projected(camera, corner);
      EXPECT_NEAR(there.x, x, kNearly);
      EXPECT_NEAR(there.y, y, kNearly);
    }
  }
}

TEST(unit_raster_camera, depth_begins_at_the_near_plane_and_has_no_end_but_that_of_the_view) {
  const FrameCamera endless = frame_camera(perspective(0.8f), 8, 8, {.near = 0.5f, .far = 9.0f});
  EXPECT_NEAR(projected(endless, {0, 0, -0.5f}).z, -1.0f, kNearly);
  const float farthest = projected(endless, {0, 0, -1e30f}).z;
  EXPECT_LT(farthest, 1.0f) << "where the background is";
  EXPECT_GT(farthest, 0.999f);
  const FrameCamera cut = frame_camera(perspective(0.8f), 8, 8, {.near = 0.5f, .far = 9.0f, .is_cut = true});
  EXPECT_NEAR(projected(cut, {0, 0, -9.0f}).z, 1.0f, kNearly);
  EXPECT_GT(projected(cut, {0, 0, -9.1f}).z, 1.0f);
}

TEST(unit_raster_camera, an_orthographic_view_is_a_box) {
  const FrameCamera camera = frame_camera(orthographic(3.0f, 2.0f), 30, 20, {.near = 1.0f, .far = 5.0f});
  EXPECT_FALSE(camera.is_perspective);
  expect_near(projected(camera, {3, 2, -1}), {1, 1, -1});
  expect_near(projected(camera, {-3, -2, -5}), {-1, -1, 1});
  expect_near(camera.at_depth({1, -1}, 4.0f), {3, -2, -4});
}

TEST(unit_raster_camera, jitter_moves_the_picture_by_pixels) {
  for (const View& view : {perspective(0.8f), orthographic(2.0f, 1.0f)}) {
    const DepthRange range{.near = 1.0f, .far = 9.0f};
    const vec3 point(0.4f, -0.3f, -4.0f);
    const vec3 still = projected(frame_camera(view, 200, 100, range), point);
    const vec3 moved = projected(frame_camera(view, 200, 100, range, {0.5f, -0.25f}), point);
    // Pixels count to the right and down.
    EXPECT_NEAR((moved.x - still.x) * 200.0f / 2.0f, 0.5f, 1e-3f);
    EXPECT_NEAR((still.y - moved.y) * 100.0f / 2.0f, -0.25f, 1e-3f);
    EXPECT_NEAR(moved.z, still.z, kNearly);
  }
}

TEST(unit_raster_camera, from_all_of_the_lens_what_is_in_focus_is_at_one_place) {
  View view = perspective(0.8f);
  view.world_from_camera = look_at({1, 2, 3}, {0, 0, 0}, 0.8f).world_from_camera;
  view.lens = {.radius = 0.2f, .focus_distance = 2.0f};
  const auto at = [&](float depth, vec2 aperture) {
    const vec3 point = transform_point(view.world_from_camera, {0.3f, 0.1f, -depth});
    return vec2(projected(frame_camera(view, 64, 64, {.near = 0.1f, .far = 9.0f}, vec2(0.0f), aperture), point));
  };
  for (const vec2 aperture : {vec2(1, 0), vec2(-0.6f, 0.8f)}) {
    EXPECT_LT(glm::distance(at(2.0f, aperture), at(2.0f, vec2(0.0f))), 1e-4f);
    // Before and behind it moves to either side, by the radius over the field of view.
    EXPECT_GT(glm::dot(at(4.0f, aperture) - at(4.0f, vec2(0.0f)), aperture), 0.01f);
    EXPECT_LT(glm::dot(at(1.0f, aperture) - at(1.0f, vec2(0.0f)), aperture), -0.01f);
  }
  EXPECT_NEAR(glm::distance(frame_camera(view, 64, 64, {}, vec2(0.0f), {1, 0}).eye, vec3(1, 2, 3)), 0.2f, kNearly);
}

TEST(unit_raster_camera, boxes_outside_are_known) {
  const mat4 clip =
      frame_camera(perspective(1.0f), 64, 64, {.near = 1.0f, .far = 9.0f, .is_cut = true}).clip_from_world;
  const auto around = [](vec3 center) { return Box3{center - vec3(0.5f), center + vec3(0.5f)}; };
  EXPECT_FALSE(is_outside(clip, around({0, 0, -4})));
  EXPECT_FALSE(is_outside(clip, {vec3(-100.0f), vec3(100.0f)})) << "it surrounds all";
  for (const vec3 beside : {vec3(8, 0, -4), vec3(-8, 0, -4), vec3(0, 8, -4), vec3(0, -8, -4)}) {
    EXPECT_TRUE(is_outside(clip, around(beside)));
    EXPECT_TRUE(is_beside(clip, around(beside)));
  }
  const Box3 beyond = around({0, 0, -20}), before = around({0, 0, -0.4f + 0.0f});
  EXPECT_TRUE(is_outside(clip, beyond));
  EXPECT_FALSE(is_beside(clip, beyond)) << "it is in the direction of the view";
  EXPECT_TRUE(is_outside(clip, before));
}

}  // namespace
}  // namespace candela::raster
