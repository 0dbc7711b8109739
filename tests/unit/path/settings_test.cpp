#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <thread>

#include "base/error.h"
#include "base/parallel.h"
#include "unit/path/scenes.h"

// What the settings promise, and that nothing but the arguments decides the picture.

namespace candela {
namespace {

using namespace test;
using path::PixelFilter;

/// A bit of everything: metal, gloss, a lamp, a map, blending.
Scene mixture() {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 3.0f), plastic({0.5f, 0.6f, 0.4f}, 0.4f));
  b.add(sphere({-0.6f, 0.5f, 0}, 0.5f, 3, false), metal({0.9f, 0.7f, 0.4f}, 0.3f));
  Material blend = matte({0.9f, 0.2f, 0.1f});
  blend.alpha_mode = AlphaMode::blend;
  blend.opacity = 0.5f;
  b.add(box({0.2f, 0, -0.4f}, {0.9f, 0.7f, 0.4f}), blend);
  b.add(quad({-0.5f, 1.8f, -0.5f}, {1, 0, 0}, {0, 0, 1}), lamp(vec3(4.0f)));
  return b.build();
}

Environment sky() {
  return mapped_environment(32, 16, [](vec3 d) { return vec3(0.2f) + (d.y > 0.9f ? vec3(8, 7, 6) : vec3(0.0f)); });
}

View mixture_view() { return look_at({1, 1.3f, 3}, {0, 0.4f, 0}, 0.7f); }

Film shoot_mixture(const path::Settings& s) { return shoot(mixture(), sky(), mixture_view(), s); }

TEST(unit_path_settings, what_is_clamped_is_light_that_was_turned_again_and_nothing_else) {
  path::Settings s = settings(37, 20, 16);
  const Film whole = shoot_mixture(s);
  s.clamp = 1e9f;
  EXPECT_TRUE(films_are_identical(shoot_mixture(s), whole));
  s.clamp = 1e-6f;
  const Film clamped = shoot_mixture(s);
  s.clamp.reset();
  s.bounces = 1;
  const Film direct = shoot_mixture(s);
  for (std::size_t i = 0; i < direct.beauty.pixels.size(); ++i) {
    ASSERT_NEAR(clamped.beauty.pixels[i], direct.beauty.pixels[i], 1e-4f) << i;
  }
  EXPECT_GT(mean_of(whole.beauty).y, 1.05f * mean_of(direct.beauty).y) << "there is something to clamp";
  s.integrator = path::Integrator::minimal;
  s.clamp = 1.0f;
  EXPECT_THROW(shoot_mixture(s), Error);
}

// ----- threads

Film with_threads(int threads, const path::Settings& s) {
  const ThreadLimit limit(threads);
  return shoot_mixture(s);
}

TEST(unit_path_settings, threads_do_not_change_the_film) {
  path::Settings s = settings(37, 20, 5);
  s.layers = {Layer::albedo, Layer::normal, Layer::depth, Layer::position, Layer::object_id};
  for (const auto filter : {PixelFilter::box, PixelFilter::gaussian, PixelFilter::blackman_harris}) {
    s.filter = filter;
    EXPECT_TRUE(films_are_identical(with_threads(1, s), with_threads(2, s)));
  }
  s.noise = 0.1f;
  s.samples = 96;
  const Film one = with_threads(1, s);
  EXPECT_TRUE(films_are_identical(one, with_threads(2, s)));
  EXPECT_TRUE(films_are_identical(one, with_threads(4, s)));
  s.integrator = path::Integrator::minimal;
  EXPECT_TRUE(films_are_identical(with_threads(1, s), with_threads(3, s)));
  // The twin: another seed is another film.
  path::Settings other = s;
  other.seed = 1;
  EXPECT_FALSE(films_are_identical(with_threads(1, s), with_threads(1, other)));
}

// ----- bounces

TEST(unit_path_settings, one_bounce_is_direct_light_and_none_is_emission_alone) {
  // A white corner: the wall is lit, the floor sees only the wall.
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 2.0f), matte(vec3(0.8f)));
  b.add(quad({-1, 0, 2}, {0, 0, -4}, {0, 2, 0}), matte(vec3(0.8f)));  // faces +x
  b.add(quad({-0.2f, 1.9f, -0.5f}, {1, 0, 0}, {0, 0, 1}), lamp(vec3(0.0f)));
  b.add_light(sunlight(vec3(1.0f), 3.0f), aimed({1, 0, 0}, vec3(0.0f)));  // along the floor
  const auto floor = [&](int bounces) {
    return mean_luminance(
        shoot(b.build(), dark_environment(), from_above(1.0f, 0.5f), settings(8, 64, bounces)).beauty);
  };
  EXPECT_EQ(floor(0), 0.0);
  EXPECT_LT(floor(1), 1e-5);
  EXPECT_GT(floor(2), 0.01);
  SceneBuilder c;
  c.add(quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), lamp({0.5f, 0.25f, 0.125f}));
  const View view = look_at({0, 0, 3}, vec3(0.0f), 0.2f);
  EXPECT_EQ(shoot(c.build(), dark_environment(), view, settings(4, 1, 0)).beauty.rgb(1, 1), vec3(0.5f, 0.25f, 0.125f));
}

// ----- samples

TEST(unit_path_settings, samples_are_counted) {
  for (const int samples : {1, 3, 16, 33}) {
    path::Statistics statistics;
    path::Settings s = settings(21, samples, 2);
    s.height = 10;
    path::render(mixture(), sky(), mixture_view(), s, {}, &statistics);
    EXPECT_EQ(statistics.samples + statistics.spared_samples, static_cast<std::uint64_t>(210 * samples));
    EXPECT_DOUBLE_EQ(statistics.mean_samples_per_pixel, samples);
    EXPECT_GE(statistics.camera_rays, statistics.samples);
    EXPECT_GT(statistics.shadow_rays, 0U);
    EXPECT_GT(statistics.render_s, 0.0);
    EXPECT_FALSE(statistics.interrupted);
  }
}

TEST(unit_path_settings, passes_do_not_change_the_samples) {
  // With a target that is never reached every pixel takes all its samples, after looks at the error in between.
  path::Settings s = settings(24, 52, 3);
  const Film plain = shoot_mixture(s);
  s.noise = 1e-9f;
  EXPECT_TRUE(films_are_identical(plain, shoot_mixture(s)));
  s.noise.reset();
  s.time_limit_s = 1e6;
  EXPECT_TRUE(films_are_identical(plain, shoot_mixture(s)));
  s.samples = 53;
  EXPECT_FALSE(films_are_identical(plain, shoot_mixture(s)));
}

TEST(unit_path_settings, seeds_give_independent_pictures_of_one_mean) {
  const Scene scene = mixture();
  path::Settings s = settings(24, 16, 3);
  const Film a = shoot(scene, sky(), mixture_view(), s);
  s.seed = 1;
  const Film b = shoot(scene, sky(), mixture_view(), s);
  s.samples = 1024;
  const Film truth = shoot(scene, sky(), mixture_view(), s);
  // Errors of neighbouring seeds do not go together.
  double ab = 0.0, aa = 0.0, bb = 0.0;
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x) {
      const dvec3 t(truth.beauty.rgb(x, y)), da = dvec3(a.beauty.rgb(x, y)) - t, db = dvec3(b.beauty.rgb(x, y)) - t;
      ab += glm::dot(da, db), aa += glm::dot(da, da), bb += glm::dot(db, db);
    }
  }
  EXPECT_LT(std::abs(ab) / std::sqrt(aa * bb), 0.2);
  EXPECT_NEAR(aa / bb, 1.0, 0.5);
}

TEST(unit_path_settings, wrong_settings_are_refused) {
  const auto refuses = [](const std::function<void(path::Settings&)>& change) {
    path::Settings s = settings(4, 1, 1);
    change(s);
    try {
      path::render(mixture(), sky(), mixture_view(), s);
    } catch (const Error&) {
      return true;
    }
    return false;
  };
  EXPECT_TRUE(refuses([](path::Settings& s) { s.width = 0; }));
  EXPECT_TRUE(refuses([](path::Settings& s) { s.height = 65537; }));
  EXPECT_TRUE(refuses([](path::Settings& s) { s.samples = 0; }));
  EXPECT_TRUE(refuses([](path::Settings& s) { s.bounces = -1; }));
  EXPECT_TRUE(refuses([](path::Settings& s) { s.noise = 0.0f; }));
  EXPECT_TRUE(refuses([](path::Settings& s) { s.noise = std::nanf(""); }));
  EXPECT_TRUE(refuses([](path::Settings& s) { s.time_limit_s = 0.0; }));
  EXPECT_FALSE(refuses([](path::Settings&) {}));
  for (const float x : {1e30f, kInfinity, std::nanf("")}) {
    View view = mixture_view();
    view.world_from_camera[3][0] = x;
    EXPECT_THROW(path::render(mixture(), sky(), view, settings(4, 1, 1)), Error);
  }
}

// ----- stopping

/// Root mean square difference of what is shown, of all channels.
double shown_error(const Film& film, const Film& truth, const DevelopSettings& develop) {
  const Shown shown(develop.tone_curve, develop.exposure.value_or(metered_exposure(truth)));
  double squares = 0.0;
  for (int y = 0; y < film.height(); ++y) {
    for (int x = 0; x < film.width(); ++x) {
      const vec3 apart = shown(film.beauty.rgb(x, y)) - shown(truth.beauty.rgb(x, y));
      squares += static_cast<double>(glm::dot(apart, apart)) / (3.0 * film.width() * film.height());
    }
  }
  return std::sqrt(squares);
}

TEST(unit_path_settings, noise_target_is_reached_and_saves_samples) {
  const Scene scene = mixture();
  path::Settings s = settings(20, 6144, 4);
  const Film truth = shoot(scene, sky(), mixture_view(), s);
  s.samples = 4096;
  s.seed = 5;
  double previous = 1e9;
  for (const float target : {0.03f, 0.01f}) {
    s.noise = target;
    path::Statistics statistics;
    const Film film = path::render(scene, sky(), mixture_view(), s, {}, &statistics);
    EXPECT_LT(statistics.mean_samples_per_pixel, 2000.0);
    EXPECT_GE(statistics.mean_samples_per_pixel, 16.0);
    const double error = shown_error(film, truth, {});
    EXPECT_LT(error, 2.0 * static_cast<double>(target)) << statistics.mean_samples_per_pixel;
    EXPECT_GT(error, static_cast<double>(target) / 5.0) << "wasteful: " << statistics.mean_samples_per_pixel;
    EXPECT_LT(error, previous);
    previous = error;
  }
}

TEST(unit_path_settings, noise_is_judged_after_exposure_and_tone_curve) {
  // Soot under a small bright light: very noisy for how dark it is.
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 30.0f), matte(vec3(0.0005f)));
  b.add(box({-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}), matte(vec3(0.0005f)));
  b.add(quad({-1, 4, -1}, {2, 0, 0}, {0, 0, 2}), lamp(vec3(8.0f)));
  const path::Tracer tracer(b.build(), sky());
  path::Settings s = settings(16, 256, 3);
  s.noise = 0.02f;
  const auto samples = [&](float exposure, ToneCurve curve = ToneCurve::linear) {
    s.develop.exposure = exposure;
    s.develop.tone_curve = curve;
    path::Statistics statistics;
    tracer.render(look_at({1.5f, 3, 2}, {0, 0.4f, 0}, 0.7f), s, {}, &statistics);
    return statistics.mean_samples_per_pixel;
  };
  EXPECT_EQ(samples(1.0f), 16.0) << "black parts hold the picture up";
  const double seen = samples(500.0f);
  EXPECT_GT(seen, 24.0) << "the same light where it is seen";
  EXPECT_LT(samples(1e6f), seen) << "white parts hold the picture up";
  EXPECT_NE(samples(500.0f, ToneCurve::agx), seen) << "the tone curve has no say";
  // Metered, whatever the light's unit is.
  s.develop.exposure.reset();
  path::Statistics statistics;
  tracer.render(look_at({1.5f, 3, 2}, {0, 0.4f, 0}, 0.7f), s, {}, &statistics);
  EXPECT_GT(statistics.mean_samples_per_pixel, 24.0);
}

TEST(unit_path_settings, flat_pictures_stop_at_the_first_look) {
  path::Settings s = settings(16, 4096, 1);
  s.noise = 0.01f;
  path::Statistics statistics;
  SceneBuilder b;
  path::render(b.build(), constant_environment(vec3(0.5f)), mixture_view(), s, {}, &statistics);
  EXPECT_DOUBLE_EQ(statistics.mean_samples_per_pixel, 16.0);
}

TEST(unit_path_settings, time_limit_ends_the_work) {
  path::Settings s = settings(48, 1 << 24, 4);
  s.time_limit_s = 0.3;
  path::Statistics statistics;
  const Film film = path::render(mixture(), sky(), mixture_view(), s, {}, &statistics);
  EXPECT_GE(statistics.render_s, 0.29);
  EXPECT_LT(statistics.render_s, 3.0);  // generous: machines are busy
  EXPECT_GE(statistics.mean_samples_per_pixel, 1.0);
  EXPECT_FALSE(statistics.interrupted);
  for (int i = 0; i < 48 * 48; ++i) ASSERT_EQ(film.beauty.at(i % 48, i / 48)[3], 1.0f);
}

TEST(unit_path_settings, stop_flag_leaves_a_complete_picture) {
  // Large enough that one pass is more than one chunk of tiles; the flag is up before the work begins.
  path::Settings s = settings(320, 4096, 1);
  std::atomic<bool> stop{true};
  Job job;
  job.stop = &stop;
  path::Statistics statistics;
  const Film film = path::render(mixture(), sky(), mixture_view(), s, job, &statistics);
  EXPECT_TRUE(statistics.interrupted);
  EXPECT_LT(statistics.mean_samples_per_pixel, 64.0);
  for (int i = 0; i < 320 * 320; ++i) ASSERT_EQ(film.beauty.at(i % 320, i / 320)[3], 1.0f) << i;
}

// ----- jobs

std::vector<Progress> progress_of(const path::Settings& s) {
  std::vector<Progress> seen;
  Job job;
  const auto thread = std::this_thread::get_id();
  job.progress = [&](const Progress& p) {
    EXPECT_EQ(std::this_thread::get_id(), thread);
    seen.push_back(p);
  };
  path::render(mixture(), sky(), mixture_view(), s, job);
  return seen;
}

TEST(unit_path_settings, progress_only_grows_and_ends_at_one) {
  path::Settings plain = settings(160, 40, 3);
  path::Settings noisy = settings(64, 4096, 3);
  noisy.noise = 0.1f;
  path::Settings timed = settings(64, 1 << 24, 3);
  timed.time_limit_s = 0.2;
  for (const path::Settings& s : {plain, noisy, timed}) {
    const auto seen = progress_of(s);
    ASSERT_GE(seen.size(), 3U);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      EXPECT_GE(seen[i].fraction, i == 0 ? 0.0 : seen[i - 1].fraction);
      EXPECT_GE(seen[i].samples_per_pixel, i == 0 ? 0.0 : seen[i - 1].samples_per_pixel);
      EXPECT_GE(seen[i].seconds, i == 0 ? 0.0 : seen[i - 1].seconds);
      EXPECT_LE(seen[i].fraction, 1.0);
      EXPECT_GE(seen[i].remaining_s.value_or(0.0), 0.0);
    }
    EXPECT_LT(seen.front().fraction, 0.9);
    EXPECT_EQ(seen.back().fraction, 1.0);
    ASSERT_TRUE(seen.back().remaining_s);
    EXPECT_EQ(*seen.back().remaining_s, 0.0);
  }
}

TEST(unit_path_settings, partial_pictures_grow_into_the_final_one) {
  path::Settings s = settings(64, 64, 2);
  s.layers = {Layer::albedo, Layer::depth};
  std::vector<Film> films;
  Job job;
  job.partial = [&](const Film& film) { films.push_back(film); };
  job.partial_interval_s = 1e-9;
  const Film final = path::render(mixture(), sky(), mixture_view(), s, job);
  ASSERT_GE(films.size(), 3U);
  for (const Film& film : films) {
    ASSERT_EQ(film.width(), 64);
    EXPECT_EQ(film.layers.size(), 2U);
  }
  EXPECT_LT(largest_difference(films.back().beauty, final.beauty), 1e-6);
  EXPECT_GT(largest_difference(films.front().beauty, final.beauty), 1e-2);

  job.partial_interval_s = 1e9;
  films.clear();
  path::render(mixture(), sky(), mixture_view(), s, job);
  EXPECT_TRUE(films.empty());
}

TEST(unit_path_settings, a_noise_target_that_is_not_reached_is_counted) {
  const Scene scene = mixture();
  path::Settings s;
  s.width = 24, s.height = 16, s.samples = 8;
  path::Statistics statistics;
  render(scene, {}, look_at({1, 2, 3}, vec3(0.0f), 0.8f), s, {}, &statistics);
  EXPECT_FALSE(statistics.noise.has_value());

  s.noise = 1e-6f;
  render(scene, {}, look_at({1, 2, 3}, vec3(0.0f), 0.8f), s, {}, &statistics);
  ASSERT_TRUE(statistics.noise.has_value());
  EXPECT_GT(statistics.noise->share_above, 0.1);
  EXPECT_GT(statistics.noise->worst, 1e-6f);
  EXPECT_FALSE(statistics.timed_out);

  s.samples = 1 << 20;
  s.time_limit_s = 0.05;
  render(scene, {}, look_at({1, 2, 3}, vec3(0.0f), 0.8f), s, {}, &statistics);
  EXPECT_TRUE(statistics.timed_out);
  EXPECT_GT(statistics.noise->share_above, 0.0);

  s.noise = 0.9f;
  s.time_limit_s.reset();
  render(scene, {}, look_at({1, 2, 3}, vec3(0.0f), 0.8f), s, {}, &statistics);
  EXPECT_FALSE(statistics.timed_out);
  EXPECT_EQ(statistics.noise->share_above, 0.0);
  EXPECT_LT(statistics.noise->worst, 0.9f);
}

}  // namespace
}  // namespace candela
