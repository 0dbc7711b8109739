#include "path/empty_pixels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "path/environment_light.h"
#include "support/random.h"
#include "unit/path/scenes.h"

// A pixel that only a smooth background can be seen in needs few samples; whether it is one is proved, never sampled.

namespace candela {
namespace {

using namespace test;
using path::EnvironmentLight;

constexpr int kSize = 48;

struct Found {
  int missed = 0;     ///< pixels said to be empty in which a ray met something
  int covered = 0;    ///< pixels said to be covered
  int untouched = 0;  ///< of these, pixels that no ray met anything in, nor any of their neighbours
};

/// Against 4 rays at the corners of every pixel's support and `rays` within it.
Found compare(const Scene& scene, const View& view, float radius, int rays) {
  const path::Geometry geometry(scene);
  const path::Camera camera(view, kSize, kSize);
  const std::vector<std::uint8_t> covered = path::find_covered_pixels(geometry, camera.pinhole().value(), radius);
  Pcg32 random(5);
  std::vector<std::uint8_t> met(covered.size(), 0);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      for (int i = 0; i < rays; ++i) {
        const vec2 u = i < 4 ? vec2(i & 1, i / 2) : random.next_vec2();
        const vec2 film = vec2(x, y) + 0.5f + radius * (2.0f * u - 1.0f);
        if (geometry.intersect(camera.generate(film, vec2(0.5f)).ray, 0))
          met[static_cast<std::size_t>(y * kSize + x)] = 1;
      }
    }
  }
  Found found;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const auto i = static_cast<std::size_t>(y * kSize + x);
      found.missed += met[i] != 0 && covered[i] == 0 ? 1 : 0;
      if (covered[i] == 0) continue;
      ++found.covered;
      bool is_near = false;
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, kSize - 1); ++v) {
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, kSize - 1); ++u)
          is_near = is_near || met[static_cast<std::size_t>(v * kSize + u)] != 0;
      }
      found.untouched += is_near ? 0 : 1;
    }
  }
  return found;
}

/// Thin blades, a ball, and one mesh placed twice.
Scene thicket(vec3 center) {
  Pcg32 random(3);
  SceneBuilder b;
  for (int i = 0; i < 12; ++i) {
    const vec3 from = center + 1.6f * (random.next_vec3() - 0.5f);
    b.add(quad(from, 0.9f * (random.next_vec3() - 0.5f), 0.004f * (random.next_vec3() - 0.5f)), matte(vec3(0.5f)));
  }
  const int ball = b.add_mesh(sphere(vec3(0.0f), 0.3f, 2, true), b.add_material(matte(vec3(0.5f))));
  b.add_node(ball, translation(center + vec3(0.5f, -0.4f, 0)) * scaling({1.0f, -0.2f, 0.6f}));
  b.add_node(ball, translation(center + vec3(-0.6f, 0.3f, 0)) * rotation({1, 2, 3}, 0.8f));
  return b.build();
}

TEST(unit_path_empty, a_pixel_in_which_a_ray_meets_something_is_covered) {
  for (const float radius : {0.5f, 1.5f}) {
    for (const vec3 center : {vec3(0.0f), vec3(30, -2, 50)}) {
      const View view = look_at(center + vec3(0.4f, 0.5f, 3), center, 0.7f);
      const Found found = compare(thicket(center), view, radius, 64);
      EXPECT_EQ(found.missed, 0);
      EXPECT_GT(found.covered, 200);
      EXPECT_LT(found.covered, kSize * kSize / 2) << "most pixels are empty";
      EXPECT_LT(found.untouched, found.covered / 4) << "and little more is covered than there is";
    }
  }
}

TEST(unit_path_empty, ground_that_passes_below_the_eye_is_covered_up_to_its_horizon) {
  for (const float half : {5.0f, 2000.0f}) {
    SceneBuilder b;
    b.add(plane({0, -1, 0}, half), matte(vec3(0.5f)));
    const Found found = compare(b.build(), look_at({0.3f, 0, 0}, {0.1f, 0, -1}, 1.2f), 0.5f, 16);
    EXPECT_EQ(found.missed, 0);
    EXPECT_GT(found.covered, kSize * kSize / 4);
    EXPECT_LT(found.covered, kSize * kSize / 2 + 2 * kSize);
  }
}

TEST(unit_path_empty, what_is_behind_the_eye_covers_nothing) {
  SceneBuilder b;
  b.add(sphere({0, 0, 5}, 1.0f, 2, true), matte(vec3(0.5f)));
  EXPECT_EQ(compare(b.build(), look_at({0, 0, 0}, {0, 0, -1}, 1.2f), 0.5f, 4).covered, 0);
}

TEST(unit_path_empty, where_rounding_may_decide_all_is_covered) {
  // The eye is in the triangles' plane, as far from the origin as metres are coarse.
  const vec3 far(4e6f, 0, 0);
  SceneBuilder b;
  b.add(plane(far, 3.0f), matte(vec3(0.5f)));
  EXPECT_EQ(compare(b.build(), look_at(far, far + vec3(0, 0.5f, -1), 0.8f), 0.5f, 4).covered, kSize * kSize);
}

TEST(unit_path_empty, cameras_without_one_point_to_look_from_have_no_pinhole) {
  View view = look_at({0, 0, 3}, vec3(0.0f), 0.7f);
  EXPECT_TRUE(path::Camera(view, 8, 8).pinhole());
  view.lens.radius = 0.1f;
  EXPECT_FALSE(path::Camera(view, 8, 8).pinhole());
  view.lens.radius = 0.0f;
  view.projection = OrthographicCamera{.xmag = 1.0f, .ymag = 1.0f};
  EXPECT_FALSE(path::Camera(view, 8, 8).pinhole());
}

TEST(unit_path_empty, a_pinhole_sees_points_where_their_rays_pass_the_film) {
  Pcg32 random(7);
  View view = look_at({2, 1, 3}, {0.3f, 0, 0}, 0.9f);
  view.world_from_camera[0] *= 2.0f;  // a scale on one axis
  const path::Camera camera(view, 40, 30);
  const path::Camera::Pinhole pinhole = camera.pinhole().value();
  for (int i = 0; i < 100; ++i) {
    const vec2 film = random.next_vec2() * vec2(40, 30);
    const path::Ray ray = camera.generate(film, vec2(0.5f)).ray;
    const dvec2 found =
        pinhole.film(pinhole.from_world(ray.origin + ray.direction * (1.0f + 9.0f * random.next_float())));
    EXPECT_LT(glm::length(found - dvec2(film)), 1e-3) << film.x << " " << film.y;
  }
}

// ----- what is seen in them

std::array<vec3, 4> square_around(vec3 direction, float half) {
  const Frame frame = frame_from_normal(direction);
  std::array<vec3, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) {
    corners[i] =
        glm::normalize(direction + frame.t * ((i & 1) != 0 ? half : -half) + frame.b * ((i & 2) != 0 ? half : -half));
  }
  return corners;
}

TEST(unit_path_empty, contrast_is_no_less_than_that_of_the_light_within) {
  Pcg32 random(11);
  Environment e = mapped_environment(64, 32, [&](vec3 d) { return vec3(1.2f + d.y) + 0.2f * random.next_vec3(); });
  e.rotation = 0.7f;
  const EnvironmentLight light(e);
  int smooth = 0;
  for (int i = 0; i < 400; ++i) {
    const vec3 middle = frame_from_normal(glm::normalize(random.next_vec3() - 0.5f)).t;
    const float half = 0.002f + 0.1f * random.next_float();
    const auto corners = square_around(middle, half);
    const float contrast = light.contrast(corners, EnvironmentLight::Sight::lights);
    float least = kInfinity, most = 0.0f, sum = 0.0f;
    constexpr int kLooks = 60;
    for (int k = 0; k < kLooks; ++k) {
      const vec2 u = random.next_vec2();
      const vec3 d =
          glm::normalize(glm::mix(glm::mix(corners[0], corners[1], u.x), glm::mix(corners[2], corners[3], u.x), u.y));
      const float l = luminance(light.evaluate(d).radiance);
      least = std::min(least, l);
      most = std::max(most, l);
      sum += l / kLooks;
    }
    EXPECT_GE(1.3f * contrast, (most - least) / sum) << i << ": the mean of texels is not that of the square";
    smooth += contrast < 0.1f ? 1 : 0;
  }
  EXPECT_GT(smooth, 20) << "small squares have little";
}

TEST(unit_path_empty, a_sun_is_too_much_contrast_wherever_it_touches_the_pixel) {
  Environment e = constant_environment(vec3(0.5f));
  SunDisc sun;
  sun.direction = glm::normalize(vec3(0.3f, 0.5f, -0.9f));
  sun.angular_radius = 0.01f;
  sun.radiance = vec3(5.0f);
  e.suns.push_back(sun);
  const EnvironmentLight light(e);
  const Frame frame = frame_from_normal(sun.direction);
  for (const float angle : {0.0f, 0.01f, 0.013f}) {
    const auto corners = square_around(std::cos(angle) * frame.n + std::sin(angle) * frame.t, 0.004f);
    EXPECT_EQ(light.contrast(corners, EnvironmentLight::Sight::lights), kInfinity) << angle;
    EXPECT_EQ(light.contrast(corners, EnvironmentLight::Sight::map), 0.0f) << "who does not see suns";
  }
  const auto beside = square_around(std::cos(0.03f) * frame.n + std::sin(0.03f) * frame.t, 0.004f);
  EXPECT_EQ(light.contrast(beside, EnvironmentLight::Sight::lights), 0.0f);
}

TEST(unit_path_empty, the_backdrop_counts_where_it_is_what_is_seen) {
  Environment e = mapped_environment(64, 32, [](vec3) { return vec3(1.0f); });
  const Environment stripes = mapped_environment(64, 32, [](vec3 d) { return vec3(d.y > 0.0f ? 1.0f : 0.1f); });
  e.backdrop = stripes.map;
  const EnvironmentLight light(e);
  const auto horizon = square_around({0, 0, -1}, 0.05f);
  EXPECT_EQ(light.contrast(horizon, EnvironmentLight::Sight::lights), 0.0f);
  EXPECT_GT(light.contrast(horizon, EnvironmentLight::Sight::backdrop), 0.5f);
}

// ----- the picture

/// A ball before a sky that brightens upwards.
Scene ball() {
  SceneBuilder b;
  b.add(sphere(vec3(0.0f), 0.4f, 3, false), matte(vec3(0.6f)));
  return b.build();
}

TEST(unit_path_empty, empty_pixels_take_fewer_samples_and_their_mean_is_that_of_all) {
  const Environment sky =
      mapped_environment(64, 32, [](vec3 d) { return vec3(0.5f + 0.4f * d.y, 0.5f, 0.7f - 0.2f * d.x); });
  const View view = look_at({0.3f, 0.2f, 3}, vec3(0.0f), 0.7f);
  const path::Tracer tracer(ball(), sky);
  path::Statistics statistics;
  const path::Settings s = settings(32, 256, 2);
  const Film film = tracer.render(view, s, {}, &statistics);
  EXPECT_GT(statistics.spared_samples, 32u * 32u * 256u / 2);
  EXPECT_EQ(statistics.samples + statistics.spared_samples, 32u * 32u * 256u);
  EXPECT_EQ(statistics.mean_samples_per_pixel, 256.0);

  const EnvironmentLight light(sky);
  const path::Camera camera(view, 32, 32);
  int compared = 0;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      if (glm::length(vec2(x, y) - 15.5f) < 12.0f) continue;  // the ball
      vec3 mean(0.0f);
      constexpr int kGrid = 16;
      for (int i = 0; i < kGrid * kGrid; ++i) {
        const vec2 film_point = vec2(x, y) + (vec2(i % kGrid, i / kGrid) + 0.5f) / static_cast<float>(kGrid);
        mean += light.evaluate(camera.generate(film_point, vec2(0.5f)).ray.direction).radiance / float(kGrid * kGrid);
      }
      EXPECT_LT(glm::length(film.beauty.rgb(x, y) - mean), 1e-3f * glm::length(mean)) << x << " " << y;
      ++compared;
    }
  }
  EXPECT_GT(compared, 400);
}

TEST(unit_path_empty, what_differs_within_a_pixel_takes_all_samples) {
  Pcg32 random(2);
  const Environment noise =
      mapped_environment(512, 256, [&](vec3) { return random.next_vec3() * random.next_float(); });
  path::Statistics statistics;
  path::render(ball(), noise, look_at({0.3f, 0.2f, 3}, vec3(0.0f), 0.7f), settings(32, 64, 1), {}, &statistics);
  EXPECT_LT(statistics.spared_samples, 32u * 32u * 64u / 100);
}

}  // namespace
}  // namespace candela
