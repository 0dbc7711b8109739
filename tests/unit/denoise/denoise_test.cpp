#include "denoise/denoise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "denoise/regression.h"
#include "image/metrics.h"
#include "support/random.h"
#include "unit/path/scenes.h"

namespace candela {
namespace {

using namespace test;
using denoise::Method;

/// A film whose light is `truth(x, y)` times an albedo, with noise of a standard deviation that its features know.
struct Synthetic {
  Film film;
  Image truth;
};

Synthetic synthetic(ivec2 size, float deviation, const std::function<vec3(int, int)>& light,
                    const std::function<vec3(int, int)>& albedo, std::uint64_t seed = 1) {
  Synthetic s;
  Pcg32 random(seed);
  s.truth = Image(size.x, size.y, 3);
  s.film.beauty = Image(size.x, size.y, 4);
  DenoisingFeatures& f = s.film.features.emplace();
  f.albedo = f.normal = f.variance = Image(size.x, size.y, 3);
  f.seen = Image(size.x, size.y, 4);
  f.albedo_variance = f.normal_variance = Image(size.x, size.y, 1);
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const vec3 a = albedo(x, y), truth = light(x, y) * a;
      s.truth.set_rgb(x, y, truth);
      vec3 noise(0.0f);  // of variance 1: the sum of three uniform numbers, twice
      for (int i = 0; i < 3; ++i) noise += 2.0f * (random.next_vec3() - 0.5f);
      s.film.beauty.set_rgb(x, y, truth + deviation * truth * noise);
      s.film.beauty.at(x, y)[3] = 1.0f;
      f.albedo.set_rgb(x, y, a);
      f.normal.set_rgb(x, y, {0, 0, 1});
      f.variance.set_rgb(x, y, deviation * deviation * truth * truth);
    }
  }
  return s;
}

vec3 even(int, int) { return vec3(0.5f); }
vec3 slope(int x, int y) { return {0.2f + 0.01f * static_cast<float>(x), 0.5f, 0.9f - 0.008f * static_cast<float>(y)}; }
vec3 checkers(int x, int y) { return (x / 2 + y / 2) % 2 == 0 ? vec3(0.8f, 0.7f, 0.2f) : vec3(0.1f, 0.3f, 0.5f); }

double error_of(const Film& film, const Image& truth) { return mse(film.beauty, truth); }

TEST(unit_denoise, noise_goes_and_slopes_of_light_and_texture_stay) {
  for (const auto& albedo : {even, checkers}) {
    Synthetic s = synthetic({48, 40}, 0.3f, slope, albedo);
    const double before = error_of(s.film, s.truth);
    denoise::denoise(s.film, Method::regression);
    EXPECT_LT(error_of(s.film, s.truth), before / 15.0);
    EXPECT_NEAR(image_mean(s.film.beauty).y / image_mean(s.truth).y, 1.0, 0.02);
  }
}

TEST(unit_denoise, a_shadow_keeps_its_edge) {
  const auto shadow = [](int x, int) { return vec3(x < 20 ? 1.0f : 0.1f); };
  Synthetic s = synthetic({48, 40}, 0.2f, shadow, even);
  denoise::denoise(s.film, Method::regression);
  for (int y = 4; y < 36; ++y) {
    EXPECT_NEAR(s.film.beauty.rgb(18, y).y, 0.5f, 0.12f) << y;
    EXPECT_NEAR(s.film.beauty.rgb(21, y).y, 0.05f, 0.02f) << y;
  }
}

TEST(unit_denoise, what_is_certain_stays_as_it_was) {
  // Light that no linear function of the features is, without noise: nothing may change it.
  const auto detail = [](int x, int y) { return vec3((x * 7 + y * 13) % 5 == 0 ? 2.0f : 0.3f); };
  Synthetic s = synthetic({40, 40}, 0.001f, detail, even);
  denoise::denoise(s.film, Method::regression);
  EXPECT_LT(rel_mse(s.film.beauty, s.truth), 1e-4);
}

TEST(unit_denoise, the_error_vanishes_with_the_noise) {
  double last = std::numeric_limits<double>::infinity();
  const auto waves = [](int x, int y) {
    return vec3(1.0f + 0.8f * std::sin(0.9f * static_cast<float>(x)) * std::cos(0.7f * static_cast<float>(y)));
  };
  for (const float deviation : {0.4f, 0.1f, 0.025f, 0.006f}) {
    Synthetic s = synthetic({40, 40}, deviation, waves, even);
    denoise::denoise(s.film, Method::regression);
    const double error = error_of(s.film, s.truth);
    EXPECT_LT(error, 0.5 * last) << deviation;
    last = error;
  }
}

TEST(unit_denoise, a_lone_bright_pixel_goes) {
  Synthetic s = synthetic({32, 32}, 0.05f, even, even);
  s.film.beauty.set_rgb(15, 16, vec3(40.0f));
  s.film.features->variance.set_rgb(15, 16, vec3(1600.0f));  // one sample of sixteen
  denoise::denoise(s.film, Method::regression);
  for (int y = 13; y < 20; ++y) {
    for (int x = 12; x < 19; ++x) EXPECT_NEAR(s.film.beauty.rgb(x, y).x, 0.25f, 0.05f) << x << " " << y;
  }
}

TEST(unit_denoise, light_that_is_seen_directly_is_not_touched) {
  Synthetic s = synthetic(
      {32, 32}, 0.0f, [](int, int) { return vec3(0.0f); }, even);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      const vec3 seen((x * 5 + y * 3) % 7 == 0 ? 9.0f : 0.1f);
      s.film.features->seen.set_rgb(x, y, seen);
      s.film.beauty.set_rgb(x, y, seen);
      s.truth.set_rgb(x, y, seen);
    }
  }
  denoise::denoise(s.film, Method::regression);
  EXPECT_LT(max_abs_difference(s.film.beauty, s.truth), 1e-5);
}

TEST(unit_denoise, the_plain_picture_and_alpha_are_kept) {
  Synthetic s = synthetic({9, 7}, 0.3f, slope, even);
  s.film.beauty.at(3, 3)[3] = 0.25f;
  const Image before = s.film.beauty;
  denoise::denoise(s.film, Method::regression);
  EXPECT_EQ(s.film.noisy.pixels, before.pixels);
  EXPECT_NE(s.film.beauty.pixels, before.pixels);
  EXPECT_EQ(s.film.beauty.at(3, 3)[3], 0.25f);
}

TEST(unit_denoise, pictures_of_any_size_and_odd_numbers_stay_finite) {
  for (const ivec2 size : {ivec2(1, 1), ivec2(2, 1), ivec2(1, 30), ivec2(17, 3)}) {
    Synthetic s = synthetic(size, 1.0f, slope, checkers);
    denoise::denoise(s.film, Method::regression);
    EXPECT_TRUE(is_finite_and_not_negative(s.film.beauty)) << size.x << "x" << size.y;
  }
  Synthetic dark = synthetic(
      {12, 12}, 0.0f, [](int, int) { return vec3(0.0f); }, [](int, int) { return vec3(0.0f); });
  dark.film.features->variance.set_rgb(4, 4, vec3(1e30f));
  dark.film.beauty.set_rgb(5, 5, vec3(1e30f));
  denoise::denoise(dark.film, Method::regression);
  EXPECT_TRUE(is_finite_and_not_negative(dark.film.beauty));
}

TEST(unit_denoise, a_stop_while_it_works_leaves_the_film_as_it_was) {
  const Synthetic before = synthetic({40, 40}, 0.3f, slope, even);
  for (const Method method : {Method::regression, Method::oidn}) {
    if (!denoise::why_not(method).empty()) continue;
    Synthetic s = before;
    std::atomic<bool> stop{false};
    std::vector<double> fractions;
    Job job{.stop = &stop};
    job.progress = [&](const Progress& p) {
      fractions.push_back(p.fraction);
      stop = true;
    };
    EXPECT_FALSE(denoise::denoise(s.film, method, job));
    EXPECT_EQ(s.film.beauty.pixels, before.film.beauty.pixels);
    EXPECT_TRUE(s.film.noisy.empty());
    EXPECT_EQ(fractions.size(), 1U) << "it went on";
    // A stop that came before is that of the samples: they are what is denoised.
    EXPECT_TRUE(denoise::denoise(s.film, method, job));
    EXPECT_NE(s.film.beauty.pixels, before.film.beauty.pixels);
    EXPECT_EQ(s.film.noisy.pixels, before.film.beauty.pixels);
    EXPECT_TRUE(std::is_sorted(fractions.begin() + 1, fractions.end()));
    if (method == Method::regression) {
      EXPECT_EQ(fractions.back(), 1.0);
    }
  }
}

TEST(unit_denoise, threads_do_not_change_a_bit) {
  Synthetic one = synthetic({70, 50}, 0.4f, slope, checkers), two = one;
  {
    const ThreadLimit limit(1);
    denoise::denoise(one.film, Method::regression);
  }
  const ThreadLimit limit(2);
  denoise::denoise(two.film, Method::regression);
  EXPECT_EQ(one.film.beauty.pixels, two.film.beauty.pixels);
}

TEST(unit_denoise, ways_have_names) {
  EXPECT_EQ(denoise::parse_method("oidn"), Method::oidn);
  EXPECT_EQ(denoise::parse_method(denoise::method_name(Method::regression)), Method::regression);
  EXPECT_THROW(denoise::parse_method("median"), Error);
  EXPECT_EQ(denoise::why_not(Method::regression), "");
}

TEST(unit_denoise, open_image_denoise_does_it_where_it_is_installed) {
  const std::string why = denoise::why_not(Method::oidn);
  Synthetic s = synthetic({64, 48}, 0.3f, slope, even);
  if (!why.empty()) {
    EXPECT_THROW(denoise::denoise(s.film, Method::oidn), Error);
    GTEST_SKIP() << why;
  }
  const double before = error_of(s.film, s.truth);
  denoise::denoise(s.film, Method::oidn);
  EXPECT_LT(error_of(s.film, s.truth), before / 5.0);
}

// ----- what the path tracer tells it

Scene shelf() {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 3.0f), matte({0.5f, 0.4f, 0.3f}));
  b.add(quad({-2, 0, -1}, {4, 0, 0}, {0, 2, 0}), metal(vec3(0.9f), 0.0f));
  b.add(sphere({0.6f, 0.5f, 0.3f}, 0.5f, 2, false), plastic({0.1f, 0.3f, 0.7f}, 0.3f));
  b.add(quad({-0.5f, 2.2f, -0.5f}, {1, 0, 0}, {0, 0, 1}), lamp(vec3(8.0f)));
  return b.build();
}

path::Settings with_features(int size, int samples) {
  path::Settings s = settings(size, samples, 4);
  s.has_features = true;
  return s;
}

TEST(unit_denoise, a_mirror_has_the_features_of_what_it_shows) {
  SceneBuilder b;
  b.add(quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), metal(vec3(0.8f), 0.0f));
  b.add(quad({2, -2, 4}, {-4, 0, 0}, {0, 4, 0}), matte({0.5f, 0.25f, 0.1f}));
  const Film film =
      shoot(b.build(), constant_environment(vec3(1.0f)), look_at({0, 0, 2}, vec3(0.0f), 0.4f), with_features(8, 16));
  const vec3 albedo = film.features->albedo.rgb(4, 4), normal = film.features->normal.rgb(4, 4);
  EXPECT_LT(glm::length(albedo - 0.8f * vec3(0.5f, 0.25f, 0.1f)), 0.02f)
      << albedo.x << " " << albedo.y << " " << albedo.z;
  EXPECT_LT(glm::length(normal - vec3(0, 0, -1)), 1e-3f);
}

TEST(unit_denoise, light_and_background_are_seen_directly_and_the_rest_is_not) {
  SceneBuilder b;
  b.add(quad({-0.5f, -0.5f, 0}, {1, 0, 0}, {0, 1, 0}), lamp(vec3(3.0f)));
  const Film film =
      shoot(b.build(), constant_environment(vec3(0.4f)), look_at({0, 0, 3}, vec3(0.0f), 0.8f), with_features(16, 16));
  EXPECT_NEAR(film.features->seen.rgb(8, 8).x, 3.0f, 1e-4f);
  EXPECT_NEAR(film.features->seen.rgb(0, 0).x, 0.4f, 1e-4f);
  for (const float v : film.features->variance.pixels) EXPECT_LT(v, 1e-8f);
}

TEST(unit_denoise, blurred_edges_before_the_background_lose_their_noise_and_sharp_ones_stay) {
  SceneBuilder b;
  b.add(quad({-0.5f, -0.5f, 0}, {1, 0, 0}, {0, 1, 0}), matte(vec3(0.05f)));
  const path::Tracer tracer(b.build(), mapped_environment(64, 32, [](vec3 d) { return vec3(1.0f + 0.5f * d.x); }));
  View view = look_at({0.1f, 0.2f, 3}, vec3(0.0f), 0.5f);
  const auto gain = [&](float radius) {
    view.lens.radius = radius;
    view.lens.focus_distance = 30.0f;
    const Film truth = tracer.render(view, settings(48, 1024, 2));
    Film film = tracer.render(view, with_features(48, 16));
    const double before = mse(film.beauty, truth.beauty);
    denoise::denoise(film, Method::regression);
    return mse(film.beauty, truth.beauty) / before;
  };
  EXPECT_LT(gain(0.25f), 0.5);
  EXPECT_LT(gain(0.0f), 1.05);
}

TEST(unit_denoise, glass_that_now_reflects_and_now_shows_the_sky_loses_its_noise) {
  Material glass = plastic({0.5f, 0.8f, 0.9f}, 0.0f);
  glass.transmission = 1.0f;
  glass.double_sided = true;
  SceneBuilder b;
  b.add(quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), glass);
  const path::Tracer tracer(b.build(), constant_environment(vec3(0.5f)));
  const View view = look_at({0.5f, 0.4f, 3}, vec3(0.0f), 0.5f);
  const Film truth = tracer.render(view, settings(32, 2048, 4));
  Film film = tracer.render(view, with_features(32, 16));
  const double before = mse(film.beauty, truth.beauty);
  denoise::denoise(film, Method::regression);
  EXPECT_LT(mse(film.beauty, truth.beauty), 0.6 * before);
}

TEST(unit_denoise, the_variance_is_that_of_pictures_with_other_seeds) {
  // Open sky on a plane and a ball: what Sobol' points are best at.
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 30.0f), matte(vec3(0.5f)));
  b.add(sphere({0, 0.5f, 0}, 0.5f, 3, false), matte({0.2f, 0.5f, 0.8f}));
  const path::Tracer tracer(b.build(), mapped_environment(64, 32, [](vec3 d) { return vec3(1.0f + 0.9f * d.x); }));
  const View view = look_at({0.5f, 1.4f, 4}, {0, 0.3f, 0}, 0.4f);
  path::Settings s = with_features(24, 16);
  double stated = 0.0;
  std::vector<Film> films;
  constexpr int kSeeds = 24;
  for (int seed = 0; seed < kSeeds; ++seed) {
    s.seed = static_cast<std::uint32_t>(seed);
    films.push_back(tracer.render(view, s));
    const DenoisingFeatures& f = *films.back().features;
    for (const float v : f.variance.pixels) stated += static_cast<double>(v) / kSeeds;
  }
  double found = 0.0;
  for (std::size_t i = 0; i < films[0].features->variance.pixels.size(); ++i) {
    Moments moments;
    for (const Film& film : films)
      moments.add(
          static_cast<double>(film.beauty.pixels[i / 3 * 4 + i % 3] - film.features->seen.pixels[i / 3 * 4 + i % 3]));
    found += moments.variance();
  }
  // Independent samples would make it six times as much. The whole does better than its halves say, if anything.
  EXPECT_GT(stated / found, 0.8);
  EXPECT_LT(stated / found, 2.2);
}

TEST(unit_denoise, few_samples_denoised_are_nearer_to_the_truth_than_they_were) {
  const path::Tracer tracer(shelf(), constant_environment(vec3(0.3f)));
  const View view = look_at({0.5f, 1.4f, 4}, {0, 0.6f, 0}, 0.7f);
  const Film truth = tracer.render(view, settings(48, 2048, 4));
  for (const int samples : {1, 4, 16}) {
    Film film = tracer.render(view, with_features(48, samples));
    const double before = rel_mse_trimmed(film.beauty, truth.beauty, 0.01);
    denoise::denoise(film, Method::regression);
    const double wanted = samples == 1 ? 0.75 : 0.5;  // of one sample nobody knows the variance
    EXPECT_LT(rel_mse_trimmed(film.beauty, truth.beauty, 0.01), wanted * before) << samples;
  }
}

TEST(unit_denoise, of_one_sample_a_dark_pixel_is_as_uncertain_as_those_around) {
  const path::Tracer tracer(shelf(), constant_environment(vec3(0.0f)));
  const View view = look_at({0.5f, 1.4f, 4}, {0, 0.6f, 0}, 0.4f);
  const auto certain = [&](int samples) {
    const Film film = tracer.render(view, with_features(48, samples));
    int count = 0;
    for (int y = 1; y < 47; ++y) {
      for (int x = 1; x < 47; ++x) {
        vec3 beside(0.0f);
        for (const ivec2 d : {ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1)})
          beside += film.beauty.rgb(x + d.x, y + d.y) - film.features->seen.rgb(x + d.x, y + d.y);
        const bool is_dark = max_component(film.beauty.rgb(x, y)) <= 0.0f && max_component(beside) > 0.0f;
        count += is_dark && max_component(film.features->variance.rgb(x, y)) <= 0.0f ? 1 : 0;
      }
    }
    return count;
  };
  EXPECT_EQ(certain(1), 0);
  EXPECT_EQ(certain(3), 0);
}

TEST(unit_denoise, features_change_no_picture) {
  const path::Tracer tracer(shelf(), constant_environment(vec3(0.3f)));
  const View view = look_at({0.5f, 1.4f, 4}, {0, 0.6f, 0}, 0.7f);
  path::Settings s = with_features(24, 20);
  const Film with = tracer.render(view, s);
  s.has_features = false;
  const Film without = tracer.render(view, s);
  EXPECT_EQ(with.beauty.pixels, without.beauty.pixels);
  EXPECT_FALSE(without.features);
  s.has_features = true;
  s.integrator = path::Integrator::minimal;
  EXPECT_THROW(tracer.render(view, s), Error);
}

}  // namespace
}  // namespace candela
