#include "math/spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "base/error.h"

namespace candela {
namespace {

using Spectrum = std::function<double(double wavelength_nm)>;

dvec2 chromaticity(const Spectrum& spectrum) {
  dvec3 xyz(0.0);
  for (double nm = kSpectrumMinNm; nm <= kSpectrumMaxNm; nm += 1.0) xyz += cie_xyz(nm) * spectrum(nm);
  return dvec2(xyz) / (xyz.x + xyz.y + xyz.z);
}

// ----- the observer

TEST(unit_math_spectrum, observer_has_the_sums_of_the_published_table) {
  dvec3 sum(0.0);
  for (int nm = 360; nm <= 830; ++nm) sum += cie_xyz(nm);
  // Sums of the table at 1 nm; what lies between the 5 nm rows here is linear.
  EXPECT_NEAR(sum.x, 106.8655, 2e-3);
  EXPECT_NEAR(sum.y, 106.8569, 2e-3);
  EXPECT_NEAR(sum.z, 106.8923, 2e-3);
}

TEST(unit_math_spectrum, observer_is_one_at_555_nm_and_linear_between_rows) {
  EXPECT_EQ(cie_xyz(555.0).y, 1.0);
  EXPECT_EQ(cie_xyz(360.0).x, 0.0001299);
  EXPECT_EQ(cie_xyz(830.0).y, 4.5181e-7);
  EXPECT_NEAR(cie_xyz(557.5).y, 0.5 * (1.0 + 0.995), 1e-15);
  EXPECT_NEAR(cie_xyz(601.0).x, 0.8 * 1.0622 + 0.2 * 1.0456, 1e-15);
  for (const double nm : {0.0, 359.99, 830.01, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(cie_xyz(nm), dvec3(0.0)) << nm;
  }
}

// ----- Rec.709

TEST(unit_math_spectrum, rec709_has_its_primaries_and_its_white) {
  const auto xy = [](dvec3 rgb) {
    const dvec3 xyz = xyz_from_rec709(rgb);
    return dvec2(xyz) / (xyz.x + xyz.y + xyz.z);
  };
  EXPECT_LT(glm::distance(xy({1, 0, 0}), dvec2(0.64, 0.33)), 1e-12);
  EXPECT_LT(glm::distance(xy({0, 1, 0}), dvec2(0.30, 0.60)), 1e-12);
  EXPECT_LT(glm::distance(xy({0, 0, 1}), dvec2(0.15, 0.06)), 1e-12);
  EXPECT_LT(glm::distance(xy({1, 1, 1}), dvec2(0.3127, 0.3290)), 1e-12);
  EXPECT_NEAR(xyz_from_rec709(dvec3(1.0)).y, 1.0, 1e-12);
  EXPECT_LT(glm::distance(rec709_from_xyz(xyz_from_rec709({0.2, 0.5, -0.1})), dvec3(0.2, 0.5, -0.1)), 1e-12);
}

// ----- black bodies

TEST(unit_math_spectrum, planck_obeys_stefan_boltzmann_and_wien) {
  constexpr double kSigma = 5.670374419e-8;
  for (const double kelvin : {1000.0, 5772.0, 20000.0}) {
    double power = 0.0;
    double peak = 0.0;
    double peak_nm = 0.0;
    const double step = 4e3 / kelvin;  // in nm: the spectrum scales with 1/T
    for (double nm = step; nm < 1e6 * step; nm += step) {
      const double l = planck(nm, kelvin);
      power += l * step;
      if (l > peak) peak = l, peak_nm = nm;
    }
    EXPECT_NEAR(std::numbers::pi * power / (kSigma * std::pow(kelvin, 4.0)), 1.0, 1e-5) << kelvin;
    EXPECT_NEAR(peak_nm * kelvin / 2.897771955e6, 1.0, 2e-3) << kelvin;
  }
}

/// CIE 15:2004: illuminant A is a black body at 2848 K by the c₂ = 0.01435 m K of 1931, 2855.5 K by the constant of
/// today. Planckian locus: Wyszecki & Stiles 1982, "Color Science", table 1(3.11), c₂ = 0.014388 m K.
struct LocusPoint {
  double kelvin;
  dvec2 xy;
};
const LocusPoint kLocus[] = {
    {2855.5, {0.44757, 0.40745}}, {1000.0, {0.6528, 0.3444}}, {2000.0, {0.5267, 0.4133}}, {3000.0, {0.4369, 0.4041}},
    {4000.0, {0.3805, 0.3768}},   {5000.0, {0.3451, 0.3516}}, {6500.0, {0.3135, 0.3237}}, {10000.0, {0.2807, 0.2884}},
};

bool is_on_the_locus(const std::function<dvec2(double kelvin)>& xy) {
  for (const LocusPoint& p : kLocus) {
    const dvec2 off = glm::abs(xy(p.kelvin) - p.xy);
    if (off.x > 1.2e-4 || off.y > 1.2e-4) return false;  // four digits are tabulated, some rounded twice
  }
  return true;
}

TEST(unit_math_spectrum, black_bodies_lie_on_the_planckian_locus) {
  for (const LocusPoint& p : kLocus) {
    EXPECT_NEAR(blackbody_xy(p.kelvin).x, p.xy.x, 1.2e-4) << p.kelvin;
    EXPECT_NEAR(blackbody_xy(p.kelvin).y, p.xy.y, 1.2e-4) << p.kelvin;
  }
  EXPECT_NEAR(blackbody_xy(2855.5).x, 0.44757, 2e-5);
  EXPECT_NEAR(blackbody_xy(2855.5).y, 0.40745, 2e-5);
  EXPECT_TRUE(is_on_the_locus(blackbody_xy));
  const auto locus = [](const std::function<double(double nm, double kelvin)>& law) {
    return is_on_the_locus([&](double kelvin) { return chromaticity([&](double nm) { return law(nm, kelvin); }); });
  };
  EXPECT_TRUE(locus(planck));
  EXPECT_FALSE(locus([](double nm, double kelvin) { return planck(nm, kelvin) * nm; })) << "photons, not watts";
  EXPECT_FALSE(locus([](double nm, double kelvin) { return planck(nm, kelvin) * nm * nm; })) << "per hertz, not per nm";
  EXPECT_FALSE(locus([](double nm, double kelvin) { return planck(nm, kelvin * 1.003); })) << "c₂ of 1931";
  EXPECT_FALSE(locus([](double nm, double kelvin) { return planck(nm + 1.0, kelvin); })) << "table off by 1 nm";
}

TEST(unit_math_spectrum, blackbody_color_has_luminance_one_and_the_chromaticity_of_its_temperature) {
  for (double kelvin = 1000.0; kelvin <= 40000.0; kelvin *= 1.05) {
    const vec3 rgb = blackbody_color(kelvin);
    EXPECT_NEAR(luminance(rgb), 1.0f, 1e-6f) << kelvin;
    EXPECT_GE(rgb.x, 0.0f);
    EXPECT_GE(rgb.y, 0.0f);
    EXPECT_GE(rgb.z, 0.0f);
    if (kelvin < 1900.0) {
      EXPECT_EQ(rgb.z, 0.0f) << kelvin;
      continue;
    }
    EXPECT_GT(rgb.z, 0.0f) << kelvin;
    const dvec3 xyz = xyz_from_rec709(dvec3(rgb));
    EXPECT_LT(glm::distance(dvec2(xyz) / (xyz.x + xyz.y + xyz.z), blackbody_xy(kelvin)), 1e-6) << kelvin;
  }
}

TEST(unit_math_spectrum, hotter_is_bluer) {
  float last = -1.0f;
  for (double kelvin = 2000.0; kelvin <= 40000.0; kelvin += 500.0) {
    const vec3 rgb = blackbody_color(kelvin);
    EXPECT_GT(rgb.z / rgb.x, last) << kelvin;
    last = rgb.z / rgb.x;
  }
}

TEST(unit_math_spectrum, temperatures_out_of_range_are_errors) {
  EXPECT_NO_THROW(blackbody_color(1000.0));
  EXPECT_NO_THROW(blackbody_color(40000.0));
  for (const double bad :
       {0.0, -5.0, 999.9, 40000.1, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(blackbody_color(bad), Error) << bad;
  }
  EXPECT_THROW(daylight_xy(3999.0), Error);
  EXPECT_THROW(daylight_xy(25001.0), Error);
}

TEST(unit_math_spectrum, daylight_has_d65_as_its_white) {
  // CIE 15:2004, tables T.1 and T.3, integrated from spectra that the equations of the locus meet to 1.3e-4. The
  // temperature carries the factor 1.4388 / 1.4380 of the constants then and now.
  EXPECT_NEAR(daylight_xy(6500.0 * 1.4388 / 1.4380).x, 0.31272, 3e-5);
  EXPECT_NEAR(daylight_xy(6500.0 * 1.4388 / 1.4380).y, 0.32903, 1.5e-4);
  EXPECT_NEAR(daylight_xy(5000.0 * 1.4388 / 1.4380).x, 0.34567, 2e-5);
  EXPECT_NEAR(daylight_xy(5000.0 * 1.4388 / 1.4380).y, 0.35850, 1.5e-4);
  EXPECT_NEAR(daylight_xy(7500.0 * 1.4388 / 1.4380).x, 0.29902, 3e-5);
  EXPECT_NEAR(daylight_xy(7500.0 * 1.4388 / 1.4380).y, 0.31485, 1.5e-4);
  const vec3 white = color_from_xy(daylight_xy(6504.0));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(white[c], 1.0f, 2e-3f);
  // A black body of the same temperature is pinker than daylight.
  EXPECT_LT(blackbody_color(6504.0).y, white.y);
  EXPECT_NEAR(daylight_xy(6999.999).x, daylight_xy(7000.001).x, 2e-5);
}

}  // namespace
}  // namespace candela
