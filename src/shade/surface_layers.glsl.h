#ifndef CANDELA_SHADE_SURFACE_LAYERS_GLSL_H
#define CANDELA_SHADE_SURFACE_LAYERS_GLSL_H

#include "shade/surface_base.glsl.h"
#include "shade/surface_terms.glsl.h"

// The base with what may lie above and below it:
//
//     coat ─ sheen ─ base = metallic · metal + (1 - metallic) · (transmission · glass + (1 - transmission) · opaque)
//
// Every weight mixes whole BSDFs, each of which keeps energy by itself. A layer dims a lobe below it by a factor of
// each direction, s(wo) s(wi), so that reciprocity holds; s is such that a white lobe returns just what the layer lets
// through (docs/theory/layers.md).

SHADE_BEGIN

// ----- what a layer lets through

/// Coat and sheen seen at one direction: albedos at weight 1, and how they dim the base's specular lobe.
struct LayersAt {
  float coat_albedo;
  float sheen_albedo;
  float sheen_scale;  ///< of the sheen lobe itself
  vec3 coat_over;     ///< see table_over
  vec3 sheen_over;
};

SHADE_FN float layers_coat_cosine(SHADE_IN(Surface) s, vec3 w) { return abs(dot(s.coat_normal, w)); }

SHADE_FN float layers_coat_albedo(SHADE_IN(Surface) s, vec2 ab) {
  return kCoatF0 * ab.x + ab.y + s.coat_escape_share * (1.0f - ab.x - ab.y);
}

/// Roughness of the base's facets along an azimuth with this squared cosine.
SHADE_FN float layers_roughness_at(SHADE_IN(Surface) s, float cos2) {
  return sqrt(sqrt(mix(s.alpha_y * s.alpha_y, s.alpha_x * s.alpha_x, cos2)));
}

SHADE_FN float layers_roughness_along(SHADE_IN(Surface) s, vec3 w) {
  if ((s.lobes & kLobeAnisotropy) == 0) return s.roughness;
  return layers_roughness_at(s, w.x * w.x / max(w.x * w.x + w.y * w.y, 1e-12f));
}

/// And its row in the tables of GGX.
SHADE_FN TableCell layers_row_along(SHADE_IN(Surface) s, vec3 w) {
  if ((s.lobes & kLobeAnisotropy) == 0) return s.row;
  return table_ggx_roughness(layers_roughness_along(s, w));
}

/// At cosines to the coat's normal and to the base's, above a base of this roughness.
SHADE_FN LayersAt layers_at_cosines(SHADE_IN(Surface) s, float coat_mu, float mu, float roughness) {
  LayersAt at;
  at.coat_albedo = 0.0f;
  at.sheen_albedo = 0.0f;
  at.sheen_scale = 1.0f;
  at.coat_over = vec3(1.0f);
  at.sheen_over = vec3(1.0f);
  if ((s.lobes & kLobeClearcoat) != 0) {
    at.coat_albedo = layers_coat_albedo(s, table_ggx_curve(coat_mu, s.coat_row, s.coat_curve));
    // How the base's lobe spreads is the base normal's matter; how much comes through, the coat's.
    at.coat_over = table_coat_over(mu, roughness, s.coat_roughness, at.coat_albedo);
  }
  if ((s.lobes & kLobeSheen) != 0) {
    at.sheen_albedo = table_sheen(mu, s.sheen_roughness);
    at.sheen_scale = s.model.literal_layers ? 1.0f : table_sheen_scale(mu, s.sheen_roughness);
    at.sheen_over = table_sheen_over(mu, roughness, s.sheen_roughness, at.sheen_albedo);
  }
  return at;
}

SHADE_APART SHADE_FN LayersAt layers_at(SHADE_IN(Surface) s, vec3 w) {
  return layers_at_cosines(s, layers_coat_cosine(s, w), abs(w.z), layers_roughness_along(s, w));
}

/// Share of light that reaches the base.
SHADE_FN float layers_through(SHADE_IN(Surface) s, float coat_albedo, float sheen_albedo) {
  return (1.0f - s.coat * coat_albedo) * (1.0f - s.sheen_weight * sheen_albedo);
}

/// Factor of the base's specular lobe from wo to the direction that `at` belongs to.
SHADE_FN float layers_over(SHADE_IN(Surface) s, LayersAt at) {
  if (s.model.literal_layers) return s.coat_over_o * s.sheen_over_o;
  return (1.0f - s.coat + s.coat * s.coat_over_o * at.coat_over.x) *
         (1.0f - s.sheen_weight + s.sheen_weight * s.sheen_over_o * at.sheen_over.x);
}

/// Factor of light that goes through a sheet, where it is the reflected lobe turned round, or into a body: what the
/// layers let through at the more grazing of both directions, so that neither side gains.
SHADE_FN float layers_across(SHADE_IN(Surface) s, LayersAt at) {
  if (s.model.literal_layers || s.is_thin) return layers_over(s, at);
  return min(layers_through(s, s.coat_albedo_o, s.sheen_albedo_o), layers_through(s, at.coat_albedo, at.sheen_albedo));
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
  float below_coat = s.coat > 0.0f ? layers_below_one(s, s.coat, at.coat_albedo, at.coat_over, ab, known) : t;
  float below_sheen =
      s.sheen_weight > 0.0f ? layers_below_one(s, s.sheen_weight, at.sheen_albedo, at.sheen_over, ab, known) : t;
  return t > 0.0f ? below_coat * below_sheen / t : 0.0f;
}

// ----- preparation

/// Matter: colours, films, widths. Between base_matter and base_energy.
SHADE_APART SHADE_FN void layers_matter(SHADE_IN(SurfaceParams) p, SHADE_INOUT(Surface) s) {
  s.model = p.model;
  bool has_index = (p.lobes & kLobeModel) == 0 || shading_model_has_index(p.model);
  if (!has_index) base_rises_by_schlick(s);
  s.coat_curve = table_curve_at(has_index ? kTableCurveOfGlass : 0);
  s.coat = 0.0f;
  s.coat_normal = vec3(0.0f, 0.0f, 1.0f);
  s.sheen_weight = 0.0f;
  s.sheen = vec3(0.0f);
  s.coat_multiscatter = 0.0f;
  s.alpha_x = s.alpha;
  s.alpha_y = s.alpha;
  s.iridescence = (p.lobes & kLobeIridescence) != 0 && p.film_nm > 0.0f ? p.iridescence : 0.0f;
  s.has_film_below = s.iridescence > 0.0f && s.weight_dielectric > 0.0f;
  s.is_thin = true;
  s.eta = 1.5f;
  s.diffuse_below = vec3(0.0f);

  if ((p.lobes & kLobeAnisotropy) != 0 && p.anisotropy > 0.0f) {
    // KHR_materials_anisotropy: the direction of the texture is the rougher one.
    s.alpha_x = max(mix(s.alpha, 1.0f, shade_sqr(p.anisotropy)), kGgxMirrorAlpha);
    s.alpha_y = max(s.alpha, kGgxMirrorAlpha);
    s.alpha = s.alpha_y;  // no mirror, for terms that know one width only
    s.is_mirror = false;
    s.roughness = sqrt(sqrt(s.alpha_x * s.alpha_y));
    s.row = table_ggx_roughness(s.roughness);
  }

  if ((p.lobes & kLobeConductor) != 0) {
    s.conductor_n = p.conductor_n;
    s.conductor_k = p.conductor_k;
    s.f0_metal = min(fresnel_conductor3(1.0f, p.conductor_n, p.conductor_k), vec3(1.0f));
  }

  if ((p.lobes & kLobeTransmission) != 0) {
    s.is_thin = p.is_thin;
    s.eta = p.is_thin ? max(p.ior, 1.0f) : p.eta;
    s.weight_glass = s.weight_dielectric * p.transmission;
    s.weight_dielectric = s.weight_dielectric - s.weight_glass;
    s.diffuse = s.diffuse * (1.0f - p.transmission);
    s.glass_f0 = p.ior == 0.0f ? 1.0f : f0_from_eta(s.eta);
    s.glass_f0_tinted = min(p.specular_color * s.glass_f0, vec3(1.0f)) * p.specular;
    // A body is crossed at two of its boundaries: each takes half of the colour.
    s.glass_tint = p.is_thin ? p.base_color : sqrt(p.base_color);
    s.is_glass_delta = s.is_mirror || (!p.is_thin && abs(s.eta - 1.0f) < 1e-3f);
  } else {
    s.is_glass_delta = true;
    s.glass_f0 = 0.0f;
    s.glass_f0_tinted = vec3(0.0f);
    s.glass_tint = vec3(0.0f);
  }

  if ((p.lobes & kLobeDiffuseTransmission) != 0) {
    s.diffuse_below =
        p.diffuse_transmission_color * (p.diffuse_transmission * (1.0f - p.metallic) *
                                        ((p.lobes & kLobeTransmission) != 0 ? 1.0f - p.transmission : 1.0f));
    s.diffuse = s.diffuse * (1.0f - p.diffuse_transmission);
    if (!s.is_thin) {
      // Radiance is η² times as much inside, and light from inside meets the boundary's total reflection.
      if (s.eta > 1.0f) {
        s.diffuse_below = s.diffuse_below * (1.0f / (s.eta * s.eta));
      } else {
        s.diffuse += s.diffuse_below * (1.0f - s.eta * s.eta);
      }
    }
    if ((p.lobes & kLobeTransmission) != 0 && s.is_thin && p.scatter > 0.0f) {
      // KHR_materials_scatter: that share of the glass is matter which sends light to both sides.
      float scattered = s.weight_glass * p.scatter;
      s.weight_glass = s.weight_glass - scattered;
      s.weight_dielectric += scattered;
      float forward = 0.5f * (1.0f + p.scatter_anisotropy);
      s.diffuse += p.scatter_color * (scattered * (1.0f - forward));
      s.diffuse_below += p.scatter_color * (scattered * forward);
    }
  }

  s.film_ior = p.film_ior;
  s.film_nm = p.film_nm;
  s.film_f0_dielectric = s.f0_dielectric;
  s.film_f0_metal = s.f0_metal;
  s.f82_tint = min(p.specular_color, vec3(1.0f));
  if (s.iridescence > 0.0f) {
    // For the albedo tables; the lobe itself has the whole curve.
    s.f0_dielectric = mix(s.f0_dielectric, terms_film(s, 1.0f, s.film_f0_dielectric), s.iridescence);
    s.f0_metal = mix(s.f0_metal, terms_film_metal(s, 1.0f), s.iridescence);
  }
}

/// Squared cosines of azimuths that stand evenly in a quarter of the circle.
SHADE_CONST int kAzimuths = 4;
SHADE_FN float layers_azimuth(int i) {
  return i == 0 ? 0.9619398f : i == 1 ? 0.6913417f : i == 2 ? 0.3086583f : 0.0380602f;
}

/// A film lets each channel through by a law of its own: base_transmission of each, where facets reflect `beyond` more
/// than the boundary's curve, over that of the whole.
SHADE_FN vec3 layers_film_below(SHADE_IN(Surface) s, vec2 ab, vec3 beyond) {
  vec3 reflected =
      s.f0_dielectric * ab.x + vec3(s.f90_dielectric * ab.y) + s.film_escape * (1.0f - ab.x - ab.y) + beyond;
  return max(vec3(1.0f) - reflected, vec3(0.0f)) * (1.0f / max(base_transmission(s, ab), 1e-3f));
}

SHADE_FN vec3 layers_film_below_at(SHADE_IN(Surface) s, vec2 ab, vec3 w) {
  TableCell m = table_cell_mu(abs(w.z), kTableMu);
  TableCell row = layers_row_along(s, w);
  vec3 beyond = vec3(0.0f);
  for (int i = 0; i < kFilmCosines; ++i) beyond += s.film_beyond[i] * table_film(i, m, row);
  return layers_film_below(s, ab, beyond);
}

SHADE_FN float layers_film_mean(SHADE_IN(Surface) s, int i) {
  if ((s.lobes & kLobeAnisotropy) == 0) return table_film_mean(i, s.row);
  float sum = 0.0f;
  for (int k = 0; k < kAzimuths; ++k) {
    sum += table_film_mean(i, table_ggx_roughness(layers_roughness_at(s, layers_azimuth(k))));
  }
  return sum * (1.0f / float(kAzimuths));
}

/// After base_energy, whose split-sum terms and means these are.
SHADE_APART SHADE_FN void layers_prepare_film(vec3 wo, vec2 ab, vec2 mean, SHADE_INOUT(Surface) s) {
  vec3 beyond = vec3(0.0f);
  for (int i = 0; i < kFilmCosines; ++i) {
    float mu = table_film_cosine(i);
    vec3 curve = s.f0_dielectric + (vec3(s.f90_dielectric) - s.f0_dielectric) * base_rise(s, mu);
    s.film_beyond[i] = terms_fresnel_dielectric(s, mu) - curve;
    beyond += s.film_beyond[i] * layers_film_mean(s, i);
  }
  s.film_escape = multiscatter_share3(base_mean(s), table_walk(s.row));
  s.film_below_scale = vec3(1.0f) / max(layers_film_below(s, mean, beyond), vec3(1e-3f));
  s.film_below_o = layers_film_below_at(s, ab, wo);
}

/// Split-sum terms from what an anisotropic lobe loses and its B by Schlick's curve, of a curve that moves B of a round
/// lobe from `from` to `to`.
SHADE_FN vec2 layers_anisotropic_terms(vec2 entry, float from, float to) {
  float b = clamp(table_other_rise(entry.y, from, to, 1.0f), 0.0f, 1.0f - entry.x);
  return vec2(1.0f - entry.x - b, b);
}

/// Split-sum terms at w by a curve.
SHADE_FN vec2 layers_ggx(SHADE_IN(Surface) s, vec3 w, TableCell curve) {
  float mu = abs(w.z);
  if ((s.lobes & kLobeAnisotropy) == 0) return table_ggx_curve(mu, s.row, curve);
  float along = layers_roughness_along(s, w);
  vec2 entry = table_anisotropic(mu, along, sqrt(s.alpha_x), sqrt(s.alpha_y));
  if (curve.i == 0) return vec2(1.0f - entry.x - entry.y, entry.y);
  TableCell row = table_ggx_roughness(along);
  return layers_anisotropic_terms(entry, table_ggx(mu, row).y, table_ggx_curve(mu, row, curve).y);
}

/// Cosine-weighted means of the split-sum terms.
SHADE_FN vec2 layers_ggx_mean(SHADE_IN(Surface) s) {
  if ((s.lobes & kLobeAnisotropy) == 0) return table_ggx_curve_mean(s.row, s.curve);
  vec2 entry = table_anisotropic_mean(sqrt(s.alpha_x), sqrt(s.alpha_y));
  float from = 0.0f;
  float to = 0.0f;
  for (int i = 0; i < kAzimuths; ++i) {
    TableCell row = table_ggx_roughness(layers_roughness_at(s, layers_azimuth(i)));
    from += table_ggx_mean(row).y * (1.0f / float(kAzimuths));
    to += table_ggx_curve_mean(row, s.curve).y * (1.0f / float(kAzimuths));
  }
  return layers_anisotropic_terms(entry, from, to);
}

SHADE_FN void layers_prepare_coat(SHADE_IN(SurfaceParams) p, vec3 wo, SHADE_INOUT(Surface) s) {
  s.coat_roughness = p.clearcoat_roughness;
  s.coat_alpha = roughness_to_alpha(p.clearcoat_roughness);
  s.is_coat_mirror = s.coat_alpha < kGgxMirrorAlpha;
  s.coat_normal = p.clearcoat_normal;
  s.coat = p.clearcoat;
  s.coat_row = table_ggx_roughness(s.coat_roughness);
  vec2 mean = table_ggx_curve_mean(s.coat_row, s.coat_curve);
  float escape_mean = 1.0f - mean.x - mean.y;
  float f_mean = kCoatF0 + (1.0f - kCoatF0) * table_walk_rise(s.coat_row, s.coat_curve);
  float share = s.model.multiscatter ? multiscatter_share(f_mean, table_walk(s.coat_row)) : 0.0f;
  s.coat_escape_share = share;
  s.coat_multiscatter = share / (kShadePi * max(escape_mean, 1e-6f));
  vec2 ab = table_ggx_curve(layers_coat_cosine(s, wo), s.coat_row, s.coat_curve);
  s.coat_escape_o = s.is_coat_mirror ? 0.0f : base_escape(ab);
}

SHADE_FN void layers_prepare_sheen(SHADE_IN(SurfaceParams) p, SHADE_INOUT(Surface) s) {
  s.sheen = p.sheen_color;
  s.sheen_roughness = max(p.sheen_roughness, kSheenLeastRoughness);
  s.sheen_alpha = sheen_alpha(p.sheen_roughness);
  s.sheen_weight = shade_max3(p.sheen_color);
}

/// Cosine-weighted mean of what single scattering at a boundary loses.
SHADE_FN float layers_glass_escape_mean(SHADE_IN(Surface) s, float eta) {
  if ((s.lobes & kLobeAnisotropy) == 0) return 1.0f - table_glass_mean(s.roughness, eta);
  float sum = 0.0f;
  for (int i = 0; i < kAzimuths; ++i) sum += 1.0f - table_glass_mean(layers_roughness_at(s, layers_azimuth(i)), eta);
  return sum * (1.0f / float(kAzimuths));
}

/// Multiple scattering of a rough boundary between two transparent media, or within a sheet. What single scattering
/// loses at wo leaves on either side. How much of it crosses is one number for both directions, as reciprocity asks
/// (Kulla & Conty 2017, p. 20, leave it free); random walks say which.
SHADE_FN void layers_prepare_glass(vec3 wo, SHADE_INOUT(Surface) s) {
  s.glass_escape_o = 0.0f;
  s.glass_reflected = 0.0f;
  s.glass_multireflect = 0.0f;
  s.glass_multitransmit = vec3(0.0f);
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
  float here = max(layers_glass_escape_mean(s, s.eta), 1e-6f);
  float there = max(layers_glass_escape_mean(s, 1.0f / s.eta), 1e-6f);
  float n2 = s.eta * s.eta;
  float across = table_glass_through(s.roughness, s.eta) * (s.eta >= 1.0f ? here : there * n2);
  float through = min(across / here, 1.0f);
  s.glass_escape_o = max(1.0f - table_glass(wo.z, layers_roughness_along(s, wo), s.eta), 0.0f);
  s.glass_reflected = 1.0f - through;
  s.glass_multireflect = s.weight_glass * (1.0f - through) / (kShadePi * here);
  s.glass_multitransmit = s.glass_tint * (s.weight_glass * through / (kShadePi * there * n2));
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
    sum += weight * 4.0f * t * mu * layers_transmission(s, layers_at_cosines(s, mu, mu, s.roughness), ab, mu, s.row);
  }
  return sum;
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
  float sheen = s.sheen_weight * s.sheen_albedo_o;
  if (sheen < 1e-6f) sheen = 0.0f;  // rounding: straight down between narrow fibres there is nothing
  float coat = s.coat * s.coat_albedo_o;
  if (dot(s.coat_normal, wo) <= 1e-4f) coat = 0.0f;  // it turns its back
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
  s.film_below_o = vec3(1.0f);
  if (s.has_film_below) layers_prepare_film(wo, ab, mean, s);
  if ((s.lobes & kLobeClearcoat) != 0) layers_prepare_coat(p, wo, s);
  if ((s.lobes & kLobeSheen) != 0) layers_prepare_sheen(p, s);
  layers_prepare_glass(wo, s);

  LayersAt at = layers_at(s, wo);
  s.coat_albedo_o = at.coat_albedo;
  s.sheen_albedo_o = at.sheen_albedo;
  s.sheen_scale_o = at.sheen_scale;
  s.coat_over_o = at.coat_over.x;
  s.sheen_over_o = at.sheen_over.x;
  if (s.model.literal_layers) {
    // KHR_materials_clearcoat and _sheen as printed: by the view alone.
    s.coat_over_o = 1.0f - s.coat * terms_coat_fresnel(s, layers_coat_cosine(s, wo));
    s.sheen_over_o = 1.0f - s.sheen_weight * at.sheen_albedo;
  } else if ((s.lobes & (kLobeSheen | kLobeClearcoat)) != 0) {
    s.transmission_o = layers_transmission(s, at, ab, wo.z, layers_row_along(s, wo));
    s.diffuse_scale = 1.0f / max(layers_transmission_mean(s), 1e-6f);
  }
  layers_chances(wo, s);
}

SHADE_FN bool layers_is_delta(SHADE_IN(Surface) s) {
  return s.chance_diffuse <= 0.0f && s.chance_diffuse_below <= 0.0f && s.chance_sheen <= 0.0f &&
         (s.chance_specular <= 0.0f || s.is_mirror) && (s.chance_glass <= 0.0f || s.is_glass_delta) &&
         (s.chance_coat <= 0.0f || s.is_coat_mirror);
}

SHADE_FN bool layers_scatters_through(SHADE_IN(Surface) s) {
  return s.chance_diffuse_below > 0.0f || (s.chance_glass > 0.0f && !s.is_glass_delta);
}

// ----- the coat's frame

SHADE_FN vec3 layers_to_coat(SHADE_IN(Surface) s, vec3 w) {
  vec3 t = shade_tangent(s.coat_normal);
  return vec3(dot(w, t), dot(w, cross(s.coat_normal, t)), dot(w, s.coat_normal));
}

SHADE_FN vec3 layers_from_coat(SHADE_IN(Surface) s, vec3 w) {
  vec3 t = shade_tangent(s.coat_normal);
  return t * w.x + cross(s.coat_normal, t) * w.y + s.coat_normal * w.z;
}

// ----- evaluation

/// What the diffuse layer gets of the light from wi and returns to wo through all that lies above it.
SHADE_FN vec3 layers_diffuse_through(SHADE_IN(Surface) s, vec3 wi, LayersAt at, vec2 ab) {
  vec3 through =
      vec3(s.transmission_o * layers_transmission(s, at, ab, abs(wi.z), layers_row_along(s, wi)) * s.diffuse_scale);
  if (!s.has_film_below) return through;
  return through * s.film_below_o * layers_film_below_at(s, ab, wi) * s.film_below_scale;
}

/// The same by the model's blend.
SHADE_FN vec3 layers_diffuse_share(SHADE_IN(Surface) s, vec3 wo, vec3 wi, float cos_m, LayersAt at, vec2 ab) {
  if (s.model.blend == kBlendAlbedo) return layers_diffuse_through(s, wi, at, ab);
  float share = layers_across(s, at);
  if (s.model.blend == kBlendHalfVector) share *= 1.0f - shade_max3(terms_fresnel_dielectric(s, cos_m));
  if (s.model.blend == kBlendView) share *= 1.0f - shade_max3(terms_fresnel_dielectric(s, wo.z));
  return vec3(share);
}

/// The coat: value and density.
SHADE_FN SurfaceEval layers_eval_coat(SHADE_IN(Surface) s, vec3 wo, vec3 wi) {
  SurfaceEval r;
  r.value = vec3(0.0f);
  r.pdf = 0.0f;
  vec3 o = layers_to_coat(s, wo);
  vec3 i = layers_to_coat(s, wi);
  if (o.z <= 0.0f || i.z <= 0.0f) return r;
  vec2 ab = table_ggx_curve(i.z, s.coat_row, s.coat_curve);
  float f = s.coat_multiscatter * s.coat_escape_o * base_escape(ab);
  if (!s.is_coat_mirror) {
    vec3 wm = o + i;
    float cos_m = 0.5f * length(wm);
    wm = wm * (0.5f / cos_m);
    f += terms_coat_fresnel(s, cos_m) * ggx_d(wm, s.coat_alpha) * ggx_v_smith(o, i, s.coat_alpha);
    r.pdf = ggx_pdf_visible(o, wm, s.coat_alpha);
  }
  r.value = vec3(s.coat * f * i.z);
  return r;
}

/// The sheen below a coat.
SHADE_FN vec3 layers_eval_sheen(SHADE_IN(Surface) s, vec3 wo, vec3 wi, LayersAt at) {
  vec3 wm = normalize(wo + wi);
  float share =
      s.model.literal_layers ? s.coat_over_o : (1.0f - s.coat * s.coat_albedo_o) * (1.0f - s.coat * at.coat_albedo);
  share *= s.sheen_scale_o * at.sheen_scale;
  return s.sheen * (share * charlie_d(wm, s.sheen_alpha) * charlie_v(wo, wi, s.sheen_alpha) * wi.z);
}

SHADE_APART SHADE_FN SurfaceEval layers_eval_above(SHADE_IN(Surface) s, vec3 wo, vec3 wi, LayersAt at) {
  SurfaceEval r;
  vec3 wm = wo + wi;
  float cos_m = 0.5f * length(wm);
  wm = wm * (0.5f / cos_m);
  vec2 ab = layers_ggx(s, wi, s.curve);
  float escape = base_escape(ab);
  float over = layers_over(s, at);

  // ----- diffuse, and what scatters many times between facets
  vec3 lost = s.multiscatter * (s.escape_o * escape);
  r.pdf = s.chance_diffuse * cosine_pdf(wi.z);
  r.value = lost * over;
  if (s.weight_glass > 0.0f) {
    float glass_escape = s.is_thin || s.is_glass_delta
                             ? escape
                             : max(1.0f - table_glass(wi.z, layers_roughness_along(s, wi), s.eta), 0.0f);
    r.value += vec3(s.glass_multireflect * s.glass_escape_o * glass_escape * over);
  }
  r.value += terms_diffuse_shape(s, s.diffuse, wo, wi, cos_m) * layers_diffuse_share(s, wo, wi, cos_m, at, ab);

  // ----- facets
  if (!s.is_mirror) {
    float density = terms_pdf_visible(s, wo, wm);
    vec3 f = terms_fresnel_opaque(s, cos_m);
    r.pdf += s.chance_specular * density;
    if (s.weight_glass > 0.0f && !s.is_glass_delta) {
      vec3 glass = terms_fresnel_glass(s, cos_m);
      f += s.weight_glass * glass;
      r.pdf += s.chance_glass * terms_glass_chance(glass, s.glass_tint) * density;
    }
    r.value += f * (terms_dv(s, wo, wi, wm) * over);
  }
  r.value = r.value * wi.z;

  // ----- layers
  if (s.sheen_weight > 0.0f) {
    r.value += layers_eval_sheen(s, wo, wi, at);
    r.pdf += s.chance_sheen * (0.5f / kShadePi);
  }
  if (s.coat > 0.0f) {
    SurfaceEval coat = layers_eval_coat(s, wo, wi);
    r.value += coat.value;
    r.pdf += s.chance_coat * coat.pdf;
  }
  return r;
}

/// Light from the other side: wi.z < 0.
SHADE_APART SHADE_FN SurfaceEval layers_eval_below(SHADE_IN(Surface) s, vec3 wo, vec3 wi, LayersAt at) {
  SurfaceEval r;
  float cos_i = -wi.z;
  vec2 ab = layers_ggx(s, wi, s.curve);
  float across = layers_across(s, at);
  r.pdf = s.chance_diffuse_below * cosine_pdf(cos_i);
  r.value = s.diffuse_below * layers_diffuse_through(s, wi, at, ab) * (cos_i * (1.0f / kShadePi));
  if (s.weight_glass <= 0.0f || s.is_glass_delta) return r;

  float escape =
      s.is_thin ? base_escape(ab) : max(1.0f - table_glass(cos_i, layers_roughness_along(s, wi), 1.0f / s.eta), 0.0f);
  r.value += s.glass_multitransmit * (s.glass_escape_o * escape * cos_i * across);

  if (s.is_thin) {
    // As if reflected, then turned to the other side (KHR_materials_transmission).
    vec3 mirrored = vec3(wi.x, wi.y, cos_i);
    vec3 wm = wo + mirrored;
    float cos_m = 0.5f * length(wm);
    wm = wm * (0.5f / cos_m);
    vec3 f = terms_fresnel_glass(s, cos_m);
    r.value += s.glass_tint * (vec3(1.0f) - f) * (s.weight_glass * terms_dv(s, wo, mirrored, wm) * cos_i * across);
    r.pdf += s.chance_glass * (1.0f - terms_glass_chance(f, s.glass_tint)) * terms_pdf_visible(s, wo, wm);
    return r;
  }

  // ----- Walter et al. 2007, eq. 21, over η² because radiance is what camera paths carry
  vec3 wm = microfacet_half_refract(wo, wi, s.eta);
  float cos_o = dot(wo, wm);
  float cos_t = dot(wi, wm);
  if (cos_o <= 0.0f || cos_t >= 0.0f) return r;
  // From the rarer side: near the critical angle the other cosine has no digits left.
  vec3 f = terms_fresnel_glass_rare(s, s.eta > 1.0f ? cos_o : -cos_t);
  float jacobian = microfacet_refract_jacobian(cos_o, cos_t, s.eta);
  float dg = 4.0f * terms_dv(s, wo, vec3(wi.x, wi.y, cos_i), wm) * cos_i * cos_o;  // D G (wo·wm) / wo.z
  r.value += s.glass_tint * (vec3(1.0f) - f) * (s.weight_glass * dg * jacobian * across / (s.eta * s.eta));
  r.pdf += s.chance_glass * (1.0f - terms_glass_chance(f, s.glass_tint)) *
           (4.0f * cos_o * terms_pdf_visible(s, wo, wm) * jacobian);
  return r;
}

SHADE_APART SHADE_FN SurfaceEval layers_eval(SHADE_IN(Surface) s, vec3 wo, vec3 wi) {
  SurfaceEval r;
  r.value = vec3(0.0f);
  r.pdf = 0.0f;
  if (wo.z <= 0.0f || wi.z == 0.0f) return r;
  bool is_below = wi.z < 0.0f;
  if (is_below && (s.lobes & (kLobeTransmission | kLobeDiffuseTransmission)) == 0) return r;
  LayersAt at = layers_at(s, wi);
  if (is_below) return layers_eval_below(s, wo, wi, at);
  return layers_eval_above(s, wo, wi, at);
}

// ----- sampling

/// Weight over its chance of the delta lobe that goes straight through a smooth sheet.
SHADE_APART SHADE_FN vec3 layers_straight(SHADE_IN(Surface) s, vec3 wo) {
  if (!s.is_thin || !s.is_mirror || s.weight_glass <= 0.0f) return vec3(0.0f);
  float across =
      s.model.literal_layers ? s.coat_over_o * s.sheen_over_o : layers_through(s, s.coat_albedo_o, s.sheen_albedo_o);
  return s.glass_tint * (vec3(1.0f) - terms_fresnel_glass(s, wo.z)) * (s.weight_glass * across);
}

/// `u` chooses between reflection and refraction at a smooth boundary.
SHADE_FN SurfaceSample layers_sample_glass_delta(SHADE_IN(Surface) s, vec3 wo, float u) {
  SurfaceSample r = surface_no_sample(wo);
  r.is_delta = true;
  vec3 f = terms_fresnel_glass(s, wo.z);
  float reflected = terms_glass_chance(f, s.glass_tint);
  if (u < reflected) {
    LayersAt at = layers_at(s, r.wi);
    r.pdf = s.chance_glass * reflected;
    r.weight = f * (s.weight_glass * layers_over(s, at) / r.pdf);
    return r;
  }
  r.pdf = s.chance_glass * (1.0f - reflected);
  if (s.is_thin) {
    r.wi = -wo;
    r.is_straight = true;
    r.weight = layers_straight(s, wo) * (1.0f / r.pdf);
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
SHADE_FN vec3 layers_direction_glass(SHADE_IN(Surface) s, vec3 wo, vec2 u, float u_side) {
  vec3 wm = terms_sample_visible(s, wo, u);
  vec3 reflected = microfacet_reflect(wo, wm);
  vec3 f = terms_fresnel_glass(s, dot(wo, wm));
  if (u_side < terms_glass_chance(f, s.glass_tint)) return reflected.z > 0.0f ? reflected : vec3(0.0f);
  if (s.is_thin) return reflected.z > 0.0f ? vec3(reflected.x, reflected.y, -reflected.z) : vec3(0.0f);
  vec3 refracted = microfacet_refract(wo, wm, s.eta);
  return refracted.z < 0.0f ? refracted : vec3(0.0f);
}

SHADE_FN vec3 uniform_hemisphere_sample(vec2 u) {
  float r = sqrt(max(1.0f - u.x * u.x, 0.0f));
  float phi = 2.0f * kShadePi * u.y;
  return vec3(r * cos(phi), r * sin(phi), u.x);
}

SHADE_APART SHADE_FN SurfaceSample layers_sample(SHADE_IN(Surface) s, vec3 wo, vec3 u) {
  SurfaceSample r = surface_no_sample(wo);
  vec2 u2 = vec2(u.x, u.y);
  vec3 wi = vec3(0.0f);
  float at = s.chance_specular;
  if (u.z < at) {
    if (s.is_mirror) {
      r.is_delta = true;
      r.pdf = s.chance_specular;
      r.weight = terms_fresnel_opaque(s, wo.z) * (layers_over(s, layers_at(s, r.wi)) / r.pdf);
      return r;
    }
    wi = microfacet_reflect(wo, terms_sample_visible(s, wo, u2));
    if (wi.z <= 0.0f) return r;
  } else if (u.z < at + s.chance_glass) {
    float u_side = (u.z - at) / s.chance_glass;
    if (s.is_glass_delta) return layers_sample_glass_delta(s, wo, u_side);
    wi = layers_direction_glass(s, wo, u2, u_side);
  } else if (u.z < at + s.chance_glass + s.chance_coat) {
    if (s.is_coat_mirror) {
      vec3 o = layers_to_coat(s, wo);
      wi = layers_from_coat(s, vec3(-o.x, -o.y, o.z));
      if (wi.z <= 0.0f) return r;
      r.wi = wi;
      r.is_delta = true;
      r.pdf = s.chance_coat;
      // The cosine cancels, so that no other normal's enters.
      r.weight = vec3(s.coat * terms_coat_fresnel(s, o.z) / r.pdf);
      return r;
    }
    vec3 o = layers_to_coat(s, wo);
    wi = layers_from_coat(s, microfacet_reflect(o, ggx_sample_visible(o, s.coat_alpha, u2)));
    if (wi.z <= 0.0f) return r;
  } else if (u.z < at + s.chance_glass + s.chance_coat + s.chance_sheen) {
    wi = uniform_hemisphere_sample(u2);
  } else if (u.z < at + s.chance_glass + s.chance_coat + s.chance_sheen + s.chance_diffuse_below) {
    wi = cosine_sample(u2);
    wi.z = -wi.z;
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

/// Estimated albedo of everything; `specular` that of the base's facets.
SHADE_APART SHADE_FN vec3 layers_albedo(SHADE_IN(Surface) s, vec3 specular) {
  float through = layers_through(s, s.coat_albedo_o, s.sheen_albedo_o);
  return (s.diffuse + s.diffuse_below) * s.film_below_o * s.transmission_o +
         (specular + s.glass_tint * s.weight_glass) * through + s.sheen * s.sheen_albedo_o +
         vec3(s.coat * s.coat_albedo_o);
}

SHADE_END

#endif
