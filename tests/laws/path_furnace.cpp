#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "unit/path/scenes.h"

// Closed forms in which only energy counts: whatever the shape, the answer is a number.

namespace candela {
namespace {

using namespace test;

/// Largest departure of any pixel and channel from `value`.
double departure(const Film& film, double value) {
  double largest = 0.0;
  for (int y = 0; y < film.height(); ++y) {
    for (int x = 0; x < film.width(); ++x) {
      const vec3 c = film.beauty.rgb(x, y);
      for (int i = 0; i < 3; ++i) largest = std::max(largest, std::abs(static_cast<double>(c[i]) - value));
    }
  }
  return largest;
}

Film in_furnace(const Primitive& shape, const Material& material, int samples) {
  SceneBuilder b;
  b.add(shape, material);
  return shoot(b.build(), constant_environment(vec3(1.0f)), look_at({1.7f, 1.3f, 2.6f}, vec3(0.0f), 0.8f),
               settings(24, samples, 64));
}

constexpr float kInvisible = 1e-4f;

TEST(law_path, white_matte_convex_bodies_are_invisible_in_the_furnace) {
  for (const Primitive& shape : {box(vec3(-0.6f), vec3(0.6f)), sphere(vec3(0.0f), 1.0f, 3, true)}) {
    EXPECT_LT(departure(in_furnace(shape, matte(vec3(1.0f)), 16), 1.0), kInvisible);
    // The twin: half a percent of absorption is seen.
    EXPECT_GT(departure(in_furnace(shape, matte(vec3(0.995f)), 16), 1.0), kInvisible);
  }
}

TEST(law_path, white_mirrors_are_invisible_in_the_furnace) {
  for (const Primitive& shape :
       {box(vec3(-0.6f), vec3(0.6f)), sphere(vec3(0.0f), 1.0f, 3, true), sphere(vec3(0.0f), 1.0f, 3, false)}) {
    EXPECT_LT(departure(in_furnace(shape, metal(vec3(1.0f), 0.0f), 16), 1.0), kInvisible);
    EXPECT_GT(departure(in_furnace(shape, metal(vec3(0.995f), 0.0f), 16), 1.0), kInvisible);
  }
}

/// A room without a front wall: light bounces many times before it leaves.
Scene open_room(const Material& material) {
  SceneBuilder b;
  Primitive room = turned_inside_out(box(vec3(-1.0f), vec3(1.0f)));
  room.triangles.resize(room.triangles.size() - 2);  // the last face is +z
  b.add(room, material);
  return b.build();
}

Moments room_in_furnace(const Material& material, path::Integrator integrator) {
  const Scene scene = open_room(material);
  return over_seeds(24, [&](std::uint32_t seed) {
    path::Settings s = settings(8, 16, 400);
    s.seed = seed;
    s.integrator = integrator;
    return mean_of(
               shoot(scene, constant_environment(vec3(1.0f)), look_at({0.2f, 0.1f, 0.9f}, {0, 0, -1}, 1.2f), s).beauty)
        .y;
  });
}

TEST(law_path, white_matte_hollow_is_invisible_in_the_furnace) {
  for (const auto integrator : {path::Integrator::full, path::Integrator::minimal}) {
    const Moments white = room_in_furnace(matte(vec3(1.0f)), integrator);
    EXPECT_GT(z_test_p_value(white, 1.0, 1e-4), kFamilySignificance) << white.mean() << " ± " << white.standard_error();
    const Moments grey = room_in_furnace(matte(vec3(0.99f)), integrator);
    EXPECT_LT(z_test_p_value(grey, 1.0, 1e-4), kFamilySignificance) << grey.mean() << " ± " << grey.standard_error();
  }
}

// ----- a closed room whose walls glow: every point sees the same, so the radiance is the sum of a series

struct GlowingRoom {
  Primitive shape;
  bool double_sided;
};

Moments glow(const GlowingRoom& room, float rho, int bounces, path::Integrator integrator) {
  SceneBuilder b;
  Material m = matte(vec3(rho));
  m.emission = vec3(0.7f);
  m.double_sided = room.double_sided;
  b.add(room.shape, m);
  const Scene scene = b.build();
  return over_seeds(12, [&](std::uint32_t seed) {
    path::Settings s = settings(8, 16, bounces);
    s.seed = seed;
    s.integrator = integrator;
    return mean_luminance(shoot(scene, dark_environment(), look_at({0.1f, 0.2f, 0.3f}, {1, 0, 0}, 1.4f), s).beauty);
  });
}

double series(double rho, int bounces) {
  double sum = 0.0;
  for (int k = 0; k <= bounces; ++k) sum += std::pow(rho, k);
  return 0.7 * sum;
}

// Light is read on both sides of each facet edge; what the offset of ray origins cuts off there.
constexpr double kEdges = 2e-4;

TEST(law_path, closed_glowing_room_reaches_the_geometric_series) {
  const GlowingRoom rooms[] = {{turned_inside_out(sphere(vec3(0.0f), 1.0f, 2, true)), false},
                               {sphere(vec3(0.0f), 1.0f, 2, true), true},
                               {turned_inside_out(box(vec3(-1.0f), vec3(1.0f))), false}};
  for (const GlowingRoom& room : rooms) {
    for (const float rho : {0.3f, 0.5f, 0.8f}) {
      for (const auto integrator : {path::Integrator::full, path::Integrator::minimal}) {
        const Moments m = glow(room, rho, 60, integrator);
        const double expected = 0.7 / (1.0 - static_cast<double>(rho));
        EXPECT_GT(z_test_p_value(m, expected, kEdges * expected), sidak_threshold(18))
            << "rho " << rho << ": " << m.mean() << " ± " << m.standard_error() << ", expected " << expected;
        EXPECT_LT(z_test_p_value(m, 1.03 * expected, kEdges * expected), sidak_threshold(18));
      }
    }
  }
}

TEST(law_path, bounce_limit_truncates_the_geometric_series) {
  const GlowingRoom room{turned_inside_out(sphere(vec3(0.0f), 1.0f, 2, true)), false};
  for (const int bounces : {0, 1, 2, 3, 5}) {
    const double expected = series(0.8, bounces);
    for (const auto integrator : {path::Integrator::full, path::Integrator::minimal}) {
      const Moments m = glow(room, 0.8f, bounces, integrator);
      EXPECT_GT(z_test_p_value(m, expected, kEdges * expected), sidak_threshold(10))
          << bounces << " bounces: " << m.mean() << " ± " << m.standard_error() << ", expected " << expected;
      EXPECT_LT(z_test_p_value(m, series(0.8, bounces + 1), kEdges * expected), sidak_threshold(10));
    }
  }
}

}  // namespace
}  // namespace candela
