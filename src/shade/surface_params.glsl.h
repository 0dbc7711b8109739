#ifndef CANDELA_SHADE_SURFACE_PARAMS_GLSL_H
#define CANDELA_SHADE_SURFACE_PARAMS_GLSL_H

#include "shade/model.glsl.h"
#include "shade/surface_constants.glsl.h"
#include "shade/tables.glsl.h"

SHADE_BEGIN

// What a material uses beyond metallic-roughness with ior and specular. A set of these bits is known per material; what
// is absent costs nothing.
SHADE_CONST int kLobeModel = 1;  // terms other than the default ones
SHADE_CONST int kLobeAnisotropy = 2;
SHADE_CONST int kLobeIridescence = 4;
SHADE_CONST int kLobeConductor = 8;  // measured metal
SHADE_CONST int kLobeTransmission = 16;
SHADE_CONST int kLobeDiffuseTransmission = 32;
SHADE_CONST int kLobeSheen = 64;
SHADE_CONST int kLobeClearcoat = 128;
SHADE_CONST int kLobeDiffuseRoughness = 256;
SHADE_CONST int kLobeRetroreflection = 512;
SHADE_CONST int kLobeFuzz = 1024;
SHADE_CONST int kLobeEdgeColor = 2048;  // the specular colour is that of the whole lobe
SHADE_CONST int kLobeCoatAnisotropy = 4096;

// Lobes that have something in common: fibres above the base, and a curve of reflectance of their own.
SHADE_CONST int kLobesOfFibres = kLobeSheen | kLobeFuzz;
SHADE_CONST int kLobesOfFresnel = kLobeModel | kLobeConductor | kLobeIridescence | kLobeEdgeColor;

// Of parameters or a surface. A shader that is made for one material has them as a constant, LOBES: what it lacks is
// then gone before a driver has to look through it.
#ifdef LOBES
#define SHADE_LOBES(x) LOBES
#else
#define SHADE_LOBES(x) (x).lobes
#endif

/// What textures and factors say at one point, before any physics. Linear Rec.709.
struct SurfaceParams {
  int lobes;  ///< kLobe… bits; fields of lobes that are absent are not read
  vec3 base_color;
  float metallic;
  float roughness;
  float ior;  ///< 0 = the specification's compatibility mode with F0 = F90 = 1
  float specular;
  vec3 specular_color;
  ShadingModel model;

  float anisotropy;  ///< strength; the frame's x axis is the direction in which the lobe is wide

  float iridescence;
  float film_ior;
  float film_nm;  ///< thickness

  vec3 conductor_n;
  vec3 conductor_k;

  float transmission;
  bool is_thin;  ///< a sheet: light leaves where it enters, unbent
  float eta;     ///< n on the far side / n on the viewer's side; of a body that transmits

  float diffuse_transmission;
  vec3 diffuse_transmission_color;
  float scatter;  ///< share of what a sheet transmits that is scattered, below the bit of diffuse transmission
  vec3 scatter_color;
  float scatter_anisotropy;  ///< of which (1 + this) / 2 leaves on the other side

  vec3 sheen_color;
  float sheen_roughness;

  float clearcoat;
  float clearcoat_roughness;
  vec3 clearcoat_normal;       ///< local
  float clearcoat_ior;         ///< 0: it reflects all
  vec3 clearcoat_color;        ///< what it leaves of white light that crosses it twice at normal incidence
  float clearcoat_darkening;   ///< how much counts of the light that its underside sends back down
  float clearcoat_anisotropy;  ///< strength
  vec3 clearcoat_direction;    ///< local, in which the coat's lobe is wide

  float diffuse_roughness;

  float retroreflection;  ///< share of what opaque facets reflect that returns to where it came from

  float fuzz;  ///< weight of fibres above everything
  vec3 fuzz_color;
  float fuzz_roughness;
};

/// The closure: what eval, sample and pdf need, computed once per hit for one viewing direction.
struct Surface {
  int lobes;

  // ----- the base: weights of its three kinds of matter add to 1
  float weight_dielectric;  ///< opaque
  float weight_metal;
  float weight_glass;
  vec3 diffuse;  ///< albedo of the diffuse layer, times its weight
  vec3 f0_dielectric;
  float f90_dielectric;
  vec3 f0_metal;
  float roughness;
  float alpha;
  bool is_mirror;    ///< the specular lobe is a delta
  TableCell row;     ///< of `roughness` in the tables of GGX
  float index;       ///< of the dielectric boundary; 0 where its reflectance rises by Schlick's curve
  float rise_scale;  ///< see fresnel_rise
  float rise_mean;   ///< of that curve, over the facets that multiply scattered light meets
  TableCell curve;   ///< and its place in the tables of GGX; Schlick's of a metal alone

  // ----- energy: what single scattering loses, and what the boundary lets through
  float escape_mean;       ///< 1 - mean albedo of single scattering between white facets
  float escape_o;          ///< 1 - that albedo at wo
  vec3 multiscatter;       ///< reflected share of what is lost / (π escape_mean)
  vec3 single_albedo_o;    ///< of the opaque facets at wo, single scattering
  vec3 specular_albedo_o;  ///< and multiple scattering included
  float boundary_f0;       ///< of the dielectric boundary above the diffuse layer, strongest channel
  float boundary_escape;   ///< its share of multiply scattered light
  float transmission_o;    ///< of everything above the diffuse layer at wo
  float diffuse_scale;     ///< 1 / its cosine-weighted mean

  // ----- chances of the lobes to be sampled; they add to 1 where there is anything
  float chance_specular;
  float chance_diffuse;  ///< cosine-weighted, upper side

  // ----- below here only with the bits that need it
  ShadingModel model;
  float alpha_x;
  float alpha_y;

  float iridescence;
  float film_ior;
  float film_nm;
  vec3 film_f0_dielectric;  ///< of the matter below the film
  vec3 film_f0_metal;
  vec3 film_beyond[kFilmCosines];  ///< what a dielectric's film reflects beyond the bare boundary's curve
  bool has_film_below;             ///< a diffuse layer may lie below a film
  vec3 film_escape;                ///< share of what single scattering loses that the film reflects
  vec3 film_below_o;      ///< of each channel that reaches the diffuse layer over the share of the strongest, at wo
  vec3 film_below_scale;  ///< likewise, of diffuse_scale
  bool has_f82_tint;      ///< a metal's reflectance dips near 82°
  vec3 f82_tint;
  vec3 f90_tint;  ///< of a dielectric's reflectance at grazing angles
  vec3 conductor_n;
  vec3 conductor_k;

  bool is_thin;
  bool is_glass_delta;
  float eta;
  float glass_f0;  ///< of the bare boundary
  vec3 glass_f0_tinted;
  vec3 glass_tint;   ///< of what goes through
  vec3 glass_shine;  ///< of what is reflected, beyond its F0
  float glass_escape_o;
  float glass_reflected;     ///< share of what single scattering loses that stays on this side
  float glass_multireflect;  ///< as `multiscatter`
  vec3 glass_multitransmit;  ///< and what goes to the other side
  vec3 diffuse_below;        ///< albedo of diffuse transmission, times its weight

  vec3 sheen;  ///< colour
  float sheen_alpha;
  float sheen_roughness;
  float sheen_weight;  ///< strongest channel of the colour: how much of a sheen lies above the base
  float sheen_albedo_o;
  float sheen_scale_o;
  float sheen_over_o;       ///< how it dims the specular lobe at wo
  bool is_sheen_on_top;     ///< of the coat too, which it then dims
  vec3 sheen_normal;        ///< of fibres on top
  float sheen_over_coat_o;  ///< how they dim the coat's lobe at wo

  float coat;  ///< weight
  float coat_alpha;
  vec2 coat_widths;  ///< alphas along the coat's tangent and across it
  float coat_roughness;
  bool is_coat_mirror;
  vec3 coat_normal;
  vec3 coat_tangent;
  TableCell coat_row;
  TableCell coat_curve;
  float coat_escape_share;  ///< share that it reflects of what its single scattering loses
  float coat_multiscatter;  ///< as `multiscatter`
  float coat_escape_o;
  float coat_albedo_o;
  float coat_over_o;  ///< how it dims the specular lobe at wo
  float coat_f0;
  float coat_index;     ///< 0 where its reflectance rises by Schlick's curve
  float coat_strength;  ///< how far the tables of what lies below it count
  bool is_coat_clear;   ///< neither coloured nor darkening
  vec3 coat_color;
  vec3 coat_darkening;  ///< factor of all that lies below it
  vec3 coat_tint_o;     ///< left of light on its way through it to wo

  float diffuse_roughness;
  vec3 diffuse_color;  ///< of that layer, whatever its weight
  vec3 diffuse_below_color;
  float diffuse_balance_mean;  ///< mean transmission of the boundary
  float diffuse_balance_o;     ///< see rough_diffuse_balance

  float retroreflection;

  float chance_glass;
  float chance_diffuse_below;  ///< cosine-weighted, other side
  float chance_sheen;
  float chance_coat;
};

/// A layer above the base, seen at one direction: its albedo at weight 1, and how it dims the base's specular lobe (see
/// table_over).
struct LayerAt {
  float albedo;
  vec3 over;
};

struct SurfaceEval {
  vec3 value;  ///< f·|cos θi|
  float pdf;   ///< per solid angle
};

struct SurfaceSample {
  vec3 wi;      ///< wi.z < 0: through the surface
  vec3 weight;  ///< f·|cos θi| / pdf; 0 = no sample
  float pdf;    ///< per solid angle; of a delta lobe the probability of choosing it
  bool is_delta;
  bool is_straight;  ///< passed a sheet without turning: wi = -wo
};

/// Directional albedos at wo, each as it is left by what lies above it.
struct SurfaceShares {
  vec3 specular;  ///< opaque facets, of one reflection
  vec3 spread;    ///< of several among them, which leaves as widely as diffuse light
  vec3 diffuse;
  vec3 below;    ///< diffuse light from the other side
  vec3 glass;    ///< facets of the transparent part, reflected
  vec3 through;  ///< and let through, tint included: of one sheet, or of one boundary of a body
  vec3 sheen;
  vec3 coat;
  float rise;       ///< of what the facets reflect, the share by which Fresnel's terms have risen from F0
  float coat_rise;  ///< the same of the coat
};

SHADE_FN LayerAt layer_absent() {
  LayerAt at;
  at.albedo = 0.0f;
  at.over = vec3(1.0f);
  return at;
}

SHADE_FN SurfaceParams surface_params_default() {
  SurfaceParams p;
  p.lobes = 0;
  p.base_color = vec3(1.0f);
  p.metallic = 1.0f;
  p.roughness = 1.0f;
  p.ior = 1.5f;
  p.specular = 1.0f;
  p.specular_color = vec3(1.0f);
  p.model = shading_model_candela();
  p.anisotropy = 0.0f;
  p.iridescence = 0.0f;
  p.film_ior = 1.3f;
  p.film_nm = 400.0f;
  p.conductor_n = vec3(1.0f);
  p.conductor_k = vec3(0.0f);
  p.transmission = 0.0f;
  p.is_thin = true;
  p.eta = 1.5f;
  p.diffuse_transmission = 0.0f;
  p.diffuse_transmission_color = vec3(1.0f);
  p.scatter = 0.0f;
  p.scatter_color = vec3(1.0f);
  p.scatter_anisotropy = 0.0f;
  p.sheen_color = vec3(0.0f);
  p.sheen_roughness = 0.0f;
  p.clearcoat = 0.0f;
  p.clearcoat_roughness = 0.0f;
  p.clearcoat_normal = vec3(0.0f, 0.0f, 1.0f);
  p.clearcoat_ior = kCoatIndex;
  p.clearcoat_color = vec3(1.0f);
  p.clearcoat_darkening = 0.0f;
  p.clearcoat_anisotropy = 0.0f;
  p.clearcoat_direction = vec3(1.0f, 0.0f, 0.0f);
  p.diffuse_roughness = 0.0f;
  p.retroreflection = 0.0f;
  p.fuzz = 0.0f;
  p.fuzz_color = vec3(1.0f);
  p.fuzz_roughness = 0.5f;
  return p;
}

SHADE_END

#endif
