// A material's factors. Mirrors raster/blocks.h.
layout(std140) uniform Material {
  vec4 base_color;         // rgb, opacity
  vec4 emission;           // rgb, alpha cutoff
  vec4 metallic_roughness; // metallic, roughness, ior, specular
  vec4 specular_color;     // rgb, normal scale
  vec4 coat;               // weight, roughness, normal scale, occlusion strength
  vec4 sheen;              // rgb, roughness
  vec4 anisotropy;         // strength, cos and sin of its rotation, dispersion
  vec4 film;               // weight, ior, nm where the texture is 0 and where it is 1
  vec4 transmission;       // weight, thickness, 1 = sheet, diffuse transmission's weight
  vec4 extinction;         // 1/m
  vec4 below_color;        // of diffuse transmission; which share of what a sheet transmits is scattered
  vec4 conductor_n;
  vec4 conductor_k;
  vec4 scatter;            // how wide light spreads in a scattering body, metres, for each colour
  vec4 scatter_color;      // what of the light that enters it comes out again, or of what a sheet scatters; forwards
  vec4 relief;             // height between black and white, metres; the value that lies on the mesh
  vec4 uv_transform[2 * kSlots];
};

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
  vec4 a = uv_transform[2 * slot], b = uv_transform[2 * slot + 1];
  vec2 uv = b.z < 0.5 ? surface_uv.xy : surface_uv.zw;
#ifdef MORE_UVS
  for (int i = 0; i < MORE_UVS; ++i) {
    float place = b.z - 2.0 * float(i) - 2.0;
    if (place > -0.5) uv = place < 0.5 ? surface_more_uv[i].xy : surface_more_uv[i].zw;
  }
#endif
  return a.xy * uv.x + a.zw * uv.y + b.xy;
}
