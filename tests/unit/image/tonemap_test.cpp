#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "image/develop.h"
#include "math/types.h"
#include "shade/color.glsl.h"
#include "shade/tonemap.glsl.h"

namespace candela {
namespace {

const std::vector<int> kCurves = [] {
  std::vector<int> curves;
  curves.reserve(kToneCurves.size());
  for (const ToneCurveInfo& info : kToneCurves) curves.push_back(static_cast<int>(info.curve));
  return curves;
}();

void expect_near(vec3 a, vec3 b, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << "channel " << c;
}

TEST(unit_image_tonemap, srgb_encoding_has_the_values_of_the_standard) {
  EXPECT_EQ(shade::srgb_encode_channel(0.0f), 0.0f);
  EXPECT_NEAR(shade::srgb_encode_channel(1.0f), 1.0f, 1e-6f);
  EXPECT_NEAR(shade::srgb_encode_channel(0.0031308f), 0.04045f, 1e-6f);
  EXPECT_NEAR(shade::srgb_encode_channel(0.18f), 0.46135613f, 1e-6f);  // code 117.6
  EXPECT_NEAR(shade::srgb_decode_channel(0.5f), 0.21404114f, 1e-6f);
  for (int i = 0; i <= 4096; ++i) {
    const float v = static_cast<float>(i) / 4096.0f;
    ASSERT_NEAR(shade::srgb_encode_channel(shade::srgb_decode_channel(v)), v, 1e-6f);
  }
  EXPECT_NEAR(shade::color_luminance(vec3(1.0f)), 1.0f, 1e-6f);
  EXPECT_NEAR(shade::color_luminance(vec3(0.0f, 1.0f, 0.0f)), 0.7152f, 1e-6f);
}

TEST(unit_image_tonemap, pictures_and_shaders_have_the_same_curves) {
  for (const ToneCurveInfo& info : kToneCurves) {
    for (const vec3 c : {vec3(0.01f, 0.2f, 0.7f), vec3(3.0f, 0.5f, 0.1f)}) {
      EXPECT_EQ(info.function(c), shade::tone_map(static_cast<int>(info.curve), c)) << info.name;
    }
  }
}

TEST(unit_image_tonemap, every_curve_keeps_black_and_stays_in_the_display_range) {
  for (const int curve : kCurves) {
    SCOPED_TRACE(curve);
    EXPECT_EQ(shade::tone_map(curve, vec3(0.0f)), vec3(0.0f));
    for (const float r : {-1.0f, 0.0f, 1e-30f, 1e-3f, 0.5f, 4.0f, 1e4f, 1e20f, 3e38f}) {
      for (const float g : {0.0f, 0.02f, 1.0f, 100.0f, 1e30f}) {
        const vec3 c = shade::tone_map(curve, vec3(r, g, 0.3f));
        for (int k = 0; k < 3; ++k) {
          EXPECT_GE(c[k], 0.0f) << r << ' ' << g;
          EXPECT_LE(c[k], 1.0f) << r << ' ' << g;
        }
      }
    }
  }
}

TEST(unit_image_tonemap, every_curve_keeps_greys_grey_and_brighter_greys_brighter) {
  for (const int curve : kCurves) {
    SCOPED_TRACE(curve);
    float before = 0.0f;
    for (float stops = -9.0f; stops < 8.0f; stops += 0.125f) {
      const vec3 c = shade::tone_map(curve, vec3(std::exp2(stops)));
      EXPECT_NEAR(c.x, c.y, 2e-4f);
      EXPECT_NEAR(c.z, c.y, 2e-4f);
      // The AgX polynomial is flat above its range, and the fit dips by less than this at its ends.
      EXPECT_GE(c.y, before - 1e-6f) << stops;
      before = c.y;
    }
    EXPECT_GT(before, 0.99f);
  }
}

TEST(unit_image_tonemap, pbr_neutral_takes_off_fresnel_and_then_leaves_base_colours_alone) {
  expect_near(shade::tone_pbr_neutral(vec3(0.5f, 0.3f, 0.2f)), vec3(0.46f, 0.26f, 0.16f), 1e-6f);
  expect_near(shade::tone_pbr_neutral(vec3(0.5f, 0.3f, 0.04f)), vec3(0.47f, 0.27f, 0.01f), 1e-6f);  // 0.04 - 0.04²/0.16
  expect_near(shade::tone_pbr_neutral(vec3(0.8f)), vec3(0.76f), 1e-6f);
}

/// The inverse of Khronos' curve above its start of compression, in double: an independent derivation.
dvec3 pbr_neutral_inverse(dvec3 shown) {
  const double peak_shown = std::max({shown.x, shown.y, shown.z}), d = 0.24;
  if (peak_shown < 0.76) return shown + 0.04;
  const double peak = d * d / (1.0 - peak_shown) - d + 0.76;  // new_peak survives the mix unchanged
  const double g = 1.0 / (0.15 * (peak - peak_shown) + 1.0);
  return ((shown - peak_shown) / g + peak_shown) * (peak / peak_shown) + 0.04;
}

TEST(unit_image_tonemap, pbr_neutral_has_the_analytic_inverse) {
  for (const vec3 c :
       {vec3(0.9f, 0.5f, 0.2f), vec3(2.0f, 1.0f, 0.3f), vec3(5.0f, 5.0f, 5.0f), vec3(0.1f, 12.0f, 3.0f)}) {
    const dvec3 back = pbr_neutral_inverse(dvec3(shade::tone_pbr_neutral(c)));
    // Near white the inverse is steep: errors of single precision grow with the square of the brightness.
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(back[k], static_cast<double>(c[k]), 3e-5 * static_cast<double>(max_component(c)));
  }
}

TEST(unit_image_tonemap, agx_places_its_range_and_middle_grey) {
  // 0.18 lies 10 of 16.5 stops into the range; contrast(0.60606) = 0.49673, and 0.49673^2.2 = 0.21452.
  expect_near(shade::tone_agx(vec3(0.18f)), vec3(0.21452f), 3e-4f);
  EXPECT_EQ(shade::tone_agx(vec3(0.18f * 0x1p-10f)), vec3(0.0f));
  const float white = std::pow(0.99858f, 2.2f);  // the polynomial at 1
  expect_near(shade::tone_agx(vec3(0.18f * 90.6f)), vec3(white), 3e-4f);
  // Saturated light is drawn towards white as it brightens.
  const vec3 dim = shade::tone_agx(vec3(0.2f, 0.0f, 0.0f)), bright = shade::tone_agx(vec3(50.0f, 0.0f, 0.0f));
  EXPECT_GT(bright.y / bright.x, 2.0f * dim.y / dim.x);
  EXPECT_GT(bright.y, 0.2f);
}

TEST(unit_image_tonemap, aces_has_the_values_of_the_fit) {
  // On the grey axis both matrices have rows that sum to 1, so only the rational function remains.
  for (const double v : {0.01, 0.18, 1.0, 10.0}) {
    const double fit = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
    const auto f = static_cast<float>(std::min(fit, 1.0));
    expect_near(shade::tone_aces(vec3(static_cast<float>(v))), vec3(f), 3e-5f);
  }
  EXPECT_NEAR(shade::tone_aces(vec3(0.18f)).x, 0.1056f, 2e-4f);  // ACES puts 18 % grey near 10 % of display white
  // Pure red, computed in double from the matrices.
  expect_near(shade::tone_aces(vec3(1.0f, 0.0f, 0.0f)), vec3(0.688028f, 0.0f, 0.002639f), 1e-5f);
}

TEST(unit_image_tonemap, hable_has_the_values_of_the_printed_formula) {
  const auto printed = [](double x) {
    const double a = 0.15, b = 0.5, c = 0.1, d = 0.2, e = 0.02, f = 0.3;
    return (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f;
  };
  for (const double v : {0.001, 0.18, 1.0, 3.0}) {
    const auto expected = static_cast<float>(printed(2.0 * v) / printed(11.2));
    expect_near(shade::tone_hable(vec3(static_cast<float>(v))), vec3(expected), 1e-6f);
  }
  EXPECT_EQ(shade::tone_hable(vec3(5.6f)), vec3(1.0f));
}

TEST(unit_image_tonemap, simple_curves_are_what_they_say) {
  expect_near(shade::tone_reinhard(vec3(1.0f, 3.0f, 0.25f)), vec3(0.5f, 0.75f, 0.2f), 1e-6f);
  expect_near(shade::tone_exponential(vec3(1.0f, 0.5f, 0.0f)), vec3(0.63212056f, 0.39346934f, 0.0f), 1e-6f);
  expect_near(shade::tone_linear(vec3(0.3f, 1.5f, -2.0f)), vec3(0.3f, 1.0f, 0.0f), 0.0f);
}

}  // namespace
}  // namespace candela
