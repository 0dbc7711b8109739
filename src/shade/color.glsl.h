#ifndef CANDELA_SHADE_COLOR_GLSL_H
#define CANDELA_SHADE_COLOR_GLSL_H

#include "shade/shim.glsl.h"

SHADE_BEGIN

/// Relative luminance of linear Rec.709 (ITU-R BT.709-6, item 3.2).
SHADE_FN float color_luminance(vec3 rgb) { return dot(rgb, vec3(0.2126f, 0.7152f, 0.0722f)); }

/// Linear light in [0, 1] to the sRGB code value in [0, 1]. IEC 61966-2-1:1999, exact piecewise curve.
SHADE_FN float srgb_encode_channel(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * pow(linear, 1.0f / 2.4f) - 0.055f;
}

/// Inverse of srgb_encode_channel.
SHADE_FN float srgb_decode_channel(float code) {
  return code <= 0.04045f ? code / 12.92f : pow((code + 0.055f) / 1.055f, 2.4f);
}

SHADE_FN vec3 srgb_encode(vec3 linear) {
  return vec3(srgb_encode_channel(linear.x), srgb_encode_channel(linear.y), srgb_encode_channel(linear.z));
}

SHADE_FN vec3 srgb_decode(vec3 code) {
  return vec3(srgb_decode_channel(code.x), srgb_decode_channel(code.y), srgb_decode_channel(code.z));
}

SHADE_END

#endif
