#ifndef CANDELA_SHADE_LOBE_TRANSMISSION_GLSL_H
#define CANDELA_SHADE_LOBE_TRANSMISSION_GLSL_H

#include "shade/layers_above.glsl.h"

// KHR_materials_transmission: the share of the dielectric that is clear, as a sheet or as the boundary of a body.

SHADE_BEGIN

/// How far the reflectance has risen from F0 (0) to F90 (1), by the exact law of a boundary with normal reflectance
/// `f0`.
SHADE_FN float glass_rise(float cos_theta, float eta, float f0) {
  return f0 < 1.0f ? shade_saturate((fresnel_dielectric(cos_theta, eta) - f0) / (1.0f - f0)) : 0.0f;
}

/// Of a transparent boundary, at the cosine on its rarer side: the exact law between F0 and F90.
SHADE_FN vec3 glass_fresnel_rare(SHADE_IN(Surface) s, float cos_theta) {
  if ((SHADE_LOBES(s) & kLobeTransmission) == 0) return vec3(1.0f);
  vec3 f0 = s.glass_f0_tinted;
  float rise = glass_rise(cos_theta, max(s.eta, 1.0f / s.eta), s.glass_f0);
  vec3 f = f0 + (vec3(s.f90_dielectric) - f0) * rise;
  if ((SHADE_LOBES(s) & kLobeIridescence) == 0) return f;
  return s.iridescence > 0.0f ? mix(f, terms_film(s, cos_theta, f0), s.iridescence) : f;
}

/// The same at the cosine on wo's side; all of it at total internal reflection.
SHADE_FN vec3 glass_fresnel(SHADE_IN(Surface) s, float cos_theta) {
  if (s.eta >= 1.0f) return glass_fresnel_rare(s, cos_theta);
  float sin2_rare = (1.0f - cos_theta * cos_theta) / (s.eta * s.eta);
  if (sin2_rare >= 1.0f) return vec3(1.0f);
  return glass_fresnel_rare(s, sqrt(1.0f - sin2_rare));
}

/// Probability of following the reflected part of glass whose facets reflect `f` and tint what goes through.
SHADE_FN float glass_reflect_chance(vec3 f, vec3 tint) {
  float reflected = shade_max3(f);
  float through = shade_max3(tint * (vec3(1.0f) - f));
  return through > 0.0f ? reflected / (reflected + through) : 1.0f;
}

SHADE_FN void glass_matter(SHADE_IN(SurfaceParams) p, SHADE_INOUT(Surface) s) {
  if ((SHADE_LOBES(p) & kLobeTransmission) == 0) {
    s.is_thin = true;
    s.eta = 1.5f;
    s.is_glass_delta = true;
    s.glass_f0 = 0.0f;
    s.glass_f0_tinted = vec3(0.0f);
    s.glass_shine = vec3(1.0f);
    s.glass_tint = vec3(0.0f);
    return;
  }
  s.is_thin = p.is_thin;
  s.eta = p.is_thin ? max(p.ior, 1.0f) : p.eta;
  s.weight_glass = s.weight_dielectric * p.transmission;
  s.weight_dielectric = s.weight_dielectric - s.weight_glass;
  s.diffuse = s.diffuse * (1.0f - p.transmission);
  s.glass_f0 = p.ior == 0.0f ? 1.0f : f0_from_eta(s.eta);
  s.glass_f0_tinted = min(p.specular_color * s.glass_f0, vec3(1.0f)) * p.specular;
  s.glass_shine = vec3(1.0f);
  // A body is crossed at two of its boundaries: each takes half of the colour.
  s.glass_tint = p.is_thin ? p.base_color : sqrt(p.base_color);
  s.is_glass_delta = s.is_mirror || (!p.is_thin && abs(s.eta - 1.0f) < 1e-3f);
}

/// Cosine-weighted mean of what single scattering at a boundary loses.
SHADE_FN float glass_escape_mean(SHADE_IN(Surface) s, float eta) {
  if ((SHADE_LOBES(s) & kLobeAnisotropy) == 0) return 1.0f - table_glass_mean(s.roughness, eta);
  float sum = 0.0f;
  for (int i = 0; i < kAzimuths; ++i)
    sum += 1.0f - table_glass_mean(anisotropy_roughness_at(s, anisotropy_azimuth(i)), eta);
  return sum * (1.0f / float(kAzimuths));
}

/// Multiple scattering of a rough boundary between two transparent media, or within a sheet. What single scattering
/// loses at wo leaves on either side. How much of it crosses is one number for both directions, as reciprocity asks
/// (Kulla & Conty 2017, p. 20, leave it free); random walks say which.
SHADE_FN void glass_prepare(vec3 wo, SHADE_INOUT(Surface) s) {
  s.glass_escape_o = 0.0f;
  s.glass_reflected = 0.0f;
  s.glass_multireflect = 0.0f;
  s.glass_multitransmit = vec3(0.0f);
  if ((SHADE_LOBES(s) & kLobeTransmission) == 0) return;
  if (s.is_glass_delta || !s.model.multiscatter) return;
  if (s.is_thin) {
    float rise = table_rise(table_curve(s.eta));
    float reflected = shade_max3(s.glass_f0_tinted + (vec3(s.f90_dielectric) - s.glass_f0_tinted) * rise);
    float scale = s.weight_glass / (kShadePi * max(s.escape_mean, 1e-6f));
    s.glass_escape_o = s.escape_o;
    s.glass_reflected = reflected;
    s.glass_multireflect = reflected * scale;
    s.glass_multitransmit = s.glass_tint * ((1.0f - reflected) * scale);
    return;
  }
  float here = max(glass_escape_mean(s, s.eta), 1e-6f);
  float there = max(glass_escape_mean(s, 1.0f / s.eta), 1e-6f);
  float n2 = s.eta * s.eta;
  float across = table_glass_through(s.roughness, s.eta) * (s.eta >= 1.0f ? here : there * n2);
  float through = min(across / here, 1.0f);
  s.glass_escape_o = max(1.0f - table_glass(wo.z, anisotropy_roughness_along(s, wo), s.eta), 0.0f);
  s.glass_reflected = 1.0f - through;
  s.glass_multireflect = s.weight_glass * (1.0f - through) / (kShadePi * here);
  s.glass_multitransmit = s.glass_tint * (s.weight_glass * through / (kShadePi * there * n2));
}

SHADE_FN bool glass_is_delta(SHADE_IN(Surface) s) { return s.chance_glass <= 0.0f || s.is_glass_delta; }

/// What facets reflect of light from wi after several bounces among them; `escape` is what an opaque base's single
/// scattering loses there.
SHADE_FN vec3 glass_multireflected(SHADE_IN(Surface) s, vec3 wi, float escape) {
  if ((SHADE_LOBES(s) & kLobeTransmission) == 0) return vec3(0.0f);
  float glass_escape = s.is_thin || s.is_glass_delta
                           ? escape
                           : max(1.0f - table_glass(wi.z, anisotropy_roughness_along(s, wi), s.eta), 0.0f);
  return s.glass_shine * (s.glass_multireflect * s.glass_escape_o * glass_escape);
}

/// The reflecting facets: their Fresnel factor, and the density of theirs where that of all facets is `density`.
SHADE_FN SurfaceEval glass_facets(SHADE_IN(Surface) s, float cos_m, float density) {
  vec3 f = glass_fresnel(s, cos_m);
  SurfaceEval r;
  r.value = s.weight_glass * f * s.glass_shine;
  r.pdf = s.chance_glass * glass_reflect_chance(f, s.glass_tint) * density;
  return r;
}

/// Adds light from the other side: wi.z < 0. `ab` are the split-sum terms there, `across` what the layers let through.
SHADE_FN void glass_add_below(SHADE_IN(Surface) s, vec3 wo, vec3 wi, vec2 ab, float across,
                              SHADE_INOUT(SurfaceEval) r) {
  if ((SHADE_LOBES(s) & kLobeTransmission) == 0) return;
  float cos_i = -wi.z;
  float escape = s.is_thin ? base_escape(ab)
                           : max(1.0f - table_glass(cos_i, anisotropy_roughness_along(s, wi), 1.0f / s.eta), 0.0f);
  r.value += s.glass_multitransmit * (s.glass_escape_o * escape * cos_i * across);

  if (s.is_thin) {
    // As if reflected, then turned to the other side (KHR_materials_transmission).
    vec3 mirrored = vec3(wi.x, wi.y, cos_i);
    vec3 wm = wo + mirrored;
    float cos_m = 0.5f * length(wm);
    wm = wm * (0.5f / cos_m);
    vec3 f = glass_fresnel(s, cos_m);
    r.value += s.glass_tint * (vec3(1.0f) - f) * (s.weight_glass * terms_dv(s, wo, mirrored, wm) * cos_i * across);
    r.pdf += s.chance_glass * (1.0f - glass_reflect_chance(f, s.glass_tint)) * terms_pdf_visible(s, wo, wm);
    return;
  }

  // ----- Walter et al. 2007, eq. 21, over η² because radiance is what camera paths carry
  vec3 wm = microfacet_half_refract(wo, wi, s.eta);
  float cos_o = dot(wo, wm);
  float cos_t = dot(wi, wm);
  if (cos_o <= 0.0f || cos_t >= 0.0f) return;
  // From the rarer side: near the critical angle the other cosine has no digits left.
  vec3 f = glass_fresnel_rare(s, s.eta > 1.0f ? cos_o : -cos_t);
  float jacobian = microfacet_refract_jacobian(cos_o, cos_t, s.eta);
  float dg = 4.0f * terms_dv(s, wo, vec3(wi.x, wi.y, cos_i), wm) * cos_i * cos_o;  // D G (wo·wm) / wo.z
  r.value += s.glass_tint * (vec3(1.0f) - f) * (s.weight_glass * dg * jacobian * across / (s.eta * s.eta));
  r.pdf += s.chance_glass * (1.0f - glass_reflect_chance(f, s.glass_tint)) *
           (4.0f * cos_o * terms_pdf_visible(s, wo, wm) * jacobian);
}

/// Weight over its chance of the delta lobe that goes straight through a smooth sheet.
SHADE_APART SHADE_FN vec3 glass_straight(SHADE_IN(Surface) s, vec3 wo) {
  if (!s.is_thin || !s.is_mirror || s.weight_glass <= 0.0f) return vec3(0.0f);
  float across =
      s.model.literal_layers ? s.coat_over_o * s.sheen_over_o : layers_through(s, s.coat_albedo_o, s.sheen_albedo_o);
  return s.glass_tint * (vec3(1.0f) - glass_fresnel(s, wo.z)) * (s.weight_glass * across);
}

/// `u` chooses between reflection and refraction at a smooth boundary.
SHADE_FN SurfaceSample glass_sample_delta(SHADE_IN(Surface) s, vec3 wo, float u) {
  SurfaceSample r = surface_no_sample(wo);
  r.is_delta = true;
  vec3 f = glass_fresnel(s, wo.z);
  float reflected = glass_reflect_chance(f, s.glass_tint);
  if (u < reflected) {
    LayersAt at = layers_at(s, r.wi);
    r.pdf = s.chance_glass * reflected;
    r.weight = f * s.glass_shine * (s.weight_glass * layers_over(s, at) / r.pdf);
    return r;
  }
  r.pdf = s.chance_glass * (1.0f - reflected);
  if (s.is_thin) {
    r.wi = -wo;
    r.is_straight = true;
    r.weight = glass_straight(s, wo) * (1.0f / r.pdf);
    return r;
  }
  float eta = abs(s.eta - 1.0f) < 1e-3f ? 1.0f : s.eta;
  r.wi = microfacet_refract(wo, vec3(0.0f, 0.0f, 1.0f), eta);
  if (r.wi.z >= 0.0f) {
    r.wi = vec3(-wo.x, -wo.y, wo.z);
    r.pdf = 0.0f;
    return r;
  }
  LayersAt at = layers_at(s, r.wi);
  r.weight = s.glass_tint * (vec3(1.0f) - f) * (s.weight_glass * layers_across(s, at) / (r.pdf * eta * eta));
  return r;
}

/// A direction of the rough glass lobe; wi.z = 0 where there is none.
SHADE_FN vec3 glass_direction(SHADE_IN(Surface) s, vec3 wo, vec2 u, float u_side) {
  vec3 wm = terms_sample_visible(s, wo, u);
  vec3 reflected = microfacet_reflect(wo, wm);
  vec3 f = glass_fresnel(s, dot(wo, wm));
  if (u_side < glass_reflect_chance(f, s.glass_tint)) return reflected.z > 0.0f ? reflected : vec3(0.0f);
  if (s.is_thin) return reflected.z > 0.0f ? vec3(reflected.x, reflected.y, -reflected.z) : vec3(0.0f);
  vec3 refracted = microfacet_refract(wo, wm, s.eta);
  return refracted.z < 0.0f ? refracted : vec3(0.0f);
}

/// What it reflects and lets through of light that is the same from everywhere, where the opaque facets' split-sum
/// terms are `ab` and the layers let `over` through.
SHADE_FN void glass_shares(SHADE_IN(Surface) s, vec3 wo, vec2 ab, float over, SHADE_INOUT(SurfaceShares) r) {
  if ((SHADE_LOBES(s) & kLobeTransmission) == 0) return;
  if (s.weight_glass <= 0.0f) return;
  // A smooth boundary, or a film, reflects by the exact curve; a rough one loses what the tables of glass say.
  vec2 ab_glass = anisotropy_ggx(s, wo, table_curve(max(s.eta, 1.0f / s.eta)));
  vec3 reflected = s.glass_f0_tinted * ab_glass.x + vec3(s.f90_dielectric * ab_glass.y);
  if (s.is_glass_delta) reflected = glass_fresnel(s, wo.z);
  if (s.iridescence > 0.0f) reflected = glass_fresnel(s, wo.z) * (ab.x + ab.y);
  float rise = base_share_of_rise(shade_max3(s.glass_f0_tinted) * (ab_glass.x + ab_glass.y), shade_max3(reflected));
  r.rise = mix(r.rise, rise, s.weight_glass);
  reflected = min(reflected, vec3(1.0f));
  vec3 lost = min(vec3(s.glass_escape_o * s.glass_reflected), vec3(1.0f) - reflected);
  r.glass = reflected * s.glass_shine * (s.weight_glass * over);
  r.spread += lost * s.glass_shine * (s.weight_glass * over);
  r.through = s.glass_tint * (vec3(1.0f) - reflected - lost) * (s.weight_glass * over);
}

SHADE_END

#endif
