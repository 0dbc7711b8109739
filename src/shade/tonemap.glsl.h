#ifndef CANDELA_SHADE_TONEMAP_GLSL_H
#define CANDELA_SHADE_TONEMAP_GLSL_H

#include "shade/shim.glsl.h"

// Tone curves: exposed linear Rec.709, 0 … ∞, to linear Rec.709 that a display can show, 0 … 1, before the sRGB
// encoding. Every curve sends black to black and never leaves [0, 1]; tone_limit makes any finite input safe.

SHADE_BEGIN

SHADE_CONST int kTonePbrNeutral = 0;
SHADE_CONST int kToneAgx = 1;
SHADE_CONST int kToneAces = 2;
SHADE_CONST int kToneReinhard = 3;
SHADE_CONST int kToneExponential = 4;
SHADE_CONST int kToneLinear = 5;
SHADE_CONST int kToneHable = 6;

/// Drops negative light and what is so bright that the square in a rational curve would overflow; 1e6 is white to all.
SHADE_FN vec3 tone_limit(vec3 color) { return clamp(color, vec3(0.0f), vec3(1e6f)); }

/// Clips at the display's white.
SHADE_FN vec3 tone_linear(vec3 color) { return clamp(color, vec3(0.0f), vec3(1.0f)); }

/// Khronos PBR Neutral (Khronos Group 2024, "PBR Neutral Tone Mapping", specification): base colours up to 0.8 under
/// white light of radiance 1 keep their hue and saturation; only highlights are compressed and desaturated.
SHADE_FN vec3 tone_pbr_neutral(vec3 color) {
  const float f90 = 0.04f;  // Fresnel reflectance that the curve takes off again
  const float start_compression = 0.8f - f90;
  const float desaturation = 0.15f;
  vec3 c = tone_limit(color);
  float darkest = min(c.x, min(c.y, c.z));
  float offset = darkest < 2.0f * f90 ? darkest - darkest * darkest / (4.0f * f90) : f90;
  c = c - vec3(offset);
  float peak = shade_max3(c);
  if (peak < start_compression) return c;
  float d = 1.0f - start_compression;
  float new_peak = 1.0f - d * d / (peak + d - start_compression);
  float g = 1.0f / (desaturation * (peak - new_peak) + 1.0f);
  return mix(vec3(new_peak), c * (new_peak / peak), g);
}

/// AgX's default contrast on its log axis, a sixth-order fit. Wrensch 2023, "Minimal AgX Implementation" (iolite); its
/// value at 0 is -0.0023 (clipped to black afterwards) and at 1 is 0.9986, so AgX white is code 254 or 255 of 255.
SHADE_FN vec3 tone_agx_contrast(vec3 x) {
  vec3 x2 = x * x;
  vec3 x4 = x2 * x2;
  return 15.5f * x4 * x2 - 40.14f * x4 * x + 31.96f * x4 - 6.868f * x2 * x + 0.4298f * x2 + 0.1191f * x -
         vec3(0.00232f);
}

/// AgX (Sobotka 2022; the Rec.2020 base of Blender 4.0 by EaryChow, AgXBaseRec2020), without a look. The outset matrix
/// is the inverse of EaryChow's outset; Rec.709 <-> Rec.2020 follows from the primaries (ITU-R BT.2087-0).
SHADE_FN vec3 tone_agx(vec3 color) {
  // Columns, as GLSL and glm fill a matrix.
  mat3 rec2020_from_rec709 =
      mat3(0.6274039f, 0.0690973f, 0.0163914f, 0.3292830f, 0.9195404f, 0.0880133f, 0.0433131f, 0.0113623f, 0.8955953f);
  mat3 rec709_from_rec2020 = mat3(1.6604910f, -0.1245505f, -0.0181508f, -0.5876411f, 1.1328999f, -0.1005789f,
                                  -0.0728499f, -0.0083494f, 1.1187297f);
  mat3 inset = mat3(0.856627153315983f, 0.137318972929847f, 0.11189821299995f, 0.0951212405381588f, 0.761241990602591f,
                    0.0767994186031903f, 0.0482516061458583f, 0.101439036467562f, 0.811302368396859f);
  mat3 outset =
      mat3(1.1271005818144368f, -0.1413297634984383f, -0.14132976349843826f, -0.11060664309660323f, 1.157823702216272f,
           -0.11060664309660294f, -0.016493938717834573f, -0.016493938717834257f, 1.2519364065950405f);
  const float min_log2 = -12.47393f;  // 10 stops below middle grey 0.18
  const float max_log2 = 4.026069f;   // 6.5 stops above

  vec3 c = inset * (rec2020_from_rec709 * tone_limit(color));
  c = (log2(max(c, vec3(1e-10f))) - vec3(min_log2)) / (max_log2 - min_log2);
  c = outset * tone_agx_contrast(clamp(c, vec3(0.0f), vec3(1.0f)));
  c = rec709_from_rec2020 * pow(max(c, vec3(0.0f)), vec3(2.2f));
  return clamp(c, vec3(0.0f), vec3(1.0f));
}

/// ACES RRT and sRGB ODT. Fit by Stephen Hill, in Pettineo & Neubelt, "Baking Lab" (ACES.hlsl). Input matrix: sRGB to
/// AP1 (Bradford) with RRT saturation 0.96; output: ODT saturation 0.93 and back. No extra exposure: 0.18 comes out
/// near 0.1, as in ACES itself (some viewers multiply by 1/0.6 or 1.8 first).
SHADE_FN vec3 tone_aces(vec3 color) {
  mat3 rrt_from_rec709 = mat3(0.59719f, 0.07600f, 0.02840f, 0.35458f, 0.90834f, 0.13383f, 0.04823f, 0.01566f, 0.83777f);
  mat3 rec709_from_odt =
      mat3(1.60475f, -0.10208f, -0.00327f, -0.53108f, 1.10813f, -0.07276f, -0.07367f, -0.00605f, 1.07602f);
  vec3 v = rrt_from_rec709 * tone_limit(color);
  vec3 a = v * (v + vec3(0.0245786f)) - vec3(0.000090537f);
  vec3 b = v * (0.983729f * v + vec3(0.4329510f)) + vec3(0.238081f);
  return clamp(rec709_from_odt * (a / b), vec3(0.0f), vec3(1.0f));
}

/// x / (1 + x). Reinhard et al. 2002, "Photographic Tone Reproduction for Digital Images", eq. 3, but on each channel
/// instead of luminance, so that bright saturated light turns white and nothing leaves [0, 1].
SHADE_FN vec3 tone_reinhard(vec3 color) {
  vec3 c = tone_limit(color);
  return c / (vec3(1.0f) + c);
}

/// 1 - e^-x on each channel: the response of film that saturates, slope 1 at black.
SHADE_FN vec3 tone_exponential(vec3 color) { return vec3(1.0f) - exp(-tone_limit(color)); }

/// The curve of a film's print on each channel, with a toe and a shoulder, to one before its white is scaled: x (A x +
/// C B) + D E over x (A x + B) + D F, less E / F, as one fraction that is 0 at black. Hable 2010, "Uncharted 2: HDR
/// Lighting" (GDC), with its constants.
SHADE_FN vec3 tone_hable_curve(vec3 x) {
  return x * (0.042f * x + vec3(0.005f)) / (0.3f * (x * (0.15f * x + vec3(0.5f)) + vec3(0.06f)));
}

/// And its exposure, twice what comes in, and white, which is 11.2 of that.
SHADE_FN vec3 tone_hable(vec3 color) {
  return min(tone_hable_curve(2.0f * tone_limit(color)) / tone_hable_curve(vec3(11.2f)), vec3(1.0f));
}

/// The curve by number; unknown numbers clip.
SHADE_FN vec3 tone_map(int curve, vec3 color) {
  if (curve == kTonePbrNeutral) return tone_pbr_neutral(color);
  if (curve == kToneAgx) return tone_agx(color);
  if (curve == kToneAces) return tone_aces(color);
  if (curve == kToneReinhard) return tone_reinhard(color);
  if (curve == kToneHable) return tone_hable(color);
  if (curve == kToneExponential) return tone_exponential(color);
  return tone_linear(color);
}

SHADE_END

#endif
