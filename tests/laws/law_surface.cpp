// Laws of the whole surface, each over lobes alone and typical surfaces, and over mutants that must fail. All
// combinations are law_table.cpp's.

#include <gtest/gtest.h>

#include <cstddef>

#include "laws/run_laws.h"

namespace candela::laws {
namespace {

bool is_opaque(const NamedSurface& row) {
  return (row.params.lobes & (shade::kLobeTransmission | shade::kLobeDiffuseTransmission)) == 0;
}

// Not so smooth that no derivative can be taken.
bool is_rough(const NamedSurface& row) { return row.is_core && row.params.roughness >= 0.3f; }

TEST(law_surface, reciprocity) { expect_law(rows(1, is_any), reciprocity); }
TEST(law_surface, reciprocity_catches_mutants) {
  expect_mutants_caught(rows(1, is_core), reciprocity, reciprocity_mutants(), 1, 100);
}

TEST(law_surface, values_are_finite_and_not_negative) { expect_law(rows(1, is_any), finiteness); }
TEST(law_surface, finiteness_catches_mutants) {
  expect_mutants_caught(rows(1, is_core), finiteness, finiteness_mutants());
}

TEST(law_surface, opaque_surfaces_know_no_light_from_below) { expect_law(rows(1, is_opaque), opacity); }
TEST(law_surface, opacity_catches_mutants) { expect_mutants_caught(rows(1, is_opaque), opacity, opacity_mutants()); }

TEST(law_surface, white_furnace_neither_gains_nor_loses) { expect_law(rows(3, is_core), energy); }
TEST(law_surface, energy_catches_mutants) { expect_mutants_caught(rows(1, is_core), energy, energy_mutants()); }

TEST(law_surface, pdf_integrates_to_one) {
  expect_law(rows(6, is_core), pdf_integrates_to_one, pdf_integrates_to_one_tests());
}
TEST(law_surface, pdf_catches_mutants) {
  expect_mutants_caught(rows(1, is_core), pdf_integrates_to_one, pdf_mutants(), pdf_integrates_to_one_tests(), 8);
}

TEST(law_surface, sampling_follows_pdf) {
  expect_law(rows(6, is_core), sampling_follows_pdf, sampling_follows_pdf_tests());
}
TEST(law_surface, sampling_catches_mutants) {
  expect_mutants_caught(rows(1, is_core), sampling_follows_pdf, sampling_mutants(), sampling_follows_pdf_tests(), 8);
}

TEST(law_surface, pdf_is_inverse_jacobian_of_sampling) { expect_law(rows(3, is_core), pdf_is_inverse_jacobian); }
TEST(law_surface, inverse_jacobian_catches_mutants) {
  expect_mutants_caught(rows(1, is_rough), pdf_is_inverse_jacobian, density_mutants(), 1, 4);
}

TEST(law_surface, weight_is_eval_over_pdf) { expect_law(rows(1, is_any), weight_is_eval_over_pdf); }
TEST(law_surface, weight_catches_mutants) {
  expect_mutants_caught(rows(1, is_core), weight_is_eval_over_pdf, weight_mutants(), 1, 100);
}

TEST(law_surface, mean_weight_is_albedo) {
  expect_law(rows(6, is_core), mean_weight_is_albedo, mean_weight_is_albedo_tests());
}
TEST(law_surface, mean_weight_catches_mutants) {
  expect_mutants_caught(rows(1, is_core), mean_weight_is_albedo, mean_mutants(), mean_weight_is_albedo_tests(), 8);
}

// The table's roughness is replaced by the law's own. A streak is no mirror, and engines' terms have limits of their
// own.
bool has_smooth_limit(const NamedSurface& row) {
  return row.is_core && row.params.roughness == 0.0f &&
         (row.params.lobes & (shade::kLobeAnisotropy | shade::kLobeModel | shade::kLobeClearcoat)) == 0;
}

SurfaceParams with_roughness(SurfaceParams p, float roughness) {
  p.roughness = roughness;
  return p;
}

TEST(law_surface, small_roughness_tends_to_the_mirror) {
  for (const NamedSurface& row : rows(1, has_smooth_limit)) {
    const Verdict verdict = smooth_limit([&](float r) { return real_bsdf(with_roughness(row.params, r)); });
    EXPECT_TRUE(verdict.holds) << row.name << ": " << verdict.evidence;
  }
}

TEST(law_surface, smooth_limit_catches_mutants) {
  for (const Mutant& mutant : smooth_limit_mutants()) {
    int shown = 0;
    for (const NamedSurface& row : rows(1, has_smooth_limit)) {
      if (!mutant.shows(row.params)) continue;
      ++shown;
      const Verdict verdict = smooth_limit([&](float r) { return mutant.make(with_roughness(row.params, r)); });
      EXPECT_FALSE(verdict.holds) << "not caught: " << mutant.name << " on " << row.name;
    }
    EXPECT_GT(shown, 0) << mutant.name;
  }
}

// surface_is_delta lets an integrator skip the search for lights: nothing may be lost by it.
TEST(law_surface, a_surface_of_deltas_reflects_nothing_else) {
  int deltas = 0;
  for (const NamedSurface& row : rows(1, is_any)) {
    for (const vec3 wo : view_directions()) {
      if (!shade::surface_is_delta(shade::surface_prepare(row.params, wo))) continue;
      ++deltas;
      const Closure closure = real_bsdf(row.params).seen_from(wo);
      // A narrow sheen seen from above is as good as nothing, and not worth a sample.
      constexpr float kNothing = 1e-12f;
      for (const vec3 wi : view_directions()) {
        EXPECT_LT(shade::shade_max3(closure.eval(wi).value), kNothing) << row.name;
        EXPECT_LT(shade::shade_max3(closure.eval(-wi).value), kNothing) << row.name;
      }
      const SurfaceSample s = closure.draw(vec3(0.3f, 0.4f, 0x1.fffffep-1f));
      EXPECT_TRUE(s.is_delta || s.pdf == 0.0f) << row.name;
    }
  }
  EXPECT_GT(deltas, 0);
}

// surface_scatters_through lets it skip lights behind: likewise.
TEST(law_surface, what_does_not_scatter_through_has_no_light_from_below) {
  int through = 0;
  for (const NamedSurface& row : rows(1, is_any)) {
    for (const vec3 wo : view_directions()) {
      const shade::Surface s = shade::surface_prepare(row.params, wo);
      if (shade::surface_scatters_through(s)) {
        ++through;
        continue;
      }
      for (const vec3 wi : view_directions()) {
        EXPECT_EQ(shade::surface_eval(s, wo, -wi).value, vec3(0.0f)) << row.name;
      }
    }
  }
  EXPECT_GT(through, 0);
}

// ----- refraction through the whole closure

SurfaceParams glass(float eta) {
  SurfaceParams p = shade::surface_params_default();
  p.lobes = shade::kLobeTransmission;
  p.metallic = 0.0f;
  p.roughness = 0.0f;
  p.transmission = 1.0f;
  p.is_thin = false;
  p.ior = std::max(eta, 1.0f / eta);
  p.eta = eta;
  return p;
}

TEST(law_surface, refraction_obeys_snell_and_scales_radiance) {
  for (const float eta : {1.33f, 1.5f, 2.42f, 1.0f / 1.33f, 1.0f / 1.5f}) {
    int refracted = 0;
    for (const float cosine : {0.2f, 0.5f, 0.8f, 0.95f, 1.0f}) {
      const vec3 wo = direction(cosine, 0.4f);
      const float sine = std::sqrt(1.0f - cosine * cosine);
      for (const laws::DeltaLobe& lobe : laws::delta_lobes(real_bsdf(glass(eta)).seen_from(wo))) {
        if (lobe.wi.z > 0.0f) continue;
        ++refracted;
        const float sine_t = std::sqrt(lobe.wi.x * lobe.wi.x + lobe.wi.y * lobe.wi.y);
        EXPECT_NEAR(eta * sine_t, sine, 1e-6f);
        // What arrives at the eye of the radiance behind: (1 - F) / η².
        EXPECT_NEAR(lobe.value.y, (1.0f - shade::fresnel_dielectric(cosine, eta)) / (eta * eta), 1e-4f);
        EXPECT_GT(std::abs(lobe.value.y - (1.0f - shade::fresnel_dielectric(cosine, eta))), 0.05f);  // and not without
      }
      EXPECT_EQ(sine / eta < 1.0f, !laws::delta_lobes(real_bsdf(glass(eta)).seen_from(wo)).empty() &&
                                       laws::delta_lobes(real_bsdf(glass(eta)).seen_from(wo)).back().wi.z < 0.0f)
          << "total reflection alone beyond the critical angle, cosine " << cosine << ", eta " << eta;
    }
    EXPECT_GT(refracted, 0);
  }
}

// Brewster: at tan θ = η the reflected light has one polarisation, so that R is half of that one's reflectance, (η² -
// 1)² / (η² + 1)² / 2.
TEST(law_surface, glass_reflects_half_of_one_polarisation_at_brewsters_angle) {
  for (const float eta : {1.33f, 1.5f, 2.42f}) {
    const float cosine = 1.0f / std::sqrt(1.0f + eta * eta);
    const auto lobes = laws::delta_lobes(real_bsdf(glass(eta)).seen_from(direction(cosine, 0.4f)));
    ASSERT_FALSE(lobes.empty());
    const float n2 = eta * eta;
    const float expected = 0.5f * (n2 - 1.0f) * (n2 - 1.0f) / ((n2 + 1.0f) * (n2 + 1.0f));
    EXPECT_GT(lobes.front().wi.z, 0.0f);
    EXPECT_NEAR(lobes.front().value.y, expected, 1e-5f);
    // Schlick's curve, which opaque surfaces have, is no substitute.
    EXPECT_GT(std::abs(shade::fresnel_schlick(vec3(shade::f0_from_eta(eta)), vec3(1.0f), cosine).x - expected), 3e-3f);
  }
}

}  // namespace
}  // namespace candela::laws
