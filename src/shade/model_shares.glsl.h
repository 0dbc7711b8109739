#ifndef CANDELA_SHADE_MODEL_SHARES_GLSL_H
#define CANDELA_SHADE_MODEL_SHARES_GLSL_H

#include "shade/layers_above.glsl.h"

// What surfaces by the terms of other models return of light that is the same from everywhere.

SHADE_BEGIN

/// Points that the terms of other models are summed over: a lattice of Fibonacci, whose sums over both axes of the
/// square converge fastest (Niederreiter 1992, "Random Number Generation and Quasi-Monte Carlo Methods", 5.1). The sums
/// are within 1.5 % from roughness 0.3 on.
SHADE_CONST int kModelPoints = 55;

SHADE_FN vec2 model_point(int i) {
  return vec2(fract((34.0f * float(i) + 0.5f) * (1.0f / float(kModelPoints))),
              (float(i) + 0.5f) * (1.0f / float(kModelPoints)));
}

/// The tables know the default terms of facets; of others what they reflect at once is the sum of their values.
SHADE_FN vec3 model_specular(SHADE_IN(Surface) s, vec3 wo) {
  vec3 mirrored = vec3(-wo.x, -wo.y, wo.z);
  if (s.is_mirror) return terms_fresnel_opaque(s, wo.z) * layers_over(s, layers_at(s, mirrored));
  bool is_wide = s.model.distribution == kDistributionCharlie;
  vec3 sum = vec3(0.0f);
  for (int i = 0; i < SHADE_TIMES(kModelPoints); ++i) {
    vec2 u = model_point(i);
    vec3 wi = is_wide ? uniform_hemisphere_sample(u) : microfacet_reflect(wo, terms_sample_visible(s, wo, u));
    if (wi.z <= 0.0f) continue;
    vec3 wm = wo + wi;
    float cos_m = 0.5f * length(wm);
    wm = wm * (0.5f / cos_m);
    float density = is_wide ? 0.5f / kShadePi : terms_pdf_visible(s, wo, wm);
    float value = terms_dv(s, wo, wi, wm) * layers_over(s, layers_at(s, wi)) * wi.z;
    sum += terms_fresnel_opaque(s, cos_m) * (value / density);
  }
  return sum * (1.0f / float(kModelPoints));
}

SHADE_FN vec3 model_diffuse(SHADE_IN(Surface) s, vec3 wo) {
  vec3 sum = vec3(0.0f);
  for (int i = 0; i < SHADE_TIMES(kModelPoints); ++i) {
    vec3 wi = cosine_sample(model_point(i));
    if (wi.z <= 0.0f) continue;
    float cos_m = 0.5f * length(wo + wi);
    vec2 ab = anisotropy_ggx(s, wi, s.curve);
    sum +=
        terms_diffuse_shape(s, s.diffuse, wo, wi, cos_m) * layers_diffuse_share(s, wo, wi, cos_m, layers_at(s, wi), ab);
  }
  return sum * (kShadePi / float(kModelPoints));
}

SHADE_FN vec3 model_sheen(SHADE_IN(Surface) s, vec3 wo) {
  vec3 sum = vec3(0.0f);
  for (int i = 0; i < SHADE_TIMES(kModelPoints); ++i) {
    vec3 wi = uniform_hemisphere_sample(model_point(i));
    if (wi.z <= 0.0f) continue;
    LayersAt at = layers_at(s, wi);
    sum += s.is_sheen_on_top ? sheen_eval_on_top(s, wo, wi, at.sheen_scale)
                             : sheen_eval(s, wo, wi, layers_below_coat(s, at), at.sheen_scale);
  }
  return sum * (2.0f * kShadePi / float(kModelPoints));
}

SHADE_END

#endif
