// Irradiance, prefiltered radiance, suns: against analytic answers and the brute-force integral.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "ibl/bake.h"
#include "ibl/cube.h"
#include "laws/ibl_scenes.h"

namespace candela::laws {
namespace {

constexpr double kPiD = std::numbers::pi;
using ibl::Kernel;
using ibl::Lobe;
using ibl::Method;

ibl::ErrorBound error_of(const ibl::Source& source, const Kernel& filter, const Kernel& truth, Method method,
                         int count = 40) {
  ibl::PrefilterSettings settings;
  settings.method = method;
  settings.fis_size = 64;
  const std::vector<dvec3> directions = ibl::random_directions(count, 11);
  return ibl::compare(ibl::Prefilter(source, {filter}, settings).at(filter, directions),
                      ibl::reference(source, truth, directions), directions);
}

TEST(law_ibl_irradiance, of_a_constant_is_pi) {
  const ibl::Source source = panorama(64, [](dvec3) { return dvec3(1.0, 2.0, 3.0); });
  const std::vector<dvec3> directions = ibl::random_directions(20, 1);
  for (const auto method :
       {ibl::IrradianceMethod::exact, ibl::IrradianceMethod::montecarlo, ibl::IrradianceMethod::riemann}) {
    for (const dvec3& v : ibl::irradiance(source, directions, method, 4096)) {
      EXPECT_NEAR(v.x, kPiD, 1e-3 * kPiD);
      EXPECT_NEAR(v.z, 3.0 * kPiD, 3e-3 * kPiD);
    }
  }
  // Without the cosine it would be 2π.
  EXPECT_NEAR(ibl::cosine_factor(0), kPiD, 1e-12);
}

TEST(law_ibl_irradiance, of_a_cosine_lobe_is_analytic) {
  // ∫ max(n·w, 0) max(a·w, 0) dw = ⅔ (sin β + (π - β) cos β), β between n and a.
  const dvec3 a = glm::normalize(dvec3(0.4, -0.7, 0.5));
  const ibl::Source source = panorama(512, [&](dvec3 d) { return dvec3(std::max(glm::dot(d, a), 0.0)); });
  const std::vector<dvec3> directions = ibl::random_directions(60, 2);
  const std::vector<dvec3> values = ibl::irradiance(source, directions, ibl::IrradianceMethod::exact, 0);
  double wrong = 0.0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const double beta = std::acos(glm::dot(directions[i], a));
    const auto analytic = [](double b) { return 2.0 / 3.0 * (std::sin(b) + (kPiD - b) * std::cos(b)); };
    EXPECT_NEAR(values[i].x, analytic(beta), 1e-3);
    wrong = std::max(wrong, std::abs(values[i].x - analytic(kPiD - beta)));  // lit from behind
  }
  EXPECT_GT(wrong, 0.5);
}

TEST(law_ibl_irradiance, sums_converge_to_the_exact_one) {
  const ibl::Source source = sun_and_sky(64);
  const std::vector<dvec3> directions = ibl::random_directions(60, 5);
  const std::vector<dvec3> exact = ibl::irradiance(source, directions, ibl::IrradianceMethod::exact, 0);
  for (const auto method : {ibl::IrradianceMethod::montecarlo, ibl::IrradianceMethod::riemann}) {
    const auto rms = [&](int samples) {
      return ibl::compare(ibl::irradiance(source, directions, method, samples), exact, directions).rms;
    };
    EXPECT_LT(rms(1 << 16), 0.3 * rms(1 << 8));
    EXPECT_LT(rms(1 << 16), 0.03);
  }
}

TEST(law_ibl_sh, projects_what_it_can_hold_without_error) {
  const auto radiance = [](dvec3 d) { return dvec3(1.0 + 0.5 * d.x - 0.3 * d.y + 0.2 * d.z, d.x * d.z + 1.0, 2.0); };
  ibl::Source source = panorama(256, radiance);
  const ibl::Sh sh = ibl::sh_project(source, 2);
  for (const dvec3& d : ibl::random_directions(20, 4)) {
    const dvec3 v = ibl::sh_evaluate(sh, d), expected = radiance(d);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(v[c], expected[c], 1e-3);
  }
  // Irradiance of 1 + a·d is π + ⅔π a·n.
  const dvec3 up = ibl::sh_evaluate(ibl::sh_irradiance(sh), dvec3(0, 1, 0));
  EXPECT_NEAR(up.x, kPiD - 0.2 * kPiD, 2e-3);
}

TEST(law_ibl_sh, basis_is_orthonormal) {
  const int order = ibl::kMostShOrder;
  const auto count = static_cast<std::size_t>((order + 1) * (order + 1));
  std::vector<double> gram(count * count, 0.0);
  constexpr int kRows = 64;
  double total = 0.0;
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < 2 * kRows; ++i) {
      const double theta = kPiD * (j + 0.5) / kRows, phi = kPiD * i / kRows;
      const dvec3 d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
      const double weight = ibl::texel_solid_angle(j, 2 * kRows, kRows);
      const std::vector<double> basis = ibl::sh_basis(order, d);
      total += weight;
      for (std::size_t a = 0; a < count; ++a) {
        for (std::size_t b = 0; b < count; ++b) gram[a * count + b] += weight * basis[a] * basis[b];
      }
    }
  }
  EXPECT_NEAR(total, 4.0 * kPiD, 1e-9);
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = 0; b < count; ++b) EXPECT_NEAR(gram[a * count + b], a == b ? 1.0 : 0.0, 0.02) << a << ' ' << b;
  }
}

TEST(law_ibl_sh, more_orders_err_less_and_a_window_leaves_nothing_negative) {
  const ibl::Source source = sun_and_sky(128);
  const std::vector<dvec3> directions = ibl::random_directions(400, 9);
  std::vector<dvec3> exact = ibl::irradiance(source, directions, ibl::IrradianceMethod::exact, 0);
  const auto rms = [&](const ibl::Sh& sh) {
    std::vector<dvec3> values;
    values.reserve(directions.size());
    for (const dvec3& d : directions) values.push_back(ibl::sh_evaluate(sh, d));
    return ibl::compare(values, exact, directions).rms;
  };
  const auto irradiance = [&](int order) { return ibl::sh_irradiance(ibl::sh_project(source, order)); };
  EXPECT_LT(rms(irradiance(8)), 0.5 * rms(irradiance(2)));

  // Radiance of a sun rings below 0 until it is windowed.
  const ibl::Sh ringing = ibl::sh_project(source, 4);
  double width = 0.0;
  const ibl::Sh quiet = ibl::sh_window(ringing, ibl::Window::automatic, &width);
  const auto least = [&](const ibl::Sh& sh) {
    double low = 1e9;
    for (const dvec3& d : directions) {
      const dvec3 v = ibl::sh_evaluate(sh, d);
      low = std::min(low, luminance(v));
    }
    return low;
  };
  EXPECT_LT(least(ringing), -0.05);
  EXPECT_GT(least(quiet), -0.01);
  EXPECT_GT(width, 1.0);
  EXPECT_EQ(quiet.coefficients[0], ringing.coefficients[0]);  // the mean stays
}

TEST(law_ibl_prefilter, equals_the_exact_integral_of_a_sun_and_a_sky) {
  const ibl::Source source = sun_and_sky(256);
  for (const double roughness : {0.2, 0.35, 0.5, 0.75, 1.0}) {
    const Kernel kernel(Lobe::ggx, roughness);
    const ibl::ErrorBound zonal = error_of(source, kernel, kernel, Method::zonal);
    EXPECT_LT(zonal.max, 2e-3) << roughness;
    EXPECT_LT(zonal.rms, 5e-4) << roughness;
  }
  const Kernel kernel(Lobe::ggx, 0.5);
  EXPECT_GT(error_of(source, Kernel(Lobe::ggx, 0.52), kernel, Method::zonal).max, 0.02);
  EXPECT_GT(error_of(source, Kernel(Lobe::ggx, 0.25), kernel, Method::zonal).max, 0.3);  // α for roughness
  EXPECT_GT(error_of(source, kernel, kernel, Method::fis).max, 0.01);                    // what its footprints cost
}

TEST(law_ibl_prefilter, sums_over_a_tree_equal_it_too) {
  const ibl::Source source = sun_and_sky(256);
  for (const double roughness : {0.07, 0.5}) {
    const Kernel kernel(Lobe::ggx, roughness);
    EXPECT_LT(error_of(source, kernel, kernel, Method::hierarchical, 12).max, 0.01) << roughness;
  }
}

TEST(law_ibl_prefilter, equals_the_exact_integral_of_the_sheen_lobe) {
  const ibl::Source source = sun_and_sky(128);
  for (const double roughness : {0.3, 0.6, 1.0}) {
    const Kernel kernel(Lobe::charlie, roughness);
    EXPECT_LT(error_of(source, kernel, kernel, Method::automatic).max, 3e-3) << roughness;
  }
}

TEST(law_ibl_prefilter, a_disc_is_a_source_like_any_other) {
  ibl::Source source = panorama(64, [](dvec3) { return dvec3(1.0); });
  source.suns.push_back({glm::normalize(vec3(0.5f, 0.7f, -0.3f)), 0.0047f, vec3(4e4f)});
  const Kernel kernel(Lobe::ggx, 0.4);
  const std::vector<dvec3> at = {dvec3(source.suns[0].direction)};
  const double flux = 4e4 * ibl::disc_solid_angle(source.suns[0]);
  const double value = ibl::Prefilter(source, {kernel}, {}).at(kernel, at)[0].x;
  EXPECT_NEAR(value, 1.0 + flux * kernel(0.0), 2e-3 * value);
}

TEST(law_ibl_prefilter, rotating_the_input_rotates_the_output) {
  // A shift of columns is a turn, and the rotation of the source undoes it.
  const ibl::Source source = sun_and_sky(128);
  constexpr int kShift = 20;
  ibl::Source shifted = source;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 128; ++x) shifted.map.set_rgb((x + kShift) % 128, y, source.map.rgb(x, y));
  }
  const double turn = 2.0 * kPiD * kShift / 128;
  const Kernel kernel(Lobe::ggx, 0.4);
  const std::vector<dvec3> directions = ibl::random_directions(20, 8);
  const auto at = [&](const ibl::Source& s) { return ibl::Prefilter(s, {kernel}, {}).at(kernel, directions); };
  const std::vector<dvec3> original = at(source);
  shifted.rotation = turn;
  EXPECT_LT(ibl::compare(at(shifted), original, directions).max, 1e-5);
  shifted.rotation = -turn;
  EXPECT_GT(ibl::compare(at(shifted), original, directions).max, 0.1);
  shifted.rotation = turn;
  const dvec3 flux(ibl::cube_from_source(shifted, 8)[4].rgb(2, 3)),
      expected(ibl::cube_from_source(source, 8)[4].rgb(2, 3));
  EXPECT_NEAR(flux.x, expected.x, 1e-5);
}

TEST(law_ibl_sun, has_the_illuminance_direction_and_size_it_was_made_with) {
  const dvec3 towards = glm::normalize(dvec3(-0.3, 0.5, 0.6));
  constexpr double kRadius = 0.05;
  const ibl::Source source = panorama(512, [&](dvec3 d) {
    return dvec3(0.5) + (std::acos(glm::dot(d, towards)) < kRadius ? dvec3(400.0, 300.0, 200.0) : dvec3(0.0));
  });
  const ibl::SunExtraction found = ibl::extract_suns(source);
  ASSERT_EQ(found.suns.size(), 1U);
  const ibl::Sun& sun = found.suns[0];
  EXPECT_GT(glm::dot(sun.direction, towards), std::cos(0.002));
  EXPECT_NEAR(sun.angular_radius, kRadius, 0.003);
  const double solid_angle = kPiD * std::pow(std::sin(kRadius), 2);
  EXPECT_NEAR(sun.illuminance.x, 400.0 * solid_angle, 0.02 * 400.0 * solid_angle);
  EXPECT_NEAR(sun.illuminance.z / sun.illuminance.x, 0.5, 1e-3);
  // Nothing is lost: sun and rest are the whole.
  const dvec3 rest = ibl::total_flux(found.rest), whole = ibl::total_flux(source);
  EXPECT_NEAR(rest.x + sun.illuminance.x, whole.x, 2e-3 * whole.x);
  EXPECT_NEAR(rest.x, 0.5 * 4.0 * kPiD, 0.01);
}

TEST(law_ibl_sun, windows_and_skies_are_none) {
  EXPECT_TRUE(ibl::extract_suns(panorama(128, [](dvec3) { return dvec3(1.0); })).suns.empty());
  EXPECT_TRUE(ibl::extract_suns(panorama(128, [](dvec3 d) { return dvec3(d.y > 0.95 ? 100.0 : 0.01); })).suns.empty());
}

TEST(law_ibl_bake, is_the_same_for_any_number_of_threads) {
  const ibl::Source source = sun_and_sky(128);
  ibl::BakeSettings settings;
  settings.size = 32;
  settings.levels = 3;
  settings.irradiance_size = 8;
  settings.proof_directions = 4;
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    return ibl::bake(source, settings);
  };
  const ibl::Bake one = with(1), two = with(2);
  for (std::size_t level = 0; level < 3; ++level) {
    for (std::size_t f = 0; f < 6; ++f) {
      EXPECT_EQ(one.specular.levels[level][f].pixels, two.specular.levels[level][f].pixels);
    }
  }
  for (std::size_t f = 0; f < 6; ++f) EXPECT_EQ(one.irradiance[f].pixels, two.irradiance[f].pixels);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(one.sh.coefficients[i], two.sh.coefficients[i]);
  EXPECT_EQ(one.levels[2].proof.at_texels.max, two.levels[2].proof.at_texels.max);
}

TEST(law_ibl_bake, refines_until_the_bound_holds) {
  const ibl::Source source = sun_and_sky(64);
  ibl::BakeSettings settings;
  settings.size = 8;
  settings.levels = 1;
  settings.roughness = {0.6};
  settings.irradiance_size = 1;
  settings.proof_directions = 8;
  settings.specular.method = Method::montecarlo;
  settings.specular.samples = 64;
  const double loose = ibl::bake(source, settings).levels[0].proof.at_texels.max;
  settings.error = 0.3 * loose;
  const ibl::Level level = ibl::bake(source, settings).levels[0];
  EXPECT_GT(level.refinements, 0);
  EXPECT_EQ(level.holds, level.proof.at_texels.max <= settings.error);
  EXPECT_LT(level.proof.at_texels.max, loose);
  settings.error = 1e-9;
  EXPECT_FALSE(ibl::bake(source, settings).levels[0].holds);
}

}  // namespace
}  // namespace candela::laws
