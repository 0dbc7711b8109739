#ifndef CANDELA_SHADE_LOBE_DIFFUSE_ROUGHNESS_GLSL_H
#define CANDELA_SHADE_LOBE_DIFFUSE_ROUGHNESS_GLSL_H

#include "shade/surface_terms.glsl.h"

// KHR_materials_diffuse_roughness: the diffuse layer is EON's rather than Lambert's. Here is by what factor it differs.

SHADE_BEGIN

SHADE_FN void rough_diffuse_matter(SHADE_IN(SurfaceParams) p, SHADE_INOUT(Surface) s) {
  s.diffuse_roughness = (SHADE_LOBES(p) & kLobeDiffuseRoughness) != 0 ? p.diffuse_roughness : 0.0f;
  s.diffuse_color = p.base_color;
  s.diffuse_below_color = p.diffuse_transmission_color;
}

/// Light that comes through the boundary arrives more from above than a diffuse layer alone expects, and EON sends more
/// of it back there. A factor of each direction by the boundary's transmission `t` there keeps white white within half
/// a percent; 0.08 is a fit over the roughness of the boundary.
SHADE_FN float rough_diffuse_balance(SHADE_IN(Surface) s, float t) {
  return 1.0f - 0.08f * s.diffuse_roughness * (t - s.diffuse_balance_mean);
}

/// `ab` and `mean`: the boundary's split-sum terms at wo, and their means.
SHADE_FN void rough_diffuse_prepare(vec2 ab, vec2 mean, SHADE_INOUT(Surface) s) {
  if ((SHADE_LOBES(s) & kLobeDiffuseRoughness) == 0) return;
  if (s.diffuse_roughness <= 0.0f) return;
  s.diffuse_balance_mean = base_transmission(s, mean);
  s.diffuse_balance_o = rough_diffuse_balance(s, base_transmission(s, ab));
}

/// By what factor a layer of this colour differs from a Lambertian one; wi.z > 0, where the boundary's split-sum terms
/// are `ab`. Light that leaves on the other side does so as if it left on this one.
SHADE_FN vec3 rough_diffuse_gain(SHADE_IN(Surface) s, vec3 color, vec3 wo, vec3 wi, vec2 ab) {
  if ((SHADE_LOBES(s) & kLobeDiffuseRoughness) == 0) return vec3(1.0f);
  vec3 visible = max(color, vec3(1e-6f));
  return eon_f(visible, s.diffuse_roughness, wo, wi) / lambert_f(visible) *
         (s.diffuse_balance_o * rough_diffuse_balance(s, base_transmission(s, ab)));
}

/// Of light from everywhere: EON's directional albedo over the colour of the layer.
SHADE_FN vec3 rough_diffuse_albedo(SHADE_IN(Surface) s, vec3 color, float mu) {
  if ((SHADE_LOBES(s) & kLobeDiffuseRoughness) == 0) return vec3(1.0f);
  if (s.diffuse_roughness <= 0.0f) return vec3(1.0f);
  float single = eon_albedo(mu, s.diffuse_roughness);
  float average = (1.0f + kEonMean * s.diffuse_roughness) / (1.0f + kEonEdge * s.diffuse_roughness);
  vec3 further = color * average / (vec3(1.0f) - color * (1.0f - average));
  return vec3(single) + further * (1.0f - single);
}

SHADE_END

#endif
