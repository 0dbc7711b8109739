#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "path/medium.h"
#include "support/random.h"
#include "unit/path/scenes.h"

// Materials that light goes through, and all of them at once, in pictures whose answer is known.

namespace candela {
namespace {

using namespace test;

Material glass(float ior, float roughness) {
  Material m;
  m.metallic = 0.0f;
  m.roughness = roughness;
  m.ior = ior;
  m.transmission = 1.0f;
  m.thickness = 1.0f;
  return m;
}

Material sheet(vec3 color, float roughness) {
  Material m = glass(1.5f, roughness);
  m.base_color = color;
  m.thickness = 0.0f;
  m.double_sided = true;
  return m;
}

double mean_in_furnace(const Primitive& shape, const Material& material, int samples, int bounces) {
  SceneBuilder b;
  b.add(shape, material);
  const Film film = shoot(b.build(), constant_environment(vec3(1.0f)), look_at({0, 0, 3}, vec3(0.0f), 0.4f),
                          settings(16, samples, bounces));
  return mean_luminance(film.beauty);
}

TEST(law_path, clear_glass_is_invisible_in_the_furnace) {
  for (const float ior : {1.0f, 1.33f, 1.5f, 2.4f}) {
    EXPECT_NEAR(mean_in_furnace(sphere(vec3(0.0f), 1.0f, 4, false), glass(ior, 0.0f), 64, 256), 1.0, 2e-3) << ior;
  }
  // The twin: glass that absorbs.
  Material grey = glass(1.5f, 0.0f);
  grey.attenuation_color = vec3(0.9f);
  grey.attenuation_distance = 1.0f;
  EXPECT_LT(mean_in_furnace(sphere(vec3(0.0f), 1.0f, 4, false), grey, 64, 256), 0.95);
}

TEST(law_path, rough_glass_keeps_its_light_in_the_furnace) {
  // The tables are half a percent off at worst, and light meets the boundary several times before it leaves.
  for (const float roughness : {0.2f, 0.5f, 1.0f}) {
    EXPECT_NEAR(mean_in_furnace(box(vec3(-0.6f), vec3(0.6f)), glass(1.5f, roughness), 256, 1024), 1.0, 0.03)
        << roughness;
  }
  // The twin: half a percent of tint at every crossing is no more than that, ten percent is.
  Material tinted = glass(1.5f, 0.5f);
  tinted.base_color = vec3(0.9f);
  EXPECT_LT(mean_in_furnace(box(vec3(-0.6f), vec3(0.6f)), tinted, 256, 1024), 0.97);
}

TEST(law_path, clear_and_frosted_sheets_keep_their_light) {
  for (const float roughness : {0.0f, 0.3f, 0.8f}) {
    EXPECT_NEAR(mean_in_furnace(quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), sheet(vec3(1.0f), roughness), 64, 16), 1.0,
                5e-3)
        << roughness;
  }
}

/// Radiance along -z through a slab of thickness 1 m with index 1, which neither bends nor reflects.
vec3 through_slab(const Material& material, int samples) {
  SceneBuilder b;
  b.add(box({-50, -50, -0.5f}, {50, 50, 0.5f}), material);
  View view = look_at({0, 0, 3}, vec3(0.0f), 0.01f);
  const Film film = shoot(b.build(), constant_environment(vec3(1.0f)), view, settings(8, samples, 64));
  return vec3(mean_of(film.beauty));
}

TEST(law_path, a_slab_follows_beer_and_lambert) {
  Material m = glass(1.0f, 0.0f);
  m.attenuation_color = {0.8f, 0.4f, 0.1f};
  m.attenuation_distance = 0.5f;
  const vec3 measured = through_slab(m, 4);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(measured[c], std::pow(m.attenuation_color[c], 2.0f), 1e-3) << c;
    // The twin: colour at half the distance.
    EXPECT_GT(std::abs(measured[c] - m.attenuation_color[c]), 1e-3);
  }
}

TEST(law_path, a_body_that_only_scatters_keeps_its_light) {
  Material m = glass(1.0f, 0.0f);
  m.attenuation_color = {0.5f, 0.2f, 0.05f};
  m.attenuation_distance = 0.3f;
  m.multiscatter_color = vec3(1.0f);
  for (const float g : {-0.5f, 0.0f, 0.7f}) {
    m.scatter_anisotropy = g;
    SceneBuilder b;
    b.add(box(vec3(-0.5f), vec3(0.5f)), m);
    const auto mean = mean_over_seeds(8, b.build(), constant_environment(vec3(1.0f)),
                                      look_at({0, 0, 3}, vec3(0.0f), 0.3f), settings(8, 128, 64));
    for (const Moments& channel : mean) {
      EXPECT_NEAR(channel.mean(), 1.0, 4.0 * channel.standard_error() + 1e-3) << "g " << g;
    }
  }
  // The twin: a little absorption.
  m.multiscatter_color = vec3(0.5f);
  m.scatter_anisotropy = 0.0f;
  SceneBuilder b;
  b.add(box(vec3(-0.5f), vec3(0.5f)), m);
  const Film film =
      shoot(b.build(), constant_environment(vec3(1.0f)), look_at({0, 0, 3}, vec3(0.0f), 0.3f), settings(8, 128, 64));
  EXPECT_LT(mean_luminance(film.beauty), 0.97);
}

TEST(law_path, a_deep_scattering_body_has_its_multiscatter_colour) {
  // Index 1, a thousand mean free paths deep, seen from directions that are spread by their cosine: what it reflects of
  // diffuse light. The fit claims about 0.01.
  Material m = glass(1.0f, 0.0f);
  m.attenuation_color = vec3(0.01f);
  m.attenuation_distance = 0.002f;
  m.multiscatter_color = {0.8f, 0.5f, 0.2f};
  SceneBuilder b;
  b.add(box({-50, -1, -50}, {50, 0, 50}), m);
  const Scene scene = b.build();
  dvec3 sum(0.0);
  constexpr int kDirections = 8;
  for (int i = 0; i < kDirections; ++i) {
    const float mu = std::sqrt((static_cast<float>(i) + 0.5f) / kDirections);
    const vec3 eye(3.0f * std::sqrt(1.0f - mu * mu), 3.0f * mu, 0.0f);
    const Film film =
        shoot(scene, constant_environment(vec3(1.0f)), look_at(eye, vec3(0.0f), 0.01f), settings(8, 256, 64));
    sum += mean_of(film.beauty) / static_cast<double>(kDirections);
  }
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(sum[c], static_cast<double>(m.multiscatter_color[c]), 0.015) << c;
    // The twin: the single-scattering albedo is far from it.
    EXPECT_GT(std::abs(sum[c] - static_cast<double>(path::single_scatter_albedo(m.multiscatter_color, 0.0f)[c])), 0.05);
  }
}

TEST(law_medium, henyey_greenstein_has_its_mean_cosine) {
  for (const float g : {-0.8f, -0.2f, 0.0f, 0.3f, 0.9f}) {
    double sum = 0.0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      sum += static_cast<double>(shade::phase_cosine(g, (static_cast<float>(i) + 0.5f) / kSteps));
    }
    EXPECT_NEAR(sum / kSteps, static_cast<double>(g), 1e-3);
    if (g == 0.0f) continue;
    EXPECT_GT(std::abs(sum / kSteps + static_cast<double>(g)), 1e-3) << "forward is not backward";
  }
}

TEST(law_medium, single_scatter_albedo_ends_and_rises) {
  EXPECT_NEAR(path::single_scatter_albedo(vec3(1.0f), 0.0f).x, 1.0f, 1e-3f);
  EXPECT_NEAR(path::single_scatter_albedo(vec3(0.0f), 0.0f).x, 0.0f, 2e-2f);
  float before = -1.0f;
  for (int i = 0; i <= 20; ++i) {
    const float a = path::single_scatter_albedo(vec3(static_cast<float>(i) / 20.0f), 0.0f).x;
    EXPECT_GT(a, before);
    before = a;
    // Similarity: a forward phase function needs more scattering for the same colour.
    EXPECT_GE(path::single_scatter_albedo(vec3(static_cast<float>(i) / 20.0f), 0.5f).x, a);
  }
}

TEST(law_path, a_clear_sheet_casts_the_shadow_of_its_transmittance) {
  // A sun straight above a floor under a sheet: (1 - F0) tint of its light, no caustic noise needed.
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 5.0f), matte(vec3(1.0f)));
  b.add(quad({-2, 1, -2}, {0, 0, 4}, {4, 0, 0}), sheet({0.5f, 0.25f, 1.0f}, 0.0f));
  b.add_light(sunlight(vec3(1.0f), std::numbers::pi_v<float>), aimed({0, 3, 0}, vec3(0.0f)));
  // From below the sheet, so that only the light on the floor counts; one bounce, so that no light comes back from it.
  View view = look_at({0.3f, 0.5f, 0.3f}, {0.3f, 0, 0.29f}, 0.2f);
  const Film film = shoot(b.build(), dark_environment(), view, settings(8, 16, 1));
  const vec3 c(mean_of(film.beauty));
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(c[i], 0.96f * vec3(0.5f, 0.25f, 1.0f)[i], 5e-3f) << i;
  }
}

TEST(law_path, a_liquid_that_overlaps_its_glass_bends_light_at_the_right_indices) {
  // Slabs of glass and water that overlap by a tenth, seen at 45°: what was entered last counts, so the ray's offset is
  // that of 1.0 m of glass and 1.0 m of water, whatever the overlap. Measured by a checker of one stripe behind.
  const auto brightness = [](float overlap, float stripe) {
    SceneBuilder b;
    b.add(box({-50, -1, -50}, {50, 0, 50}), glass(1.5f, 0.0f));
    b.add(box({-50, -2, -50}, {50, -1 + overlap, 50}), glass(1.33f, 0.0f));
    b.add(quad({stripe, -2.01f, -50}, {0, 0, 100}, {100, 0, 0}), lamp(vec3(1.0f)));
    View view = look_at({-3, 3, 0}, vec3(0.0f), 0.002f);
    const Film film = shoot(b.build(), dark_environment(), view, settings(4, 64, 16));
    return mean_luminance(film.beauty);
  };
  // Snell: sin θ / n, tan over each metre.
  const double sine = std::numbers::sqrt2 / 2.0;
  const auto tangent = [&](double n) { return sine / n / std::sqrt(1.0 - sine * sine / (n * n)); };
  const double overlapped = 0.9 * tangent(1.5) + 1.1 * tangent(1.33);
  const auto edge = static_cast<float>(overlapped);
  EXPECT_GT(brightness(0.1f, edge - 0.03f), 0.5);
  EXPECT_LT(brightness(0.1f, edge + 0.03f), 0.1);
}

struct Case {
  std::string name;
  Scene scene;
  Environment environment;
  View view;
  int bounces = 12;
};

Case glass_and_lamp() {
  SceneBuilder b;
  b.add(plane({0, -1, 0}, 4.0f), matte({0.6f, 0.7f, 0.5f}));
  Material g = glass(1.5f, 0.4f);
  g.attenuation_color = {0.9f, 0.6f, 0.3f};
  g.attenuation_distance = 1.0f;
  b.add(sphere(vec3(0.0f), 1.0f, 3, false), g);
  b.add(quad({-1.5f, 2, -1.5f}, {3, 0, 0}, {0, 0, 3}), lamp({6, 5, 4}));
  return {"rough tinted glass under a lamp", b.build(), constant_environment(vec3(0.2f)),
          look_at({0, 0.5f, 3.5f}, vec3(0.0f), 0.7f)};
}

Case window() {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 4.0f), matte({0.8f, 0.7f, 0.6f}));
  b.add(quad({-1.2f, 0, 0.2f}, {2.4f, 0, 0}, {0, 1.8f, 0}), sheet({0.4f, 0.9f, 0.7f}, 0.0f));
  b.add(quad({-1.2f, 0, 0.6f}, {2.4f, 0, 0}, {0, 1.8f, 0}), sheet({0.9f, 0.9f, 0.4f}, 0.3f));
  b.add(quad({-1, 0.2f, -1.5f}, {2, 0, 0}, {0, 1.5f, 0}), lamp({5, 5, 6}));
  return {"lamp behind a clear and a frosted sheet", b.build(), constant_environment(vec3(0.1f)),
          look_at({0.5f, 1.0f, 3.0f}, {0, 0.6f, 0}, 0.9f)};
}

Case layers() {
  SceneBuilder b;
  Material coated = metal({0.9f, 0.6f, 0.3f}, 0.5f);
  coated.clearcoat = 1.0f;
  coated.clearcoat_roughness = 0.2f;
  coated.anisotropy = 0.6f;
  Material cloth = matte({0.1f, 0.2f, 0.5f});
  cloth.sheen_color = {0.9f, 0.8f, 0.7f};
  cloth.sheen_roughness = 0.5f;
  Material leaf = matte({0.2f, 0.6f, 0.1f});
  leaf.diffuse_transmission = 0.6f;
  leaf.diffuse_transmission_color = {0.7f, 0.9f, 0.2f};
  leaf.double_sided = true;
  Material bubble = plastic(vec3(0.3f), 0.3f);
  bubble.iridescence = 1.0f;
  b.add(sphere({-1.2f, 0, 0}, 0.7f, 3, false), coated);
  b.add(sphere({0.2f, 0, 0}, 0.7f, 3, false), cloth);
  b.add(sphere({1.5f, 0, 0}, 0.6f, 3, false), bubble);
  b.add(quad({-1.5f, -0.8f, 0.9f}, {3, 0, 0}, {0, 0.6f, 0}), leaf);
  b.add(plane({0, -0.8f, 0}, 4.0f), matte(vec3(0.5f)));
  b.add(quad({-1.5f, 2, -1.5f}, {3, 0, 0}, {0, 0, 3}), lamp({4, 5, 6}));
  return {"coat, sheen, film and leaf", b.build(), constant_environment({0.3f, 0.2f, 0.2f}),
          look_at({0, 0.8f, 4}, vec3(0.0f), 0.7f)};
}

Case wax() {
  SceneBuilder b;
  Material m = matte(vec3(0.9f));
  m.diffuse_transmission = 1.0f;
  m.thickness = 1.0f;
  m.attenuation_color = {0.6f, 0.4f, 0.2f};
  m.attenuation_distance = 0.2f;
  m.multiscatter_color = {0.9f, 0.7f, 0.5f};
  b.add(sphere(vec3(0.0f), 1.0f, 3, false), m);
  b.add(quad({-1.5f, 2, -1.5f}, {3, 0, 0}, {0, 0, 3}), lamp({6, 6, 6}));
  return {"wax", b.build(), constant_environment(vec3(0.2f)), look_at({0, 0.5f, 3.5f}, vec3(0.0f), 0.7f), 24};
}

TEST(law_path, full_and_minimal_integrator_agree_on_layers_and_bodies) {
  const Case cases[] = {glass_and_lamp(), window(), layers(), wax()};
  const double threshold = sidak_threshold(3 * std::size(cases));
  for (const Case& c : cases) {
    path::Settings s = settings(8, 64, c.bounces);
    const auto full = mean_over_seeds(16, c.scene, c.environment, c.view, s);
    s.integrator = path::Integrator::minimal;
    s.samples = 256;
    const auto minimal = mean_over_seeds(16, c.scene, c.environment, c.view, s);
    for (std::size_t i = 0; i < 3; ++i) {
      const double error = std::hypot(full[i].standard_error(), minimal[i].standard_error());
      EXPECT_GT(normal_p_value((full[i].mean() - minimal[i].mean()) / error), threshold)
          << c.name << ", channel " << i << ": full " << full[i].mean() << " minimal " << minimal[i].mean() << " ± "
          << error;
      EXPECT_LT(normal_p_value((1.1 * full[i].mean() - minimal[i].mean()) / error), threshold)
          << c.name << ", channel " << i << ": relative error " << error / minimal[i].mean();
    }
  }
}

/// Any legal material. Half of the numbers are at an end of their range.
Material random_material(Pcg32& random) {
  const auto unit = [&] {
    const float kind = random.next_float();
    return kind < 0.25f ? 0.0f : kind < 0.5f ? 1.0f : random.next_float();
  };
  const auto color = [&] { return vec3(unit(), unit(), unit()); };
  const auto sometimes = [&](float value) { return random.next_float() < 0.5f ? value : 0.0f; };
  Material m;
  m.base_color = color();
  m.metallic = unit();
  m.roughness = unit();
  m.ior = random.next_float() < 0.1f ? 0.0f : 1.0f + 3.0f * unit() * unit();
  m.specular = unit();
  m.specular_color = 2.0f * color();
  m.clearcoat = sometimes(unit());
  m.clearcoat_roughness = unit();
  m.sheen_color = random.next_float() < 0.5f ? color() : vec3(0.0f);
  m.sheen_roughness = unit();
  m.anisotropy = sometimes(unit());
  m.anisotropy_rotation = 6.0f * unit();
  m.iridescence = sometimes(unit());
  m.iridescence_ior = 1.0f + 2.0f * unit();
  m.iridescence_thickness_max_nm = 1200.0f * unit();
  m.transmission = sometimes(unit());
  m.thickness = sometimes(1.0f);
  m.attenuation_color = glm::max(color(), vec3(1e-6f));
  m.attenuation_distance = random.next_float() < 0.3f ? kInfinity : 0.01f + 2.0f * unit();
  m.dispersion = sometimes(5.0f * unit());
  m.diffuse_transmission = sometimes(unit());
  m.diffuse_transmission_color = color();
  if (random.next_float() < 0.3f) m.multiscatter_color = color();
  m.scatter_anisotropy = 0.98f * (2.0f * random.next_float() - 1.0f);
  if (random.next_float() < 0.1f) m.conductor_n = 3.0f * color() + vec3(0.1f), m.conductor_k = 5.0f * color();
  m.double_sided = random.next_float() < 0.5f;
  m.emission = random.next_float() < 0.1f ? color() : vec3(0.0f);
  return m;
}

TEST(law_path, no_legal_material_makes_a_sample_that_is_not_finite) {
  Pcg32 random(2024);
  for (int round = 0; round < 40; ++round) {
    SceneBuilder b;
    for (int i = 0; i < 25; ++i) {
      const int row = i / 5, column = i % 5;
      const vec3 center(static_cast<float>(column) - 2.0f, static_cast<float>(row) - 2.0f, 0.0f);
      b.add(sphere(center, 0.45f, 2, i % 2 == 0), random_material(random));
    }
    b.add_light(point_light(vec3(1.0f), 10.0f), translation({1, 2, 3}));
    // shoot() fails the test at a sample that is not finite.
    const Film film =
        shoot(b.build(), constant_environment(vec3(0.5f)), look_at({0, 0, 6}, vec3(0.0f), 0.8f), settings(40, 4, 12));
    EXPECT_TRUE(is_finite_and_not_negative(film.beauty)) << "round " << round;
  }
}

}  // namespace
}  // namespace candela
