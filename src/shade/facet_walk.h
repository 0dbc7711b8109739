#pragma once

#include <algorithm>
#include <cmath>

#include "shade/fresnel.glsl.h"
#include "shade/microfacet.glsl.h"

// Light that walks between the facets of a rough surface until it leaves: the truth that closed forms of multiple
// scattering are made from and measured by; C++ only. Heitz, Hanika, d'Eon & Dachsbacher 2016, "Multiple-Scattering
// Microfacet BSDFs with the Smith Model". The surface is a medium of facets whose heights are uniform in [-1, 1];
// nothing depends on that choice.

namespace candela::shade {

struct FacetExit {
  vec3 w;                ///< away from the surface; z < 0 on the other side
  int bounces = 0;       ///< at facets
  bool is_lost = false;  ///< still walking after a thousand, or lost to rounding
};

/// A walk over facets of GGX of this width. `Random` has next_float() in [0, 1) and next_vec2().
template <class Random>
class FacetWalk {
 public:
  FacetWalk(float alpha, Random& random) : alpha_(alpha), random_(random) {}

  /// Over mirrors; `at_facet(cosine)` is told of each that reflects.
  template <class F>
  FacetExit over_mirrors(vec3 wo, const F& at_facet) const {
    FacetExit exit{-wo};
    double height = kAbove;
    while (next_facet(exit, height)) {
      const vec3 back = -exit.w;
      const vec3 wm = ggx_sample_visible(back, alpha_, random_.next_vec2());
      at_facet(std::max(dot(back, wm), 0.0f));
      exit.w = microfacet_reflect(back, wm);
    }
    return exit;
  }

  /// Over a boundary to an index `eta` times as large, which reflects or refracts by Fresnel's law.
  FacetExit over_glass(vec3 wo, float eta) const {
    FacetExit exit{-wo};
    double height = kAbove;
    bool is_beyond = false;
    // On the other side the surface is seen in a mirror: heights and directions change their sign, and eta inverts.
    while (next_facet(exit, height)) {
      const vec3 back = -exit.w;
      const vec3 wm = ggx_sample_visible(back, alpha_, random_.next_vec2());
      const float here = is_beyond ? 1.0f / eta : eta;
      if (random_.next_float() < fresnel_dielectric(std::max(dot(back, wm), 0.0f), here)) {
        exit.w = microfacet_reflect(back, wm);
        continue;
      }
      const vec3 refracted = microfacet_refract(back, wm, here);
      exit.w = vec3(refracted.x, refracted.y, -refracted.z);
      height = -height;
      is_beyond = !is_beyond;
    }
    if (is_beyond) exit.w.z = -exit.w.z;
    return exit;
  }

 private:
  static constexpr double kAbove = 1.0;
  static constexpr int kMostBounces = 1000;

  /// Smith's Λ of a direction of either sign, Λ(-w) = -1 - Λ(w).
  double lambda(vec3 w) const {
    const auto up = static_cast<double>(ggx_lambda(w, alpha_));
    return w.z >= 0.0f ? up : -1.0 - up;
  }

  /// Moves to where the ray meets the next facet, and says whether it does: it leaves from a height h with probability
  /// C(h)^Λ(w), C being the share of facets below (Heitz et al. 2016, §4).
  bool next_facet(FacetExit& exit, double& height) const {
    if (exit.bounces >= kMostBounces || !std::isfinite(exit.w.z)) {
      exit.is_lost = true;
      return false;
    }
    if (std::abs(exit.w.z) > 1e-5f) {
      const double l = lambda(exit.w);
      const double below = std::clamp(0.5 * (height + 1.0), 0.0, 1.0);
      const double u = static_cast<double>(random_.next_float());
      if (exit.w.z > 0.0f && (l < 1e-12 || u >= 1.0 - std::pow(below, l))) return false;
      height = 2.0 * std::clamp(below * std::pow(1.0 - u, -1.0 / l), 0.0, 1.0) - 1.0;
    }
    ++exit.bounces;
    return true;
  }

  float alpha_;
  Random& random_;
};

}  // namespace candela::shade
