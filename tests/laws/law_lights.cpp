// Falloff and cones of punctual lights (KHR_lights_punctual).

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "shade/lights.glsl.h"

namespace candela::laws {
namespace {

using Falloff = std::function<float(float distance, float range)>;
using Cone = std::function<float(float cos_angle, float cos_inner, float cos_outer)>;

constexpr float kForever = std::numeric_limits<float>::infinity();

bool is_inverse_square_without_range(const Falloff& f) {
  for (float d = 1e-3f; d < 1e6f; d *= 1.7f) {
    if (std::abs(f(d, kForever) * d * d - 1.0f) > 1e-5f) return false;
  }
  return true;
}

bool window_closes_at_range(const Falloff& f) {
  for (const float range : {0.1f, 1.0f, 37.0f}) {
    for (const float beyond : {1.0f, 1.0001f, 2.0f, 1e6f}) {
      if (f(range * beyond, range) != 0.0f) return false;
    }
    float previous = kForever;
    for (int i = 1; i <= 100; ++i) {
      const float d = range * static_cast<float>(i) / 100.0f;
      const float q = d / range;
      const float value = f(d, range);
      if (!(value < previous) || value < 0.0f) return false;
      if (std::abs(value * d * d - (1.0f - q * q * q * q)) > 1e-5f) return false;
      previous = value;
    }
    if (std::abs(f(0.01f * range, range) * 1e-4f * range * range - 1.0f) > 1e-4f) return false;  // untouched when near
  }
  return true;
}

TEST(law_lights, inverse_square_without_a_range) {
  EXPECT_TRUE(is_inverse_square_without_range(shade::light_falloff_gltf));
  EXPECT_FALSE(is_inverse_square_without_range([](float d, float) { return 1.0f / (d * d + 1.0f); })) << "Karis 2013";
  EXPECT_FALSE(is_inverse_square_without_range([](float d, float) { return 1.0f / d; }));
}

TEST(law_lights, window_closes_at_the_range) {
  EXPECT_TRUE(window_closes_at_range(shade::light_falloff_gltf));
  EXPECT_FALSE(window_closes_at_range([](float d, float) { return 1.0f / (d * d); })) << "no window";
  EXPECT_FALSE(window_closes_at_range([](float d, float range) {
    const float q = d / range;
    const float window = shade::shade_saturate(1.0f - q * q * q * q);
    return window * window / (d * d);
  })) << "squared window of Karis 2013";
  EXPECT_FALSE(window_closes_at_range([](float d, float range) {
    const float q = d / range;
    return shade::shade_saturate(1.0f - q * q) / (d * d);
  })) << "second power";
}

TEST(law_lights, falloff_is_finite_at_the_light) {
  for (const float range : {1.0f, kForever}) {
    EXPECT_TRUE(std::isfinite(shade::light_falloff_gltf(0.0f, range)));
    EXPECT_GT(shade::light_falloff_gltf(0.0f, range), 1e6f);
  }
}

// 1 inside the inner cone, 0 outside the outer one, monotone between; down to beams of half a degree.
bool is_cone(const Cone& f) {
  const float pairs[][2] = {{0.0f, 45.0f}, {20.0f, 30.0f}, {44.9f, 45.0f}, {0.0f, 1.0f}, {0.0f, 0.5f}, {30.0f, 90.0f}};
  for (const auto& [inner_deg, outer_deg] : pairs) {
    const auto cosine = [](float deg) { return std::cos(deg * shade::kShadePi / 180.0f); };
    const float inner = cosine(inner_deg);
    const float outer = cosine(outer_deg);
    if (std::abs(f(1.0f, inner, outer) - 1.0f) > 1e-3f || std::abs(f(inner, inner, outer) - 1.0f) > 1e-3f) return false;
    if (f(outer, inner, outer) != 0.0f || f(cosine(outer_deg + 0.1f), inner, outer) != 0.0f) return false;
    if (f(-1.0f, inner, outer) != 0.0f) return false;
    const float middle = f(0.5f * (inner + outer), inner, outer);
    if (std::abs(middle - 0.25f) > 1e-2f) return false;  // the square of one half
    float previous = 1.0f;
    for (int i = 0; i <= 50; ++i) {
      const float value = f(inner + (outer - inner) * static_cast<float>(i) / 50.0f, inner, outer);
      if (value > previous + 1e-6f || value < 0.0f || value > 1.0f) return false;
      previous = value;
    }
  }
  return true;
}

TEST(law_lights, spot_is_full_inside_and_dark_outside) {
  EXPECT_TRUE(is_cone(shade::light_spot_gltf));
  EXPECT_FALSE(is_cone([](float c, float inner, float outer) { return shade::light_spot_gltf(c, outer, inner); }))
      << "cones swapped";
  EXPECT_FALSE(is_cone([](float c, float inner, float outer) {
    return std::sqrt(shade::light_spot_gltf(c, inner, outer));
  })) << "not squared";
  EXPECT_FALSE(is_cone([](float c, float inner, float outer) {
    const float t = shade::shade_saturate((c - outer) / std::max(0.001f, inner - outer));
    return t * t;
  })) << "the extension's sample code dims beams narrower than 2.6 degrees";
}

TEST(law_lights, a_spot_of_equal_cones_has_a_hard_edge) {
  const float edge = std::cos(0.5f);
  EXPECT_EQ(shade::light_spot_gltf(std::cos(0.49f), edge, edge), 1.0f);
  EXPECT_EQ(shade::light_spot_gltf(std::cos(0.51f), edge, edge), 0.0f);
}

}  // namespace
}  // namespace candela::laws
