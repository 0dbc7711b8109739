#include "path/guide.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "math/sobol.h"
#include "unit/path/scenes.h"

// Guides are densities, learned; and what they lead stays what it was.

namespace candela {
namespace {

using namespace test;
using path::Guide;
using path::GuidedKind;
using path::GuideLearner;
using path::GuideRecord;
using path::Guiding;

vec3 direction_of(vec2 u) {
  const float z = 2.0f * u.x - 1.0f, phi = 2.0f * kPi * u.y, r = std::sqrt(std::max(1.0f - z * z, 0.0f));
  return {r * std::cos(phi), r * std::sin(phi), z};
}

constexpr vec3 kBright = {0.36f, 0.48f, 0.8f};

/// Light from around one direction in the half of space with x > 0, from everywhere in the other.
Guide learned(int rounds) {
  Guide guide({vec3(-1.0f), vec3(1.0f)});
  for (int round = 0; round < rounds; ++round) {
    GuideLearner learner(guide, false);
    for (std::uint32_t i = 0; i < 40000; ++i) {
      SobolSampler sampler(static_cast<std::uint32_t>(round), i);
      const vec3 position = 2.0f * sampler.next_3d() - vec3(1.0f);
      GuideRecord record;
      record.region = guide.find_region(position);
      const vec3 direction = direction_of(sampler.next_2d());
      record.cell = guide.find_cell(record.region, direction);
      record.bsdf_pdf = 0.25f / kPi;
      record.learned_pdf = guide.pdf(record.region, direction);
      record.pdf = record.bsdf_pdf;
      const bool is_bright = position.x <= 0.0f || glm::dot(direction, kBright) > 0.95f;
      record.light = is_bright ? 4.0f * kPi : 0.0f;
      record.reflected = is_bright ? 1.0f : 0.0f;
      learner.add({&record, 1});
    }
    guide = learner.next();
  }
  return guide;
}

TEST(unit_path_guide, density_is_that_of_its_samples_and_integrates_to_one) {
  for (const int rounds : {0, 1, 3}) {
    const Guide guide = learned(rounds);
    for (const vec3 position : {vec3(0.7f, 0.1f, -0.2f), vec3(-0.7f, 0.1f, -0.2f)}) {
      const std::uint32_t region = guide.find_region(position);
      constexpr std::uint32_t kCount = 1U << 16;
      double integral = 0.0, reciprocal = 0.0;
      for (std::uint32_t i = 0; i < kCount; ++i) {
        SobolSampler sampler(7, i);
        integral += static_cast<double>(guide.pdf(region, direction_of(sampler.next_2d()))) / kCount;
        const vec3 drawn = guide.sample(region, sampler.next_2d());
        EXPECT_NEAR(glm::length(drawn), 1.0f, 1e-4f);
        // ∫ over what lies above z = 0.3, by its own samples
        if (drawn.z > 0.3f) reciprocal += 1.0 / static_cast<double>(guide.pdf(region, drawn)) / kCount;
      }
      EXPECT_NEAR(integral * 4.0 * static_cast<double>(kPi), 1.0, 0.02) << rounds;
      if (position.x < 0.0f || rounds == 0) {
        EXPECT_NEAR(reciprocal, 2.0 * static_cast<double>(kPi) * 0.7, 0.15) << rounds;
      }
    }
  }
}

TEST(unit_path_guide, light_is_looked_for_where_it_was_found) {
  const Guide guide = learned(3);
  EXPECT_GT(guide.region_count(), 4u);
  const std::uint32_t lit = guide.find_region({0.8f, 0.0f, 0.0f}), even = guide.find_region({-0.8f, 0.0f, 0.0f});
  EXPECT_GT(guide.pdf(lit, kBright), 10.0f * 0.25f / kPi);
  EXPECT_LT(guide.pdf(lit, -kBright), 0.1f * 0.25f / kPi);
  EXPECT_NEAR(guide.pdf(even, kBright), 0.25f / kPi, 0.2f * 0.25f / kPi);
  // Where the material never looked, the guide is asked often; where all is alike, there is nothing to ask.
  EXPECT_GT(guide.mix(lit, GuidedKind::diffuse).learned, 0.5f);
  EXPECT_EQ(guide.mix(lit, GuidedKind::diffuse).sky, 0.0f);
  EXPECT_EQ(guide.mix(lit, GuidedKind::sharp).by_material(), 1.0f) << "of that kind nothing was met";
}

/// A closed room, lit through a slit: by bounces alone.
struct Room {
  Scene scene;
  Environment light = mapped_environment(16, 8, [](vec3 d) { return d.x > 0.0f ? vec3(6, 5, 4) : vec3(0.0f); });
  View view = look_at({0.0f, 1.0f, 1.9f}, {0.0f, 0.9f, -1.0f}, 1.1f);

  Room() {
    SceneBuilder b;
    const Material wall = matte({0.7f, 0.7f, 0.65f});
    const auto slab = [&](vec3 lower, vec3 upper) { b.add(box(lower, upper), wall); };
    slab({-2.2f, -0.2f, -2.2f}, {2.2f, 0.0f, 2.2f});
    slab({-2.2f, 2.0f, -2.2f}, {2.2f, 2.2f, 2.2f});
    slab({-2.2f, 0.0f, -2.2f}, {2.2f, 2.0f, -2.0f});
    slab({-2.2f, 0.0f, 2.0f}, {2.2f, 2.0f, 2.2f});
    slab({-2.2f, 0.0f, -2.0f}, {-2.0f, 2.0f, 2.0f});
    slab({2.0f, 0.0f, -2.0f}, {2.2f, 0.9f, 2.0f});
    slab({2.0f, 1.2f, -2.0f}, {2.2f, 2.0f, 2.0f});
    // A screen before the slit: no place that is seen sees the sky.
    slab({1.2f, 0.5f, -2.0f}, {1.3f, 2.0f, 2.0f});
    scene = b.build();
  }
};

path::Settings led(Guiding guiding, int size, int samples) {
  path::Settings s = settings(size, samples, 8);
  s.guiding = guiding;
  return s;
}

TEST(unit_path_guide, threads_do_not_change_a_guided_picture) {
  const Room room;
  const auto with = [&](int threads, Guiding guiding) {
    const ThreadLimit limit(threads);
    return shoot(room.scene, room.light, room.view, led(guiding, 64, 6));
  };
  for (const Guiding guiding : {Guiding::on, Guiding::automatic}) {
    EXPECT_TRUE(films_are_identical(with(1, guiding), with(2, guiding)));
  }
  EXPECT_FALSE(films_are_identical(with(1, Guiding::on), with(1, Guiding::off))) << "the twin";
}

TEST(unit_path_guide, a_guided_picture_that_goes_on_is_that_of_one_run) {
  const Room room;
  const path::Tracer tracer(room.scene, room.light);
  for (const Guiding guiding : {Guiding::on, Guiding::automatic}) {
    const path::Settings s = led(guiding, 64, 9);
    path::Statistics statistics;
    const Film whole = tracer.render(room.view, s, {}, &statistics);
    EXPECT_TRUE(statistics.guided);
    // Of another view before, and in pieces.
    tracer.render(look_at({0, 1, 0}, {0, 0, -1}, 1.0f), s);
    path::Picture picture(tracer, room.view, s);
    for (const int samples : {2, 3, 7, 9}) picture.trace(samples);
    EXPECT_TRUE(films_are_identical(picture.film(), whole));
    EXPECT_EQ(picture.statistics().learning_paths, statistics.learning_paths);
  }
}

TEST(unit_path_guide, it_is_chosen_where_it_pays) {
  const Room room;
  path::Statistics statistics;
  const auto error = [&](Guiding guiding) {
    const path::Tracer tracer(room.scene, room.light);
    path::Settings s = led(guiding, 64, 32);
    const Image a = tracer.render(room.view, s, {}, &statistics).beauty;
    s.seed = 1;
    const Image b = tracer.render(room.view, s).beauty;
    double sum = 0.0;
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) sum += static_cast<double>(glm::length(a.rgb(x, y) - b.rgb(x, y)));
    }
    return sum;
  };
  const double led_by_choice = error(Guiding::automatic);
  EXPECT_TRUE(statistics.guided);
  EXPECT_GT(statistics.learning_paths, 0u);
  const double alone = error(Guiding::off);
  EXPECT_FALSE(statistics.guided);
  EXPECT_LT(led_by_choice, 0.8 * alone);

  // A ball under an open sky has no use for it.
  SceneBuilder b;
  b.add(sphere(vec3(0.0f), 1.0f, 4, true), matte(vec3(0.6f)));
  const path::Tracer ball(b.build(), room.light);
  ball.render(look_at({0, 0, 3}, vec3(0.0f), 0.8f), led(Guiding::automatic, 64, 8), {}, &statistics);
  EXPECT_FALSE(statistics.guided);
}

TEST(unit_path_guide, clamping_takes_indirect_light_alone) {
  const Room room;
  path::Settings s = led(Guiding::off, 24, 16);
  const double whole = mean_luminance(shoot(room.scene, room.light, room.view, s).beauty);
  s.clamp = 0.5f;
  const Image clamped = shoot(room.scene, room.light, room.view, s).beauty;
  EXPECT_LT(mean_luminance(clamped), 0.95 * whole);
  EXPECT_GT(mean_luminance(clamped), 0.0);
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x) EXPECT_LE(max_component(clamped.rgb(x, y)), 0.5001f) << "nothing else is seen there";
  }
  s.clamp = 1e6f;
  EXPECT_NEAR(mean_luminance(shoot(room.scene, room.light, room.view, s).beauty), whole, 1e-6);

  // What comes from the sky at the first bounce is not touched, nor is what mirrors show of it.
  SceneBuilder b;
  b.add(plane({0, -1, 0}, 4.0f), matte(vec3(0.5f)));
  b.add(plane({0, -1, -6}, 2.0f), metal(vec3(1.0f), 0.0f));
  const Scene open = b.build();
  path::Settings t = led(Guiding::off, 24, 4);
  const View view = look_at({0, 1, 3}, {0, -1, -2}, 0.8f);
  const Environment bright = constant_environment(vec3(50.0f));
  const Film free = shoot(open, bright, view, t);
  t.clamp = 0.01f;
  EXPECT_LT(largest_difference(free.beauty, shoot(open, bright, view, t).beauty), 0.02);
}

TEST(unit_path_guide, what_only_the_full_integrator_can_is_refused_by_the_others) {
  const Room room;
  path::Settings s = led(Guiding::on, 4, 1);
  s.integrator = path::Integrator::minimal;
  EXPECT_THROW(path::render(room.scene, room.light, room.view, s), Error);
  s.guiding = Guiding::automatic;
  EXPECT_NO_THROW(path::render(room.scene, room.light, room.view, s));
  s.clamp = 1.0f;
  EXPECT_THROW(path::render(room.scene, room.light, room.view, s), Error);
  s.integrator = path::Integrator::full;
  for (const float bad : {0.0f, -1.0f, std::nanf("")}) {
    s.clamp = bad;
    EXPECT_THROW(path::render(room.scene, room.light, room.view, s), Error);
  }
}

}  // namespace
}  // namespace candela
