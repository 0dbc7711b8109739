#if defined(ALPHA_MASK) || defined(ALPHA_BLEND)
#include "material.glsl"

in float v_alpha;

float fetch_opacity() {
  float a = base_color.a * v_alpha;
#ifdef HAS_base_color
  a *= base_color_texel().a;
#endif
  return a;
}
#endif
#ifdef BEYOND_LAST_LAYER
#include "layer_slack.glsl"

uniform highp sampler2D last_layer;
#endif
#ifdef HAS_PASSING
layout(location = 0) out vec4 o_passing;
#endif

void main() {
#ifdef ALPHA_MASK
  if (fetch_opacity() < emission.a) discard;
#endif
#ifdef ALPHA_BLEND
  float a = fetch_opacity();
#ifdef OPAQUE_PART
  if (a < kOpaqueAlpha) discard;
#else
  if (a >= kWholeAlpha || a < kLeastAlpha) discard;
#endif
#ifdef BEYOND_LAST_LAYER
  if (gl_FragCoord.z - layer_slack() <= texelFetch(last_layer, ivec2(gl_FragCoord.xy), 0).x) discard;
#endif
#ifdef HAS_PASSING
  o_passing = vec4(1.0 - clamp(a, 0.0, 1.0));
#endif
#endif
}
