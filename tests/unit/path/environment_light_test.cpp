#include "path/environment_light.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scene/environment.h"
#include "support/random.h"
#include "support/statistics.h"
#include "unit/path/scenes.h"

namespace candela {
namespace {

using namespace test;
using path::EnvironmentLight;

vec3 random_direction(Pcg32& random) {
  const vec2 u = random.next_vec2();
  const float z = 1.0f - 2.0f * u.x, r = std::sqrt(std::max(0.0f, 1.0f - z * z));
  return {r * std::cos(2.0f * kPi * u.y), z, r * std::sin(2.0f * kPi * u.y)};
}

/// A sky with a gradient, a hot patch and some noise.
Environment rough_sky(float turn) {
  Pcg32 random(9);
  Environment e = mapped_environment(64, 32, [&](vec3 d) {
    const vec3 sky = vec3(0.2f, 0.3f, 0.5f) * (1.2f + d.y) + 0.2f * random.next_vec3();
    return glm::dot(d, glm::normalize(vec3(1, 1, 0.5f))) > 0.98f ? sky + vec3(60, 50, 40) : sky;
  });
  e.rotation = turn;
  e.intensity = 1.7f;
  e.constant = vec3(0.05f, 0.04f, 0.03f);
  return e;
}

TEST(unit_path_environment, radiance_is_the_references) {
  Pcg32 random(1);
  for (const float turn : {0.0f, 0.8f, -2.5f}) {
    const Environment e = rough_sky(turn);
    const EnvironmentLight light(e);
    for (int i = 0; i < 2000; ++i) {
      const vec3 d = random_direction(random);
      const vec3 expected = environment_radiance(e, d), found = light.evaluate(d).radiance;
      // Bilinear weights move by the rounding of u and v times the width of the map, steeply beside the patch.
      ASSERT_LT(glm::length(found - expected), 2e-3f) << d.x << " " << d.y << " " << d.z;
    }
  }
  Environment turned_wrongly = rough_sky(0.8f);
  const EnvironmentLight light(rough_sky(-0.8f));
  float largest = 0.0f;
  for (int i = 0; i < 2000; ++i) {
    const vec3 d = random_direction(random);
    largest = std::max(largest, glm::length(light.evaluate(d).radiance - environment_radiance(turned_wrongly, d)));
  }
  EXPECT_GT(largest, 1.0f);
}

TEST(unit_path_environment, radiance_is_the_references_at_the_seam_and_the_poles) {
  const Environment e = rough_sky(0.0f);
  const EnvironmentLight light(e);
  for (const vec3 d : {vec3(0, 1, 0), vec3(0, -1, 0), vec3(-1, 0, 0), vec3(-1, 0, 1e-8f), vec3(-1, 0, -1e-8f),
                       glm::normalize(vec3(1e-4f, 1, 0)), glm::normalize(vec3(-1, 0.3f, -1e-5f))}) {
    EXPECT_LT(glm::length(light.evaluate(d).radiance - environment_radiance(e, d)), 2e-3f)
        << d.x << " " << d.y << " " << d.z;
  }
}

TEST(unit_path_environment, suns_are_where_the_reference_has_them) {
  Environment e;
  SunDisc sun;
  sun.direction = glm::normalize(vec3(0.3f, 0.5f, -0.9f));
  sun.angular_radius = 0.01f;
  sun.radiance = vec3(5.0f);
  e.suns.push_back(sun);
  e.rotation = 1.1f;
  e.intensity = 2.0f;
  const EnvironmentLight light(e);
  ASSERT_EQ(light.suns().size(), 1U);
  const auto& found = light.suns()[0];
  EXPECT_EQ(found.radiance, vec3(10.0f));
  EXPECT_NEAR(found.solid_angle / (kPi * 1e-4f), 1.0f, 1e-4f);
  EXPECT_EQ(environment_radiance(e, found.frame.n), vec3(10.0f));
  EXPECT_EQ(environment_radiance(e, glm::normalize(found.frame.n + 0.0099f * found.frame.t)), vec3(10.0f));
  EXPECT_EQ(environment_radiance(e, glm::normalize(found.frame.n + 0.0102f * found.frame.b)), vec3(0.0f));
}

TEST(unit_path_environment, pdf_integrates_to_one_over_the_sphere) {
  const EnvironmentLight light(rough_sky(0.6f));
  // Midpoints of a grid four times finer than the cells of the density, which is constant over each in u and v.
  constexpr int kColumns = 256, kRows = 128;
  double sum = 0.0;
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      const double theta = M_PI * (y + 0.5) / kRows, phi = 2.0 * M_PI * (x + 0.5) / kColumns - 0.6;
      const vec3 d(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
      sum += static_cast<double>(light.evaluate(d).pdf) * std::sin(theta) * (M_PI / kRows) * (2.0 * M_PI / kColumns);
    }
  }
  EXPECT_NEAR(sum, 1.0, 2e-3);
}

TEST(unit_path_environment, sampled_density_and_radiance_are_the_evaluated_ones) {
  for (const float turn : {0.0f, 2.2f}) {
    const EnvironmentLight light(rough_sky(turn));
    Pcg32 random(2);
    int differ = 0;
    for (int i = 0; i < 20000; ++i) {
      const EnvironmentLight::Sample s = light.sample(random.next_vec2());
      ASSERT_GT(s.pdf, 0.0f);
      ASSERT_NEAR(glm::length(s.direction), 1.0f, 1e-5f);
      const EnvironmentLight::Value v = light.evaluate(s.direction);
      ASSERT_LT(glm::length(v.radiance - light.read(s.footprint).radiance), 1e-2f);
      differ += std::abs(v.pdf - s.pdf) > 1e-3f * s.pdf ? 1 : 0;
    }
    // A direction within rounding of an edge between two cells may come back in the other one.
    EXPECT_LE(differ, 5);
  }
}

TEST(unit_path_environment, densities_agree_beside_the_pole) {
  // A sun at the zenith of a fine map: the sine of the polar angle must not lose its digits.
  const EnvironmentLight light(
      mapped_environment(1024, 512, [](vec3 d) { return vec3(d.y > 0.99999f ? 1000.0f : 0.1f); }));
  Pcg32 random(3);
  int differ = 0;
  for (int i = 0; i < 5000; ++i) {
    const EnvironmentLight::Sample s = light.sample(random.next_vec2());
    const float pdf = light.evaluate(s.direction).pdf;
    differ += std::abs(pdf - s.pdf) > 2e-3f * s.pdf ? 1 : 0;
  }
  EXPECT_LE(differ, 20);
}

TEST(unit_path_environment, what_is_below_the_mean_is_never_sampled) {
  const Environment e = rough_sky(0.0f);
  const EnvironmentLight light(e);
  // Far from the hot patch the sky is well below the mean of the sphere.
  EXPECT_EQ(light.evaluate(glm::normalize(vec3(-1, -1, -0.5f))).pdf, 0.0f);
  EXPECT_GT(light.evaluate(glm::normalize(vec3(1, 1, 0.5f))).pdf, 1.0f);
  const float mean = light.flux() / (4.0f * kPi);
  Pcg32 random(4);
  int below = 0, above = 0;
  for (int i = 0; i < 5000; ++i) {
    const vec3 d = random_direction(random);
    const EnvironmentLight::Value v = light.evaluate(d);
    // Cells are as bright as their mean; far below and far above the threshold there is no doubt.
    if (luminance(v.radiance) > 8.0f * mean && v.pdf > 0.0f) ++above;
    if (luminance(v.radiance) < 0.2f * mean && v.pdf > 0.0f) ++below;
  }
  EXPECT_GT(above, 10);
  EXPECT_EQ(below, 0);
}

TEST(unit_path_environment, constant_maps_cannot_be_sampled) {
  EXPECT_FALSE(EnvironmentLight(constant_environment(vec3(1.0f))).can_sample());
  EXPECT_FALSE(EnvironmentLight(mapped_environment(32, 16, [](vec3) { return vec3(0.7f); })).can_sample());
  EXPECT_FALSE(EnvironmentLight(mapped_environment(32, 16, [](vec3) { return vec3(0.0f); })).can_sample());
  EXPECT_TRUE(EnvironmentLight(rough_sky(0.0f)).can_sample());
}

TEST(unit_path_environment, flux_is_the_integral_of_the_radiance) {
  EXPECT_NEAR(EnvironmentLight(constant_environment(vec3(2.0f))).flux(), 8.0f * kPi, 1e-4f);
  const Environment e = rough_sky(0.3f);
  Moments m;
  Pcg32 random(5);
  for (int i = 0; i < 400000; ++i)
    m.add(4.0 * M_PI * static_cast<double>(luminance(environment_radiance(e, random_direction(random)))));
  EXPECT_GT(z_test_p_value(m, static_cast<double>(EnvironmentLight(e).flux())), kFamilySignificance);
}

/// Irradiance on a plane from a map that is dark but for one texel.
TEST(unit_path_environment, estimator_of_irradiance_is_unbiased_for_a_one_texel_sun) {
  constexpr int kColumns = 64, kRows = 32, kX = 40, kY = 7;
  auto map = std::make_shared<Image>(kColumns, kRows, 3);
  map->set_rgb(kX, kY, vec3(1000.0f));
  Environment e;
  e.map = map;
  // By quadrature over the bilinear tent.
  double expected = 0.0;
  constexpr int kSteps = 256;
  for (int j = 0; j < kSteps; ++j) {
    for (int i = 0; i < kSteps; ++i) {
      const double x = 2.0 * (i + 0.5) / kSteps - 1.0, y = 2.0 * (j + 0.5) / kSteps - 1.0;
      const double theta = M_PI * (kY + 0.5 + y) / kRows;
      const double area = std::pow(2.0 / kSteps, 2.0) * (2.0 * M_PI / kColumns) * (M_PI / kRows) * std::sin(theta);
      expected += 1000.0 * (1.0 - std::abs(x)) * (1.0 - std::abs(y)) * std::cos(theta) * area;
    }
  }
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 10.0f), matte(vec3(1.0f)));
  const Moments m = mean_over_seeds(16, b.build(), e, from_above(1.0f, 1.0f), settings(8, 128, 1))[0];
  EXPECT_GT(z_test_p_value(m, expected / M_PI, 1e-4 * expected), kFamilySignificance)
      << m.mean() << " ± " << m.standard_error() << ", expected " << expected / M_PI;
  EXPECT_LT(z_test_p_value(m, 1.02 * expected / M_PI), kFamilySignificance) << m.standard_error();
}

}  // namespace
}  // namespace candela
