// Laws of the whole surface. Every TEST runs its law over the table of surfaces, and over mutants of them that must
// fail.

#include <gtest/gtest.h>

#include <cstddef>

#include "laws/bsdf_laws.h"
#include "laws/mutants.h"
#include "laws/surfaces.h"
#include "support/statistics.h"

namespace candela::laws {
namespace {

using Law = std::function<Verdict(const Bsdf&, std::size_t index)>;

Law without_index(Verdict (*law)(const Bsdf&)) {
  return [law](const Bsdf& bsdf, std::size_t) { return law(bsdf); };
}

// A law with random numbers: seeds differ by row, and p-values are judged as one family over the whole table.
Law statistical(Verdict (*law)(const Bsdf&, const Trial&), int tests_per_surface) {
  const double threshold = test::sidak_threshold(surfaces().size() * static_cast<std::size_t>(tests_per_surface));
  return [law, threshold](const Bsdf& bsdf, std::size_t index) { return law(bsdf, {1000 + index, threshold}); };
}

void expect_law(const Law& law) {
  const auto table = surfaces();
  for (std::size_t i = 0; i < table.size(); ++i) {
    const Verdict verdict = law(real_bsdf(table[i].params), i);
    EXPECT_TRUE(verdict.holds) << table[i].name << ": " << verdict.evidence;
  }
}

// Each mutant must be caught on every surface that shows it; `stride` thins the table for the expensive laws.
void expect_mutants_caught(const Law& law, const std::vector<Mutant>& mutants, std::size_t stride = 1) {
  const auto table = surfaces();
  for (const Mutant& mutant : mutants) {
    std::size_t shown = 0;
    for (std::size_t i = 0; i < table.size(); ++i) {
      if (!mutant.shows(table[i].params) || shown++ % stride != 0) continue;
      EXPECT_FALSE(law(mutant.make(table[i].params), i).holds)
          << "not caught: " << mutant.name << " on " << table[i].name;
    }
    EXPECT_GT(shown, 0U) << "no surface of the table shows: " << mutant.name;
  }
}

TEST(law_surface, reciprocity) { expect_law(without_index(reciprocity)); }
TEST(law_surface, reciprocity_catches_mutants) {
  expect_mutants_caught(without_index(reciprocity), reciprocity_mutants());
}

TEST(law_surface, values_are_finite_and_not_negative) { expect_law(without_index(finiteness)); }
TEST(law_surface, finiteness_catches_mutants) {
  expect_mutants_caught(without_index(finiteness), finiteness_mutants());
}

TEST(law_surface, no_energy_is_made) { expect_law(without_index(energy)); }
TEST(law_surface, energy_catches_mutants) { expect_mutants_caught(without_index(energy), energy_mutants(), 3); }

TEST(law_surface, pdf_integrates_to_one) {
  expect_law(statistical(pdf_integrates_to_one, pdf_integrates_to_one_tests()));
}
TEST(law_surface, pdf_catches_mutants) {
  expect_mutants_caught(statistical(pdf_integrates_to_one, pdf_integrates_to_one_tests()), pdf_mutants(), 3);
}

TEST(law_surface, sampling_follows_pdf) { expect_law(statistical(sampling_follows_pdf, sampling_follows_pdf_tests())); }
TEST(law_surface, sampling_catches_mutants) {
  expect_mutants_caught(statistical(sampling_follows_pdf, sampling_follows_pdf_tests()), sampling_mutants(), 3);
}

TEST(law_surface, weight_is_eval_over_pdf) { expect_law(without_index(weight_is_eval_over_pdf)); }
TEST(law_surface, weight_catches_mutants) {
  expect_mutants_caught(without_index(weight_is_eval_over_pdf), weight_mutants());
}

TEST(law_surface, mean_weight_is_albedo) {
  expect_law(statistical(mean_weight_is_albedo, mean_weight_is_albedo_tests()));
}
TEST(law_surface, mean_weight_catches_mutants) {
  expect_mutants_caught(statistical(mean_weight_is_albedo, mean_weight_is_albedo_tests()), mean_mutants(), 3);
}

// The table's roughness is replaced by the law's own; one row per look and metallic is enough.
bool is_smooth(const SurfaceParams& p) { return p.roughness == 0.0f; }

SurfaceParams with_roughness(SurfaceParams p, float roughness) {
  p.roughness = roughness;
  return p;
}

TEST(law_surface, small_roughness_tends_to_the_mirror) {
  for (const NamedSurface& surface : surfaces()) {
    if (!is_smooth(surface.params)) continue;
    const Verdict verdict = smooth_limit([&](float r) { return real_bsdf(with_roughness(surface.params, r)); });
    EXPECT_TRUE(verdict.holds) << surface.name << ": " << verdict.evidence;
  }
}

TEST(law_surface, smooth_limit_catches_mutants) {
  for (const Mutant& mutant : smooth_limit_mutants()) {
    int shown = 0;
    for (const NamedSurface& surface : surfaces()) {
      if (!is_smooth(surface.params) || !mutant.shows(surface.params)) continue;
      ++shown;
      const Verdict verdict = smooth_limit([&](float r) { return mutant.make(with_roughness(surface.params, r)); });
      EXPECT_FALSE(verdict.holds) << "not caught: " << mutant.name << " on " << surface.name;
    }
    EXPECT_GT(shown, 0) << mutant.name;
  }
}

// surface_is_delta lets an integrator skip the search for lights: nothing may be lost by it.
TEST(law_surface, a_surface_of_deltas_reflects_nothing_else) {
  int deltas = 0;
  for (const NamedSurface& surface : surfaces()) {
    for (const vec3 wo : view_directions()) {
      if (!shade::surface_is_delta(shade::surface_prepare(surface.params, wo.z))) continue;
      ++deltas;
      const Bsdf bsdf = real_bsdf(surface.params);
      for (const vec3 wi : view_directions()) EXPECT_EQ(bsdf.eval(wo, wi).value, vec3(0.0f)) << surface.name;
      EXPECT_TRUE(bsdf.sample(wo, vec3(0.3f, 0.4f, 0x1.fffffep-1f)).is_delta) << surface.name;
    }
  }
  EXPECT_GT(deltas, 0);
}

}  // namespace
}  // namespace candela::laws
