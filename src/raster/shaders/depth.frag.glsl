#if defined(ALPHA_MASK) || defined(ALPHA_BLEND)
#include "material.glsl"

in float v_alpha;

float fetch_opacity() {
  float a = material.opacity * v_alpha;
#ifdef opacity_factor
  a *= opacity_factor();
#endif
  return a;
}
#endif
#ifdef IS_SHADOW
in float v_depth;
#if defined(BEYOND_LAST_LAYER) || defined(AT_LAST_LAYER)
const float kShadowSlack = 4e-7;  // of a depth: some roundings of a float
#endif
#include "veil_depth.glsl"
#endif
#if defined(BEYOND_LAST_LAYER) || defined(AT_LAST_LAYER)
#include "layer_slack.glsl"

uniform highp sampler2D last_layer;
#endif
#ifdef HAS_PASSING
layout(location = 0) out vec4 o_passing;
#endif

void main() {
#ifdef IS_SHADOW
  // 1 near the light, near / distance of a perspective view: linear in the picture, and of floats' full precision. What
  // stands before a slice is at its beginning. Back by what a texel covers of a slope.
  float depth = v_depth * gl_FragCoord.w;
  float slope = max(abs(dFdx(depth)), abs(dFdy(depth)));
  depth -= slope;
#if defined(ALPHA_BLEND) && !defined(OPAQUE_PART)
  depth = veil_stored(max(depth, 0.0));
#endif
  depth = clamp(depth, 0.0, 1.0);
  gl_FragDepth = depth;
#endif
#ifdef ALPHA_MASK
  if (fetch_opacity() < material.drawn_cutoff) discard;
#endif
#ifdef ALPHA_BLEND
  float a = fetch_opacity();
#ifdef OPAQUE_PART
  if (a < kOpaqueAlpha) discard;
#else
  if (a >= kWholeAlpha || a < kLeastAlpha) discard;
#endif
#ifdef AT_LAST_LAYER
  float first = texelFetch(last_layer, ivec2(gl_FragCoord.xy), 0).x;
  if (depth + kSlopeSlack * slope + kShadowSlack * depth < first) discard;
#endif
#ifdef BEYOND_LAST_LAYER
  float last = texelFetch(last_layer, ivec2(gl_FragCoord.xy), 0).x;
#ifdef IS_SHADOW
  if (depth + kSlopeSlack * slope + kShadowSlack * depth >= last) discard;
#else
  if (gl_FragCoord.z - layer_slack() <= last) discard;
#endif
#endif
#ifdef HAS_PASSING
  o_passing = vec4(1.0 - clamp(a, 0.0, 1.0));
#endif
#endif
}
