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

// A rectangle, or where shape.x is 1 a square about corners[0] that faces what it lights, half of whose side is
// corners[1].x.
struct Area {
  vec4 corners[4];  // counter-clockwise from the front; [0].w: radius of a disc as large
  vec4 color;       // radiance
  vec4 shape;       // x: 1 faces everything, y: 1 shines to both sides, z: first shadow (-1 none), w: count of shadows
};

layout(std140) uniform Lights {
  Light lights[kMostLights];
  mat4 shadow_from_world[kMostShadows];
  vec4 shadow_texel[kMostShadows];  // x: metres per texel (at distance 1 of a perspective one), y: 1 perspective,
                                    // zw: distances of the near and far plane
  Area areas[kMostAreas];
};

uniform highp sampler2DArrayShadow shadow_maps;
uniform highp sampler2DArray light_profiles;
#if defined(HAS_SOFT_SHADOWS) || defined(HAS_VEILS)
uniform highp sampler2DArray shadow_depths;  // the same maps, to be read rather than compared with
#endif
#ifdef HAS_VEILS
// What share of light passes the first blended surface, and all of them. Their depths, those of the first and of the
// second, lie in shadow_depths behind the maps of what is opaque.
uniform highp sampler2DArray veils;
#endif

#ifdef HAS_SOFT_SHADOWS
/// Distance from the light of a depth of map `layer`.
float shadow_distance(int layer, float depth) {
  vec2 range = shadow_texel[layer].zw;
  if (shadow_texel[layer].y < 0.5) return mix(range.x, range.y, depth);
  return range.x * range.y / (range.y - depth * (range.y - range.x));
}

/// Width of the penumbra over that of the map: what stands at the mean distance of what stands in the way, of a light of
/// this radius (of a directional one: tangent of its angular radius). 0 where nothing does. `map` is which of the maps
/// of the light's `layer` says what stands there. Fernando 2005,
/// "Percentage-Closer Soft Shadows".
float shadow_penumbra(int layer, int map, vec3 at, vec2 tilt, float receiver, float radius, float turn) {
  const int kTaps = 12;
  bool is_perspective = shadow_texel[layer].y > 0.5;
  float size = float(textureSize(shadow_depths, 0).x);
  float width = shadow_texel[layer].x * size;  // metres, of a perspective one at distance 1
  float search = is_perspective ? radius / (receiver * width)
                                : radius * (receiver - shadow_texel[layer].z) / width;
  search = clamp(search, 1.5 / size, 0.1);
  float sum = 0.0, count = 0.0;
  for (int i = 0; i < kTaps; ++i) {
    float r = sqrt((float(i) + 0.5) / float(kTaps)), phi = 2.39996323 * float(i) + turn;
    vec2 offset = vec2(cos(phi), sin(phi)) * (r * search);
    float d = texture(shadow_depths, vec3(at.xy + offset, float(map))).x;
    if (d < at.z + dot(tilt, offset) - 2e-5) {
      sum += shadow_distance(layer, d);
      count += 1.0;
    }
  }
  if (count < 0.5) return 0.0;
  float blocker = sum / count;
  float spread = max(receiver - blocker, 0.0);
  return is_perspective ? radius * spread / (max(blocker, 1e-4) * receiver * width) : radius * spread / width;
}

float shadow_softly(int layer, vec3 at, vec2 tilt, float radius) {
  const int kTaps = 16;
  float turn = 6.2831853 * fract(52.9829189 * fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715))) + soft.y);
  float size = float(textureSize(shadow_depths, 0).x);
  float penumbra = shadow_penumbra(layer, layer, at, tilt, shadow_distance(layer, at.z), radius, turn);
  penumbra = clamp(penumbra, 1.0 / size, 0.1);
  float sum = 0.0;
  for (int i = 0; i < kTaps; ++i) {
    float r = sqrt((float(i) + 0.5) / float(kTaps)), phi = 2.39996323 * float(i) + turn;
    vec2 offset = vec2(cos(phi), sin(phi)) * (r * penumbra);
    sum += texture(shadow_maps, vec4(at.xy + offset, float(layer), at.z + dot(tilt, offset) - 2e-5));
  }
  return sum / float(kTaps);
}
#endif

#ifdef HAS_VEILS
/// What share of light comes to a depth of map `layer` through the blended surfaces in one texel.
float veil_at(int layer, ivec2 texel, float depth) {
  ivec3 size = textureSize(veils, 0);
  texel = clamp(texel, ivec2(0), size.xy - 1);
  if (depth <= texelFetch(shadow_depths, ivec3(texel, size.z + layer), 0).x) return 1.0;
  vec2 passing = texelFetch(veils, ivec3(texel, layer), 0).xy;
  return depth <= texelFetch(shadow_depths, ivec3(texel, 2 * size.z + layer), 0).x ? passing.x : passing.y;
}

/// The same by a tent of three texels, as what is opaque.
float veil_passing(int layer, vec3 at) {
  vec2 p = at.xy * vec2(textureSize(veils, 0).xy);
  ivec2 texel = ivec2(floor(p));
  vec2 off = p - vec2(texel) - 0.5;
  vec3 wx = vec3(0.25 - 0.5 * off.x, 0.5, 0.25 + 0.5 * off.x), wy = vec3(0.25 - 0.5 * off.y, 0.5, 0.25 + 0.5 * off.y);
  float sum = 0.0;
  for (int i = 0; i < 9; ++i) {
    sum += wx[i % 3] * wy[i / 3] * veil_at(layer, texel + ivec2(i % 3 - 1, i / 3 - 1), at.z - 1e-5);
  }
  return sum;
}

#ifdef HAS_SOFT_SHADOWS
/// The same from a light with an extent.
float veil_softly(int layer, vec3 at, vec2 tilt, float radius) {
  const int kTaps = 16;
  float turn = 6.2831853 * fract(52.9829189 * fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715))) + soft.y);
  ivec3 size = textureSize(veils, 0);
  float penumbra = shadow_penumbra(layer, size.z + layer, at, tilt, shadow_distance(layer, at.z), radius, turn);
  penumbra = clamp(penumbra, 1.0 / float(size.x), 0.1);
  float sum = 0.0;
  for (int i = 0; i < kTaps; ++i) {
    float r = sqrt((float(i) + 0.5) / float(kTaps)), phi = 2.39996323 * float(i) + turn;
    vec2 offset = vec2(cos(phi), sin(phi)) * (r * penumbra);
    sum += veil_at(layer, ivec2(floor((at.xy + offset) * vec2(size.xy))), at.z + dot(tilt, offset) - 2e-5);
  }
  return sum / float(kTaps);
}
#endif
#endif

#ifdef HAS_SOFT_SHADOWS
vec3 shadow_point(int layer, vec3 position) {
  vec4 clip = shadow_from_world[layer] * vec4(position, 1.0);
  return clip.xyz / clip.w * 0.5 + 0.5;
}

/// How the depth of the plane of a surface changes over the map: a filter as wide as a light must not find the surface in
/// its own way. In a perspective map, too, a plane's depth is linear.
vec2 shadow_tilt(int layer, vec3 at, vec3 position, vec3 normal, float step) {
  vec3 x = shade_tangent(normal);
  vec3 a = shadow_point(layer, position + x * step) - at, b = shadow_point(layer, position + cross(normal, x) * step) - at;
  float area = a.x * b.y - a.y * b.x;
  vec2 tilt = vec2(a.z * b.y - b.z * a.y, b.z * a.x - a.z * b.x);
  return abs(area) < 1e-12 ? vec2(0.0) : clamp(tilt / area, vec2(-4.0), vec2(4.0));
}
#endif

/// Share of a light that arrives, by the shadow map `layer`; 1 where it does not reach. `radius` as shadow_penumbra()
/// has it; of a light without one the shadow is hard.
float shadow_in(int layer, vec3 position, vec3 normal, float n_dot_l, float radius) {
  float texel = shadow_texel[layer].x;
  vec4 clip = shadow_from_world[layer] * vec4(position, 1.0);
  if (shadow_texel[layer].y > 0.5) texel *= clip.w;
  // Along the normal, by what a texel covers of a slope: no surface then shadows itself.
  float slope = sqrt(max(1.0 - n_dot_l * n_dot_l, 0.0));
  clip = shadow_from_world[layer] * vec4(position + normal * (texel * (0.6 + 1.6 * slope)), 1.0);
  vec3 at = clip.xyz / clip.w * 0.5 + 0.5;
  if (clip.w <= 0.0 || any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return 1.0;
#ifdef HAS_SOFT_SHADOWS
  // Of a picture of many frames each has a hard shadow from a point of its own.
  radius *= soft.z;
  if (radius > 0.0 && soft.z > 0.18) {
    vec3 moved = position + normal * (texel * (0.6 + 1.6 * slope));
    vec2 tilt = shadow_tilt(layer, at, moved, normal, 4.0 * texel);
    float arriving = shadow_softly(layer, at, tilt, radius);
#ifdef HAS_VEILS
    arriving *= veil_softly(layer, at, tilt, radius);
#endif
    return arriving;
  }
#endif
  // Four taps half a texel off, each weighing four texels: a tent three texels wide.
  vec2 d = 0.5 / vec2(textureSize(shadow_maps, 0).xy);
  float z = at.z - 1e-5;
  float l = float(layer);
  float arriving = 0.25 * (texture(shadow_maps, vec4(at.x - d.x, at.y - d.y, l, z)) +
                           texture(shadow_maps, vec4(at.x + d.x, at.y - d.y, l, z)) +
                           texture(shadow_maps, vec4(at.x - d.x, at.y + d.y, l, z)) +
                           texture(shadow_maps, vec4(at.x + d.x, at.y + d.y, l, z)));
#ifdef HAS_VEILS
  arriving *= veil_passing(layer, at);
#endif
  return arriving;
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

/// Which of six views from a point, in the order +x -x +y -y +z -z, sees what lies towards -wi.
int shadow_face(vec3 wi) {
  vec3 a = abs(wi);
  return a.x >= a.y && a.x >= a.z ? (wi.x > 0.0 ? 1 : 0) : a.y >= a.z ? (wi.y > 0.0 ? 3 : 2) : (wi.z > 0.0 ? 5 : 4);
}

float light_shadow(Light light, vec3 position, vec3 normal, vec3 wi) {
  int first = int(light.cone.z);
  if (first < 0) return 1.0;
  float n_dot_l = dot(normal, wi);
  if (int(light.position.w) == 0) {
    return shadow_in(first + shadow_face(wi), position, normal, n_dot_l, soft.x);
  }
  bool is_sun = int(light.position.w) == 2;
  int layer = first + (is_sun ? light_cascade(light, position) : 0);
  return shadow_in(layer, position, normal, n_dot_l, is_sun ? light.cone.x : soft.x);
}

#ifdef HAS_AREAS
/// The corners of an area light from a point, relative to it; false where it shines elsewhere.
bool area_corners(Area area, vec3 position, out vec3 c[4]) {
  if (area.shape.x > 0.5) {
    vec3 to = area.corners[0].xyz - position;
    float distance = length(to);
    float half_side = area.corners[1].x;
    if (distance < 1.2 * half_side) return false;  // within the body
    vec3 z = to / distance;
    vec3 x = shade_tangent(z) * half_side;
    vec3 y = cross(z, x);
    c[0] = to - x - y, c[1] = to + x - y, c[2] = to + x + y, c[3] = to - x + y;
    return true;
  }
  for (int i = 0; i < 4; ++i) c[i] = area.corners[i].xyz - position;
  float front = -dot(cross(c[1] - c[0], c[2] - c[0]), c[0]);
  return front > 0.0 || area.shape.y > 0.5;
}

float area_shadow(Area area, vec3 position, vec3 normal) {
  int first = int(area.shape.z);
  if (first < 0) return 1.0;
  vec3 center = area.corners[0].xyz;
  int layer = first;
  if (area.shape.x < 0.5) {
    center = 0.25 * (center + area.corners[1].xyz + area.corners[2].xyz + area.corners[3].xyz);
    vec3 n = cross(area.corners[1].xyz - area.corners[0].xyz, area.corners[2].xyz - area.corners[0].xyz);
    if (area.shape.w > 1.5 && dot(n, position - center) < 0.0) ++layer;
  }
  vec3 wi = normalize(center - position);
  if (area.shape.x > 0.5) layer += shadow_face(wi);
  return shadow_in(layer, position, normal, dot(normal, wi), area.corners[0].w);
}
#endif

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
