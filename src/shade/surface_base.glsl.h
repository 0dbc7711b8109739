#ifndef CANDELA_SHADE_SURFACE_BASE_GLSL_H
#define CANDELA_SHADE_SURFACE_BASE_GLSL_H

#include "shade/diffuse.glsl.h"
#include "shade/fresnel.glsl.h"
#include "shade/surface_params.glsl.h"

// Metallic-roughness with KHR_materials_ior and KHR_materials_specular (glTF 2.0 Appendix B and the extensions' own
// formulas): mix(dielectric, metal, metallic) of whole BRDFs, never of their F0. The BSDF contract is in
// surface.glsl.h.

SHADE_BEGIN

/// Tangent of a frame around n. Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
SHADE_FN vec3 shade_tangent(vec3 n) {
  float sgn = n.z < 0.0f ? -1.0f : 1.0f;
  float a = -1.0f / (sgn + n.z);
  return vec3(1.0f + sgn * n.x * n.x * a, sgn * n.x * n.y * a, -sgn * n.x);
}

/// A direction in the frame of a normal and a tangent, and back.
SHADE_FN vec3 shade_to_local(vec3 n, vec3 t, vec3 w) { return vec3(dot(w, t), dot(w, cross(n, t)), dot(w, n)); }

SHADE_FN vec3 shade_from_local(vec3 n, vec3 t, vec3 w) { return t * w.x + cross(n, t) * w.y + n * w.z; }

/// Share of light that facets reflect after several bounces among them, of what single scattering loses: the series
/// over the number of bounces, as Kulla & Conty 2017, "Revisiting Physically Based Shading at Imageworks", have it,
/// with what random walks say of its terms. `mean` is the mean reflectance of the facets that such light meets, `walk`
/// what table_walk() has of the roughness.
SHADE_FN float multiscatter_share(float mean, vec2 walk) {
  float further = mean * walk.y / (1.0f - mean * (1.0f - walk.y));
  return mean * mean * (walk.x + (1.0f - walk.x) * further);
}

SHADE_FN vec3 multiscatter_share3(vec3 mean, vec2 walk) {
  return vec3(multiscatter_share(mean.x, walk), multiscatter_share(mean.y, walk), multiscatter_share(mean.z, walk));
}

/// Mean reflectance of the dielectric facets that multiply scattered light meets.
SHADE_FN vec3 base_mean(SHADE_IN(Surface) s) {
  return s.f0_dielectric + (vec3(s.f90_dielectric) - s.f0_dielectric) * s.rise_mean;
}

/// How far the dielectric boundary's reflectance has risen from F0 to F90.
SHADE_FN float base_rise(SHADE_IN(Surface) s, float cos_theta) {
  return s.index > 0.0f ? fresnel_rise(cos_theta, s.index, s.rise_scale) : schlick_weight(cos_theta);
}

/// Of an albedo, the share by which Fresnel's terms have risen from F0, where they would leave `at_f0` without that.
SHADE_FN float base_share_of_rise(float at_f0, float albedo) {
  return albedo > 0.0f ? shade_saturate(1.0f - at_f0 / albedo) : 0.0f;
}

/// Fresnel of both opaque materials, weighted.
SHADE_FN vec3 base_fresnel(SHADE_IN(Surface) s, float cos_theta) {
  vec3 f = vec3(0.0f);
  if (s.weight_dielectric > 0.0f) {
    f = s.weight_dielectric * (s.f0_dielectric + (vec3(s.f90_dielectric) - s.f0_dielectric) * base_rise(s, cos_theta));
  }
  if (s.weight_metal > 0.0f) {
    f += s.weight_metal * (s.f0_metal + (vec3(1.0f) - s.f0_metal) * schlick_weight(cos_theta));
  }
  return f;
}

/// What single scattering between white facets loses at a direction with split-sum terms `ab`. Nothing of a mirror:
/// what is left there is rounding.
SHADE_FN float base_escape(vec2 ab) {
  float e = 1.0f - ab.x - ab.y;
  return e > 1e-5f ? e : 0.0f;
}

/// Share of light that crosses the dielectric boundary at a direction with its split-sum terms `ab`: 1 - its albedo.
SHADE_FN float base_transmission(SHADE_IN(Surface) s, vec2 ab) {
  return max(1.0f - s.boundary_f0 * ab.x - s.f90_dielectric * ab.y - s.boundary_escape * (1.0f - ab.x - ab.y), 0.0f);
}

/// Albedo of single scattering of the opaque base at a direction where the dielectric's split-sum terms are `ab` and
/// the metal's `ab_metal`.
SHADE_FN vec3 base_single_albedo(SHADE_IN(Surface) s, vec2 ab, vec2 ab_metal) {
  return s.weight_dielectric * (s.f0_dielectric * ab.x + vec3(s.f90_dielectric * ab.y)) +
         s.weight_metal * (s.f0_metal * ab_metal.x + vec3(ab_metal.y));
}

/// The dielectric's reflectance rises by Schlick's curve.
SHADE_FN void base_rises_by_schlick(SHADE_INOUT(Surface) s) {
  s.index = 0.0f;
  s.rise_scale = 1.0f;
  s.curve = table_curve_schlick();
}

/// Or by that of an index.
SHADE_FN void base_rises_by_index(float ior, SHADE_INOUT(Surface) s) {
  if (ior == kCoatIndex) {  // of most surfaces: nothing to compute
    s.index = kCoatIndex;
    s.rise_scale = 1.0f / (1.0f - kCoatF0);
    s.curve = table_curve_at(kTableCurveOfGlass);
    return;
  }
  s.index = min(max(ior, 1.0f / ior), kTableMostIndex);
  s.rise_scale = fresnel_rise_scale(s.index);
  s.curve = table_curve(s.index);
}

/// Weights, colours and widths of the base.
SHADE_FN void base_matter(SHADE_IN(SurfaceParams) p, SHADE_INOUT(Surface) s) {
  s.lobes = p.lobes;
  s.weight_metal = p.metallic;
  s.weight_dielectric = 1.0f - p.metallic;
  s.weight_glass = 0.0f;
  float f0_ior = p.ior == 0.0f ? 1.0f : f0_from_eta(p.ior);
  s.f0_dielectric = min(p.specular_color * f0_ior, vec3(1.0f)) * p.specular;
  s.f90_dielectric = p.specular;
  s.f0_metal = p.base_color;
  s.diffuse = p.base_color * s.weight_dielectric;
  s.roughness = p.roughness;
  s.alpha = roughness_to_alpha(p.roughness);
  s.is_mirror = s.alpha < kGgxMirrorAlpha;
  s.row = table_ggx_roughness(p.roughness);
  // Without an index (0) F0 may be a metal's.
  if (p.metallic < 1.0f && p.ior > 0.0f) {
    base_rises_by_index(p.ior, s);
  } else {
    base_rises_by_schlick(s);
  }
}

/// What the base loses and lets through, and the shares of the samples. `ab` are the split-sum terms at wo, `mean`
/// their cosine-weighted means, `ab_metal` those at wo by Schlick's curve.
SHADE_FN void base_energy(vec2 ab, vec2 mean, vec2 ab_metal, SHADE_INOUT(Surface) s) {
  s.escape_mean = 1.0f - mean.x - mean.y;
  s.escape_o = s.is_mirror ? 0.0f : base_escape(ab);
  s.rise_mean = table_walk_rise(s.row, s.curve);

  // ----- multiple scattering between facets, of each material before they are mixed
  vec2 walk = table_walk(s.row);
  vec3 share_dielectric = vec3(0.0f);
  vec3 share = vec3(0.0f);
  if (s.weight_metal < 1.0f) {
    share_dielectric = multiscatter_share3(base_mean(s), walk);
    share = s.weight_dielectric * share_dielectric;
  }
  if (s.weight_metal > 0.0f) {
    float rise = s.curve.i == 0 ? s.rise_mean : table_walk_rise(s.row, table_curve_schlick());
    share += s.weight_metal * multiscatter_share3(s.f0_metal + (vec3(1.0f) - s.f0_metal) * rise, walk);
  }
  s.multiscatter = share * (1.0f / (kShadePi * max(s.escape_mean, 1e-6f)));

  // ----- the diffuse layer below the boundary: ρ/π T(wo) T(wi) / T_mean returns exactly what the boundary lets in
  // (Kelemen & Szirmay-Kalos 2001, "A Microfacet Based Coupled Specular-Matte BRDF Model").
  s.boundary_f0 = shade_max3(s.f0_dielectric);
  s.boundary_escape = shade_max3(share_dielectric);
  s.transmission_o = base_transmission(s, ab);
  s.diffuse_scale = 1.0f / max(base_transmission(s, mean), 1e-6f);

  // ----- chances by estimated albedo
  s.single_albedo_o = base_single_albedo(s, ab, ab_metal);
  s.specular_albedo_o = s.single_albedo_o + share * s.escape_o;
  float specular = shade_max3(s.single_albedo_o);
  float diffuse = shade_max3(s.diffuse) * s.transmission_o + shade_max3(share) * s.escape_o;
  float total = specular + diffuse;
  // At least a tenth for whichever lobe exists at all, so that no weight explodes where the estimate is off.
  float chance = total > 0.0f ? specular / total : 0.0f;
  if (diffuse > 0.0f && specular > 0.0f) chance = clamp(chance, 0.1f, 0.9f);
  s.chance_specular = chance;
  s.chance_diffuse = diffuse > 0.0f ? 1.0f - chance : 0.0f;
}

SHADE_FN SurfaceEval base_eval(SHADE_IN(Surface) s, vec3 wo, vec3 wi) {
  SurfaceEval r;
  r.value = vec3(0.0f);
  r.pdf = 0.0f;
  if (wo.z <= 0.0f || wi.z <= 0.0f) return r;
  vec2 ab = table_ggx_curve(wi.z, s.row, s.curve);
  float diffuse = s.transmission_o * base_transmission(s, ab) * s.diffuse_scale * (1.0f / kShadePi);
  r.value = (s.diffuse * diffuse + s.multiscatter * (s.escape_o * base_escape(ab))) * wi.z;
  r.pdf = s.chance_diffuse * cosine_pdf(wi.z);
  if (!s.is_mirror) {
    vec3 wm = wo + wi;
    float cos_m = 0.5f * length(wm);  // = wo·wm = wi·wm, the same from both sides to the last bit
    wm = wm * (0.5f / cos_m);
    float d = ggx_d(wm, s.alpha);
    r.value += base_fresnel(s, cos_m) * (d * ggx_v_smith(wo, wi, s.alpha) * wi.z);
    r.pdf += s.chance_specular * ggx_pdf_visible(wo, wm, s.alpha);
  }
  return r;
}

SHADE_FN SurfaceSample surface_no_sample(vec3 wo) {
  SurfaceSample r;
  r.wi = vec3(-wo.x, -wo.y, wo.z);
  r.weight = vec3(0.0f);
  r.pdf = 0.0f;
  r.is_delta = false;
  r.is_straight = false;
  return r;
}

SHADE_FN SurfaceSample base_sample(SHADE_IN(Surface) s, vec3 wo, vec3 u) {
  SurfaceSample r = surface_no_sample(wo);
  if (u.z < s.chance_specular) {
    if (s.is_mirror) {
      r.weight = base_fresnel(s, wo.z) * (1.0f / s.chance_specular);
      r.pdf = s.chance_specular;
      r.is_delta = true;
      return r;
    }
    r.wi = microfacet_reflect(wo, ggx_sample_visible(wo, s.alpha, vec2(u.x, u.y)));
  } else {
    r.wi = cosine_sample(vec2(u.x, u.y));
  }
  SurfaceEval e = base_eval(s, wo, r.wi);
  if (e.pdf > 0.0f) {
    r.weight = e.value * (1.0f / e.pdf);
    r.pdf = e.pdf;
  }
  return r;
}

SHADE_END

#endif
