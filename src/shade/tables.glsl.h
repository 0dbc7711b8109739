#ifndef CANDELA_SHADE_TABLES_GLSL_H
#define CANDELA_SHADE_TABLES_GLSL_H

#include "shade/shim.glsl.h"

// Directional albedos that have no closed form, as one array of floats that shade/make_tables.cpp computes at build
// time. C++ reads the array; GLSL reads the same numbers from a texture, 256 texels wide, that whoever compiles the
// shader fills from `shade_tables()`. How entries are found and interpolated is shared.
//
// Roughnesses are spaced evenly, cosines by their square root.

#ifdef __cplusplus
namespace candela::shade {
/// Linked in from the generated source.
extern const float kTableEntries[];
extern const int kTableCount;
inline float shade_table(int index) { return kTableEntries[index]; }
}  // namespace candela::shade
#else
uniform highp sampler2D shade_table_texels;
float shade_table(int index) { return texelFetch(shade_table_texels, ivec2(index & 255, index >> 8), 0).x; }
#endif

SHADE_BEGIN

// ----- what lies where

SHADE_CONST int kTableMu = 40;         // cosines
SHADE_CONST int kTableRoughness = 40;  // roughnesses
SHADE_CONST int kTableIndices = 16;    // relative indices of refraction
SHADE_CONST int kTableLayers = 24;     // roughnesses of a layer
SHADE_CONST int kTableLobes = 32;      // roughnesses of, and cosines at, a lobe below a layer
SHADE_CONST int kTableWidths = 20;     // roughnesses along either axis of an anisotropic lobe, and cosines
SHADE_CONST int kTableAzimuths = 8;    // azimuths, by the roughness along them

/// (A, B) of GGX with height-correlated Smith masking: the albedo is F0·A + F90·B where F rises from F0 to F90 by
/// Schlick's curve, the first one, or by that of an index (fresnel_rise). [curve][roughness][mu][2]
SHADE_CONST int kTableCurves = 17;
SHADE_CONST int kTableGgx = 0;
SHADE_CONST int kTableGgxSlice = kTableRoughness * kTableMu * 2;
/// Cosine-weighted means of (A, B), [curve][roughness][2], and of the curves themselves.
SHADE_CONST int kTableGgxMean = kTableGgx + kTableCurves * kTableGgxSlice;
SHADE_CONST int kTableRise = kTableGgxMean + kTableCurves * kTableRoughness * 2;
/// Albedo of the sheen lobe, and the factor per direction that keeps it below 1. [roughness][mu]
SHADE_CONST int kTableSheen = kTableRise + kTableCurves;
SHADE_CONST int kTableSheenScale = kTableSheen + kTableRoughness * kTableMu;
/// What a rough dielectric boundary reflects and refracts together without multiple scattering, seen from the rarer
/// side and from the denser one: [side][index][roughness][mu]; and means, [side][index][roughness].
SHADE_CONST int kTableGlassSide = kTableIndices * kTableRoughness * kTableMu;
SHADE_CONST int kTableGlass = kTableSheenScale + kTableRoughness * kTableMu;
SHADE_CONST int kTableGlassMean = kTableGlass + 2 * kTableGlassSide;
/// A lobe of GGX below a layer of weight 1 (a coat or a sheen) that lets T through: what dims it on the way in and on
/// the way out alike, over √T, and the (A, B) of what is left, over T, by the curve of index 1.5. [roughness of the
/// layer][roughness of the lobe][mu][3]
SHADE_CONST int kTableOver = kTableLayers * kTableLobes * kTableLobes * 3;
SHADE_CONST int kTableCoatOver = kTableGlassMean + 2 * kTableIndices * kTableRoughness;
SHADE_CONST int kTableSheenOver = kTableCoatOver + kTableOver;
/// What single scattering of white anisotropic GGX loses, and its B by Schlick's curve: [loss, B][roughness along
/// x][along y][azimuth][mu]; and means, [loss, B][along x][along y].
SHADE_CONST int kTableAnisotropic = kTableSheenOver + kTableOver;
SHADE_CONST int kTableAnisotropicSlice = kTableWidths * kTableWidths * kTableAzimuths * kTableWidths;
SHADE_CONST int kTableAnisotropicMean = kTableAnisotropic + 2 * kTableAnisotropicSlice;
/// What facets make of a reflectance that is the polynomial with value 1 at the cosine table_film_cosine(i) and 0 at
/// the others, at 0 and at 1: [i][roughness][mu]; and means, [i][roughness].
SHADE_CONST int kFilmCosines = 8;
SHADE_CONST int kTableFilm = kTableAnisotropicMean + 2 * kTableWidths * kTableWidths;
SHADE_CONST int kTableFilmMean = kTableFilm + kFilmCosines * kTableRoughness * kTableMu;
/// The linear map that turns a white lobe of GGX into a clamped cosine: four of its numbers, see area_lobe().
/// [roughness][mu][4]
SHADE_CONST int kTableCosines = 32;  // of either
SHADE_CONST int kTableCosine = kTableFilmMean + kFilmCosines * kTableRoughness;
/// Light that meets more than one facet, by random walks: the share of it that leaves after the second, and of what is
/// left the share that leaves after each further one, [roughness][2]; and how far a curve has risen in the mean of the
/// facets that it meets, [curve][roughness].
SHADE_CONST int kTableWalk = kTableCosine + kTableCosines * kTableCosines * 4;
SHADE_CONST int kTableWalkRise = kTableWalk + kTableRoughness * 2;
/// Share of what single scattering at a rough dielectric boundary loses that leaves on the denser side, of light from
/// the rarer one. [index][roughness]
SHADE_CONST int kTableGlassThrough = kTableWalkRise + kTableCurves * kTableRoughness;
SHADE_CONST int kTableSize = kTableGlassThrough + kTableIndices * kTableRoughness;

// ----- interpolation

/// A position between two entries.
struct TableCell {
  int i;    ///< the lower one
  float t;  ///< weight of the upper one
};

SHADE_FN TableCell table_cell(float x, int count) {
  TableCell c;
  float s = clamp(x, 0.0f, 1.0f) * float(count - 1);
  c.i = min(int(s), count - 2);
  c.t = s - float(c.i);
  return c;
}

/// Cosines stand closer together near the horizon: x = √µ.
SHADE_FN TableCell table_cell_mu(float mu, int count) { return table_cell(sqrt(max(mu, 0.0f)), count); }

SHADE_FN float table_linear(int at, TableCell x) { return mix(shade_table(at + x.i), shade_table(at + x.i + 1), x.t); }

SHADE_FN float table_bilinear(int at, TableCell x, TableCell y, int width) {
  int row = at + y.i * width;
  return mix(table_linear(row, x), table_linear(row + width, x), y.t);
}

// ----- GGX

/// Which curve the reflectance of a dielectric of this index (≥ 1) follows. They stand evenly in the root of x = (η -
/// 1) / (η + 1) over 0 … kTableCurveMost, so that one of them is that of 1.5, which most surfaces have: then none other
/// is read.
SHADE_CONST float kTableCurveMost = 0.703125f;
SHADE_CONST float kTableMostIndex = 5.7368421f;  // at that x
SHADE_CONST int kTableCurveOfGlass = 9;          // index 1.5

SHADE_FN TableCell table_curve(float eta) {
  float x = max(eta - 1.0f, 0.0f) / (eta + 1.0f);
  float s = min(sqrt(x * (1.0f / kTableCurveMost)), 1.0f) * float(kTableCurves - 2);
  int lower = min(int(s + 1e-4f), kTableCurves - 3);
  TableCell c;
  c.i = lower + 1;
  c.t = max(s - float(lower), 0.0f);
  return c;
}

SHADE_FN TableCell table_curve_at(int curve) {
  TableCell c;
  c.i = curve;
  c.t = 0.0f;
  return c;
}

/// Schlick's.
SHADE_FN TableCell table_curve_schlick() { return table_curve_at(0); }

/// Cosine-weighted mean of a curve, 2 ∫ w(µ) µ dµ.
SHADE_FN float table_rise(TableCell curve) {
  float lower = shade_table(kTableRise + curve.i);
  return curve.t > 0.0f ? mix(lower, shade_table(kTableRise + curve.i + 1), curve.t) : lower;
}

SHADE_FN vec2 table_ggx_slice(int at, TableCell mu, TableCell roughness) {
  int a = at + (roughness.i * kTableMu + mu.i) * 2;
  int b = a + kTableMu * 2;
  vec2 lower = mix(vec2(shade_table(a), shade_table(a + 1)), vec2(shade_table(a + 2), shade_table(a + 3)), mu.t);
  vec2 upper = mix(vec2(shade_table(b), shade_table(b + 1)), vec2(shade_table(b + 2), shade_table(b + 3)), mu.t);
  return mix(lower, upper, roughness.t);
}

SHADE_FN vec2 table_ggx_mean_slice(int at, TableCell roughness) {
  int a = at + roughness.i * 2;
  return mix(vec2(shade_table(a), shade_table(a + 1)), vec2(shade_table(a + 2), shade_table(a + 3)), roughness.t);
}

/// Split-sum terms (A, B) at a cosine, for a roughness and a curve whose cells are known.
SHADE_FN vec2 table_ggx_curve(float mu, TableCell roughness, TableCell curve) {
  TableCell m = table_cell_mu(mu, kTableMu);
  int at = kTableGgx + curve.i * kTableGgxSlice;
  vec2 ab = table_ggx_slice(at, m, roughness);
  if (curve.t > 0.0f) ab = mix(ab, table_ggx_slice(at + kTableGgxSlice, m, roughness), curve.t);
  return ab;
}

SHADE_FN vec2 table_ggx_curve_mean(TableCell roughness, TableCell curve) {
  int at = kTableGgxMean + curve.i * kTableRoughness * 2;
  vec2 ab = table_ggx_mean_slice(at, roughness);
  if (curve.t > 0.0f) ab = mix(ab, table_ggx_mean_slice(at + kTableRoughness * 2, roughness), curve.t);
  return ab;
}

/// What random walks say of light that meets more than one facet, see kTableWalk.
SHADE_FN vec2 table_walk(TableCell roughness) {
  int a = kTableWalk + roughness.i * 2;
  return mix(vec2(shade_table(a), shade_table(a + 1)), vec2(shade_table(a + 2), shade_table(a + 3)), roughness.t);
}

SHADE_FN float table_walk_rise(TableCell roughness, TableCell curve) {
  int at = kTableWalkRise + curve.i * kTableRoughness;
  float lower = table_linear(at, roughness);
  return curve.t > 0.0f ? mix(lower, table_linear(at + kTableRoughness, roughness), curve.t) : lower;
}

#ifdef SHADE_FILTERED_TABLES
// The same tables in a texture that the driver interpolates: for each curve a row for each roughness, its cosines and
// then its mean, each as (B, 1 - A - B), so that half floats keep what little a smooth surface loses, and what
// table_walk and table_walk_rise have. Whoever compiles the shader fills it from the array.
uniform highp sampler2D shade_ggx_texels;

vec2 table_ggx_column(float x, TableCell roughness, TableCell curve) {
  // No row is filtered with the next curve's: the last one is met in its middle.
  vec2 at = vec2(x + 0.5, float(curve.i * kTableRoughness + roughness.i) + roughness.t + 0.5);
  vec2 size = vec2(kTableMu + 3, kTableCurves * kTableRoughness);
  vec2 texel = textureLod(shade_ggx_texels, at / size, 0.0).xy;
  if (curve.t > 0.0) {
    at.y += float(kTableRoughness);
    texel = mix(texel, textureLod(shade_ggx_texels, at / size, 0.0).xy, curve.t);
  }
  return texel;
}

vec2 table_ggx_texel(float x, TableCell roughness, TableCell curve) {
  vec2 texel = table_ggx_column(x, roughness, curve);
  return vec2(1.0 - texel.x - texel.y, texel.x);
}

vec2 table_ggx_filtered(float mu, TableCell roughness, TableCell curve) {
  return table_ggx_texel(sqrt(clamp(mu, 0.0, 1.0)) * float(kTableMu - 1), roughness, curve);
}

vec2 table_ggx_mean_filtered(TableCell roughness, TableCell curve) {
  return table_ggx_texel(float(kTableMu), roughness, curve);
}

vec2 table_walk_filtered(TableCell roughness) {
  return table_ggx_column(float(kTableMu + 1), roughness, table_curve_schlick());
}

float table_walk_rise_filtered(TableCell roughness, TableCell curve) {
  return table_ggx_column(float(kTableMu + 2), roughness, curve).x;
}

#define table_walk table_walk_filtered
#define table_walk_rise table_walk_rise_filtered
#define table_ggx_curve table_ggx_filtered
#define table_ggx_curve_mean table_ggx_mean_filtered
#endif

/// The same by Schlick's curve.
SHADE_FN vec2 table_ggx(float mu, TableCell roughness) { return table_ggx_curve(mu, roughness, table_curve_schlick()); }

SHADE_FN vec2 table_ggx_mean(TableCell roughness) { return table_ggx_curve_mean(roughness, table_curve_schlick()); }

/// B where a table knows that of one curve: `rise`, of what is like a lobe that has `from` by that curve and `to` by
/// the one that is wanted. `share` is how much of the lobe it is.
SHADE_FN float table_other_rise(float rise, float from, float to, float share) {
  return to >= from ? rise + share * (to - from) : rise * (to / max(from, 1e-6f));
}

SHADE_FN TableCell table_ggx_roughness(float roughness) { return table_cell(roughness, kTableRoughness); }

// ----- curves of reflectance other than a boundary's

/// Chebyshev's points, between which a polynomial strays least.
SHADE_FN float table_film_cosine(int i) {
  return 0.5f - 0.5f * cos(kShadePi * float(i + 1) * (1.0f / float(kFilmCosines + 1)));
}

SHADE_FN float table_film(int i, TableCell mu, TableCell roughness) {
  return table_bilinear(kTableFilm + i * kTableRoughness * kTableMu, mu, roughness, kTableMu);
}

SHADE_FN float table_film_mean(int i, TableCell roughness) {
  return table_linear(kTableFilmMean + i * kTableRoughness, roughness);
}

// ----- lobes as transformed cosines

SHADE_FN vec4 table_cosine_entry(int entry) {
  return vec4(shade_table(entry), shade_table(entry + 1), shade_table(entry + 2), shade_table(entry + 3));
}

SHADE_FN vec4 table_cosine(float mu, float roughness) {
  TableCell m = table_cell_mu(mu, kTableCosines);
  TableCell r = table_cell(roughness, kTableCosines);
  int a = kTableCosine + (r.i * kTableCosines + m.i) * 4;
  int b = a + kTableCosines * 4;
  return mix(mix(table_cosine_entry(a), table_cosine_entry(a + 4), m.t),
             mix(table_cosine_entry(b), table_cosine_entry(b + 4), m.t), r.t);
}

// ----- sheen

/// Fibres narrower than this have a lobe that only grazing light sees and single precision cannot normalise.
SHADE_CONST float kSheenLeastRoughness = 0.07f;

/// Narrow fibres change fastest: entries stand evenly in the root of what is above the least roughness.
SHADE_FN TableCell table_cell_sheen(float roughness, int count) {
  return table_cell(sqrt(max((roughness - kSheenLeastRoughness) * (1.0f / (1.0f - kSheenLeastRoughness)), 0.0f)),
                    count);
}

SHADE_FN float table_sheen(float mu, float roughness) {
  return table_bilinear(kTableSheen, table_cell_mu(mu, kTableMu), table_cell_sheen(roughness, kTableRoughness),
                        kTableMu);
}

SHADE_FN float table_sheen_scale(float mu, float roughness) {
  return table_bilinear(kTableSheenScale, table_cell_mu(mu, kTableMu), table_cell_sheen(roughness, kTableRoughness),
                        kTableMu);
}

// ----- rough dielectric boundaries

/// Where relative indices stand: evenly in the root of x = (η - 1) / (η + 1) over 0 … kTableGlassMost, for η ≥ 1.
/// Media that hardly differ bend hardly, and change fastest.
SHADE_CONST float kTableGlassMost = 0.6f;  // η = 4

SHADE_FN TableCell table_cell_index(float eta) {
  float dense = max(eta, 1.0f / eta);
  return table_cell(sqrt(max(dense - 1.0f, 0.0f) / (dense + 1.0f) * (1.0f / kTableGlassMost)), kTableIndices);
}

/// `eta` = n on the other side / n on the side of the direction.
SHADE_FN float table_glass(float mu, float roughness, float eta) {
  TableCell index = table_cell_index(eta);
  TableCell row = table_cell(roughness, kTableRoughness);
  TableCell m = table_cell_mu(mu, kTableMu);
  int slice = kTableRoughness * kTableMu;
  int at = kTableGlass + (eta < 1.0f ? kTableGlassSide : 0) + index.i * slice;
  return mix(table_bilinear(at, m, row, kTableMu), table_bilinear(at + slice, m, row, kTableMu), index.t);
}

SHADE_FN float table_glass_mean(float roughness, float eta) {
  int at = kTableGlassMean + (eta < 1.0f ? kTableIndices * kTableRoughness : 0);
  return table_bilinear(at, table_cell(roughness, kTableRoughness), table_cell_index(eta), kTableRoughness);
}

SHADE_FN float table_glass_through(float roughness, float eta) {
  return table_bilinear(kTableGlassThrough, table_cell(roughness, kTableRoughness), table_cell_index(eta),
                        kTableRoughness);
}

// ----- layers over GGX

SHADE_FN vec3 table_over_entry(int entry) {
  return vec3(shade_table(entry), shade_table(entry + 1), shade_table(entry + 2));
}

SHADE_FN vec3 table_over_row(int at, TableCell mu) {
  return mix(table_over_entry(at + mu.i * 3), table_over_entry(at + mu.i * 3 + 3), mu.t);
}

SHADE_FN vec3 table_over(int at, float mu, float roughness, TableCell layer) {
  TableCell lobe = table_cell(roughness, kTableLobes);
  TableCell m = table_cell_mu(mu, kTableLobes);
  int row = kTableLobes * 3;
  int slice = kTableLobes * row;
  int a = at + layer.i * slice + lobe.i * row;
  vec3 lower = mix(table_over_row(a, m), table_over_row(a + row, m), lobe.t);
  vec3 upper = mix(table_over_row(a + slice, m), table_over_row(a + slice + row, m), lobe.t);
  return mix(lower, upper, layer.t);
}

/// Factor per direction, A and B, below a coat of albedo `e` at this cosine.
SHADE_FN vec3 table_coat_over(float mu, float roughness, float coat_roughness, float e) {
  float t = max(1.0f - e, 0.0f);
  return table_over(kTableCoatOver, mu, roughness, table_cell(coat_roughness, kTableLayers)) * vec3(sqrt(t), t, t);
}

/// The same below a sheen.
SHADE_FN vec3 table_sheen_over(float mu, float roughness, float sheen_roughness, float e) {
  float t = max(1.0f - e, 0.0f);
  return table_over(kTableSheenOver, mu, roughness, table_cell_sheen(sheen_roughness, kTableLayers)) *
         vec3(sqrt(t), t, t);
}

// ----- anisotropic GGX

SHADE_FN vec2 table_anisotropic_at(int at, TableCell azimuth, TableCell mu) {
  return vec2(table_bilinear(at, mu, azimuth, kTableWidths),
              table_bilinear(at + kTableAnisotropicSlice, mu, azimuth, kTableWidths));
}

/// (1 - albedo, B) at a direction with this cosine, along which the lobe has the roughness `along`.
SHADE_FN vec2 table_anisotropic(float mu, float along, float roughness_x, float roughness_y) {
  TableCell x = table_cell(roughness_x, kTableWidths);
  TableCell y = table_cell(roughness_y, kTableWidths);
  TableCell m = table_cell_mu(mu, kTableWidths);
  float least = min(roughness_x, roughness_y);
  float most = max(roughness_x, roughness_y);
  TableCell c = table_cell((along - least) / max(most - least, 1e-6f), kTableAzimuths);
  int cell = kTableAzimuths * kTableWidths;
  int row = kTableWidths * cell;
  int at = kTableAnisotropic + x.i * row + y.i * cell;
  vec2 lower = mix(table_anisotropic_at(at, c, m), table_anisotropic_at(at + cell, c, m), y.t);
  vec2 upper = mix(table_anisotropic_at(at + row, c, m), table_anisotropic_at(at + row + cell, c, m), y.t);
  return mix(lower, upper, x.t);
}

SHADE_FN vec2 table_anisotropic_mean(float roughness_x, float roughness_y) {
  TableCell x = table_cell(roughness_x, kTableWidths);
  TableCell y = table_cell(roughness_y, kTableWidths);
  return vec2(table_bilinear(kTableAnisotropicMean, y, x, kTableWidths),
              table_bilinear(kTableAnisotropicMean + kTableWidths * kTableWidths, y, x, kTableWidths));
}

SHADE_END

#endif
