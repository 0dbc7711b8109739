#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "math/spectrum.h"
#include "shade/dispersion.glsl.h"
#include "support/quadrature.h"
#include "support/random.h"
#include "support/statistics.h"

namespace candela::laws {
namespace {

// ----- index of refraction

using Ior = std::function<float(float n_d, float dispersion, float wavelength_nm)>;

// KHR_materials_dispersion: n(F) - n(C) = (n_d - 1) / V_d and n(d) = n_d, at the lines of Fraunhofer.
bool has_the_abbe_number(const Ior& ior) {
  for (const float n_d : {1.33f, 1.5f, 2.42f}) {
    for (const float dispersion : {0.36f, 0.625f, 1.0f}) {
      const double spread = static_cast<double>(ior(n_d, dispersion, 486.13f) - ior(n_d, dispersion, 656.27f));
      const double expected = static_cast<double>((n_d - 1.0f) * dispersion / 20.0f);
      if (std::abs(spread / expected - 1.0) > 1e-3) return false;  // the constants have six digits, the lines five
      if (std::abs(ior(n_d, dispersion, 587.56f) - n_d) > 1e-3f * static_cast<float>(expected)) return false;
    }
  }
  return true;
}

TEST(law_dispersion, index_has_its_abbe_number) {
  EXPECT_TRUE(has_the_abbe_number(shade::dispersion_ior));
  EXPECT_FALSE(has_the_abbe_number([](float n, float d, float nm) { return shade::dispersion_ior(n, 20.0f / d, nm); }))
      << "the Abbe number for its inverse";
  EXPECT_FALSE(has_the_abbe_number([](float n, float d, float nm) {
    return n + (n - 1.0f) * d / 20.0f * (523655.0f / (nm * nm) - 1.5f);
  })) << "n_d at another line";
}

TEST(law_dispersion, index_is_constant_without_dispersion_and_never_below_one) {
  for (float nm = 360.0f; nm <= 830.0f; nm += 10.0f) {
    EXPECT_EQ(shade::dispersion_ior(1.5f, 0.0f, nm), 1.5f);
    EXPECT_EQ(shade::dispersion_ior(1.0f, 5.0f, nm), 1.0f);
    EXPECT_GE(shade::dispersion_ior(1.1f, 100.0f, nm), 1.0f);
    EXPECT_GT(shade::dispersion_ior(1.5f, 1.0f, nm), shade::dispersion_ior(1.5f, 1.0f, nm + 10.0f));
  }
}

// ----- sensitivities

using Sensitivity = std::function<vec3(float wavelength_nm)>;

dvec3 integral(const Sensitivity& f) {
  dvec3 sum(0.0);
  for (int c = 0; c < 3; ++c) {
    sum[c] = test::integrate([&](double nm) { return static_cast<double>(f(static_cast<float>(nm))[c]); },
                             kSpectrumMinNm, kSpectrumMaxNm, 1e-7);
  }
  return sum;
}

bool keeps_white(const Sensitivity& f) {
  return glm::all(glm::lessThan(glm::abs(integral(f) - dvec3(1.0)), dvec3(2e-5)));
}

TEST(law_dispersion, white_stays_white) {
  EXPECT_TRUE(keeps_white(shade::wavelength_sensitivity)) << integral(shade::wavelength_sensitivity).x;
  const auto expected_weight = [](float nm) { return shade::wavelength_weight(nm) * shade::wavelength_pdf(nm); };
  EXPECT_TRUE(keeps_white(expected_weight));
  EXPECT_FALSE(keeps_white([](float nm) { return shade::wavelength_weight(nm) / 470.0f; })) << "as if uniform";
  EXPECT_FALSE(keeps_white([](float nm) { return shade::wavelength_sensitivity(nm + 0.5f) * 1.0002f; }));
}

// How far sensitivities are from the observer's: rms and maximum, in units of the highest.
dvec2 distance_to_the_observer(const Sensitivity& f) {
  std::vector<dvec3> truth;
  dvec3 total(0.0);
  for (int nm = 360; nm <= 830; ++nm) {
    truth.push_back(glm::max(rec709_from_xyz(cie_xyz(nm)) * cie_d65(nm), dvec3(0.0)));
    total += truth.back();
  }
  double peak = 0.0;
  double sum = 0.0;
  double worst = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double expected = truth[i][c] / total[c];
      const double error = std::abs(static_cast<double>(f(360.0f + static_cast<float>(i))[c]) - expected);
      peak = std::max(peak, expected);
      sum += error * error / 3.0;
      worst = std::max(worst, error);
    }
  }
  return dvec2(std::sqrt(sum / static_cast<double>(truth.size())), worst) / peak;
}

TEST(law_dispersion, sensitivities_are_those_of_the_observer_in_rec709) {
  // Measured 0.0164 and 0.109: the corner where red and green are cut at 0 is rounded.
  const dvec2 distance = distance_to_the_observer(shade::wavelength_sensitivity);
  RecordProperty("rms", std::to_string(distance.x));
  RecordProperty("max", std::to_string(distance.y));
  EXPECT_LT(distance.x, 0.018);
  EXPECT_LT(distance.y, 0.12);
  EXPECT_GT(distance_to_the_observer([](float nm) { return shade::wavelength_sensitivity(nm + 5.0f); }).x, 0.03);
  EXPECT_GT(distance_to_the_observer([](float nm) {
              const vec3 w = shade::wavelength_sensitivity(nm);
              return vec3(w.z, w.y, w.x);
            }).x,
            0.2);
}

using ChannelIor = std::function<vec3(float n_d, float dispersion)>;

bool is_the_mean_index(const ChannelIor& ior) {
  for (const float n_d : {1.33f, 1.8f}) {
    for (const float dispersion : {0.4f, 8.0f}) {
      const dvec3 mean = integral(
          [&](float nm) { return shade::wavelength_sensitivity(nm) * shade::dispersion_ior(n_d, dispersion, nm); });
      const double spread = static_cast<double>((n_d - 1.0f) * dispersion / 20.0f);
      if (glm::any(glm::greaterThan(glm::abs(dvec3(ior(n_d, dispersion)) - mean), dvec3(2e-3 * spread)))) return false;
    }
  }
  return true;
}

TEST(law_dispersion, one_index_for_a_channel_is_the_mean_over_its_sensitivity) {
  EXPECT_TRUE(is_the_mean_index(shade::dispersion_channel_ior));
  // The lines C, d and F are no channels.
  EXPECT_FALSE(is_the_mean_index([](float n_d, float dispersion) {
    return vec3(shade::dispersion_ior(n_d, dispersion, 656.3f), n_d, shade::dispersion_ior(n_d, dispersion, 486.1f));
  }));
}

// ----- sampling

using Warp = std::function<float(float u)>;

bool follows_the_pdf(const Warp& warp) {
  constexpr int kSamples = 200000;
  constexpr int kBins = 94;
  std::vector<double> expected(kBins);
  for (int i = 0; i < kBins; ++i) {
    const auto pdf = [](double nm) { return static_cast<double>(shade::wavelength_pdf(static_cast<float>(nm))); };
    expected[static_cast<std::size_t>(i)] = kSamples * test::integrate(pdf, 360.0 + 5.0 * i, 365.0 + 5.0 * i, 1e-8);
  }
  std::vector<double> observed(kBins, 0.0);
  test::Pcg32 random(7);
  for (int i = 0; i < kSamples; ++i) {
    const auto bin = static_cast<std::size_t>((warp(random.next_float()) - 360.0f) / 5.0f);
    observed[std::min<std::size_t>(bin, kBins - 1)] += 1.0;
  }
  return test::chi_square_test(observed, expected).p_value > test::kFamilySignificance;
}

TEST(law_dispersion, samples_follow_their_density) {
  EXPECT_TRUE(follows_the_pdf(shade::wavelength_sample));
  EXPECT_FALSE(follows_the_pdf([](float u) { return shade::wavelength_sample(u) + 1.0f; }));
  EXPECT_FALSE(follows_the_pdf([](float u) { return shade::wavelength_sample(u * u); }));
  EXPECT_FALSE(follows_the_pdf([](float u) { return 360.0f + 470.0f * u; }));
}

// The mean of the weights over strata of u, which converges faster than chance.
bool weighs_one(const Warp& warp, const Sensitivity& weight) {
  constexpr int kStrata = 100000;
  dvec3 sum(0.0);
  for (int i = 0; i < kStrata; ++i) sum += dvec3(weight(warp((static_cast<float>(i) + 0.5f) / kStrata)));
  return glm::all(glm::lessThan(glm::abs(sum / static_cast<double>(kStrata) - dvec3(1.0)), dvec3(1e-4)));
}

TEST(law_dispersion, mean_weight_of_the_samples_is_one_in_every_channel) {
  EXPECT_TRUE(weighs_one(shade::wavelength_sample, shade::wavelength_weight));
  EXPECT_FALSE(weighs_one([](float u) { return shade::wavelength_sample(u) + 1.0f; }, shade::wavelength_weight));
  EXPECT_FALSE(weighs_one([](float u) { return 360.0f + 470.0f * u; }, shade::wavelength_weight));
  EXPECT_FALSE(
      weighs_one(shade::wavelength_sample, [](float nm) { return shade::wavelength_sensitivity(nm) * 470.0f; }));
}

TEST(law_dispersion, samples_are_visible_and_weights_bounded_for_all_u) {
  std::vector<float> all = {0.0f, 1e-30f, 1e-7f, 0x1.fffffep-1f};
  for (int i = 0; i < 4096; ++i) all.push_back(static_cast<float>(i) / 4096.0f);
  for (const float u : all) {
    const float nm = shade::wavelength_sample(u);
    ASSERT_TRUE(nm >= 360.0f && nm <= 830.0f) << u << ' ' << nm;
    ASSERT_GT(shade::wavelength_pdf(nm), 0.0f) << u;
    const vec3 w = shade::wavelength_weight(nm);
    for (int c = 0; c < 3; ++c) ASSERT_TRUE(w[c] >= 0.0f && w[c] <= 3.000001f) << u << ' ' << w[c];
    ASSERT_NEAR(w.x + w.y + w.z, 3.0f, 1e-5f);
  }
  EXPECT_EQ(shade::wavelength_sensitivity(359.0f), vec3(0.0f));
  EXPECT_EQ(shade::wavelength_sensitivity(831.0f), vec3(0.0f));
}

}  // namespace
}  // namespace candela::laws
