#ifndef CANDELA_SHADE_DISPERSION_GLSL_H
#define CANDELA_SHADE_DISPERSION_GLSL_H

#include "shade/shim.glsl.h"

SHADE_BEGIN

/// Index of refraction at a wavelength; `n_d` holds at 587.6 nm, `dispersion` = 20 / Abbe number ≥ 0. Cauchy's first
/// two terms as KHR_materials_dispersion has them, never below 1: n(486.1 nm) - n(656.3 nm) = (n_d - 1) / V_d.
SHADE_FN float dispersion_ior(float n_d, float dispersion, float wavelength_nm) {
  float per_abbe = dispersion / 20.0f;
  return max(n_d + (n_d - 1.0f) * per_abbe * (523655.0f / (wavelength_nm * wavelength_nm) - 1.5168f), 1.0f);
}

/// One index for each channel of linear Rec.709, of what draws no spectrum: at the wavelength whose 1/λ², and so whose
/// index, is the mean over the sensitivities below.
SHADE_FN vec3 dispersion_channel_ior(float n_d, float dispersion) {
  return vec3(dispersion_ior(n_d, dispersion, 591.9f), dispersion_ior(n_d, dispersion, 536.7f),
              dispersion_ior(n_d, dispersion, 451.9f));
}

// One wavelength for a path that has met dispersion. The channels of linear Rec.709 are integrals of the spectrum with
// the sensitivities w_r, w_g, w_b ≥ 0, ∫ w dλ = 1, so that white stays white: L_c = ∫ w_c(λ) L_c(λ) dλ. They are the
// CIE 1931 observer times D65 in Rec.709, cut at 0 and scaled, and then written as a sum of logistic densities, which
// have a closed form for the integral and for its inverse; the fit is off by 1.6 % of the peak (rms).
// docs/theory/dispersion.md.

SHADE_CONST float kWavelengthMinNm = 360.0f;
SHADE_CONST float kWavelengthMaxNm = 830.0f;

/// Lobe i of five: centre and scale in nm, and its share of each channel. Shares of a channel sum to 1.
struct WavelengthLobe {
  float center;
  float scale;
  vec3 share;
};

SHADE_CONST int kWavelengthLobes = 5;

SHADE_FN WavelengthLobe wavelength_lobe(int i) {
  WavelengthLobe l;
  l.center = 437.91f;
  l.scale = 8.405f;
  l.share = vec3(0.04253f, 0.0f, 0.29075f);
  if (i == 1) {
    l.center = 459.76f;
    l.scale = 11.534f;
    l.share = vec3(0.0f, 0.0f, 0.70925f);
  }
  if (i == 2) {
    l.center = 527.76f;
    l.scale = 14.619f;
    l.share = vec3(0.0f, 0.66139f, 0.0f);
  }
  if (i == 3) {
    l.center = 561.63f;
    l.scale = 12.058f;
    l.share = vec3(0.0f, 0.33861f, 0.0f);
  }
  if (i == 4) {
    l.center = 605.34f;
    l.scale = 16.215f;
    l.share = vec3(0.95747f, 0.0f, 0.0f);
  }
  return l;
}

SHADE_FN float wavelength_lobe_chance(WavelengthLobe l) { return (l.share.x + l.share.y + l.share.z) / 3.0f; }

/// The logistic function, integral of the logistic density. No overflow for finite x.
SHADE_FN float wavelength_logistic(float x) {
  float e = exp(-abs(x));
  return (x < 0.0f ? e : 1.0f) / (1.0f + e);
}

/// Density of a lobe at a wavelength, with integral 1 from 360 to 830 nm.
SHADE_FN float wavelength_lobe_pdf(WavelengthLobe l, float wavelength_nm) {
  float e = exp(-abs(wavelength_nm - l.center) / l.scale);
  float inside = wavelength_logistic((kWavelengthMaxNm - l.center) / l.scale) -
                 wavelength_logistic((kWavelengthMinNm - l.center) / l.scale);
  return e / (shade_sqr(1.0f + e) * l.scale * inside);
}

/// The sensitivities w_c, per nm; 0 outside 360-830 nm.
SHADE_FN vec3 wavelength_sensitivity(float wavelength_nm) {
  vec3 w = vec3(0.0f);
  if (wavelength_nm < kWavelengthMinNm || wavelength_nm > kWavelengthMaxNm) return w;
  for (int i = 0; i < kWavelengthLobes; ++i) {
    WavelengthLobe l = wavelength_lobe(i);
    w += l.share * wavelength_lobe_pdf(l, wavelength_nm);
  }
  return w;
}

/// Density of wavelength_sample, per nm: the mean of the three sensitivities.
SHADE_FN float wavelength_pdf(float wavelength_nm) {
  vec3 w = wavelength_sensitivity(wavelength_nm);
  return (w.x + w.y + w.z) / 3.0f;
}

/// A wavelength in nm for u in [0, 1): u chooses a lobe, what is left of it the place in the lobe.
SHADE_FN float wavelength_sample(float u) {
  int chosen = kWavelengthLobes - 1;
  float below = 0.0f;
  float sum = 0.0f;
  for (int i = 0; i < kWavelengthLobes - 1; ++i) {
    float chance = wavelength_lobe_chance(wavelength_lobe(i));
    if (chosen == kWavelengthLobes - 1) {
      below = sum;
      if (u < sum + chance) chosen = i;
    }
    sum += chance;
  }
  if (chosen == kWavelengthLobes - 1) below = sum;
  WavelengthLobe l = wavelength_lobe(chosen);
  float v = shade_saturate((u - below) / wavelength_lobe_chance(l));
  float first = wavelength_logistic((kWavelengthMinNm - l.center) / l.scale);
  float beyond = wavelength_logistic((l.center - kWavelengthMaxNm) / l.scale);  // 1 - the value at the end, exactly
  float t = mix(first, 1.0f - beyond, v);
  float rest = mix(1.0f - first, beyond, v);
  return clamp(l.center + l.scale * log(t / rest), kWavelengthMinNm, kWavelengthMaxNm);
}

/// w_c / pdf: what a path of this wavelength carries in each channel. The three sum to 3, so each is in [0, 3].
SHADE_FN vec3 wavelength_weight(float wavelength_nm) {
  vec3 w = wavelength_sensitivity(wavelength_nm);
  return w * (3.0f / max(w.x + w.y + w.z, 1e-30f));
}

SHADE_END

#endif
