#include "raster/lights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "math/box.h"
#include "unit/gl/gl_fixture.h"
#include "unit/path/scenes.h"

namespace candela::raster {
namespace {

using namespace test;

class unit_raster_lights : public WithGl {  // NOLINT(readability-identifier-naming): as its suite
 protected:
  void SetUp() override {
    WithGl::SetUp();
    builder_.add(box(vec3(-1.0f), vec3(1.0f)), matte(vec3(0.5f)));
  }

  SceneLights collect(const Environment& environment = dark_environment()) {
    const Scene scene = builder_.build();
    const GpuScene gpu(scene, shade::shading_model_candela(), diagnostics_);
    bounds_ = gpu.bounds();
    const FrameCamera camera = frame_camera(look_at({0, 0, 6}, vec3(0.0f), 0.8f), 64, 64, {.near = 4.0f, .far = 8.0f});
    return collect_lights(scene, environment, gpu, camera, LightPoint(0.5f), 0.0f, 0, diagnostics_);
  }

  SceneBuilder builder_;
  Diagnostics diagnostics_;
  Box3 bounds_;
};

/// Place in a shadow map, -1 … 1, and depth; behind its light w is not positive.
struct Seen {
  vec3 at{0.0f};
  bool is_before = false;

  bool is_inside() const { return is_before && std::fabs(at.x) <= 1.0f && std::fabs(at.y) <= 1.0f; }
};

Seen seen(const ShadowEntry& shadow, vec3 point) {
  const vec4 clip = shadow.from_world * vec4(point, 1.0f);
  return {vec3(clip) / clip.w, clip.w > 0.0f};
}

TEST_F(unit_raster_lights, the_strongest_come_first_by_what_arrives_in_the_middle) {
  builder_.add_light(point_light(vec3(1.0f), 100.0f), translation({0, 10, 0}));  // 1 lx
  builder_.add_light(point_light(vec3(1.0f), 20.0f), translation({0, 2, 0}));    // 5 lx
  builder_.add_light(sunlight(vec3(1.0f), 3.0f), aimed({0, 1, 0}, vec3(0.0f)));  // 3 lx
  builder_.add_light(point_light(vec3(0.0f), 1e6f), translation({0, 2, 0}));     // none
  const SceneLights lights = collect();
  ASSERT_EQ(lights.count, 3);
  EXPECT_FLOAT_EQ(lights.block.lights[0].color.x, 20.0f);
  EXPECT_FLOAT_EQ(lights.block.lights[1].color.x, 3.0f);
  EXPECT_FLOAT_EQ(lights.block.lights[2].color.x, 100.0f);
  EXPECT_EQ(lights.shadow_count, 6 + 4 + 6);
}

TEST_F(unit_raster_lights, those_beyond_the_most_are_left_out_and_told) {
  for (int i = 0; i < kMostLights + 3; ++i) {
    builder_.add_light(point_light(vec3(1.0f), static_cast<float>(1 + i)), translation({0, 2, 0}));
  }
  const SceneLights lights = collect();
  EXPECT_EQ(lights.count, kMostLights);
  EXPECT_FLOAT_EQ(lights.block.lights[0].color.x, static_cast<float>(kMostLights + 3));
  EXPECT_FLOAT_EQ(lights.block.lights[kMostLights - 1].color.x, 4.0f) << "the weakest three are missing";
  ASSERT_EQ(diagnostics_.warnings().size(), 2u);
  EXPECT_NE(diagnostics_.warnings()[0].message.find("of 35 lights the strongest 32"), std::string::npos)
      << diagnostics_.warnings()[0].message;
  // Ten have six shadow maps each; the others none, which is told too.
  EXPECT_EQ(lights.shadow_count, 60);
  EXPECT_EQ(lights.block.lights[9].first_shadow, 54);
  EXPECT_EQ(lights.block.lights[10].first_shadow, -1);
  EXPECT_NE(diagnostics_.warnings()[1].message.find("cast no shadow"), std::string::npos);
}

TEST_F(unit_raster_lights, a_spot_sees_its_cone_and_depth_is_near_over_distance) {
  const vec3 eye(3, 4, 0), target(0, 0, 0);
  builder_.add_light(spot_light(vec3(1.0f), 10.0f, 0.1f, 0.3f), aimed(eye, target));
  const SceneLights lights = collect();
  ASSERT_EQ(lights.shadow_count, 1);
  const ShadowEntry& shadow = lights.block.shadows[0];
  const Seen middle = seen(shadow, target);
  EXPECT_NEAR(middle.at.x, 0.0f, 1e-5f);
  EXPECT_NEAR(middle.at.y, 0.0f, 1e-5f);
  EXPECT_FLOAT_EQ(middle.at.z, shadow.near / 5.0f);
  const vec3 along = glm::normalize(target - eye), across(0, 0, 1);
  const auto off = [&](float angle) { return eye + 3.0f * (std::cos(angle) * along + std::sin(angle) * across); };
  EXPECT_TRUE(seen(shadow, off(0.29f)).is_inside());
  EXPECT_FALSE(seen(shadow, off(0.33f)).is_inside());
  EXPECT_FALSE(seen(shadow, eye - along).is_inside()) << "behind it";
  EXPECT_FLOAT_EQ(lights.block.lights[0].cos_inner, std::cos(0.1f));
  EXPECT_FLOAT_EQ(lights.block.lights[0].cos_outer, std::cos(0.3f));
}

TEST_F(unit_raster_lights, six_views_from_a_point_see_everything_in_the_shaders_order) {
  const vec3 eye(0.5f, 2.0f, -0.25f);
  builder_.add_light(point_light(vec3(1.0f), 10.0f), translation(eye));
  const SceneLights lights = collect();
  ASSERT_EQ(lights.shadow_count, 6);
  for (int i = 0; i < 1000; ++i) {
    const float z = -1.0f + 2.0f * (static_cast<float>(i) + 0.5f) / 1000.0f, phi = 2.4f * static_cast<float>(i);
    const float r = std::sqrt(1.0f - z * z);
    const vec3 d(r * std::cos(phi), r * std::sin(phi), z);
    // As shadow_face() of shaders/lights.glsl: +x -x +y -y +z -z.
    const vec3 a = glm::abs(d);
    const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
    const auto face = static_cast<std::size_t>(2 * axis + (d[axis] > 0.0f ? 0 : 1));
    EXPECT_TRUE(seen(lights.block.shadows[face], eye + d).is_inside()) << "face " << face;
  }
}

TEST_F(unit_raster_lights, the_last_cascade_of_a_sun_holds_everything_and_the_first_is_the_finest) {
  builder_.add(plane(vec3(0, -1, -40), 30.0f), matte(vec3(0.5f)));
  builder_.add_light(sunlight(vec3(1.0f), 3.0f), aimed({1, 3, 2}, vec3(0.0f)));
  const SceneLights lights = collect();
  ASSERT_EQ(lights.shadow_count, 4);
  for (const vec3& c : corners(bounds_)) {
    const Seen there = seen(lights.block.shadows[3], c);
    EXPECT_TRUE(there.is_inside());
    EXPECT_GE(there.at.z, 0.0f);
    EXPECT_LE(there.at.z, 1.0f);
  }
  for (std::size_t i = 0; i + 1 < 4; ++i) EXPECT_LT(lights.block.shadows[i].texel, lights.block.shadows[i + 1].texel);
  EXPECT_TRUE(seen(lights.block.shadows[0], {0, 0, 1}).is_inside()) << "what the camera sees first";
  // Depth falls away from the light.
  const vec3 towards = glm::normalize(vec3(1, 3, 2));
  EXPECT_GT(seen(lights.block.shadows[3], towards).at.z, seen(lights.block.shadows[3], -towards).at.z);
}

TEST_F(unit_raster_lights, suns_of_the_environment_are_lights_of_their_irradiance) {
  Environment environment = dark_environment();
  SunDisc sun;
  sun.direction = glm::normalize(vec3(0, 1, 1));
  sun.radiance = vec3(1e4f);
  sun.angular_radius = 0.01f;
  environment.suns.push_back(sun);
  const SceneLights lights = collect(environment);
  ASSERT_EQ(lights.count, 1);
  EXPECT_TRUE(lights.has_suns);
  EXPECT_LT(glm::distance(lights.block.lights[0].direction, -sun.direction), 1e-6f);
  EXPECT_NEAR(lights.block.lights[0].sun_radius, std::tan(0.01f), 1e-7f);
  // π r² for a disc as small as that.
  EXPECT_NEAR(lights.block.lights[0].color.x, 1e4f * kPi * 1e-4f, 1e-3f);
}

TEST_F(unit_raster_lights, a_mirrored_lamp_is_left_handed) {
  builder_.add_light(point_light(vec3(1.0f), 2.0f), translation({0, 2, 0}));
  builder_.add_light(point_light(vec3(1.0f), 1.0f), translation({0, 2, 0}) * scaling({-1, 1, 1}));
  const SceneLights lights = collect();
  EXPECT_EQ(lights.block.lights[0].handedness, 1.0f);
  EXPECT_EQ(lights.block.lights[1].handedness, -1.0f);
  EXPECT_LT(glm::distance(lights.block.lights[1].across, vec3(-1, 0, 0)), 1e-6f);
}

TEST_F(unit_raster_lights, an_area_light_has_shadows_where_there_is_room) {
  SceneLights lights;
  lights.shadow_size = 1024;
  AreaEntry panel;
  panel.corner_0 = {-1, 3, -1}, panel.corner_1 = {1, 3, -1}, panel.corner_2 = {1, 3, 1}, panel.corner_3 = {-1, 3, 1};
  const Box3 bounds{vec3(-5.0f), vec3(5.0f)};
  ASSERT_EQ(shadow_views(panel), 1);
  ASSERT_TRUE(add_area_shadows(lights, panel, {0, 3, 0}, bounds));
  EXPECT_EQ(panel.first_shadow, 0);
  EXPECT_EQ(panel.shadow_count, 1);
  // Its corners are counter-clockwise seen from below.
  EXPECT_TRUE(seen(lights.block.shadows[0], {0, 0, 0}).is_inside());
  EXPECT_FALSE(seen(lights.block.shadows[0], {0, 5, 0}).is_inside());
  AreaEntry both = panel;
  both.has_two_sides = 1;
  ASSERT_EQ(shadow_views(both), 2);
  ASSERT_TRUE(add_area_shadows(lights, both, {0, 3, 0}, bounds));
  EXPECT_TRUE(seen(lights.block.shadows[2], {0, 5, 0}).is_inside());
  AreaEntry body;
  body.is_body = 1;
  ASSERT_EQ(shadow_views(body), 6);
  lights.shadow_count = kMostShadows - 5;
  EXPECT_FALSE(add_area_shadows(lights, body, vec3(0.0f), bounds));
  EXPECT_EQ(body.first_shadow, -1);
  lights.shadow_count = kMostShadows - 6;
  EXPECT_TRUE(add_area_shadows(lights, body, vec3(0.0f), bounds));
  EXPECT_EQ(lights.shadow_count, kMostShadows);
}

TEST(unit_raster_light_points, points_of_a_ball_look_from_everywhere_like_an_even_disc) {
  EXPECT_EQ(point_of_ball(LightPoint(0.5f)), vec3(0.0f));
  constexpr int kSide = 24;
  for (const vec3& view : {vec3(1, 0, 0), vec3(0, 0, 1), glm::normalize(vec3(1, 2, 3))}) {
    double sum = 0.0, within_half = 0.0;
    for (int i = 0; i < kSide * kSide * kSide; ++i) {
      const vec3 u = (vec3(i % kSide, i / kSide % kSide, i / kSide / kSide) + 0.5f) / static_cast<float>(kSide);
      const vec3 p = point_of_ball(u);
      ASSERT_LE(glm::length(p), 1.0f + 1e-5f);
      const double r2 = static_cast<double>(glm::dot(p, p) - glm::dot(p, view) * glm::dot(p, view));
      sum += r2;
      within_half += r2 < 0.5 ? 1.0 : 0.0;
    }
    // Of an even disc the square of the radius is even, too.
    EXPECT_NEAR(sum / (kSide * kSide * kSide), 0.5, 0.01);
    EXPECT_NEAR(within_half / (kSide * kSide * kSide), 0.5, 0.02);
  }
}

}  // namespace
}  // namespace candela::raster
