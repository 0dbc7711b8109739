#ifndef CANDELA_SHADE_SURFACE_GLSL_H
#define CANDELA_SHADE_SURFACE_GLSL_H

#include "shade/surface_layers.glsl.h"

// The surface that both renderers shade: glTF 2.0's metallic-roughness with all material extensions, one closure with
// three functions.
//
// Contract of a BSDF here: directions in the local shading frame (n = +z), unit, away from the surface; wo.z > 0, wi.z
// < 0 for light that comes through; `eval` returns f·|cos θi|; `sample` returns weight = f·|cos θi| / pdf so that an
// integrator never divides; `pdf` is per solid angle. A delta lobe is the flag `is_delta`, never a magic pdf; eval and
// pdf do not know it. Radiance that crosses into another index scales by η², as camera paths need it.
//
// surface_base.glsl.h     metallic-roughness alone: what most surfaces are, and all they pay for
// surface_terms.glsl.h    F, D, V and the diffuse shape by choice
// lobe_….glsl.h           everything else, a file for each lobe
// layers_above.glsl.h     how coat and sheen dim what lies below them
// surface_layers.glsl.h   the order of the lobes, each behind its bit
// surface.glsl.h          the choice between the short way and the long one
//
// A lobe is a bit, its members of SurfaceParams and Surface (surface_params.glsl.h), a file of its own, and a line in
// each function of surface_layers.glsl.h that has something to ask of it.

SHADE_BEGIN

/// For the viewer at wo (wo.z > 0), which decides how the lobes share the samples. `s` may hold anything before.
SHADE_FN void surface_prepare_in(SHADE_IN(SurfaceParams) p, vec3 wo, SHADE_INOUT(Surface) s) {
  base_matter(p, s);
  if (SHADE_LOBES(p) != 0) layers_matter(p, s);
  vec2 ab = SHADE_LOBES(p) == 0 ? table_ggx_curve(wo.z, s.row, s.curve) : anisotropy_ggx(s, wo, s.curve);
  vec2 mean = SHADE_LOBES(p) == 0 ? table_ggx_curve_mean(s.row, s.curve) : anisotropy_ggx_mean(s);
  vec2 ab_metal = ab;
  if (s.curve.i > 0 && s.weight_metal > 0.0f) {
    ab_metal = SHADE_LOBES(p) == 0 ? table_ggx(wo.z, s.row) : anisotropy_ggx(s, wo, table_curve_schlick());
  }
  base_energy(ab, mean, ab_metal, s);
  if (SHADE_LOBES(p) != 0) layers_prepare(p, wo, ab, mean, s);
}

SHADE_FN Surface surface_prepare(SHADE_IN(SurfaceParams) p, vec3 wo) {
  Surface s;
  surface_prepare_in(p, wo, s);
  return s;
}

/// Whether every lobe is a delta, so that no direction but the sampled ones can carry light.
SHADE_FN bool surface_is_delta(SHADE_IN(Surface) s) {
  if (SHADE_LOBES(s) != 0) return layers_is_delta(s);
  return s.is_mirror && s.chance_diffuse <= 0.0f;
}

/// Whether light arrives from the other side too, other than by delta lobes.
SHADE_FN bool surface_scatters_through(SHADE_IN(Surface) s) {
  return (SHADE_LOBES(s) & (kLobeTransmission | kLobeDiffuseTransmission)) != 0 && layers_scatters_through(s);
}

/// f·|cos θi| and the density of surface_sample, without delta lobes. wo.z > 0.
SHADE_FN SurfaceEval surface_eval(SHADE_IN(Surface) s, vec3 wo, vec3 wi) {
  if (SHADE_LOBES(s) != 0) return layers_eval(s, wo, wi);
  return base_eval(s, wo, wi);
}

/// Chooses a lobe by u.z and a direction by u.xy. wo.z > 0.
SHADE_FN SurfaceSample surface_sample(SHADE_IN(Surface) s, vec3 wo, vec3 u) {
  if (SHADE_LOBES(s) != 0) return layers_sample(s, wo, u);
  return base_sample(s, wo, u);
}

/// What passes straight through a smooth sheet: the weight of the delta lobe that leaves at -wo.
SHADE_FN vec3 surface_straight(SHADE_IN(Surface) s, vec3 wo) {
  if ((SHADE_LOBES(s) & kLobeTransmission) == 0) return vec3(0.0f);
  return layers_straight(s, wo);
}

/// What it was made of.
SHADE_FN vec3 surface_base_color(SHADE_IN(Surface) s) { return SHADE_LOBES(s) != 0 ? s.diffuse_color : s.f0_metal; }

/// Reflectance estimate for the film's albedo layer: what a denoiser should divide out.
SHADE_FN vec3 surface_albedo(SHADE_IN(Surface) s) {
  if (SHADE_LOBES(s) != 0) return layers_albedo(s, s.specular_albedo_o);
  return s.diffuse * s.transmission_o + s.specular_albedo_o;
}

/// What is left of emission on its way out through the layers above the base.
SHADE_FN vec3 surface_emission_scale(SHADE_IN(Surface) s) {
  if ((SHADE_LOBES(s) & (kLobesOfFibres | kLobeClearcoat)) == 0) return vec3(1.0f);
  return layers_emission_scale(s);
}

SHADE_END

#endif
