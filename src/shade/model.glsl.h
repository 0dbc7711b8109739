#ifndef CANDELA_SHADE_MODEL_GLSL_H
#define CANDELA_SHADE_MODEL_GLSL_H

#include "shade/shim.glsl.h"

// Which formula stands for each term of the surface. The default is the model that keeps energy and reciprocity; the
// others are what engines and texts use, for comparison.

SHADE_BEGIN

// D, the distribution of facets.
SHADE_CONST int kDistributionGgx = 0;
SHADE_CONST int kDistributionBeckmann = 1;
SHADE_CONST int kDistributionBlinnPhong = 2;
SHADE_CONST int kDistributionCharlie = 3;

// G, masking and shadowing.
SHADE_CONST int kMaskingSmithCorrelated = 0;
SHADE_CONST int kMaskingSmithSeparable = 1;
SHADE_CONST int kMaskingSchlickDirect = 2;  // k = (r + 1)² / 8
SHADE_CONST int kMaskingSchlickIbl = 3;     // k = r² / 2
SHADE_CONST int kMaskingBeckmannRational = 4;
SHADE_CONST int kMaskingCharlie = 5;

// F, reflectance of a facet.
SHADE_CONST int kFresnelSchlick = 0;
SHADE_CONST int kFresnelSphericalGaussian = 1;
SHADE_CONST int kFresnelExact = 2;  // dielectric by index, between its F0 and F90; metals Schlick's
SHADE_CONST int kFresnelF82 = 3;    // the same, and of metals specular_color is the tint at 82°

// The diffuse layer.
SHADE_CONST int kDiffuseLambert = 0;
SHADE_CONST int kDiffuseBurley = 1;
SHADE_CONST int kDiffuseOrenNayar = 2;
SHADE_CONST int kDiffuseEon = 3;

// How specular and diffuse share the light.
SHADE_CONST int kBlendAlbedo = 0;      // diffuse below a boundary, coupled by its albedo: reciprocal, keeps energy
SHADE_CONST int kBlendHalfVector = 1;  // glTF, LearnOpenGL: diffuse · (1 - F(VoH))
SHADE_CONST int kBlendView = 2;        // thesis: diffuse · (1 - F_diff), F_diff at NoV
SHADE_CONST int kBlendSum = 3;         // UE4: diffuse is not dimmed by the specular lobe
SHADE_CONST int kBlendPhong = 4;       // Blinn–Phong: kd ρ + ks (NoH)^n without a microfacet denominator

struct ShadingModel {
  int distribution;
  int masking;
  int fresnel;
  int diffuse;
  int blend;
  bool multiscatter;    ///< returns the light that single scattering between facets loses
  bool literal_layers;  ///< clearcoat and sheen dim what is below them as glTF prints it (view alone: not reciprocal)
};

SHADE_FN ShadingModel shading_model_candela() {
  ShadingModel m;
  m.distribution = kDistributionGgx;
  m.masking = kMaskingSmithCorrelated;
  m.fresnel = kFresnelExact;
  m.diffuse = kDiffuseLambert;
  m.blend = kBlendAlbedo;
  m.multiscatter = true;
  m.literal_layers = false;
  return m;
}

/// glTF 2.0 Appendix B and the extensions, as printed.
SHADE_FN ShadingModel shading_model_gltf() {
  ShadingModel m = shading_model_candela();
  m.fresnel = kFresnelSchlick;
  m.blend = kBlendHalfVector;
  m.multiscatter = false;
  m.literal_layers = true;
  return m;
}

/// Karis 2013, "Real Shading in Unreal Engine 4".
SHADE_FN ShadingModel shading_model_ue4() {
  ShadingModel m = shading_model_gltf();
  m.masking = kMaskingSchlickDirect;
  m.fresnel = kFresnelSphericalGaussian;
  m.blend = kBlendSum;
  return m;
}

/// de Vries, "LearnOpenGL", PBR chapters.
SHADE_FN ShadingModel shading_model_learnopengl() {
  ShadingModel m = shading_model_gltf();
  m.masking = kMaskingSchlickDirect;
  return m;
}

/// Ratković 2017: Beckmann facets, its rational masking, Schlick, diffuse dimmed by F_diff at NoV.
SHADE_FN ShadingModel shading_model_thesis() {
  ShadingModel m = shading_model_gltf();
  m.distribution = kDistributionBeckmann;
  m.masking = kMaskingBeckmannRational;
  m.blend = kBlendView;
  return m;
}

/// The non-physical baseline. Blinn 1977, "Models of Light Reflection for Computer Synthesized Pictures".
SHADE_FN ShadingModel shading_model_blinn_phong() {
  ShadingModel m = shading_model_gltf();
  m.distribution = kDistributionBlinnPhong;
  m.blend = kBlendPhong;
  return m;
}

/// Whether dielectrics have the curve of their index.
SHADE_FN bool shading_model_has_index(ShadingModel m) { return m.fresnel == kFresnelExact || m.fresnel == kFresnelF82; }

/// Whether it is the default, for which the compiler keeps nothing of the others.
SHADE_FN bool shading_model_is_default(ShadingModel m) {
  return m.distribution == kDistributionGgx && m.masking == kMaskingSmithCorrelated && m.fresnel == kFresnelExact &&
         m.diffuse == kDiffuseLambert && m.blend == kBlendAlbedo && m.multiscatter && !m.literal_layers;
}

SHADE_END

#endif
