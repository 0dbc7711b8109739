#ifndef CANDELA_SHADE_SURFACE_LAYERS_GLSL_H
#define CANDELA_SHADE_SURFACE_LAYERS_GLSL_H

#include "shade/lobe_anisotropy.glsl.h"
#include "shade/lobe_clearcoat.glsl.h"
#include "shade/lobe_conductor.glsl.h"
#include "shade/lobe_diffuse_roughness.glsl.h"
#include "shade/lobe_diffuse_transmission.glsl.h"
#include "shade/lobe_edge_color.glsl.h"
#include "shade/lobe_fuzz.glsl.h"
#include "shade/lobe_iridescence.glsl.h"
#include "shade/lobe_retroreflection.glsl.h"
#include "shade/lobe_sheen.glsl.h"
#include "shade/lobe_transmission.glsl.h"
#include "shade/model_shares.glsl.h"

// The base with what may lie above and below it:
//
//     fuzz ─ coat ─ sheen ─ base = metallic · metal + (1 - metallic) · (transmission · glass + (1 - transmission) ·
//     opaque)
//
// Every weight mixes whole BSDFs, each of which keeps energy by itself. Here is their order; what each is, is in its
// own file: lobe_….glsl.h, and layers_above.glsl.h for how those above dim those below.

SHADE_BEGIN

// ----- preparation

/// Matter: colours, films, widths. Between base_matter and base_energy.
SHADE_APART SHADE_FN void layers_matter(SHADE_IN(SurfaceParams) p, SHADE_INOUT(Surface) s) {
  s.model = p.model;
  bool has_index = (SHADE_LOBES(p) & kLobeModel) == 0 || shading_model_has_index(p.model);
  if (!has_index) base_rises_by_schlick(s);
  // KHR_materials_specular's colour, which glTF leaves unused for metals.
  s.has_f82_tint = (SHADE_LOBES(p) & kLobeModel) != 0 && p.model.fresnel == kFresnelF82;
  s.f82_tint = min(p.specular_color, vec3(1.0f));
  s.f90_tint = vec3(1.0f);
  coat_matter(has_index, s);
  sheen_matter(s);
  iridescence_matter(p, s);
  anisotropy_matter(p, s);
  conductor_matter(p, s);
  rough_diffuse_matter(p, s);
  retro_matter(p, s);
  glass_matter(p, s);
  below_matter(p, s);
  edge_matter(p, s);
  iridescence_matter_on_top(p, s);
}

/// How the lobes share the samples, by what each is estimated to reflect.
SHADE_FN void layers_chances(vec3 wo, SHADE_INOUT(Surface) s) {
  float specular = shade_max3(s.single_albedo_o);
  float lost = kShadePi * s.escape_mean * s.escape_o;
  float diffuse = shade_max3(s.diffuse) * s.transmission_o + shade_max3(s.multiscatter) * lost;
  float below = shade_max3(s.diffuse_below) * s.transmission_o;
  float glass = s.weight_glass;
  if (glass > 0.0f && s.glass_escape_o > 0.0f) {
    // What single scattering loses comes back on either side.
    float share = s.glass_escape_o * s.weight_glass;
    glass -= share;
    diffuse += share * s.glass_reflected;
    below += share * (1.0f - s.glass_reflected) * shade_max3(s.glass_tint);
  }
  float through = layers_through(s, s.coat_albedo_o, s.sheen_albedo_o);
  float sheen = sheen_estimate(s);
  float coat = coat_estimate(s, wo);
  if (coat * s.coat_multiscatter > 0.0f) diffuse += s.coat * s.coat_escape_share * s.coat_escape_o;
  if (s.model.distribution == kDistributionCharlie) {
    diffuse += specular;
    specular = 0.0f;
  }
  specular *= through;
  glass *= through;
  float total = specular + diffuse + below + glass + sheen + coat;
  // A twentieth at least for whatever exists.
  float least = 0.05f * total;
  s.chance_specular = specular > 0.0f ? max(specular, least) : 0.0f;
  s.chance_diffuse = diffuse > 0.0f ? max(diffuse, least) : 0.0f;
  s.chance_diffuse_below = below > 0.0f ? max(below, least) : 0.0f;
  s.chance_glass = glass > 0.0f ? max(glass, least) : 0.0f;
  s.chance_sheen = sheen > 0.0f ? max(sheen, least) : 0.0f;
  s.chance_coat = coat > 0.0f ? max(coat, least) : 0.0f;
  float sum =
      s.chance_specular + s.chance_diffuse + s.chance_diffuse_below + s.chance_glass + s.chance_sheen + s.chance_coat;
  float scale = sum > 0.0f ? 1.0f / sum : 0.0f;
  s.chance_specular *= scale;
  s.chance_diffuse *= scale;
  s.chance_diffuse_below *= scale;
  s.chance_glass *= scale;
  s.chance_sheen *= scale;
  s.chance_coat *= scale;
}

/// After base_energy: the layers, and with them the shares of light and samples.
SHADE_APART SHADE_FN void layers_prepare(SHADE_IN(SurfaceParams) p, vec3 wo, vec2 ab, vec2 mean,
                                         SHADE_INOUT(Surface) s) {
  if (!s.model.multiscatter) s.multiscatter = vec3(0.0f);
  edge_prepare(p, wo, ab, mean, s);
  s.film_below_o = vec3(1.0f);
  if (s.has_film_below) iridescence_prepare(wo, ab, mean, s);
  if ((SHADE_LOBES(s) & kLobeClearcoat) != 0) coat_prepare(p, wo, s);
  if ((SHADE_LOBES(s) & kLobeSheen) != 0) sheen_prepare(p, s);
  if ((SHADE_LOBES(s) & kLobeFuzz) != 0) fuzz_prepare(p, s);
  glass_prepare(wo, s);
  rough_diffuse_prepare(ab, mean, s);

  LayersAt at = layers_at(s, wo);
  s.coat_albedo_o = at.coat.albedo;
  s.sheen_albedo_o = at.sheen.albedo;
  s.sheen_scale_o = at.sheen_scale;
  s.coat_over_o = at.coat.over.x;
  s.sheen_over_o = at.sheen.over.x;
  if (s.is_sheen_on_top && s.coat > 0.0f) s.sheen_over_coat_o = sheen_over_coat(s, wo);
  if (s.model.literal_layers) {
    // KHR_materials_clearcoat and _sheen as printed: by the view alone.
    s.coat_over_o = 1.0f - s.coat * coat_fresnel(s, coat_cosine(s, wo));
    s.sheen_over_o = 1.0f - s.sheen_weight * at.sheen.albedo;
  } else if ((SHADE_LOBES(s) & (kLobesOfFibres | kLobeClearcoat)) != 0) {
    s.transmission_o = layers_transmission(s, at, ab, wo.z, anisotropy_row_along(s, wo));
    s.diffuse_scale = 1.0f / max(layers_transmission_mean(s), 1e-6f);
  }
  layers_chances(wo, s);
}

SHADE_FN bool layers_is_delta(SHADE_IN(Surface) s) {
  bool is_base_delta = s.chance_diffuse <= 0.0f && (s.chance_specular <= 0.0f || s.is_mirror);
  return is_base_delta && below_is_delta(s) && sheen_is_delta(s) && glass_is_delta(s) && coat_is_delta(s);
}

SHADE_FN bool layers_scatters_through(SHADE_IN(Surface) s) { return !below_is_delta(s) || !glass_is_delta(s); }

// ----- evaluation

SHADE_APART SHADE_FN SurfaceEval layers_eval_above(SHADE_IN(Surface) s, vec3 wo, vec3 wi, LayersAt at) {
  SurfaceEval r;
  vec3 wm = wo + wi;
  float cos_m = 0.5f * length(wm);
  wm = wm * (0.5f / cos_m);
  vec2 ab = anisotropy_ggx(s, wi, s.curve);
  float escape = base_escape(ab);
  float over = layers_over(s, at);

  // ----- diffuse, and what scatters many times between facets
  vec3 lost = s.multiscatter * (s.escape_o * escape);
  r.pdf = s.chance_diffuse * cosine_pdf(wi.z);
  r.value = lost * over;
  if (s.weight_glass > 0.0f) r.value += glass_multireflected(s, wi, escape) * over;
  vec3 diffuse;
  if (s.diffuse_roughness > 0.0f) {
    diffuse = lambert_f(s.diffuse) * rough_diffuse_gain(s, s.diffuse_color, wo, wi, ab);
  } else {
    diffuse = terms_diffuse_shape(s, s.diffuse, wo, wi, cos_m);
  }
  r.value += diffuse * layers_diffuse_share(s, wo, wi, cos_m, at, ab);

  // ----- facets
  if (!s.is_mirror) {
    float density = terms_pdf_visible(s, wo, wm);
    float straight = 1.0f - s.retroreflection;
    vec3 f = terms_fresnel_opaque(s, cos_m) * straight;
    r.pdf += s.chance_specular * straight * density;
    if (s.weight_glass > 0.0f && !s.is_glass_delta) {
      SurfaceEval glass = glass_facets(s, cos_m, density);
      f += glass.value;
      r.pdf += glass.pdf;
    }
    r.value += f * (terms_dv(s, wo, wi, wm) * over);
    if (s.retroreflection > 0.0f) {
      SurfaceEval turned = retro_facets(s, wo, wi);
      r.value += turned.value * over;
      r.pdf += turned.pdf;
    }
  }
  r.value = r.value * wi.z;

  // ----- layers
  if (s.sheen_weight > 0.0f && !s.is_sheen_on_top) {
    r.value += sheen_eval(s, wo, wi, layers_below_coat(s, at), at.sheen_scale);
  }
  if (s.sheen_weight > 0.0f) r.pdf += s.chance_sheen * kSheenPdf;
  if (s.coat > 0.0f) {
    r.value = r.value * coat_filter(s, coat_cosine(s, wi));
    SurfaceEval coat = coat_eval(s, wo, wi);
    r.value += coat.value * sheen_over_coat_both(s, wi);
    r.pdf += s.chance_coat * coat.pdf;
  }
  if (s.is_sheen_on_top) r.value += sheen_eval_on_top(s, wo, wi, at.sheen_scale);
  return r;
}

SHADE_APART SHADE_FN SurfaceEval layers_eval_below(SHADE_IN(Surface) s, vec3 wo, vec3 wi, LayersAt at) {
  vec2 ab = anisotropy_ggx(s, wi, s.curve);
  SurfaceEval r = below_eval(s, wi, at, ab);
  if (s.diffuse_roughness > 0.0f) {
    r.value = r.value * rough_diffuse_gain(s, s.diffuse_below_color, wo, vec3(wi.x, wi.y, -wi.z), ab);
  }
  if (s.weight_glass > 0.0f && !s.is_glass_delta) glass_add_below(s, wo, wi, ab, layers_across(s, at), r);
  r.value = r.value * coat_filter(s, coat_cosine(s, wi));
  return r;
}

SHADE_APART SHADE_FN SurfaceEval layers_eval(SHADE_IN(Surface) s, vec3 wo, vec3 wi) {
  SurfaceEval r;
  r.value = vec3(0.0f);
  r.pdf = 0.0f;
  if (wo.z <= 0.0f || wi.z == 0.0f) return r;
  bool is_below = wi.z < 0.0f;
  if (is_below && (SHADE_LOBES(s) & (kLobeTransmission | kLobeDiffuseTransmission)) == 0) return r;
  LayersAt at = layers_at(s, wi);
  if ((SHADE_LOBES(s) & (kLobeTransmission | kLobeDiffuseTransmission)) != 0) {
    if (is_below) return layers_eval_below(s, wo, wi, at);
  }
  return layers_eval_above(s, wo, wi, at);
}

// ----- sampling

SHADE_APART SHADE_FN SurfaceSample layers_sample(SHADE_IN(Surface) s, vec3 wo, vec3 u) {
  SurfaceSample r = surface_no_sample(wo);
  vec2 u2 = vec2(u.x, u.y);
  vec3 wi = vec3(0.0f);
  float at = s.chance_specular;
  if (u.z < at) {
    bool is_turned = u.z < at * s.retroreflection;
    if (s.is_mirror) {
      float share = retro_mirror_share(s, wo, is_turned);
      if (is_turned) r.wi = wo;
      r.is_delta = true;
      r.pdf = s.chance_specular * share;
      r.weight = terms_fresnel_opaque(s, wo.z) * (share * layers_over(s, layers_at(s, r.wi)) / r.pdf);
      r.weight = r.weight * coat_filter(s, coat_cosine(s, r.wi));
      return r;
    }
    wi = microfacet_reflect(wo, terms_sample_visible(s, wo, u2));
    if (wi.z <= 0.0f) return r;
    if (is_turned) wi = retro_turned(wi);
  } else if (u.z < at + s.chance_glass) {
    float u_side = (u.z - at) / s.chance_glass;
    if (s.is_glass_delta) {
      r = glass_sample_delta(s, wo, u_side);
      r.weight = r.weight * coat_filter(s, coat_cosine(s, r.wi));
      return r;
    }
    wi = glass_direction(s, wo, u2, u_side);
  } else if (u.z < at + s.chance_glass + s.chance_coat) {
    if (s.is_coat_mirror) {
      r = coat_sample_delta(s, wo);
      r.weight = r.weight * sheen_over_coat_both(s, r.wi);
      return r;
    }
    wi = coat_direction(s, wo, u2);
    if (wi.z <= 0.0f) return r;
  } else if (u.z < at + s.chance_glass + s.chance_coat + s.chance_sheen) {
    wi = uniform_hemisphere_sample(u2);
  } else if (u.z < at + s.chance_glass + s.chance_coat + s.chance_sheen + s.chance_diffuse_below) {
    wi = below_direction(u2);
  } else {
    wi = cosine_sample(u2);
  }
  if (wi.z == 0.0f) return r;
  SurfaceEval e = layers_eval(s, wo, wi);
  if (e.pdf > 0.0f) {
    r.wi = wi;
    r.weight = e.value * (1.0f / e.pdf);
    r.pdf = e.pdf;
  }
  return r;
}

/// What passes straight through a smooth sheet.
SHADE_APART SHADE_FN vec3 layers_straight(SHADE_IN(Surface) s, vec3 wo) {
  return glass_straight(s, wo) * coat_filter_mirrored(s);
}

/// What is left of emission on its way out through the layers above the base.
SHADE_FN vec3 layers_emission_scale(SHADE_IN(Surface) s) {
  return coat_filter_out(s) * ((1.0f - s.coat * s.coat_albedo_o) * (1.0f - s.sheen_weight * s.sheen_albedo_o));
}

/// Estimated albedo of everything; `specular` that of the base's facets.
SHADE_APART SHADE_FN vec3 layers_albedo(SHADE_IN(Surface) s, vec3 specular) {
  float through = layers_through(s, s.coat_albedo_o, s.sheen_albedo_o);
  vec3 below = (s.diffuse + s.diffuse_below) * s.film_below_o * s.transmission_o +
               (specular + s.glass_tint * s.weight_glass) * through;
  if (s.is_sheen_on_top) {
    return below * coat_filter_mirrored(s) + coat_share(s) * sheen_over_coat_share(s) + sheen_share(s);
  }
  return (below + sheen_share(s)) * coat_filter_mirrored(s) + coat_share(s);
}

// ----- light that is the same from everywhere

/// The mean cosine of what a diffuse surface gets.
SHADE_CONST float kMeanCosine = 2.0f / 3.0f;

SHADE_APART SHADE_FN void layers_shares(SHADE_IN(Surface) s, vec3 wo, SHADE_INOUT(SurfaceShares) r) {
  float over = layers_through(s, s.coat_albedo_o, s.sheen_albedo_o);
  vec2 ab = anisotropy_ggx(s, wo, s.curve);
  vec3 specular = s.single_albedo_o;
  // The tables know a film at normal incidence; here it has the colour of this angle.
  if (s.iridescence > 0.0f) specular = terms_fresnel_opaque(s, wo.z) * (ab.x + ab.y);
  r.specular = specular * over;
  r.spread = r.spread * over;
  r.diffuse = s.diffuse * s.film_below_o * s.transmission_o * rough_diffuse_albedo(s, s.diffuse_color, wo.z);
  r.below = below_share(s) * rough_diffuse_albedo(s, s.diffuse_below_color, wo.z);
  r.sheen = sheen_share(s);
  if (!s.is_sheen_on_top) r.sheen = r.sheen * (1.0f - s.coat * s.coat_albedo_o);
  r.coat = coat_share(s) * sheen_over_coat_share(s);
  if (s.coat > 0.0f) r.coat_rise = base_share_of_rise(s.coat_f0 * (1.0f - s.coat_escape_o), s.coat_albedo_o);
#ifndef SHADE_DEFAULT_MODEL
  if ((SHADE_LOBES(s) & kLobeModel) != 0) {
    r.specular = model_specular(s, wo);
    r.diffuse = model_diffuse(s, wo);
    if (s.sheen_weight > 0.0f) r.sheen = model_sheen(s, wo);
  }
#endif
  glass_shares(s, wo, ab, over, r);
  // Mirrored light crosses the coat as what is seen does, diffuse light at some mean.
  vec3 mirrored = coat_filter_mirrored(s);
  vec3 spread = coat_filter(s, kMeanCosine);
  r.specular = r.specular * mirrored;
  r.glass = r.glass * mirrored;
  r.through = r.through * mirrored;
  r.spread = r.spread * spread;
  r.diffuse = r.diffuse * spread;
  r.below = r.below * spread;
  if (!s.is_sheen_on_top) r.sheen = r.sheen * spread;
}

SHADE_END

#endif
