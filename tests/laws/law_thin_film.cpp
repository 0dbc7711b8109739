#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <vector>

#include "math/spectrum.h"
#include "shade/fresnel.glsl.h"
#include "shade/thin_film.glsl.h"

namespace candela::laws {
namespace {

using Complex = std::complex<double>;

struct Film {
  double cos_theta = 1.0;
  double eta1 = 1.0;
  double eta2 = 1.3;
  Complex eta3 = 1.5;
  double thickness_nm = 400.0;
};

/// Amplitudes of s and p, as Fresnel wrote them; angles may be complex.
struct Amplitudes {
  Complex s;
  Complex p;
};
Amplitudes boundary(Complex n_a, Complex cos_a, Complex n_b, Complex cos_b) {
  return {(n_a * cos_a - n_b * cos_b) / (n_a * cos_a + n_b * cos_b),
          (n_b * cos_a - n_a * cos_b) / (n_b * cos_a + n_a * cos_b)};
}

/// Reflectance at one wavelength: Airy's summation with complex amplitudes. Born & Wolf, "Principles of Optics",
/// §1.6.4.
double airy(const Film& f, double wavelength_nm) {
  const double sin1 = std::sqrt(1.0 - f.cos_theta * f.cos_theta);
  const auto cosine_in = [&](Complex n) { return std::sqrt(1.0 - (f.eta1 * sin1 / n) * (f.eta1 * sin1 / n)); };
  const Complex cos2 = cosine_in(f.eta2);
  Complex cos3 = cosine_in(f.eta3);
  if ((f.eta3 * cos3).imag() < 0.0) cos3 = -cos3;  // a wave that decays in the substrate
  const Amplitudes top = boundary(f.eta1, f.cos_theta, f.eta2, cos2);
  const Amplitudes base = boundary(f.eta2, cos2, f.eta3, cos3);
  const Complex turn = std::exp(Complex(0.0, 4.0 * std::numbers::pi * f.thickness_nm / wavelength_nm) * f.eta2 * cos2);
  return 0.5 * (std::norm((top.s + base.s * turn) / (1.0 + top.s * base.s * turn)) +
                std::norm((top.p + base.p * turn) / (1.0 + top.p * base.p * turn)));
}

/// What an observer sees under D65, in linear Rec.709 relative to white, cut to [0, 1] as the shader cuts it.
dvec3 spectral_truth(const Film& f) {
  static const std::vector<dvec3> sensitivity = [] {
    std::vector<dvec3> s;
    dvec3 total(0.0);
    for (int nm = 360; nm <= 830; ++nm) {
      s.push_back(rec709_from_xyz(cie_xyz(nm)) * cie_d65(nm));
      total += s.back();
    }
    for (dvec3& v : s) v /= total;
    return s;
  }();
  dvec3 sum(0.0);
  for (std::size_t i = 0; i < sensitivity.size(); ++i) sum += sensitivity[i] * airy(f, 360.0 + static_cast<double>(i));
  return glm::clamp(sum, 0.0, 1.0);
}

using Model = std::function<vec3(const Film&)>;

vec3 shader(const Film& f) {
  const auto eta3 = glm::vec2(static_cast<float>(f.eta3.real()), static_cast<float>(f.eta3.imag()));
  return shade::thin_film_conductor(static_cast<float>(f.cos_theta), static_cast<float>(f.eta1),
                                    static_cast<float>(f.eta2), vec3(eta3.x), vec3(eta3.y),
                                    static_cast<float>(f.thickness_nm));
}

struct Errors {
  double max = 0.0;
  double rms = 0.0;
};

const std::vector<double> kThicknesses = {0.5,   10.0,  25.0,  40.0,  55.0,  70.0,  85.0,  100.0, 130.0,
                                          160.0, 200.0, 250.0, 300.0, 350.0, 400.0, 500.0, 700.0, 1000.0};

Errors errors(const Model& model, const std::vector<Complex>& substrates, double last_deg) {
  Errors e;
  double count = 0.0;
  for (const Complex eta3 : substrates) {
    for (const double eta2 : {1.2, 1.33, 1.5, 1.8, 2.0}) {
      for (const double deg : {0.0, 20.0, 40.0, 55.0, 70.0, 80.0, 85.0, 88.0, 89.5}) {
        if (deg > last_deg) continue;
        for (const double nm : kThicknesses) {
          const Film f{std::cos(deg * std::numbers::pi / 180.0), 1.0, eta2, eta3, nm};
          const dvec3 difference = glm::abs(dvec3(model(f)) - spectral_truth(f));
          for (int c = 0; c < 3; ++c) {
            e.max = std::max(e.max, difference[c]);
            e.rms += difference[c] * difference[c];
            count += 1.0;
          }
        }
      }
    }
  }
  e.rms = std::sqrt(e.rms / count);
  return e;
}

const std::vector<Complex> kDielectrics = {1.33, 1.5, 1.8, 2.42};
// Gold, copper, aluminium, titanium at 550 nm, and silicon: strong reflection from below.
const std::vector<Complex> kMetals = {{0.35, 2.71}, {0.96, 2.58}, {0.96, 6.69}, {2.5, 3.4}, {4.1, 0.04}};

// Dielectrics: measured 4.2e-4 and 5.1e-5. The transforms of the sensitivities are off by 0.009 at most and 0.002 rms,
// times fringes of about 0.1.
constexpr double kDielectricMax = 5e-4;
constexpr double kDielectricRms = 6e-5;

TEST(law_thin_film, dielectrics_are_the_airy_sum_seen_by_the_observer) {
  const Errors e = errors(shader, kDielectrics, 89.5);
  RecordProperty("max", std::to_string(e.max));
  RecordProperty("rms", std::to_string(e.rms));
  EXPECT_LT(e.max, kDielectricMax);
  EXPECT_LT(e.rms, kDielectricRms);
}

TEST(law_thin_film, metals_are_the_airy_sum_seen_by_the_observer) {
  const Errors e = errors(shader, kMetals, 80.0);
  RecordProperty("max", std::to_string(e.max));
  RecordProperty("rms", std::to_string(e.rms));
  // Measured 0.0134 (gold at 80° and 100 nm) and 2.7e-4.
  EXPECT_LT(e.max, 0.016);
  EXPECT_LT(e.rms, 3.5e-4);
  // Towards grazing both boundaries reflect nearly all, and the fringes are sharper than the orders that are summed:
  // measured 0.071 and 1.5e-3.
  const Errors grazing = errors(shader, kMetals, 89.5);
  RecordProperty("max_grazing", std::to_string(grazing.max));
  RecordProperty("rms_grazing", std::to_string(grazing.rms));
  EXPECT_LT(grazing.max, 0.08);
  EXPECT_LT(grazing.rms, 1.8e-3);
}

TEST(law_thin_film, reflection_inside_the_film_may_be_total) {
  // From glass through a denser film to air or water, beyond the critical angle of the substrate: all returns.
  for (const double eta3 : {1.0, 1.33}) {
    for (const double deg : {0.0, 20.0, 35.0, 50.0, 70.0, 85.0}) {
      const Film f{std::cos(deg * std::numbers::pi / 180.0), 1.5, 1.7, eta3, 350.0};
      const dvec3 truth = spectral_truth(f);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(static_cast<double>(shader(f)[c]), truth[c], 1e-3) << eta3 << ' ' << deg;
    }
  }
  // From glass into a film of air.
  EXPECT_EQ(shade::thin_film_conductor(0.5f, 1.5f, 1.0f, vec3(1.5f), vec3(0.0f), 5000.0f), vec3(1.0f));
}

// ----- mistakes

// The film put together from its parts, to be spoilt.
struct Mistake {
  float opd_factor = 2.0f;
  float sign12 = 1.0f;
  bool cosine_outside = false;
  bool only_s = false;
};

vec3 with_mistake(const Film& f, const Mistake& mistake) {
  const auto c1 = static_cast<float>(f.cos_theta);
  const auto eta2 = static_cast<float>(f.eta2);
  const auto eta23 = static_cast<float>(f.eta3.real()) / eta2;
  const float c2 = std::sqrt(1.0f - (1.0f - c1 * c1) / (eta2 * eta2));
  const float cosine = mistake.cosine_outside ? c1 : c2;
  const float opd = mistake.opd_factor * 1e-3f * eta2 * static_cast<float>(f.thickness_nm) * cosine;
  const vec2 top(eta2 * eta2, 0.0f);
  const vec2 base(eta23 * eta23, 0.0f);
  shade::FilmBoundary s = shade::film_boundary_s(c1, shade::film_root(c1, top));
  shade::FilmBoundary p = shade::film_boundary_p(c1, shade::film_root(c1, top), top);
  s.re *= mistake.sign12;
  p.re *= mistake.sign12;
  if (mistake.only_s) p = s;
  const shade::FilmFringes fringes = shade::film_fringes(opd);
  vec3 r(0.0f);
  for (int c = 0; c < 3; ++c) {
    r[c] = mistake.only_s ? shade::film_airy(s, shade::film_boundary_s(c2, shade::film_root(c2, base)), fringes, c)
                          : shade::film_channel(s, p, c2, base, fringes, c);
  }
  return glm::clamp(r, 0.0f, 1.0f);
}

// The formulas that KHR_materials_iridescence shows: Schlick's curve at both boundaries, for both polarisations.
vec3 with_schlick(const Film& f) {
  const auto c1 = static_cast<float>(f.cos_theta);
  const auto eta2 = static_cast<float>(f.eta2);
  const float c2 = std::sqrt(1.0f - (1.0f - c1 * c1) / (eta2 * eta2));
  const auto boundary = [](float eta, float cos_theta) {
    const float f0 = shade::f0_from_eta(eta);
    const float r = f0 + (1.0f - f0) * shade::schlick_weight(cos_theta);
    shade::FilmBoundary b;
    b.re = eta > 1.0f ? -std::sqrt(r) : std::sqrt(r);
    b.im = 0.0f;
    b.through = 1.0f - r;
    return b;
  };
  const shade::FilmBoundary top = boundary(eta2, c1);
  const shade::FilmBoundary base = boundary(static_cast<float>(f.eta3.real()) / eta2, c2);
  const shade::FilmFringes fringes = shade::film_fringes(2e-3f * eta2 * static_cast<float>(f.thickness_nm) * c2);
  vec3 r(0.0f);
  for (int c = 0; c < 3; ++c) r[c] = shade::film_airy(top, base, fringes, c);
  return glm::clamp(r, 0.0f, 1.0f);
}

bool is_right(const Mistake& mistake) {
  return errors([&](const Film& f) { return with_mistake(f, mistake); }, {1.5, 1.8}, 85.0).max < kDielectricMax;
}

TEST(law_thin_film, mistakes_are_seen) {
  EXPECT_TRUE(is_right({}));
  EXPECT_FALSE(is_right({.sign12 = -1.0f})) << "no half wave lost at the denser film";
  EXPECT_FALSE(is_right({.opd_factor = 4.0f})) << "4 for 2 in the path difference";
  EXPECT_FALSE(is_right({.opd_factor = 1.0f})) << "one way through the film";
  EXPECT_FALSE(is_right({.cosine_outside = true})) << "cos θ₁ for cos θ₂ in the path difference";
  EXPECT_FALSE(is_right({.only_s = true})) << "one polarisation";
  EXPECT_GT(errors(with_schlick, {1.5, 1.8}, 85.0).max, 0.02) << "no polarisation at all";
}

// ----- limits

TEST(law_thin_film, no_film_is_the_bare_substrate) {
  for (float c = 0.0f; c <= 1.0f; c += 0.02f) {
    for (const float f0 : {0.02f, 0.04f, 0.17f}) {
      const float eta = (1.0f + std::sqrt(f0)) / (1.0f - std::sqrt(f0));
      const vec3 bare = shade::thin_film_fresnel(c, 1.0f, 1.8f, vec3(f0), 0.0f);
      EXPECT_NEAR(bare.x, shade::fresnel_dielectric(c, eta), 2e-5f) << c << ' ' << f0;
      // Schlick's curve is this far from Fresnel's equations, which is what a renderer that mixes both sees.
      EXPECT_NEAR(bare.x, shade::fresnel_schlick(vec3(f0), vec3(1.0f), c).x, 0.075f);
    }
    EXPECT_NEAR(shade::thin_film_conductor(c, 1.0f, 1.8f, vec3(0.35f), vec3(2.71f), 0.0f).y,
                shade::fresnel_conductor(c, 0.35f, 2.71f), 2e-5f);
    for (const float f0 : {0.5f, 0.7f, 0.9f, 0.99f}) {
      const vec3 metal = shade::thin_film_metal(c, 1.0f, 1.8f, vec3(f0), 0.0f);
      EXPECT_NEAR(metal.x, shade::fresnel_schlick(vec3(f0), vec3(1.0f), c).x, 0.036f) << c << ' ' << f0;
    }
  }
  for (const float f0 : {0.0f, 0.04f, 0.5f, 0.95f}) {
    EXPECT_NEAR(shade::thin_film_fresnel(1.0f, 1.0f, 1.3f, vec3(f0), 0.0f).x, f0, 2e-5f);
    EXPECT_NEAR(shade::thin_film_metal(1.0f, 1.0f, 1.3f, vec3(f0), 0.0f).x, f0, 2e-5f);
  }
}

TEST(law_thin_film, a_film_of_the_outside_or_of_the_substrate_is_invisible) {
  for (const float thickness : {50.0f, 400.0f, 2000.0f}) {
    for (float c = 0.05f; c <= 1.0f; c += 0.05f) {
      const float bare = shade::fresnel_dielectric(c, 1.5f);
      EXPECT_NEAR(shade::thin_film_fresnel(c, 1.0f, 1.0f, vec3(0.04f), thickness).x, bare, 2e-5f);
      EXPECT_NEAR(shade::thin_film_fresnel(c, 1.0f, 1.5f, vec3(0.04f), thickness).x, bare, 2e-5f);
    }
  }
}

TEST(law_thin_film, energy_is_kept_for_all_arguments) {
  for (const float eta1 : {1.0f, 1.5f}) {
    for (const float eta2 : {1.0f, 1.3f, 1.6f, 2.0f, 5.0f}) {
      for (const float f0 : {0.0f, 1e-6f, 0.04f, 0.5f, 0.99f, 1.0f, 2.0f}) {
        for (const float c : {0.0f, 1e-7f, 1e-3f, 0.1f, 0.5f, 0.999f, 1.0f, 1.0001f}) {
          for (const float nm : {0.0f, 0.01f, 0.03f, 1.0f, 100.0f, 1e4f, 1e6f}) {
            for (const vec3 r : {shade::thin_film_fresnel(c, eta1, eta2, vec3(f0), nm),
                                 shade::thin_film_metal(c, eta1, eta2, vec3(f0), nm)}) {
              for (int i = 0; i < 3; ++i) {
                ASSERT_TRUE(r[i] >= 0.0f && r[i] <= 1.0f)
                    << eta1 << ' ' << eta2 << ' ' << f0 << ' ' << c << ' ' << nm << ' ' << r[i];
              }
            }
          }
        }
      }
    }
  }
}

using Reflectance = std::function<vec3(float cos_theta1, float eta2, float f0, float thickness_nm)>;

bool is_continuous(const Reflectance& at) {
  for (const float eta2 : {1.3f, 2.0f}) {
    for (const float f0 : {0.0f, 0.04f, 0.5f, 0.95f, 1.0f}) {
      for (const float c : {0.0f, 1e-3f, 0.05f, 0.3f, 0.7f, 1.0f}) {
        vec3 last = at(c, eta2, f0, 0.0f);
        // 0.3 % more of the thickness, and 0.2 nm at most, is a small part of the sharpest fringe.
        for (float nm = 0.0f; nm < 300.0f; nm += std::min(0.0005f + 0.003f * nm, 0.2f)) {
          const vec3 r = at(c, eta2, f0, nm);
          if (glm::any(glm::greaterThan(glm::abs(r - last), vec3(0.04f)))) return false;
          last = r;
        }
      }
    }
  }
  return true;
}

TEST(law_thin_film, thickness_makes_no_jumps) {
  const Reflectance dielectric = [](float c, float eta2, float f0, float nm) {
    return shade::thin_film_fresnel(c, 1.0f, eta2, vec3(f0), nm);
  };
  EXPECT_TRUE(is_continuous(dielectric));
  EXPECT_TRUE(is_continuous(
      [](float c, float eta2, float f0, float nm) { return shade::thin_film_metal(c, 1.0f, eta2, vec3(f0), nm); }));
  EXPECT_FALSE(is_continuous([&](float c, float eta2, float f0, float nm) {
    return dielectric(c, eta2, f0, nm < 10.0f ? 0.0f : nm);
  })) << "thin films left out";
}

}  // namespace
}  // namespace candela::laws
