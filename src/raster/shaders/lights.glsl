#include "shade/lights.glsl.h"

// Mirrors raster/blocks.h.
struct Light {
  vec4 position;   // w: kind, 0 point, 1 spot, 2 directional
  vec4 direction;  // it shines along; w: range
  vec4 color;      // times intensity; w: falloff
  vec4 cone;       // cosines of inner and outer angle, first shadow (-1 none), count of shadows
  vec4 polynomial; // w: profile (-1 none)
  vec4 across;     // the light's own +x; w: +1 or -1, the side of its +y
};

layout(std140) uniform Lights {
  Light lights[kMostLights];
  mat4 shadow_from_world[kMostShadows];
  vec4 shadow_texel[kMostShadows];  // x: metres per texel (at distance 1 of a perspective one), y: 1 perspective
};

uniform highp sampler2DArrayShadow shadow_maps;
uniform highp sampler2DArray light_profiles;

/// Share of a light that arrives, by the shadow map `layer`; 1 where it does not reach.
float shadow_in(int layer, vec3 position, vec3 normal, float n_dot_l) {
  float texel = shadow_texel[layer].x;
  vec4 clip = shadow_from_world[layer] * vec4(position, 1.0);
  if (shadow_texel[layer].y > 0.5) texel *= clip.w;
  // Along the normal, by what a texel covers of a slope: no surface then shadows itself.
  float slope = sqrt(max(1.0 - n_dot_l * n_dot_l, 0.0));
  clip = shadow_from_world[layer] * vec4(position + normal * (texel * (0.6 + 1.6 * slope)), 1.0);
  vec3 at = clip.xyz / clip.w * 0.5 + 0.5;
  if (clip.w <= 0.0 || any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return 1.0;
  // Four taps half a texel off, each weighing four texels: a tent three texels wide.
  vec2 d = 0.5 / vec2(textureSize(shadow_maps, 0).xy);
  float z = at.z - 1e-5;
  float l = float(layer);
  return 0.25 * (texture(shadow_maps, vec4(at.x - d.x, at.y - d.y, l, z)) +
                 texture(shadow_maps, vec4(at.x + d.x, at.y - d.y, l, z)) +
                 texture(shadow_maps, vec4(at.x - d.x, at.y + d.y, l, z)) +
                 texture(shadow_maps, vec4(at.x + d.x, at.y + d.y, l, z)));
}

/// Which cascade of a directional light holds a point: the finest that does.
int light_cascade(Light light, vec3 position) {
  int first = int(light.cone.z), last = int(light.cone.w) - 1;
  for (int i = 0; i < last; ++i) {
    vec4 clip = shadow_from_world[first + i] * vec4(position, 1.0);
    vec2 edge = abs(clip.xy / clip.w);
    if (max(edge.x, edge.y) < 0.97) return i;
  }
  return last;
}

float light_shadow(Light light, vec3 position, vec3 normal, vec3 wi) {
  int first = int(light.cone.z);
  if (first < 0) return 1.0;
  float n_dot_l = dot(normal, wi);
  if (int(light.position.w) == 0) {
    // Six views of a point light, in the order +x -x +y -y +z -z.
    vec3 a = abs(wi);
    int face = a.x >= a.y && a.x >= a.z ? (wi.x > 0.0 ? 1 : 0) : a.y >= a.z ? (wi.y > 0.0 ? 3 : 2) : (wi.z > 0.0 ? 5 : 4);
    return shadow_in(first + face, position, normal, n_dot_l);
  }
  int layer = first + (int(light.position.w) == 2 ? light_cascade(light, position) : 0);
  return shadow_in(layer, position, normal, n_dot_l);
}

/// Irradiance on a surface that faces the light, and the direction towards it.
vec3 light_arriving(Light light, vec3 position, out vec3 wi) {
  int kind = int(light.position.w);
  if (kind == 2) {
    wi = -light.direction.xyz;
    return light.color.rgb;
  }
  vec3 to_light = light.position.xyz - position;
  float distance = length(to_light);
  wi = to_light / max(distance, 1e-20);
  vec3 e = light.color.rgb * light_falloff(int(light.color.w), distance, light.direction.w, light.polynomial.xyz);
  if (kind == 1) e *= light_spot_gltf(-dot(wi, light.direction.xyz), light.cone.x, light.cone.y);
  if (light.polynomial.w >= 0.0) {
    vec3 z = -light.direction.xyz, x = light.across.xyz, y = cross(z, x) * light.across.w;
    vec3 d = vec3(dot(-wi, x), dot(-wi, y), dot(-wi, z));
    float vertical = acos(clamp(-d.z, -1.0, 1.0)) / kShadePi;
    float horizontal = fract(atan(d.y, d.x) / (2.0 * kShadePi));
    vec2 size = vec2(textureSize(light_profiles, 0).xy);
    // Entries stand at both ends of either axis.
    vec2 at = (vec2(horizontal, vertical) * (size - 1.0) + 0.5) / size;
    e *= texture(light_profiles, vec3(at, light.polynomial.w)).x;
  }
  return e;
}
