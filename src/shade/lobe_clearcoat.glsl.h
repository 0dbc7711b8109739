#ifndef CANDELA_SHADE_LOBE_CLEARCOAT_GLSL_H
#define CANDELA_SHADE_LOBE_CLEARCOAT_GLSL_H

#include "shade/lobe_anisotropy.glsl.h"

// KHR_materials_clearcoat: a clear boundary of its own normal above everything else.

SHADE_BEGIN

/// No coat; of one, the curve of its reflectance.
SHADE_FN void coat_matter(bool has_index, SHADE_INOUT(Surface) s) {
  s.coat_curve = table_curve_at(has_index ? kTableCurveOfGlass : 0);
  s.coat_index = has_index ? kCoatIndex : 0.0f;
  s.coat_f0 = kCoatF0;
  s.is_coat_clear = true;
  s.coat_strength = 1.0f;
  s.coat = 0.0f;
  s.coat_normal = vec3(0.0f, 0.0f, 1.0f);
  s.coat_tangent = vec3(1.0f, 0.0f, 0.0f);
  s.coat_multiscatter = 0.0f;
}

SHADE_FN float coat_fresnel(SHADE_IN(Surface) s, float cos_theta) {
  if (s.coat_index > 0.0f) return fresnel_dielectric(cos_theta, s.coat_index);
  return s.coat_f0 + (1.0f - s.coat_f0) * schlick_weight(cos_theta);
}

SHADE_FN float coat_cosine(SHADE_IN(Surface) s, vec3 w) { return abs(dot(s.coat_normal, w)); }

// ----- in its own frame

SHADE_FN vec3 coat_to_local(SHADE_IN(Surface) s, vec3 w) { return shade_to_local(s.coat_normal, s.coat_tangent, w); }

SHADE_FN vec3 coat_from_local(SHADE_IN(Surface) s, vec3 w) {
  return shade_from_local(s.coat_normal, s.coat_tangent, w);
}

/// Its split-sum terms at w.
SHADE_FN vec2 coat_ggx(SHADE_IN(Surface) s, vec3 w) {
  if ((SHADE_LOBES(s) & kLobeCoatAnisotropy) != 0) return streak_ggx(s.coat_widths, coat_to_local(s, w), s.coat_curve);
  return table_ggx_curve(coat_cosine(s, w), s.coat_row, s.coat_curve);
}

/// What single scattering between white facets loses at w. Of streaks as the table has it: 1 - A - B would leave three
/// digits of what is little, and others for either direction.
SHADE_APART SHADE_FN float coat_escape(SHADE_IN(Surface) s, vec3 w) {
  if ((SHADE_LOBES(s) & kLobeCoatAnisotropy) == 0) return base_escape(coat_ggx(s, w));
  vec3 l = coat_to_local(s, w);
  float along = streak_roughness_along(s.coat_widths, l);
  float e = table_anisotropic(abs(l.z), along, sqrt(s.coat_widths.x), sqrt(s.coat_widths.y)).x;
  return e > 1e-5f ? e : 0.0f;
}

/// Their cosine-weighted means.
SHADE_FN vec2 coat_ggx_mean(SHADE_IN(Surface) s) {
  if ((SHADE_LOBES(s) & kLobeCoatAnisotropy) != 0) return streak_ggx_mean(s.coat_widths, s.coat_curve);
  return table_ggx_curve_mean(s.coat_row, s.coat_curve);
}

/// At a direction where its split-sum terms are `ab`, at weight 1.
SHADE_FN float coat_albedo(SHADE_IN(Surface) s, vec2 ab) {
  return s.coat_f0 * ab.x + ab.y + s.coat_escape_share * (1.0f - ab.x - ab.y);
}

/// KHR_materials_clearcoat_anisotropy: as KHR_materials_anisotropy has it for the base. What lies below sees a coat of
/// the mean width.
SHADE_FN void coat_prepare_anisotropy(SHADE_IN(SurfaceParams) p, SHADE_INOUT(Surface) s) {
  s.coat_widths = vec2(s.coat_alpha);
  if ((SHADE_LOBES(p) & kLobeCoatAnisotropy) == 0) return;
  vec3 t = p.clearcoat_direction - s.coat_normal * dot(s.coat_normal, p.clearcoat_direction);
  float t2 = dot(t, t);
  if (t2 > 1e-12f) s.coat_tangent = t * inversesqrt(t2);
  s.coat_widths =
      max(vec2(mix(s.coat_alpha, 1.0f, shade_sqr(p.clearcoat_anisotropy)), s.coat_alpha), vec2(kGgxMirrorAlpha));
  s.coat_alpha = s.coat_widths.y;
  s.is_coat_mirror = s.is_coat_mirror && p.clearcoat_anisotropy <= 0.0f;
  s.coat_roughness = sqrt(sqrt(s.coat_widths.x * s.coat_widths.y));
}

/// KHR_materials_clearcoat_ior. 0 is a coat that reflects everything.
SHADE_FN void coat_prepare_index(float ior, SHADE_INOUT(Surface) s) {
  if (ior == kCoatIndex) return;
  s.coat_f0 = ior == 0.0f ? 1.0f : f0_from_eta(ior);
  if (s.coat_index <= 0.0f || ior == 0.0f) {
    s.coat_index = 0.0f;
    s.coat_curve = table_curve_schlick();
  } else {
    s.coat_index = min(ior, kTableMostIndex);
    s.coat_curve = table_curve(s.coat_index);
  }
  // How far what the tables say of the lobe below counts: a fit to white furnaces, of indices 1 to 3 within 1 %.
  float mean = s.coat_f0 + (1.0f - s.coat_f0) * table_rise(s.coat_curve);
  float known = kCoatF0 + (1.0f - kCoatF0) * table_rise(table_curve_at(kTableCurveOfGlass));
  float strength = mean / known;
  s.coat_strength = strength < 1.0f ? pow(strength, 0.28f) : pow(strength, -0.15f);
}

/// KHR_materials_clearcoat_color: what is left of light that crosses the coat at a cosine to its normal, where it goes
/// the longer a way the flatter it is bent.
SHADE_FN vec3 coat_tint(SHADE_IN(Surface) s, float mu) {
  float index = max(s.coat_index, 1.0f);
  float cos_t = sqrt(max(1.0f - (1.0f - mu * mu) / (index * index), 1e-4f));
  return pow(s.coat_color, vec3(0.5f / cos_t));
}

/// KHR_materials_clearcoat_darkening: light that comes up from below is sent back there by the coat's underside, again
/// and again; every time what lies below keeps its share. (1 - K) / (1 - E K) of the series is left, where K is what
/// the underside reflects and E the albedo below, as OpenPBR 1.1 has it ("Coat darkening"). K is taken at normal
/// incidence for smooth matter, so that it is one number for both directions.
SHADE_FN vec3 coat_darkened(SHADE_IN(SurfaceParams) p, SHADE_IN(Surface) s) {
  float index = max(s.coat_index, 1.0f);
  float f_mean = s.coat_f0 + (1.0f - s.coat_f0) * table_rise(s.coat_curve);
  float diffuse = 1.0f - (1.0f - f_mean) / (index * index);
  vec3 f0 = s.weight_dielectric * s.f0_dielectric + s.weight_metal * s.f0_metal;
  vec3 albedo = min(f0 + s.diffuse * (1.0f - s.boundary_f0), vec3(1.0f));
  float roughness = mix(mix(1.0f, s.roughness, s.boundary_f0), s.roughness, p.metallic);
  float k = min(mix(s.coat_f0, diffuse, roughness), 0.999f);
  return mix(vec3(1.0f), vec3(1.0f - k) / (vec3(1.0f) - albedo * k), p.clearcoat_darkening);
}

SHADE_FN void coat_prepare(SHADE_IN(SurfaceParams) p, vec3 wo, SHADE_INOUT(Surface) s) {
  s.coat_roughness = p.clearcoat_roughness;
  s.coat_alpha = roughness_to_alpha(p.clearcoat_roughness);
  s.is_coat_mirror = s.coat_alpha < kGgxMirrorAlpha;
  s.coat_normal = p.clearcoat_normal;
  s.coat_tangent = shade_tangent(s.coat_normal);
  coat_prepare_anisotropy(p, s);
  s.coat = p.clearcoat;
  s.coat_row = table_ggx_roughness(s.coat_roughness);
  coat_prepare_index(p.clearcoat_ior, s);
  vec2 mean = coat_ggx_mean(s);
  float escape_mean = 1.0f - mean.x - mean.y;
  float f_mean = s.coat_f0 + (1.0f - s.coat_f0) * table_walk_rise(s.coat_row, s.coat_curve);
  float share = s.model.multiscatter ? multiscatter_share(f_mean, table_walk(s.coat_row)) : 0.0f;
  s.coat_escape_share = share;
  s.coat_multiscatter = share / (kShadePi * max(escape_mean, 1e-6f));
  s.coat_escape_o = s.is_coat_mirror ? 0.0f : coat_escape(s, wo);
  s.is_coat_clear = p.clearcoat_color == vec3(1.0f) && p.clearcoat_darkening <= 0.0f;
  if (s.is_coat_clear) return;
  s.coat_color = max(p.clearcoat_color, vec3(1e-6f));
  s.coat_tint_o = coat_tint(s, coat_cosine(s, wo));
  s.coat_darkening = coat_darkened(p, s);
}

/// What colour and darkening leave of light between wo and a direction at this cosine to the coat's normal.
SHADE_FN vec3 coat_filter(SHADE_IN(Surface) s, float mu) {
  if ((SHADE_LOBES(s) & kLobeClearcoat) == 0) return vec3(1.0f);
  if (s.is_coat_clear) return vec3(1.0f);
  return mix(vec3(1.0f), s.coat_darkening * s.coat_tint_o * coat_tint(s, mu), s.coat);
}

/// Of light that leaves at wo's own cosine: mirrored, or seen straight through.
SHADE_FN vec3 coat_filter_mirrored(SHADE_IN(Surface) s) {
  if ((SHADE_LOBES(s) & kLobeClearcoat) == 0) return vec3(1.0f);
  if (s.is_coat_clear) return vec3(1.0f);
  return mix(vec3(1.0f), s.coat_darkening * s.coat_tint_o * s.coat_tint_o, s.coat);
}

/// And of light that comes from below.
SHADE_FN vec3 coat_filter_out(SHADE_IN(Surface) s) {
  if ((SHADE_LOBES(s) & kLobeClearcoat) == 0) return vec3(1.0f);
  if (s.is_coat_clear) return vec3(1.0f);
  return mix(vec3(1.0f), s.coat_tint_o, s.coat);
}

/// Where its split-sum terms are `ab`, at a cosine to the normal of a base of this roughness.
SHADE_FN LayerAt coat_at(SHADE_IN(Surface) s, vec2 ab, float mu, float roughness) {
  LayerAt at = layer_absent();
  if ((SHADE_LOBES(s) & kLobeClearcoat) == 0) return at;
  at.albedo = coat_albedo(s, ab);
  // How the base's lobe spreads is the base normal's matter; how much comes through, the coat's.
  at.over = table_coat_over(mu, roughness, s.coat_roughness, at.albedo);
  if (s.coat_strength != 1.0f) {
    float t = max(1.0f - at.albedo, 0.0f);
    vec2 bare = table_ggx_curve(mu, table_ggx_roughness(roughness), table_curve_at(kTableCurveOfGlass));
    vec3 other = table_coat_over(mu, roughness, s.coat_roughness, 0.0f);
    at.over = max(mix(vec3(1.0f, bare.x, bare.y), other, s.coat_strength), vec3(0.0f)) * vec3(sqrt(t), t, t);
  }
  return at;
}

/// What it is estimated to reflect to wo.
SHADE_FN float coat_estimate(SHADE_IN(Surface) s, vec3 wo) {
  return dot(s.coat_normal, wo) <= 1e-4f ? 0.0f : s.coat * s.coat_albedo_o;  // 0: it turns its back
}

SHADE_FN bool coat_is_delta(SHADE_IN(Surface) s) { return s.chance_coat <= 0.0f || s.is_coat_mirror; }

// ----- its facets

SHADE_FN float coat_dv(SHADE_IN(Surface) s, vec3 o, vec3 i, vec3 wm) {
  if ((SHADE_LOBES(s) & kLobeCoatAnisotropy) != 0) {
    return ggx_d_aniso(wm, s.coat_widths.x, s.coat_widths.y) *
           ggx_v_smith_aniso(o, i, s.coat_widths.x, s.coat_widths.y);
  }
  return ggx_d(wm, s.coat_alpha) * ggx_v_smith(o, i, s.coat_alpha);
}

SHADE_FN float coat_pdf_visible(SHADE_IN(Surface) s, vec3 o, vec3 wm) {
  if ((SHADE_LOBES(s) & kLobeCoatAnisotropy) != 0) {
    return ggx_pdf_visible_aniso(o, wm, s.coat_widths.x, s.coat_widths.y);
  }
  return ggx_pdf_visible(o, wm, s.coat_alpha);
}

SHADE_FN vec3 coat_sample_visible(SHADE_IN(Surface) s, vec3 o, vec2 u) {
  if ((SHADE_LOBES(s) & kLobeCoatAnisotropy) != 0) {
    return ggx_sample_visible_aniso(o, s.coat_widths.x, s.coat_widths.y, u);
  }
  return ggx_sample_visible(o, s.coat_alpha, u);
}

/// The coat: value and density.
SHADE_FN SurfaceEval coat_eval(SHADE_IN(Surface) s, vec3 wo, vec3 wi) {
  SurfaceEval r;
  r.value = vec3(0.0f);
  r.pdf = 0.0f;
  if ((SHADE_LOBES(s) & kLobeClearcoat) == 0) return r;
  vec3 o = coat_to_local(s, wo);
  vec3 i = coat_to_local(s, wi);
  if (o.z <= 0.0f || i.z <= 0.0f) return r;
  float f = s.coat_multiscatter * s.coat_escape_o * coat_escape(s, wi);
  if (!s.is_coat_mirror) {
    vec3 wm = o + i;
    float cos_m = 0.5f * length(wm);
    wm = wm * (0.5f / cos_m);
    f += coat_fresnel(s, cos_m) * coat_dv(s, o, i, wm);
    r.pdf = coat_pdf_visible(s, o, wm);
  }
  r.value = vec3(s.coat * f * i.z);
  return r;
}

/// A smooth coat's mirror direction, as a delta lobe.
SHADE_FN SurfaceSample coat_sample_delta(SHADE_IN(Surface) s, vec3 wo) {
  SurfaceSample r = surface_no_sample(wo);
  vec3 o = coat_to_local(s, wo);
  vec3 wi = coat_from_local(s, vec3(-o.x, -o.y, o.z));
  if (wi.z <= 0.0f || s.chance_coat <= 0.0f) return r;
  r.wi = wi;
  r.is_delta = true;
  r.pdf = s.chance_coat;
  // The cosine cancels, so that no other normal's enters.
  r.weight = vec3(s.coat * coat_fresnel(s, o.z) / r.pdf);
  return r;
}

/// A direction of the rough lobe.
SHADE_FN vec3 coat_direction(SHADE_IN(Surface) s, vec3 wo, vec2 u) {
  vec3 o = coat_to_local(s, wo);
  return coat_from_local(s, microfacet_reflect(o, coat_sample_visible(s, o, u)));
}

/// Of light that is the same from everywhere.
SHADE_FN vec3 coat_share(SHADE_IN(Surface) s) { return vec3(s.coat * s.coat_albedo_o); }

SHADE_END

#endif
