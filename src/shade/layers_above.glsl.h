#ifndef CANDELA_SHADE_LAYERS_ABOVE_GLSL_H
#define CANDELA_SHADE_LAYERS_ABOVE_GLSL_H

#include "shade/lobe_clearcoat.glsl.h"
#include "shade/lobe_iridescence.glsl.h"
#include "shade/lobe_sheen.glsl.h"

// What coat and sheen leave of the light on its way to and from the base. A layer dims a lobe below it by a factor of
// each direction, s(wo) s(wi), so that reciprocity holds; s is such that a white lobe returns just what the layer lets
// through (docs/theory/layers.md).

SHADE_BEGIN

/// Coat and sheen seen at one direction.
struct LayersAt {
  LayerAt coat;
  LayerAt sheen;
  float sheen_scale;  ///< of the sheen lobe itself
};

/// Where the coat's split-sum terms are `coat_ab`, at cosines to the fibres' normal and to the base's, above a base of
/// this roughness.
SHADE_FN LayersAt layers_at_cosines(SHADE_IN(Surface) s, vec2 coat_ab, float sheen_mu, float mu, float roughness) {
  LayersAt at;
  at.coat = coat_at(s, coat_ab, mu, roughness);
  at.sheen = sheen_at(s, sheen_mu, mu, roughness);
  at.sheen_scale = sheen_scale(s, sheen_mu);
  return at;
}

SHADE_APART SHADE_FN LayersAt layers_at(SHADE_IN(Surface) s, vec3 w) {
  vec2 coat_ab = (SHADE_LOBES(s) & kLobeClearcoat) != 0 ? coat_ggx(s, w) : vec2(0.0f);
  return layers_at_cosines(s, coat_ab, sheen_cosine(s, w), abs(w.z), anisotropy_roughness_along(s, w));
}

/// Share of light that reaches the base.
SHADE_FN float layers_through(SHADE_IN(Surface) s, float coat_albedo, float sheen_albedo) {
  return (1.0f - s.coat * coat_albedo) * (1.0f - s.sheen_weight * sheen_albedo);
}

/// Share of light that crosses the coat above a sheen twice, from wo to the direction that `at` belongs to.
SHADE_FN float layers_below_coat(SHADE_IN(Surface) s, LayersAt at) {
  if (s.model.literal_layers) return s.coat_over_o;
  return (1.0f - s.coat * s.coat_albedo_o) * (1.0f - s.coat * at.coat.albedo);
}

/// Factor of the base's specular lobe from wo to the direction that `at` belongs to.
SHADE_FN float layers_over(SHADE_IN(Surface) s, LayersAt at) {
  if (s.model.literal_layers) return s.coat_over_o * s.sheen_over_o;
  return (1.0f - s.coat + s.coat * s.coat_over_o * at.coat.over.x) *
         (1.0f - s.sheen_weight + s.sheen_weight * s.sheen_over_o * at.sheen.over.x);
}

/// Factor of light that goes through a sheet, where it is the reflected lobe turned round, or into a body: what the
/// layers let through at the more grazing of both directions, so that neither side gains.
SHADE_FN float layers_across(SHADE_IN(Surface) s, LayersAt at) {
  if (s.model.literal_layers || s.is_thin) return layers_over(s, at);
  return min(layers_through(s, s.coat_albedo_o, s.sheen_albedo_o), layers_through(s, at.coat.albedo, at.sheen.albedo));
}

/// What the diffuse layer gets below a boundary with split-sum terms `ab` and one layer of weight `w` and albedo `e`: 1
/// less what the layer reflects and what the boundary reflects through it. `known` is B of the bare boundary by the
/// curve that the table of the layer has.
SHADE_FN float layers_below_one(SHADE_IN(Surface) s, float w, float e, vec3 over, vec2 ab, float known) {
  float bare = 1.0f - base_transmission(s, ab);
  float white = over.y + over.z;
  float share = white / max(ab.x + ab.y, 1e-3f);
  float b = clamp(table_other_rise(over.z, known, ab.y, share), 0.0f, white);
  float covered = s.boundary_f0 * (white - b) + s.f90_dielectric * b + s.boundary_escape * max(1.0f - e - white, 0.0f);
  return max(1.0f - w * e - (1.0f - w) * bare - w * covered, 0.0f);
}

/// Transmission of everything above the diffuse layer at a cosine where the boundary's split-sum terms are `ab`.
SHADE_FN float layers_transmission(SHADE_IN(Surface) s, LayersAt at, vec2 ab, float mu, TableCell row) {
  float t = base_transmission(s, ab);
  if (s.coat <= 0.0f && s.sheen_weight <= 0.0f) return t;
  float known = ab.y;
  if (s.curve.i != kTableCurveOfGlass || s.curve.t > 0.0f) {
    known = table_ggx_curve(mu, row, table_curve_at(kTableCurveOfGlass)).y;
  }
  float below_coat = s.coat > 0.0f ? layers_below_one(s, s.coat, at.coat.albedo, at.coat.over, ab, known) : t;
  float below_sheen =
      s.sheen_weight > 0.0f ? layers_below_one(s, s.sheen_weight, at.sheen.albedo, at.sheen.over, ab, known) : t;
  return t > 0.0f ? below_coat * below_sheen / t : 0.0f;
}

/// Mean of the transmission of boundary, sheen and coat together, over the cosine-weighted hemisphere: Gauss's rule
/// (Abramowitz & Stegun 1964, 25.4.30) with five points in x = √µ, 2µ dµ = 4x³ dx.
SHADE_FN float layers_transmission_mean(SHADE_IN(Surface) s) {
  float sum = 0.0f;
  for (int i = 0; i < 5; ++i) {
    float t = i == 0 ? 0.0469100770f : i == 1 ? 0.2307653449f : i == 2 ? 0.5f : i == 3 ? 0.7692346551f : 0.9530899230f;
    float weight = i == 0 || i == 4 ? 0.1184634425f : i == 2 ? 0.2844444444f : 0.2393143352f;
    float mu = t * t;
    vec2 ab = table_ggx_curve(mu, s.row, s.curve);
    vec2 coat_ab = (SHADE_LOBES(s) & kLobeClearcoat) != 0 ? table_ggx_curve(mu, s.coat_row, s.coat_curve) : vec2(0.0f);
    LayersAt at = layers_at_cosines(s, coat_ab, mu, mu, s.roughness);
    sum += weight * 4.0f * t * mu * layers_transmission(s, at, ab, mu, s.row);
  }
  return sum;
}

/// What the diffuse layer gets of the light from wi and returns to wo through all that lies above it.
SHADE_FN vec3 layers_diffuse_through(SHADE_IN(Surface) s, vec3 wi, LayersAt at, vec2 ab) {
  vec3 through =
      vec3(s.transmission_o * layers_transmission(s, at, ab, abs(wi.z), anisotropy_row_along(s, wi)) * s.diffuse_scale);
  if (!s.has_film_below) return through;
  return through * s.film_below_o * iridescence_below_at(s, ab, wi) * s.film_below_scale;
}

/// The same by the model's blend.
SHADE_FN vec3 layers_diffuse_share(SHADE_IN(Surface) s, vec3 wo, vec3 wi, float cos_m, LayersAt at, vec2 ab) {
  if (s.model.blend == kBlendAlbedo) return layers_diffuse_through(s, wi, at, ab);
  float share = layers_across(s, at);
  if (s.model.blend == kBlendHalfVector) share *= 1.0f - shade_max3(terms_fresnel_dielectric(s, cos_m));
  if (s.model.blend == kBlendView) share *= 1.0f - shade_max3(terms_fresnel_dielectric(s, wo.z));
  return vec3(share);
}

SHADE_END

#endif
