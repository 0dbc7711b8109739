#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "laws/laws.h"
#include "laws/surfaces.h"

// Each law takes any pair of functions that claims to be a BSDF and says whether it holds, with the numbers that
// decided. The real surface must pass, its mutants must not: a law that cannot fail proves nothing.

namespace candela::laws {

using laws::Bsdf;
using laws::Closure;
using laws::direction;
using laws::NamedSurface;
using laws::Promise;
using laws::real_bsdf;
using laws::view_directions;
using shade::SurfaceEval;
using shade::SurfaceParams;
using shade::SurfaceSample;
using shade::vec2;
using shade::vec3;

struct Verdict {
  bool holds = true;
  std::string evidence;
};

/// What a law may need to know of the surface: what is promised, where random numbers start and the p-value below which
/// a statistical law fails.
struct Trial {
  Promise promise;
  std::uint64_t seed = 1;
  double threshold = 0.0;
};

/// f(wo, wi) = f(wi, wo), and f(wo, wi) η² = f(wi, wo) through a body's boundary, where that is promised.
Verdict reciprocity(const Bsdf& bsdf, const Trial& trial);

/// Values, densities and weights are finite and not negative, at grazing angles and the corners of the random numbers;
/// sampled directions are unit.
Verdict finiteness(const Bsdf& bsdf, const Trial& trial);

/// An opaque surface has nothing to do with light from below.
Verdict opacity(const Bsdf& bsdf, const Trial& trial);

/// White furnace: the albedo is within what is promised of 1, delta lobes included.
Verdict energy(const Bsdf& bsdf, const Trial& trial);

/// ∫ pdf + P(delta) + P(no sample) = 1. "No sample" is mostly a visible normal that reflects below the horizon.
Verdict pdf_integrates_to_one(const Bsdf& bsdf, const Trial& trial);
int pdf_integrates_to_one_tests();

/// χ² of sampled directions against the integral of the pdf over adaptive cells of both hemispheres.
Verdict sampling_follows_pdf(const Bsdf& bsdf, const Trial& trial);
int sampling_follows_pdf_tests();

/// The pdf at a direction is Σ 1 / |∂wi/∂u| over all random numbers u that lead there, by numerical derivatives.
Verdict pdf_is_inverse_jacobian(const Bsdf& bsdf, const Trial& trial);

/// sample's weight is eval / pdf and its pdf is eval's pdf.
Verdict weight_is_eval_over_pdf(const Bsdf& bsdf, const Trial& trial);

/// The mean of weights is the quadrature of eval (delta lobes aside).
Verdict mean_weight_is_albedo(const Bsdf& bsdf, const Trial& trial);
int mean_weight_is_albedo_tests();

/// Just above the width at which GGX becomes a delta lobe, a surface reflects and refracts as much as just below, and
/// delta lobes go into the mirror direction, straight on, or where Snell sends them.
Verdict smooth_limit(const std::function<Bsdf(float roughness)>& family);

}  // namespace candela::laws
