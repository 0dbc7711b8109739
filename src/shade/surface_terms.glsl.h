#ifndef CANDELA_SHADE_SURFACE_TERMS_GLSL_H
#define CANDELA_SHADE_SURFACE_TERMS_GLSL_H

#include "shade/surface_base.glsl.h"
#include "shade/thin_film.glsl.h"

// The terms of the layered surface, each by the choice that its Surface carries: F, D and V, and the shape of the
// diffuse layer.

SHADE_BEGIN

/// A film on a dielectric that reflects `f0`, seen from air.
SHADE_FN vec3 terms_film(SHADE_IN(Surface) s, float cos_theta, vec3 f0) {
  return thin_film_fresnel(cos_theta, 1.0f, s.film_ior, f0, s.film_nm);
}

/// A film on the surface's metal.
SHADE_FN vec3 terms_film_metal(SHADE_IN(Surface) s, float cos_theta) {
  if ((SHADE_LOBES(s) & kLobeConductor) != 0) {
    return thin_film_conductor(cos_theta, 1.0f, s.film_ior, s.conductor_n, s.conductor_k, s.film_nm);
  }
  return thin_film_metal(cos_theta, 1.0f, s.film_ior, s.film_f0_metal, s.film_nm);
}

/// A dielectric's reflectance at grazing angles.
SHADE_FN vec3 terms_f90(SHADE_IN(Surface) s) { return s.f90_dielectric * s.f90_tint; }

SHADE_FN vec3 terms_fresnel_dielectric(SHADE_IN(Surface) s, float cos_theta) {
  vec3 f0 = s.film_f0_dielectric;
  vec3 f90 = terms_f90(s);
  vec3 f = f0 + (f90 - f0) * base_rise(s, cos_theta);
  if ((SHADE_LOBES(s) & kLobeModel) != 0 && s.model.fresnel == kFresnelSphericalGaussian) {
    f = fresnel_spherical_gaussian(f0, cos_theta);
  }
  if ((SHADE_LOBES(s) & kLobeIridescence) == 0) return f;
  return s.iridescence > 0.0f ? mix(f, terms_film(s, cos_theta, f0), s.iridescence) : f;
}

SHADE_FN vec3 terms_fresnel_metal(SHADE_IN(Surface) s, float cos_theta) {
  vec3 f0 = s.film_f0_metal;
  vec3 f = f0 + (vec3(1.0f) - f0) * schlick_weight(cos_theta);
  if ((SHADE_LOBES(s) & kLobeModel) != 0 && s.model.fresnel == kFresnelSphericalGaussian) {
    f = fresnel_spherical_gaussian(f0, cos_theta);
  }
  if (s.has_f82_tint) f = fresnel_f82(f0, s.f82_tint, cos_theta);
  if ((SHADE_LOBES(s) & kLobeConductor) != 0)
    f = min(fresnel_conductor3(cos_theta, s.conductor_n, s.conductor_k), vec3(1.0f));
  if ((SHADE_LOBES(s) & kLobeIridescence) == 0) return f;
  return s.iridescence > 0.0f ? mix(f, terms_film_metal(s, cos_theta), s.iridescence) : f;
}

/// Of both opaque materials, weighted.
SHADE_FN vec3 terms_fresnel_opaque(SHADE_IN(Surface) s, float cos_theta) {
  if ((SHADE_LOBES(s) & kLobesOfFresnel) == 0) return base_fresnel(s, cos_theta);
  vec3 f = vec3(0.0f);
  if (s.weight_dielectric > 0.0f) f += s.weight_dielectric * terms_fresnel_dielectric(s, cos_theta);
  if (s.weight_metal > 0.0f) f += s.weight_metal * terms_fresnel_metal(s, cos_theta);
  return f;
}

/// D·V, both directions above.
SHADE_FN float terms_dv(SHADE_IN(Surface) s, vec3 wo, vec3 wi, vec3 wm) {
  if ((SHADE_LOBES(s) & kLobeModel) == 0) {
    if ((SHADE_LOBES(s) & kLobeAnisotropy) != 0) {
      return ggx_d_aniso(wm, s.alpha_x, s.alpha_y) * ggx_v_smith_aniso(wo, wi, s.alpha_x, s.alpha_y);
    }
    return ggx_d(wm, s.alpha) * ggx_v_smith(wo, wi, s.alpha);
  }
  ShadingModel m = s.model;
  if (m.blend == kBlendPhong) {
    // (NoH)^n / π: neither normalised nor over a microfacet denominator.
    return pow(max(wm.z, 0.0f), blinn_phong_exponent(s.alpha)) * (1.0f / kShadePi);
  }
  float d = ggx_d_aniso(wm, s.alpha_x, s.alpha_y);
  if (m.distribution == kDistributionBeckmann) d = beckmann_d(wm, s.alpha);
  if (m.distribution == kDistributionBlinnPhong) d = blinn_phong_d(wm, s.alpha);
  if (m.distribution == kDistributionCharlie) d = charlie_d(wm, s.alpha);
  float v = ggx_v_smith_aniso(wo, wi, s.alpha_x, s.alpha_y);
  if (m.masking == kMaskingSmithSeparable) v = v_smith_separable(wo, wi, s.alpha);
  if (m.masking == kMaskingSchlickDirect) v = v_schlick_ggx(wo, wi, schlick_k_direct(s.roughness));
  if (m.masking == kMaskingSchlickIbl) v = v_schlick_ggx(wo, wi, schlick_k_ibl(s.roughness));
  if (m.masking == kMaskingBeckmannRational) v = v_beckmann_rational(wo, wi, s.alpha);
  if (m.masking == kMaskingCharlie) v = charlie_v(wo, wi, s.alpha);
  return d * v;
}

/// Density of terms_sample_visible's mirror direction: of GGX's facets, whatever D is asked for.
SHADE_FN float terms_pdf_visible(SHADE_IN(Surface) s, vec3 wo, vec3 wm) {
  if ((SHADE_LOBES(s) & kLobeAnisotropy) == 0) return ggx_pdf_visible(wo, wm, s.alpha);
  return ggx_pdf_visible_aniso(wo, wm, s.alpha_x, s.alpha_y);
}

SHADE_FN vec3 terms_sample_visible(SHADE_IN(Surface) s, vec3 wo, vec2 u) {
  if ((SHADE_LOBES(s) & kLobeAnisotropy) == 0) return ggx_sample_visible(wo, s.alpha, u);
  return ggx_sample_visible_aniso(wo, s.alpha_x, s.alpha_y, u);
}

/// The diffuse layer alone, of albedo 1: 1/π for Lambert. The rough ones take the surface's roughness.
SHADE_FN vec3 terms_diffuse_shape(SHADE_IN(Surface) s, vec3 albedo, vec3 wo, vec3 wi, float cos_m) {
  if ((SHADE_LOBES(s) & kLobeModel) == 0 || s.model.diffuse == kDiffuseLambert) return lambert_f(albedo);
  if (s.model.diffuse == kDiffuseBurley) return burley_renormalised_f(albedo, s.roughness, wi.z, wo.z, cos_m);
  if (s.model.diffuse == kDiffuseOrenNayar) return oren_nayar_f(albedo, 0.5f * kShadePi * s.roughness, wo, wi);
  return eon_f(albedo, s.roughness, wo, wi);
}

SHADE_END

#endif
