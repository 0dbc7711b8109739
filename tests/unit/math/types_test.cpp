#include "math/types.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "math/frame.h"
#include "support/random.h"

namespace candela {
namespace {

TEST(unit_math_types, box_is_empty_until_extended) {
  Box3 box;
  EXPECT_TRUE(box.empty());
  box.extend(Box3());
  EXPECT_TRUE(box.empty());
  box.extend(vec3(1.0f, 2.0f, 3.0f));
  EXPECT_FALSE(box.empty());
  EXPECT_EQ(box.size(), vec3(0.0f));
  box.extend(vec3(-1.0f, 4.0f, 3.0f));
  EXPECT_EQ(box.center(), vec3(0.0f, 3.0f, 3.0f));
  EXPECT_EQ(box.size(), vec3(2.0f, 2.0f, 0.0f));
  box.extend(Box3());
  EXPECT_EQ(box.lower, vec3(-1.0f, 2.0f, 3.0f));
}

TEST(unit_math_types, luminance_of_white_is_one) {
  EXPECT_NEAR(luminance(vec3(1.0f)), 1.0f, 1e-6f);
  EXPECT_GT(luminance(vec3(0, 1, 0)), luminance(vec3(1, 0, 0)));
  EXPECT_GT(luminance(vec3(1, 0, 0)), luminance(vec3(0, 0, 1)));
}

TEST(unit_math_types, finiteness_sees_every_component) {
  EXPECT_TRUE(is_finite(vec3(1.0f, -2.0f, 3e38f)));
  for (int i = 0; i < 3; ++i) {
    for (const float bad : {kInfinity, -kInfinity, std::numeric_limits<float>::quiet_NaN()}) {
      vec3 v(0.0f);
      v[i] = bad;
      EXPECT_FALSE(is_finite(v));
    }
  }
}

TEST(unit_math_types, points_move_and_vectors_do_not) {
  mat4 m(1.0f);
  m[3] = vec4(1.0f, 2.0f, 3.0f, 1.0f);
  EXPECT_EQ(transform_point(m, vec3(1.0f)), vec3(2.0f, 3.0f, 4.0f));
  EXPECT_EQ(transform_vector(m, vec3(1.0f)), vec3(1.0f));
}

TEST(unit_math_types, degrees_and_radians_are_inverse) {
  EXPECT_NEAR(radians(180.0f), kPi, 1e-6f);
  EXPECT_NEAR(degrees(radians(37.0f)), 37.0f, 1e-5f);
}

// ----- frames

void expect_right_handed(const Frame& f, vec3 n, float tolerance) {
  EXPECT_EQ(f.n, n);
  EXPECT_NEAR(glm::length(f.t), 1.0f, tolerance);
  EXPECT_NEAR(glm::length(f.b), 1.0f, tolerance);
  EXPECT_NEAR(glm::dot(f.t, n), 0.0f, tolerance);
  EXPECT_NEAR(glm::dot(f.b, n), 0.0f, tolerance);
  EXPECT_NEAR(glm::length(glm::cross(f.t, f.b) - n), 0.0f, tolerance);
}

vec3 any_direction(test::Pcg32& random) {
  const vec2 u = random.next_vec2();
  const float z = 2.0f * u.x - 1.0f;
  const float r = std::sqrt(std::max(1.0f - z * z, 0.0f));
  return {r * std::cos(2.0f * kPi * u.y), r * std::sin(2.0f * kPi * u.y), z};
}

TEST(unit_math_frame, frame_around_any_normal_is_orthonormal_and_right_handed) {
  test::Pcg32 random(1);
  for (int i = 0; i < 10000; ++i) {
    const vec3 n = any_direction(random);
    expect_right_handed(frame_from_normal(n), n, 2e-6f);
  }
  // Around -z, where the first formula of Frisvad 2012 broke down, with both signs of zero.
  for (const vec3 n : {vec3(0, 0, 1), vec3(0, 0, -1), vec3(1, 0, 0.0f), vec3(1, 0, -0.0f), vec3(0, -1, 0)}) {
    expect_right_handed(frame_from_normal(n), n, 1e-6f);
  }
  const vec3 near = glm::normalize(vec3(1e-4f, -1e-4f, -1.0f));
  expect_right_handed(frame_from_normal(near), near, 2e-6f);
}

TEST(unit_math_frame, frame_follows_the_tangent_and_survives_a_useless_one) {
  test::Pcg32 random(2);
  for (int i = 0; i < 1000; ++i) {
    const vec3 n = any_direction(random);
    const vec3 tangent = any_direction(random);
    const Frame f = frame_from_tangent(n, tangent);
    expect_right_handed(f, n, 1e-4f);
    EXPECT_GE(glm::dot(f.t, tangent), 0.0f);
    EXPECT_NEAR(glm::dot(f.b, tangent), 0.0f, 1e-4f);
  }
  const vec3 n(0.0f, 1.0f, 0.0f);
  expect_right_handed(frame_from_tangent(n, n), n, 1e-6f);
  expect_right_handed(frame_from_tangent(n, vec3(0.0f)), n, 1e-6f);
}

TEST(unit_math_frame, local_and_world_are_inverse) {
  test::Pcg32 random(3);
  for (int i = 0; i < 100; ++i) {
    const Frame f = frame_from_normal(any_direction(random));
    const vec3 v = any_direction(random);
    EXPECT_NEAR(glm::length(f.to_world(f.to_local(v)) - v), 0.0f, 2e-6f);
    EXPECT_NEAR(f.to_local(f.n).z, 1.0f, 1e-6f);
  }
}

}  // namespace
}  // namespace candela
