#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shade/fresnel.glsl.h"
#include "shade/gauss.h"
#include "shade/microfacet.glsl.h"

// Directional albedos by quadrature, for whoever computes tables; C++ only.

namespace candela::shade {

/// ∫ over [0, 1] of `f` where `sign` is positive. Narrow lobes change sign close to 1, so that changes are looked for
/// between even steps of the cube root of the distance from there, and found by regula falsi (the Illinois variant,
/// Dowell & Jarratt 1971). Gauss's points between them stand denser towards the upper end: there light grazes the
/// surface and masking changes fastest.
template <class Sign, class F>
void over_positive(const GaussRule& rule, const Sign& sign, const F& f) {
  constexpr int kSteps = 6;
  constexpr int kIterations = 10;
  constexpr double kLast = 0.99;  // a millionth from the end, where single precision ends
  const auto place = [](double v) { return 1.0 - (1.0 - v) * (1.0 - v) * (1.0 - v); };
  const auto piece = [&](double a, double b) {
    for (std::size_t i = 0; i < rule.nodes.size() && b > a; ++i) {
      const double w = 1.0 - rule.nodes[i];
      f(b - (b - a) * w * w * w, 3.0 * w * w * (b - a) * rule.weights[i]);
    }
  };
  double from = 0.0, at = 0.0, value = sign(0.0);
  for (int k = 1; k <= kSteps; ++k) {
    const double next = kLast * k / kSteps, next_value = sign(place(next));
    if ((value > 0.0) != (next_value > 0.0)) {
      double a = at, fa = value, b = next, fb = next_value;
      for (int i = 0; i < kIterations && fb != fa; ++i) {
        const double c = (a * fb - b * fa) / (fb - fa), fc = sign(place(c));
        if (fc * fb < 0.0) {
          a = b, fa = fb;
        } else {
          fa *= 0.5;
        }
        b = c, fb = fc;
      }
      if (value > 0.0) piece(from, place(b));
      from = place(b);
    }
    at = next, value = next_value;
  }
  if (value > 0.0) piece(from, 1.0);
}

/// What GGX reflects of light from everywhere, over facets visible from `wo` (wo.y = 0): `f(wi, cos_m, weight)` gets
/// the reflected direction, the cosine at the facet and what height-correlated Smith masking lets through of the lobe
/// there; the weights sum to the albedo of F = 1.
template <class F>
void over_ggx(vec3 wo, float alpha, const F& f) {
  static const GaussRule around = gauss_rule(16), up = gauss_rule(14);
  const auto lo = static_cast<double>(ggx_lambda(wo, alpha));
  for (std::size_t j = 0; j < around.nodes.size(); ++j) {
    // Half the circle: the other half is its mirror image.
    const auto x = static_cast<float>(0.5 * around.nodes[j]);
    const auto facet = [&](double y) { return ggx_sample_visible(wo, alpha, vec2(x, static_cast<float>(y))); };
    over_positive(
        up, [&](double y) { return static_cast<double>(microfacet_reflect(wo, facet(y)).z); },
        [&](double y, double weight) {
          const vec3 wm = facet(y);
          const vec3 wi = microfacet_reflect(wo, wm);
          if (wi.z <= 0.0f) return;
          const double masking = (1.0 + lo) / (1.0 + lo + static_cast<double>(ggx_lambda(wi, alpha)));  // G2 / G1
          f(wi, dot(wo, wm), around.weights[j] * weight * masking);
        });
  }
}

/// (A, B) of the split sum, F0 · A + F90 · B for Schlick's Fresnel. Karis 2013, "Real Shading in Unreal Engine 4",
/// eq. 8.
inline vec2 ggx_split_sum(vec3 wo, float alpha) {
  if (alpha < kGgxMirrorAlpha) {
    const float fresnel = schlick_weight(wo.z);
    return {1.0f - fresnel, fresnel};
  }
  double a = 0.0, b = 0.0;
  over_ggx(wo, alpha, [&](vec3, float cos_m, double weight) {
    const auto fresnel = static_cast<double>(schlick_weight(cos_m));
    a += weight * (1.0 - fresnel);
    b += weight * fresnel;
  });
  return {static_cast<float>(a), static_cast<float>(b)};
}

}  // namespace candela::shade
