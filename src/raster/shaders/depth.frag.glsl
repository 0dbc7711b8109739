#ifdef ALPHA_MASK
#undef HAS_height
#include "material.glsl"

in float v_alpha;
#endif

void main() {
#ifdef ALPHA_MASK
  float a = base_color.a * v_alpha;
#ifdef HAS_base_color
  a *= base_color_texel().a;
#endif
  if (a < emission.a) discard;
#endif
}
