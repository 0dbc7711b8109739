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
  vec4 below_color;        // of diffuse transmission
  vec4 conductor_n;
  vec4 conductor_k;
  vec4 uv_transform[2 * kSlots];
};

in vec4 v_uv;

vec2 slot_uv(int slot) {
  vec4 a = uv_transform[2 * slot], b = uv_transform[2 * slot + 1];
  vec2 uv = b.z < 0.5 ? v_uv.xy : v_uv.zw;
  return a.xy * uv.x + a.zw * uv.y + b.xy;
}
