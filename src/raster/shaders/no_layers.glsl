// In place of shade/surface_layers.glsl.h for materials that have no layers: their surfaces have no lobes, so that
// nothing of this is ever called. A driver spends nine tenths of its time on the layers otherwise.
#define CANDELA_SHADE_SURFACE_LAYERS_GLSL_H
#include "shade/surface_base.glsl.h"
#include "shade/surface_terms.glsl.h"

void layers_matter(SurfaceParams p, inout Surface s) {}
vec2 anisotropy_ggx(Surface s, vec3 w, TableCell curve) { return vec2(0.0); }
vec2 anisotropy_ggx_mean(Surface s) { return vec2(0.0); }
void layers_prepare(SurfaceParams p, vec3 wo, vec2 ab, vec2 mean, inout Surface s) {}
bool layers_is_delta(Surface s) { return false; }
bool layers_scatters_through(Surface s) { return false; }
vec3 layers_straight(Surface s, vec3 wo) { return vec3(0.0); }
vec3 layers_emission_scale(Surface s) { return vec3(1.0); }
vec3 layers_albedo(Surface s, vec3 specular) { return vec3(0.0); }
void layers_shares(Surface s, vec3 wo, inout SurfaceShares r) {}

SurfaceEval layers_eval(Surface s, vec3 wo, vec3 wi) {
  SurfaceEval r;
  r.value = vec3(0.0);
  r.pdf = 0.0;
  return r;
}

SurfaceSample layers_sample(Surface s, vec3 wo, vec3 u) { return surface_no_sample(wo); }
