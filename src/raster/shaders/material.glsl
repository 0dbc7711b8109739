#include "material_block.glsl"

in vec4 v_uv;
#ifdef MORE_UVS
in vec4 v_more_uv[MORE_UVS];
#endif
#ifdef HAS_height
vec4 surface_uv;  // v_uv, moved to where the view meets the relief
#ifdef MORE_UVS
vec4 surface_more_uv[MORE_UVS];
#endif
#else
#define surface_uv v_uv
#define surface_more_uv v_more_uv
#endif

vec2 slot_uv(int slot) {
  UvTransform t = material.uv[slot];
  vec2 uv = t.uv_set < 0.5 ? surface_uv.xy : surface_uv.zw;
#ifdef MORE_UVS
  for (int i = 0; i < MORE_UVS; ++i) {
    float place = t.uv_set - 2.0 * float(i) - 2.0;
    if (place > -0.5) uv = place < 0.5 ? surface_more_uv[i].xy : surface_more_uv[i].zw;
  }
#endif
  return t.along_u * uv.x + t.along_v * uv.y + t.offset;
}
