#include <gtest/gtest.h>

#include <cmath>

#include "support/random.h"
#include "unit/path/scenes.h"

// Where there are too many lamps to look at each, some are chosen by a tree; nothing of the light may be lost by that.

namespace candela {
namespace {

using namespace test;

struct PlacedLight {
  Light light;
  mat4 where;
};

/// A floor, a glossy box, and a sheet that light goes through, with lamps on both sides of it.
SceneBuilder hall() {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 4.0f), matte({0.7f, 0.6f, 0.5f}));
  b.add(box({-0.8f, 0, -0.8f}, {-0.2f, 0.6f, -0.2f}), plastic({0.2f, 0.6f, 0.8f}, 0.15f));
  Material sheet = matte({0.8f, 0.8f, 0.8f});
  sheet.diffuse_transmission = 0.6f;
  sheet.double_sided = true;
  b.add(quad({0.2f, 0.4f, 1.0f}, {0.9f, 0.2f, 0}, {0, 0.1f, -1.5f}), sheet);
  return b;
}

std::vector<PlacedLight> mixed_lights(std::size_t count) {
  Pcg32 random(7);
  std::vector<PlacedLight> lights;
  for (std::size_t i = 0; i < count; ++i) {
    const vec3 u = random.next_vec3();
    const vec3 at(4.0f * u.x - 2.0f, 0.2f + 1.5f * u.y, 4.0f * u.z - 2.0f);
    const vec3 color = 0.2f + 0.8f * random.next_vec3();
    const float intensity = std::exp(2.0f * random.next_float());
    PlacedLight p{point_light(color, intensity), translation(at)};
    if (i % 3 == 1) p.light.range = 1.0f + random.next_float();
    if (i % 3 == 2) {
      p.light = spot_light(color, 2.0f * intensity, 0.1f + 0.4f * u.x, 0.6f + 0.5f * u.y);
      p.where = aimed(at, vec3(2.0f * u.z - 1.0f, 0.3f, 2.0f * u.x - 1.0f));
    }
    if (i % 20 == 6) p.light = sunlight(color, 2.0f * intensity);
    lights.push_back(p);
  }
  return lights;
}

View from_corner() { return look_at({1.8f, 1.7f, 2.6f}, {0, 0.2f, 0}, 0.9f); }

TEST(law_path_many_lamps, they_give_what_they_give_in_small_groups) {
  constexpr std::size_t kLights = 80, kGroup = 16;
  const std::vector<PlacedLight> lights = mixed_lights(kLights);
  SceneBuilder all = hall();
  for (const PlacedLight& p : lights) all.add_light(p.light, p.where);
  const path::Settings s = settings(12, 64, 3);
  const Scene scene = all.build();
  const auto together = mean_over_seeds(16, scene, dark_environment(), from_corner(), s);
  std::array<double, 3> sum{}, variance{};
  for (std::size_t first = 0; first < kLights; first += kGroup) {
    SceneBuilder some = hall();
    for (std::size_t i = first; i < first + kGroup; ++i) some.add_light(lights[i].light, lights[i].where);
    const auto group = mean_over_seeds(16, some.build(), dark_environment(), from_corner(), s);
    for (std::size_t c = 0; c < 3; ++c) {
      sum[c] += group[c].mean();
      variance[c] += std::pow(group[c].standard_error(), 2.0);
    }
  }
  for (std::size_t c = 0; c < 3; ++c) {
    const double error = std::sqrt(variance[c] + std::pow(together[c].standard_error(), 2.0));
    EXPECT_LT(std::abs(together[c].mean() - sum[c]), 4.0 * error) << together[c].mean() << " not " << sum[c];
    EXPECT_LT(error, 0.01 * sum[c]) << "too noisy to say";
  }
}

/// Glowing balls, patches of one side and of two, under a sky that can be sampled too.
Scene many_surfaces() {
  SceneBuilder b = hall();
  Pcg32 random(3);
  Material both = lamp({1, 2, 4});
  both.double_sided = true;
  for (int i = 0; i < 45; ++i) {
    const vec3 u = random.next_vec3();
    const vec3 at(4.0f * u.x - 2.0f, 0.3f + 1.2f * u.y, 4.0f * u.z - 2.0f);
    if (i % 3 == 0) {
      b.add(sphere(at, 0.2f, 1, true), lamp({6, 4, 2}));
    } else {
      const vec3 a = 0.9f * (random.next_vec3() - 0.5f), c = 0.9f * (random.next_vec3() - 0.5f);
      b.add(quad(at, a, c), i % 3 == 1 ? lamp({3, 6, 4}) : both);
    }
  }
  return b.build();
}

TEST(law_path_many_lamps, surfaces_that_glow_have_the_mean_of_meeting_them_by_chance) {
  const Scene scene = many_surfaces();
  const Environment sky =
      mapped_environment(32, 16, [](vec3 d) { return vec3(d.y > 0.8f ? 1.0f : 0.05f, 0.1f, 0.2f); });
  path::Settings s = settings(12, 64, 3);
  const auto full = mean_over_seeds(16, scene, sky, from_corner(), s);
  s.integrator = path::Integrator::minimal;
  s.samples = 256;
  const auto minimal = mean_over_seeds(16, scene, sky, from_corner(), s);
  for (std::size_t c = 0; c < 3; ++c) {
    const double error = std::hypot(full[c].standard_error(), minimal[c].standard_error());
    EXPECT_LT(std::abs(full[c].mean() - minimal[c].mean()), 4.0 * error) << full[c].mean() << ' ' << minimal[c].mean();
    EXPECT_LT(error, 0.01 * minimal[c].mean()) << "too noisy to say";
  }
}

/// Mean over the pixels of the relative variance of a floor's picture under `count` lamps.
double floor_noise(int count) {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 4.0f), matte(vec3(0.7f)));
  Pcg32 random(5);
  for (int i = 0; i < count; ++i) {
    const vec3 u = random.next_vec3();
    b.add_light(point_light(vec3(1.0f), 10.0f / static_cast<float>(count)),
                translation({4.0f * u.x - 2.0f, 0.3f + u.y, 4.0f * u.z - 2.0f}));
  }
  const Scene scene = b.build();
  path::Settings s = centred(16, 16, 1);
  const Image a = shoot(scene, dark_environment(), from_above(3.0f, 2.0f), s).beauty;
  s.seed = 1;
  const Image c = shoot(scene, dark_environment(), from_above(3.0f, 2.0f), s).beauty;
  double sum = 0.0;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      const auto p = static_cast<double>(a.rgb(x, y).y), q = static_cast<double>(c.rgb(x, y).y);
      sum += 2.0 * std::pow((p - q) / (p + q), 2.0);
    }
  }
  return sum / 256.0;
}

TEST(law_path_many_lamps, three_thousand_add_little_noise) {
  // Where each is asked there is none; were groups estimated without their distance it would be 0.01.
  EXPECT_LT(floor_noise(10), 1e-9);
  EXPECT_LT(floor_noise(3000), 5e-4);
}

}  // namespace
}  // namespace candela
