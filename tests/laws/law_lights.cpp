// Falloff and cones of punctual lights, units of light.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "math/spectrum.h"
#include "shade/units.glsl.h"
#include "support/quadrature.h"

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
  EXPECT_GT(shade::light_falloff_inverse_square(0.0f), 1e6f);
  EXPECT_TRUE(std::isfinite(shade::light_falloff_inverse_square(0.0f)));
  EXPECT_TRUE(std::isfinite(shade::light_falloff_polynomial(0.0f, {1, 0, 0})));
  EXPECT_EQ(shade::light_falloff_ue4(0.0f, 5.0f), 1.0f);
}

// ----- every kind by its constant

constexpr shade::vec3 kPolynomial(0.5f, 0.25f, 2.0f);

struct Kind {
  const char* name;
  int constant;
  bool has_window;
  double at_1m;  ///< without a range: by hand
};
constexpr Kind kKinds[] = {{"inverse square", shade::kFalloffInverseSquare, false, 1.0},
                           {"glTF", shade::kFalloffGltf, true, 1.0},
                           {"UE4", shade::kFalloffUe4, true, 0.5},
                           {"polynomial", shade::kFalloffPolynomial, false, 1.0 / 2.75}};

Falloff falloff_of(int kind) {
  return [kind](float d, float range) { return shade::light_falloff(kind, d, range, kPolynomial); };
}

// Never negative, never rising, in no jump: a step of one part in 2000 changes it by little.
bool fades_without_a_step(const Falloff& f, float range) {
  float previous = f(0.01f, range);
  for (float d = 0.01f; d < 20.0f; d *= 1.0005f) {
    const float value = f(d, range);
    if (!std::isfinite(value) || value < 0.0f || value > previous * 1.00001f) return false;
    if (previous - value > 0.01f * std::max(previous, 0.05f)) return false;
    previous = value;
  }
  return true;
}

TEST(law_lights, every_falloff_fades_without_a_step) {
  for (const Kind& kind : kKinds) {
    EXPECT_TRUE(fades_without_a_step(falloff_of(kind.constant), 3.0f)) << kind.name;
    EXPECT_TRUE(fades_without_a_step(falloff_of(kind.constant), kForever)) << kind.name;
  }
  EXPECT_FALSE(fades_without_a_step([](float d, float range) { return d < range ? 1.0f / (d * d) : 0.0f; }, 3.0f))
      << "cut off at the range";
  EXPECT_FALSE(fades_without_a_step([](float d, float) { return d / (d * d + 1.0f); }, 3.0f)) << "rises at first";
  EXPECT_FALSE(fades_without_a_step([](float d, float) { return 1.0f - d / 10.0f; }, 3.0f)) << "negative";
}

bool ends_at_range(const Falloff& f) {
  return f(2.9f, 3.0f) > 0.0f && f(3.0f, 3.0f) == 0.0f && f(3.1f, 3.0f) == 0.0f && f(1e6f, 3.0f) == 0.0f;
}

TEST(law_lights, windows_alone_end_at_the_range) {
  for (const Kind& kind : kKinds) {
    EXPECT_EQ(ends_at_range(falloff_of(kind.constant)), kind.has_window) << kind.name;
    EXPECT_NEAR(static_cast<double>(falloff_of(kind.constant)(1.0f, kForever)), kind.at_1m, 1e-6) << kind.name;
  }
}

// All but a factor that the kind says (1, or what is added to d²) is an inverse square.
bool is_inverse_square_far_away(const Falloff& f, float factor) {
  for (const float d : {1e3f, 1e4f, 1e5f}) {
    if (std::abs(f(d, kForever) * d * d * factor - 1.0f) > 1e-3f) return false;
  }
  return true;
}

TEST(law_lights, every_falloff_without_a_range_is_an_inverse_square_far_away) {
  for (const Kind& kind : kKinds) {
    const float factor = kind.constant == shade::kFalloffPolynomial ? kPolynomial.x : 1.0f;
    EXPECT_TRUE(is_inverse_square_far_away(falloff_of(kind.constant), factor)) << kind.name;
  }
  EXPECT_FALSE(is_inverse_square_far_away([](float d, float) { return 1.0f / d; }, 1.0f));
}

TEST(law_lights, ue4_is_the_square_of_the_window) {
  const auto is_karis = [](const Falloff& f) {
    for (float d = 0.0f; d < 6.0f; d += 0.1f) {
      const double q = static_cast<double>(d) / 5.0;
      const double window = std::max(1.0 - q * q * q * q, 0.0);
      if (std::abs(static_cast<double>(f(d, 5.0f)) -
                   window * window / (static_cast<double>(d) * static_cast<double>(d) + 1.0)) > 1e-6)
        return false;
    }
    return true;
  };
  EXPECT_TRUE(is_karis(falloff_of(shade::kFalloffUe4)));
  EXPECT_FALSE(is_karis([](float d, float range) { return shade::light_window(d, range) / (d * d + 1.0f); }))
      << "glTF's window, not squared";
  EXPECT_FALSE(is_karis(falloff_of(shade::kFalloffGltf)));
}

TEST(law_lights, polynomial_of_a_square_alone_is_the_inverse_square) {
  const auto is_reciprocal = [](const std::function<float(float, shade::vec3)>& f) {
    for (float d = 0.05f; d < 100.0f; d *= 1.5f) {
      if (std::abs(f(d, {1, 0, 0}) * d * d - 1.0f) > 1e-5f) return false;
      if (std::abs(f(d, {0, 2, 0}) * d * 2.0f - 1.0f) > 1e-5f) return false;
      if (std::abs(f(d, {0, 0, 4}) - 0.25f) > 1e-6f) return false;
      if (std::abs(f(d, kPolynomial) * (0.5f * d * d + 0.25f * d + 2.0f) - 1.0f) > 1e-5f) return false;
    }
    return true;
  };
  EXPECT_TRUE(is_reciprocal(shade::light_falloff_polynomial));
  EXPECT_FALSE(is_reciprocal([](float d, shade::vec3 a) {
    return shade::light_falloff_polynomial(d, {a.z, a.y, a.x});
  })) << "coefficients in the other order";
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

// ----- units

// ∫ I(ω) dω by quadrature over z ≥ 0, twice where the lamp shines to both sides.
double flux(const std::function<double(double cos_theta)>& intensity) {
  return 2.0 * M_PI * test::integrate(intensity, 0.0, 1.0, 1e-10);
}

TEST(law_units, point_lumens_are_candela_over_the_sphere) {
  const auto agrees = [](const std::function<float(float)>& candela_of) {
    return std::abs(2.0 * flux([&](double) { return static_cast<double>(candela_of(800.0f)); }) - 800.0) < 1e-3;
  };
  EXPECT_TRUE(agrees(shade::units_candela_from_point_lumens));
  EXPECT_FALSE(agrees([](float lumens) { return lumens / (2.0f * shade::kShadePi); })) << "a hemisphere";
}

TEST(law_units, spot_lumens_are_candela_over_its_cone_and_edge) {
  using Conversion = std::function<float(float lumens, float cos_inner, float cos_outer)>;
  const auto agrees = [](const Conversion& candela_of) {
    for (const auto& [inner, outer] : {std::pair{0.0f, 0.7f}, {0.2f, 0.3f}, {0.5f, 1.5f}, {0.7f, 0.7001f}}) {
      const float cos_inner = std::cos(inner), cos_outer = std::cos(outer);
      const auto candela = static_cast<double>(candela_of(800.0f, cos_inner, cos_outer));
      const auto cone = [&](double c) {
        return candela * static_cast<double>(shade::light_spot_gltf(static_cast<float>(c), cos_inner, cos_outer));
      };
      const auto a = static_cast<double>(cos_outer), b = static_cast<double>(cos_inner);
      const double found = 2.0 * M_PI * (test::integrate(cone, a, b, 1e-3) + test::integrate(cone, b, 1.0, 1e-3));
      if (std::abs(found - 800.0) > 0.1) return false;
    }
    return true;
  };
  EXPECT_TRUE(agrees(shade::units_candela_from_spot_lumens));
  EXPECT_FALSE(agrees([](float lumens, float, float outer) {
    return lumens / (2.0f * shade::kShadePi * (1.0f - outer));
  })) << "the edge taken as full";
  EXPECT_FALSE(agrees([](float lumens, float, float) { return lumens / shade::kShadePi; })) << "whatever the cone";
}

TEST(law_units, area_lumens_are_luminance_times_the_projected_hemisphere) {
  const auto agrees = [](const std::function<float(float, float)>& nit_of) {
    const auto nit = static_cast<double>(nit_of(800.0f, 0.25f));
    return std::abs(0.25 * flux([&](double cos_theta) { return nit * cos_theta; }) - 800.0) < 1e-2;
  };
  EXPECT_TRUE(agrees(shade::units_nit_from_area_lumens));
  EXPECT_FALSE(agrees([](float lumens, float area) { return lumens / (2.0f * shade::kShadePi * area); }))
      << "no cosine";
}

TEST(law_units, every_conversion_is_undone_by_its_inverse) {
  const auto near = [](float a, float b) { return std::abs(a - b) < 1e-5f * std::abs(b); };
  for (const float x : {0.1f, 1.0f, 1234.0f}) {
    EXPECT_TRUE(near(shade::units_watts_from_lumens(shade::units_lumens_from_watts(x, 93.0f), 93.0f), x));
    EXPECT_TRUE(near(shade::units_point_lumens_from_candela(shade::units_candela_from_point_lumens(x)), x));
    EXPECT_TRUE(near(
        shade::units_spot_lumens_from_candela(shade::units_candela_from_spot_lumens(x, 0.9f, 0.7f), 0.9f, 0.7f), x));
    EXPECT_TRUE(near(shade::units_area_lumens_from_nit(shade::units_nit_from_area_lumens(x, 0.3f), 0.3f), x));
    EXPECT_TRUE(near(shade::units_lux_from_nit(shade::units_nit_from_lux(x, 0.18f), 0.18f), x));
  }
  EXPECT_FALSE(near(shade::units_watts_from_lumens(shade::units_lumens_from_watts(1.0f, 93.0f), 683.0f), 1.0f));
}

// The luminous efficacy of a wavelength is that of 555 nm times the observer's ȳ.
TEST(law_units, a_watt_of_555_nm_is_683_lumens_and_no_other_is_more) {
  const auto lumens = [](double nm) {
    return shade::units_lumens_from_watts(1.0f, shade::kLuminousEfficacy * static_cast<float>(cie_xyz(nm).y));
  };
  EXPECT_NEAR(lumens(555.0), 683.0f, 1.0f);
  EXPECT_NEAR(lumens(507.0), 683.0f * 0.4433f, 2.0f);  // photopic V(λ) of CIE 1924
  for (double nm = 400.0; nm <= 700.0; nm += 5.0) EXPECT_LE(lumens(nm), lumens(555.0) * 1.001f) << nm;
}

// All light of a lamp in the middle of a sphere falls on it, and the sphere, if Lambertian, shows E ρ / π.
TEST(law_units, lux_of_a_sphere_around_a_lamp_adds_up_to_its_lumens) {
  for (const float radius : {0.5f, 1.0f, 7.0f}) {
    const float lux = shade::units_lux_from_candela(100.0f, radius, 1.0f);
    EXPECT_NEAR(lux * 4.0f * shade::kShadePi * radius * radius, shade::units_point_lumens_from_candela(100.0f), 0.1f);
    EXPECT_NEAR(shade::units_lux_from_candela(100.0f, radius, 0.5f), 0.5f * lux, 1e-4f);
  }
  EXPECT_EQ(shade::units_lux_from_candela(100.0f, 1.0f, -0.5f), 0.0f);
}

TEST(law_units, a_white_lambertian_surface_that_faces_the_light_shows_its_colour) {
  const shade::vec3 color(3.0f, 2.0f, 0.5f);
  const shade::vec3 white(1.0f / shade::kShadePi);
  const auto shows = [&](shade::vec3 f, float n_dot_l, shade::vec3 expected) {
    return glm::length(shade::light_white_lambertian(f, color, n_dot_l) - expected) < 1e-6f;
  };
  EXPECT_TRUE(shows(white, 1.0f, color));
  EXPECT_TRUE(shows(white, 0.5f, 0.5f * color));
  EXPECT_TRUE(shows(white, -0.5f, shade::vec3(0.0f)));
  EXPECT_FALSE(shows(shade::vec3(1.0f), 1.0f, color)) << "f = 1 is no Lambertian surface";
}

}  // namespace
}  // namespace candela::laws
