#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "shade/surface.glsl.h"

// Each law takes any pair of functions that claims to be a BSDF and says whether it holds, with the numbers that
// decided. The real surface must pass, its mutants must not: a law that cannot fail proves nothing.

namespace candela::laws {

using shade::SurfaceEval;
using shade::SurfaceParams;
using shade::SurfaceSample;
using shade::vec2;
using shade::vec3;

/// The BSDF contract of shade/surface.glsl.h.
struct Bsdf {
  std::function<SurfaceEval(vec3 wo, vec3 wi)> eval;
  std::function<SurfaceSample(vec3 wo, vec3 u)> sample;
};

/// What the renderers compile.
Bsdf real_bsdf(const SurfaceParams& params);

struct Verdict {
  bool holds = true;
  std::string evidence;
};

/// What a statistical law needs to know: where its random numbers start and the p-value below which it fails.
struct Trial {
  std::uint64_t seed = 1;
  double threshold = 0.0;
};

/// Viewing directions of the laws that integrate, from the normal to nearly grazing, off the coordinate axes.
std::vector<vec3> view_directions();
vec3 direction(float cos_theta, float phi);

/// f(wo, wi) = f(wi, wo), after dividing eval by the cosine.
Verdict reciprocity(const Bsdf& bsdf);

/// Values, densities and weights are finite and not negative, down to cosines of 1e-4 and for the corners of the random
/// numbers; nothing is reflected below the horizon; sampled directions are unit.
Verdict finiteness(const Bsdf& bsdf);

/// Directional albedo ≤ 1, delta lobes included.
Verdict energy(const Bsdf& bsdf);

/// ∫ pdf + P(delta) + P(no sample) = 1. "No sample" is mostly a visible normal that reflects below the horizon.
Verdict pdf_integrates_to_one(const Bsdf& bsdf, const Trial& trial);
int pdf_integrates_to_one_tests();

/// χ² of sampled directions against the integral of the pdf over adaptive cells.
Verdict sampling_follows_pdf(const Bsdf& bsdf, const Trial& trial);
int sampling_follows_pdf_tests();

/// sample's weight is eval / pdf and its pdf is eval's pdf.
Verdict weight_is_eval_over_pdf(const Bsdf& bsdf);

/// The mean of weights is the quadrature of eval (delta lobes aside).
Verdict mean_weight_is_albedo(const Bsdf& bsdf, const Trial& trial);
int mean_weight_is_albedo_tests();

/// Just above the width at which GGX becomes a delta lobe, a surface reflects as much as just below, and the delta lobe
/// goes into the mirror direction.
Verdict smooth_limit(const std::function<Bsdf(float roughness)>& family);

}  // namespace candela::laws
