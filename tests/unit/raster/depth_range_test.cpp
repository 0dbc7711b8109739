#include "raster/depth_range.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "unit/gl/gl_fixture.h"
#include "unit/path/scenes.h"

namespace candela::raster {
namespace {

using namespace test;

class unit_raster_depth_range : public WithGl {  // NOLINT(readability-identifier-naming): as its suite
 protected:
  DepthRange seen(const View& view, float aspect = 1.0f) {
    const Scene scene = builder_.build();
    Diagnostics ignored;
    const GpuScene gpu(scene, shade::shading_model_candela(), ignored);
    return seen_range(scene, gpu, view, aspect);
  }
  /// A square that faces the view.
  void add(vec3 center, float half) {
    builder_.add(quad(center - vec3(half, half, 0), {2 * half, 0, 0}, {0, 2 * half, 0}), matte(vec3(0.5f)));
  }

  SceneBuilder builder_;
};

/// From the origin along -z, 90° high.
View ahead() {
  View view;
  view.projection = PerspectiveCamera{.yfov = 0.5f * kPi, .aspect_ratio = {}};
  return view;
}

TEST_F(unit_raster_depth_range, goes_from_the_nearest_to_the_farthest_thing_in_sight) {
  add({0, 0, -5}, 1.0f);
  add({3, 0, -20}, 1.0f);
  add({500, 0, -100}, 1.0f);  // beside the picture
  add({0, 0, 7}, 1.0f);       // behind the eye
  const DepthRange range = seen(ahead());
  EXPECT_LT(range.near, 5.0f);
  EXPECT_GT(range.near, 4.5f);
  EXPECT_NEAR(range.far, 20.0f, 1e-3f);
  EXPECT_FALSE(range.is_cut);
}

TEST_F(unit_raster_depth_range, counts_what_surrounds_the_eye_by_its_triangles) {
  builder_.add(turned_inside_out(box(vec3(-10.0f), vec3(10.0f))), matte(vec3(0.5f)));
  const DepthRange range = seen(ahead());
  // The box holds the eye; of its walls the picture's edges, at 45°, see those beside from 10 m on.
  EXPECT_GT(range.near, 8.0f);
  EXPECT_LT(range.near, 10.0f);
  EXPECT_NEAR(range.far, 10.0f, 1e-3f);
}

TEST_F(unit_raster_depth_range, a_wider_picture_sees_more) {
  add({6, 0, -4}, 0.5f);
  add({0, 0, -40}, 0.5f);
  EXPECT_GT(seen(ahead()).near, 30.0f);
  EXPECT_LT(seen(ahead(), 2.0f).near, 4.0f);
}

TEST_F(unit_raster_depth_range, a_surface_through_the_eye_leaves_a_share_of_the_way) {
  add({0, 0, -10}, 1.0f);
  builder_.add(quad({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}), matte(vec3(0.5f)));
  const DepthRange range = seen(ahead());
  EXPECT_NEAR(range.near, 1e-4f * range.far, 1e-7f * range.far);
  EXPECT_NEAR(range.far, 10.0f, 1e-3f);
}

TEST_F(unit_raster_depth_range, planes_of_a_view_are_kept_to_the_last_bit) {
  add({0, 0, -1}, 0.5f);
  add({0, 0, -50}, 0.5f);
  View view = ahead();
  view.near_plane = 0.1f, view.far_plane = 33.3f;
  DepthRange range = seen(view);
  EXPECT_TRUE(range.is_cut);
  EXPECT_EQ(range.far, 33.3f);
  EXPECT_GT(range.near, 0.5f) << "as near as something is";
  view.near_plane = 2.5f;
  view.far_plane = 60.0f;
  range = seen(view);
  EXPECT_GE(range.near, 2.5f);
  EXPECT_EQ(range.far, 60.0f);
}

TEST_F(unit_raster_depth_range, an_orthographic_one_holds_all_in_the_box_and_nothing_behind) {
  View view;
  view.projection = OrthographicCamera{.xmag = 2.0f, .ymag = 2.0f};
  add({0, 0, -3}, 1.0f);
  add({0, 0, -8}, 1.0f);
  add({9, 0, -30}, 1.0f);
  add({0, 0, 5}, 1.0f);
  const DepthRange range = seen(view);
  EXPECT_LE(range.near, 3.0f);
  EXPECT_GT(range.near, 2.9f);
  EXPECT_GE(range.far, 8.0f);
  EXPECT_LT(range.far, 8.1f);
}

TEST_F(unit_raster_depth_range, where_nothing_is_in_sight_there_is_a_range_all_the_same) {
  add({0, 0, 9}, 1.0f);
  for (const float far : {kInfinity, 0.3f}) {
    View view = ahead();
    view.far_plane = far;
    const DepthRange range = seen(view);
    EXPECT_GT(range.near, 0.0f);
    EXPECT_LT(range.near, range.far);
    EXPECT_TRUE(std::isfinite(range.far));
    EXPECT_EQ(range.is_cut, far < kInfinity);
  }
}

}  // namespace
}  // namespace candela::raster
