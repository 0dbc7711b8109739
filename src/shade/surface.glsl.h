#ifndef CANDELA_SHADE_SURFACE_GLSL_H
#define CANDELA_SHADE_SURFACE_GLSL_H

#include "shade/diffuse.glsl.h"
#include "shade/fresnel.glsl.h"
#include "shade/microfacet.glsl.h"
#include "shade/shim.glsl.h"

// The glTF metallic-roughness surface with KHR_materials_ior and KHR_materials_specular (glTF 2.0 Appendix B and the
// extensions' own formulas): mix(dielectric, metal, metallic) of whole BRDFs, never of their F0.
//
// Contract of a BSDF here: directions in the local shading frame (n = +z), unit, away from the surface; `eval` returns
// f·|cos θi|; `sample` returns weight = f·|cos θi| / pdf so that an integrator never divides; `pdf` is per solid angle.
// A delta lobe is the flag `is_delta`, never a magic pdf; eval and pdf do not know it.
//
// A lobe is added in four places of this file: its members of Surface, surface_prepare, and one term each in
// surface_lobe_weights, surface_eval and surface_sample.

SHADE_BEGIN

/// What textures and factors say at one point, before any physics. Linear Rec.709.
struct SurfaceParams {
  vec3 base_color;
  float metallic;
  float roughness;
  float ior;  ///< 0 = the specification's compatibility mode with F0 = F90 = 1
  float specular;
  vec3 specular_color;
};

/// The closure: what eval, sample and pdf need, computed once per hit.
struct Surface {
  vec3 diffuse;  ///< albedo of the Lambertian layer, already times 1 - metallic
  vec3 f0_dielectric;
  float f90_dielectric;
  vec3 f0_metal;
  float metallic;
  float alpha;
  bool is_mirror;         ///< the specular lobe is a delta
  float boundary_f0;      ///< albedo of the dielectric boundary at normal incidence, strongest channel
  float boundary_rise;    ///< and what it gains from there to grazing
  float specular_chance;  ///< probability of sampling the specular lobe from the prepared wo
};

struct SurfaceEval {
  vec3 value;  ///< f·|cos θi|
  float pdf;   ///< per solid angle
};

struct SurfaceSample {
  vec3 wi;
  vec3 weight;  ///< f·|cos θi| / pdf; 0 = no sample
  float pdf;    ///< per solid angle; of a delta lobe the probability of choosing it
  bool is_delta;
};

SHADE_FN SurfaceParams surface_params_default() {
  SurfaceParams p;
  p.base_color = vec3(1.0f);
  p.metallic = 1.0f;
  p.roughness = 1.0f;
  p.ior = 1.5f;
  p.specular = 1.0f;
  p.specular_color = vec3(1.0f);
  return p;
}

/// Fresnel of both materials at once, weighted: (1 - metallic) F_dielectric + metallic F_metal.
SHADE_FN vec3 surface_fresnel(Surface s, float cos_theta) {
  float w = schlick_weight(cos_theta);
  vec3 f_dielectric = s.f0_dielectric + (vec3(s.f90_dielectric) - s.f0_dielectric) * w;
  vec3 f_metal = s.f0_metal + (vec3(1.0f) - s.f0_metal) * w;
  return mix(f_dielectric, f_metal, s.metallic);
}

/// Share of the light along a direction that crosses the dielectric boundary: 1 - its directional albedo.
SHADE_FN float surface_boundary_transmission(Surface s, float cos_theta) {
  return 1.0f - s.boundary_f0 - s.boundary_rise * schlick_weight(cos_theta);
}

/// The Lambertian layer below the boundary, times cos θi: ρ/π T(wo) T(wi) / T_avg, which returns exactly what the
/// boundary lets in (Kelemen & Szirmay-Kalos 2001, "A Microfacet Based Coupled Specular-Matte BRDF Model"). The 1 -
/// F(wo·h) of glTF's fresnel_mix is not used: under a smooth boundary it reflects up to 1.7 times the light that
/// arrives.
SHADE_FN vec3 surface_diffuse(Surface s, float cos_theta_o, float cos_theta_i) {
  float t_average = 1.0f - s.boundary_f0 - s.boundary_rise * (1.0f / 21.0f);  // cosine-weighted mean of (1 - cos)^5
  float t = surface_boundary_transmission(s, cos_theta_o) * surface_boundary_transmission(s, cos_theta_i);
  return lambert_f(s.diffuse) * (t * cos_theta_i / max(t_average, 1e-6f));
}

/// `cos_theta_o` = wo.z of the viewer, which decides how the lobes share the samples.
SHADE_FN Surface surface_prepare(SurfaceParams p, float cos_theta_o) {
  Surface s;
  float f0_ior = p.ior == 0.0f ? 1.0f : f0_from_eta(p.ior);
  s.f0_dielectric = min(p.specular_color * f0_ior, vec3(1.0f)) * p.specular;
  s.f90_dielectric = p.specular;
  s.f0_metal = p.base_color;
  s.metallic = p.metallic;
  s.diffuse = p.base_color * (1.0f - p.metallic);
  s.alpha = roughness_to_alpha(p.roughness);
  s.is_mirror = s.alpha < kGgxMirrorAlpha;

  // ----- directional albedo of the boundary: Schlick's curve, flattened where the facets are rough
  // 25 keeps the white furnace of every roughness and ior below 1 + 1 % by quadrature, and the loss small.
  s.boundary_f0 = shade_max3(s.f0_dielectric);
  s.boundary_rise = (s.f90_dielectric - s.boundary_f0) / (1.0f + 25.0f * s.alpha * s.alpha);

  // ----- share of the samples: estimated albedo of each lobe seen from wo
  float specular = shade_max3(surface_fresnel(s, cos_theta_o));
  float diffuse = shade_max3(s.diffuse) * surface_boundary_transmission(s, cos_theta_o);
  float total = specular + diffuse;
  // At least a tenth for whichever lobe exists at all, so that no weight explodes where the estimate is off.
  float chance = total > 0.0f ? specular / total : 0.0f;
  if (diffuse > 0.0f && specular > 0.0f) chance = clamp(chance, 0.1f, 0.9f);
  s.specular_chance = chance;
  return s;
}

/// Whether every lobe is a delta, so that no direction but the sampled ones can carry light.
SHADE_FN bool surface_is_delta(Surface s) { return s.is_mirror && s.specular_chance >= 1.0f; }

/// f·|cos θi| and the density of surface_sample, without delta lobes. Zero unless both directions are above the
/// surface.
SHADE_FN SurfaceEval surface_eval(Surface s, vec3 wo, vec3 wi) {
  SurfaceEval r;
  r.value = vec3(0.0f);
  r.pdf = 0.0f;
  if (wo.z <= 0.0f || wi.z <= 0.0f) return r;
  vec3 wm = wo + wi;
  float cos_m = 0.5f * length(wm);  // = wo·wm = wi·wm, the same from both sides to the last bit
  wm = wm * (0.5f / cos_m);
  r.value = surface_diffuse(s, wo.z, wi.z);
  r.pdf = (1.0f - s.specular_chance) * cosine_pdf(wi.z);
  if (!s.is_mirror) {
    r.value += surface_fresnel(s, cos_m) * (ggx_d(wm, s.alpha) * ggx_v_smith(wo, wi, s.alpha) * wi.z);
    r.pdf += s.specular_chance * ggx_pdf_visible(wo, wm, s.alpha);
  }
  return r;
}

/// Chooses a lobe by u.z and a direction by u.xy. wo.z > 0.
SHADE_FN SurfaceSample surface_sample(Surface s, vec3 wo, vec3 u) {
  SurfaceSample r;
  r.weight = vec3(0.0f);
  r.pdf = 0.0f;
  r.is_delta = false;
  r.wi = vec3(-wo.x, -wo.y, wo.z);

  if (u.z < s.specular_chance) {
    if (s.is_mirror) {
      r.weight = surface_fresnel(s, wo.z) * (1.0f / s.specular_chance);
      r.pdf = s.specular_chance;
      r.is_delta = true;
      return r;
    }
    r.wi = microfacet_reflect(wo, ggx_sample_visible(wo, s.alpha, vec2(u.x, u.y)));
  } else {
    r.wi = cosine_sample(vec2(u.x, u.y));
  }

  SurfaceEval e = surface_eval(s, wo, r.wi);
  if (e.pdf > 0.0f) {
    r.weight = e.value * (1.0f / e.pdf);
    r.pdf = e.pdf;
  }
  return r;
}

/// Reflectance estimate for the film's albedo layer: what a denoiser should divide out.
SHADE_FN vec3 surface_albedo(Surface s, float cos_theta_o) {
  return s.diffuse * surface_boundary_transmission(s, cos_theta_o) + surface_fresnel(s, cos_theta_o);
}

SHADE_END

#endif
