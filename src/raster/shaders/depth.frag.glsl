#ifdef ALPHA_MASK
#include "material.glsl"

in float v_alpha;
#endif
#ifdef IS_SHADOW
in float v_depth;
#endif

void main() {
#ifdef IS_SHADOW
  // 1 near the light, near / distance of a perspective view: linear in the picture, and of floats' full precision. What
  // stands before a slice is at its beginning. Back by what a texel covers of a slope.
  float depth = v_depth * gl_FragCoord.w;
  gl_FragDepth = clamp(depth - max(abs(dFdx(depth)), abs(dFdy(depth))), 0.0, 1.0);
#endif
#ifdef ALPHA_MASK
  float a = base_color.a * v_alpha;
#ifdef HAS_base_color
  a *= base_color_texel().a;
#endif
  if (a < emission.a) discard;
#endif
}
