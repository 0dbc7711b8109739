#include "shade/lights.glsl.h"

// Mirrors raster/blocks.h, which says what each member is.
struct Light {
  vec3 position;
  int kind;
  vec3 direction;
  float range;
  vec3 color;
  int falloff;
  vec3 polynomial;
  int profile;
  vec3 across;
  float handedness;
  float cos_inner;
  float cos_outer;
  float sun_radius;
  int first_shadow;
  int shadow_count;
};

struct Area {
  vec3 corner_0;
  float radius;
  vec3 corner_1;
  float half_side;
  vec3 corner_2;
  float extent;
  vec3 corner_3;
  int is_body;
  vec3 color;
  int has_two_sides;
  int first_shadow;
  int shadow_count;
};

struct Shadow {
  mat4 from_world;
  float texel;
  int is_perspective;
  float near;
  float far;
};

layout(std140) uniform Lights {
  Light lights[kMostLights];
  Shadow shadows[kMostShadows];
  Area areas[kMostAreas];
};

uniform highp sampler2DArrayShadow shadow_maps;
uniform highp sampler2DArray light_profiles;
#if defined(HAS_SOFT_SHADOWS) || defined(HAS_VEILS)
uniform highp sampler2DArray shadow_depths;  // the same maps, to be read rather than compared with
#endif
#ifdef HAS_VEILS
#include "veil_depth.glsl"

// What share of light passes the first blended surface, and all of them. Their depths, those of the first and of the
// second, lie in shadow_depths behind the maps of what is opaque.
uniform highp sampler2DArray veils;
#endif

/// Where map `layer` has a point, and at what depth.
vec3 shadow_point(int layer, vec3 position) {
  vec4 clip = shadows[layer].from_world * vec4(position, 1.0);
  return vec3(clip.xy / clip.w * 0.5 + 0.5, clip.z / clip.w);
}

/// What a surface must be nearer to the light than another to be in its way, as depth: a tenth of a texel.
float shadow_slack(int layer, float depth) {
  float texel = 0.1 * shadows[layer].texel;
  return shadows[layer].is_perspective == 1 ? texel * depth : texel / (shadows[layer].far - shadows[layer].near);
}

#ifdef HAS_SOFT_SHADOWS
/// Distance from the light of a depth of map `layer`.
float shadow_distance(int layer, float depth) {
  if (shadows[layer].is_perspective == 1) return shadows[layer].near / max(depth, 1e-30);
  return mix(shadows[layer].far, shadows[layer].near, depth);
}

/// Width of the penumbra over that of the map: what stands at the mean distance of what stands in the way, of a light of
/// this radius (of a directional one: tangent of its angular radius). 0 where nothing does. `map` is which of the maps
/// of the light's `layer` says what stands there. Fernando 2005,
/// "Percentage-Closer Soft Shadows".
float shadow_penumbra(int layer, int map, vec3 at, vec2 tilt, float receiver, float radius, float turn) {
  const int kTaps = 12;
  bool is_perspective = shadows[layer].is_perspective == 1;
  float size = float(textureSize(shadow_depths, 0).x);
  float width = shadows[layer].texel * size;  // metres, of a perspective one at distance 1
  float search = is_perspective ? radius / (receiver * width) : radius * (receiver - shadows[layer].near) / width;
  search = clamp(search, 1.5 / size, 0.1);
  float slack = 2.0 * shadow_slack(layer, at.z);
  float sum = 0.0, count = 0.0;
  for (int i = 0; i < kTaps; ++i) {
    float r = sqrt((float(i) + 0.5) / float(kTaps)), phi = 2.39996323 * float(i) + turn;
    vec2 offset = vec2(cos(phi), sin(phi)) * (r * search);
    float d = texture(shadow_depths, vec3(at.xy + offset, float(map))).x;
#ifdef HAS_VEILS
    if (map != layer) d = veil_restored(d);
#endif
    if (d > at.z + dot(tilt, offset) + slack) {
      sum += shadow_distance(layer, d);
      count += 1.0;
    }
  }
  if (count < 0.5) return 0.0;
  float blocker = sum / count;
  float spread = max(receiver - blocker, 0.0);
  return is_perspective ? radius * spread / (max(blocker, 1e-4 * receiver) * receiver * width) : radius * spread / width;
}

float shadow_softly(int layer, vec3 at, vec2 tilt, float radius) {
  const int kTaps = 16;
  float turn = 6.2831853 * fract(52.9829189 * fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715))) + noise_turn);
  float size = float(textureSize(shadow_depths, 0).x);
  float penumbra = shadow_penumbra(layer, layer, at, tilt, shadow_distance(layer, at.z), radius, turn);
  penumbra = clamp(penumbra, 1.0 / size, 0.1);
  float slack = 2.0 * shadow_slack(layer, at.z);
  float sum = 0.0;
  for (int i = 0; i < kTaps; ++i) {
    float r = sqrt((float(i) + 0.5) / float(kTaps)), phi = 2.39996323 * float(i) + turn;
    vec2 offset = vec2(cos(phi), sin(phi)) * (r * penumbra);
    sum += texture(shadow_maps, vec4(at.xy + offset, float(layer), at.z + dot(tilt, offset) + slack));
  }
  return sum / float(kTaps);
}
#endif

#ifdef HAS_VEILS
/// What share of light comes to a depth of map `layer` through the blended surfaces in one texel.
float veil_at(int layer, ivec2 texel, float depth) {
  ivec3 size = textureSize(veils, 0);
  texel = clamp(texel, ivec2(0), size.xy - 1);
  depth = veil_stored(depth);
  if (depth >= texelFetch(shadow_depths, ivec3(texel, size.z + layer), 0).x) return 1.0;
  vec2 passing = texelFetch(veils, ivec3(texel, layer), 0).xy;
  return depth >= texelFetch(shadow_depths, ivec3(texel, 2 * size.z + layer), 0).x ? passing.x : passing.y;
}

/// The same by a tent of three texels, as what is opaque.
float veil_passing(int layer, vec3 at) {
  vec2 p = at.xy * vec2(textureSize(veils, 0).xy);
  ivec2 texel = ivec2(floor(p));
  vec2 off = p - vec2(texel) - 0.5;
  vec3 wx = vec3(0.25 - 0.5 * off.x, 0.5, 0.25 + 0.5 * off.x), wy = vec3(0.25 - 0.5 * off.y, 0.5, 0.25 + 0.5 * off.y);
  float z = at.z + shadow_slack(layer, at.z);
  float sum = 0.0;
  for (int i = 0; i < 9; ++i) {
    sum += wx[i % 3] * wy[i / 3] * veil_at(layer, texel + ivec2(i % 3 - 1, i / 3 - 1), z);
  }
  return sum;
}

#ifdef HAS_SOFT_SHADOWS
/// The same from a light with an extent.
float veil_softly(int layer, vec3 at, vec2 tilt, float radius) {
  const int kTaps = 16;
  float turn = 6.2831853 * fract(52.9829189 * fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715))) + noise_turn);
  ivec3 size = textureSize(veils, 0);
  float penumbra = shadow_penumbra(layer, size.z + layer, at, tilt, shadow_distance(layer, at.z), radius, turn);
  penumbra = clamp(penumbra, 1.0 / float(size.x), 0.1);
  float slack = 2.0 * shadow_slack(layer, at.z);
  float sum = 0.0;
  for (int i = 0; i < kTaps; ++i) {
    float r = sqrt((float(i) + 0.5) / float(kTaps)), phi = 2.39996323 * float(i) + turn;
    vec2 offset = vec2(cos(phi), sin(phi)) * (r * penumbra);
    sum += veil_at(layer, ivec2(floor((at.xy + offset) * vec2(size.xy))), at.z + dot(tilt, offset) + slack);
  }
  return sum / float(kTaps);
}
#endif
#endif

#ifdef HAS_SOFT_SHADOWS

/// How the depth of the plane of a surface changes over the map: a filter as wide as a light must not find the surface in
/// its own way. In a perspective map, too, a plane's depth is linear.
vec2 shadow_tilt(int layer, vec3 at, vec3 position, vec3 normal, float step) {
  vec3 x = shade_tangent(normal);
  vec3 a = shadow_point(layer, position + x * step) - at, b = shadow_point(layer, position + cross(normal, x) * step) - at;
  float area = a.x * b.y - a.y * b.x;
  if (abs(area) < 1e-12) return vec2(0.0);
  vec2 most = vec2(shadows[layer].is_perspective == 1 ? 1000.0 * at.z : 4.0);
  return clamp(vec2(a.z * b.y - b.z * a.y, b.z * a.x - a.z * b.x) / area, -most, most);
}
#endif

/// Share of a light that arrives, by the shadow map `layer`; 1 where it does not reach. `radius` as shadow_penumbra()
/// has it; of a light without one the shadow is hard.
float shadow_in(int layer, vec3 position, vec3 normal, float n_dot_l, float radius) {
  float texel = shadows[layer].texel;
  vec4 clip = shadows[layer].from_world * vec4(position, 1.0);
  if (shadows[layer].is_perspective == 1) texel *= clip.w;
  // Along the normal, by what a texel covers of a slope: no surface then shadows itself.
  float slope = sqrt(max(1.0 - n_dot_l * n_dot_l, 0.0));
  vec3 moved = position + normal * (texel * (0.6 + 1.6 * slope));
  clip = shadows[layer].from_world * vec4(moved, 1.0);
  vec3 at = vec3(clip.xy / clip.w * 0.5 + 0.5, clip.z / clip.w);
  if (clip.w <= 0.0 || any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return 1.0;
#ifdef HAS_SOFT_SHADOWS
  // Of a picture of many frames each has a hard shadow from a point of its own.
  radius *= shadow_share;
  if (radius > 0.0 && shadow_share > 0.18) {
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
  float z = at.z + shadow_slack(layer, at.z);
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
  int first = light.first_shadow, last = light.shadow_count - 1;
  for (int i = 0; i < last; ++i) {
    vec3 at = shadow_point(first + i, position);
    vec2 edge = abs(at.xy * 2.0 - 1.0);
    if (max(edge.x, edge.y) < 0.97 && at.z > 0.0 && at.z < 1.0) return i;
  }
  return last;
}

/// Which of six views from a point, in the order +x -x +y -y +z -z, sees what lies towards -wi.
int shadow_face(vec3 wi) {
  vec3 a = abs(wi);
  return a.x >= a.y && a.x >= a.z ? (wi.x > 0.0 ? 1 : 0) : a.y >= a.z ? (wi.y > 0.0 ? 3 : 2) : (wi.z > 0.0 ? 5 : 4);
}

float light_shadow(Light light, vec3 position, vec3 normal, vec3 wi) {
  int layer = light.first_shadow;
  if (layer < 0) return 1.0;
  bool is_directional = light.kind == kDirectionalLight;
  if (light.kind == kPointLight) layer += shadow_face(wi);
  if (is_directional) layer += light_cascade(light, position);
  return shadow_in(layer, position, normal, dot(normal, wi), is_directional ? light.sun_radius : light_radius);
}

#ifdef HAS_AREAS
vec3 area_middle(Area area) {
  return area.is_body == 1 ? area.corner_0 : 0.25 * (area.corner_0 + area.corner_1 + area.corner_2 + area.corner_3);
}

/// The corners of an area light from a point, relative to it; false where it shines elsewhere, and where the point is on
/// the lamp itself, if it is of a surface that `is_own`.
bool area_corners(Area area, bool is_own, vec3 position, out vec3 c[4]) {
  if (area.is_body == 1) {
    vec3 to = area.corner_0 - position;
    float distance = length(to);
    if (distance < (is_own ? 1.05 * area.extent : 1.2 * area.half_side)) return false;  // within the body
    vec3 z = to / distance;
    vec3 x = shade_tangent(z) * area.half_side;
    vec3 y = cross(z, x);
    c[0] = to - x - y, c[1] = to + x - y, c[2] = to + x + y, c[3] = to - x + y;
    return true;
  }
  c[0] = area.corner_0 - position, c[1] = area.corner_1 - position;
  c[2] = area.corner_2 - position, c[3] = area.corner_3 - position;
  vec3 n = cross(c[1] - c[0], c[2] - c[0]);
  float front = -dot(n, c[0]);
  if (is_own && abs(front) < 0.3 * area.radius * length(n) && distance(area_middle(area), position) < 1.05 * area.extent)
    return false;
  return front > 0.0 || area.has_two_sides == 1;
}

float area_shadow(Area area, vec3 position, vec3 normal) {
  int layer = area.first_shadow;
  if (layer < 0) return 1.0;
  vec3 center = area_middle(area);
  if (area.is_body == 0 && area.shadow_count > 1) {
    vec3 n = cross(area.corner_1 - area.corner_0, area.corner_2 - area.corner_0);
    if (dot(n, position - center) < 0.0) ++layer;
  }
  vec3 wi = normalize(center - position);
  if (area.is_body == 1) layer += shadow_face(wi);
  return shadow_in(layer, position, normal, dot(normal, wi), area.radius);
}
#endif

/// Irradiance on a surface that faces the light, and the direction towards it.
vec3 light_arriving(Light light, vec3 position, out vec3 wi) {
  if (light.kind == kDirectionalLight) {
    wi = -light.direction;
    return light.color;
  }
  vec3 to_light = light.position - position;
  float distance = length(to_light);
  wi = to_light / max(distance, 1e-20);
  PunctualLamp lamp;
  lamp.kind = light.kind;
  lamp.direction = light.direction;
  lamp.range = light.range;
  lamp.falloff = light.falloff;
  lamp.polynomial = light.polynomial;
  lamp.cos_inner = light.cos_inner;
  lamp.cos_outer = light.cos_outer;
  lamp.across = light.across;
  lamp.handedness = light.handedness;
  vec3 e = light.color * light_left(lamp, wi, distance);
  if (light.profile >= 0) {
    vec2 angles = light_profile_angles(light_local(lamp, wi));
    vec2 size = vec2(textureSize(light_profiles, 0).xy);
    // Entries stand at both ends of either axis.
    vec2 at = (vec2(fract(angles.x / (2.0 * kShadePi)), angles.y / kShadePi) * (size - 1.0) + 0.5) / size;
    e *= texture(light_profiles, vec3(at, float(light.profile))).x;
  }
  return e;
}
