// What shadow maps say of the light that arrives. The maps and their numbers are raster/lights.cpp's.
#include "noise.glsl"

uniform highp sampler2DArrayShadow shadow_maps;
#if defined(HAS_SOFT_SHADOWS) || defined(HAS_VEILS)
uniform highp sampler2DArray shadow_depths;  // the same maps, to be read rather than compared with
#endif
#ifdef HAS_VEILS
#include "veil_depth.glsl"

// What share of light passes the first blended surface, and all of them. Their depths, those of the first and of the
// second, lie in shadow_depths behind the maps of what is opaque.
uniform highp sampler2DArray veils;
#endif

// Of a texel: two surfaces nearer to one another than this are one, by the roundings of depth.
const float kSlack = 0.1;
// By how many texels a point is lifted along its normal before it is looked up, and how much more where the surface
// turns to the light's side: half of the tent that is three texels wide, and as much as it covers of a slope.
const float kLift = 0.6;
const float kLiftOfSlope = 1.6;
const float kLeastDepth = 1e-30;  // none is divided by
#ifdef HAS_SOFT_SHADOWS
// Points to look at for what stands in the way, and for how much of the light it hides: noise that a few frames even
// out.
const int kSearchTaps = 12;
const int kFilterTaps = 16;
// Of the map: a wider filter would need more points than these. In texels: a narrower search would miss thin things.
const float kWidestFilter = 0.1;
const float kLeastSearch = 1.5;
// Of a receiver's distance: what is nearer to the light has no penumbra that fits the map.
const float kNearestBlocker = 1e-4;
// A tilted plane is known less well than one point of it.
const float kSoftSlack = 2.0;
// How far away, in texels, two more points of a surface say how it is tilted; what area they must span on the map; and
// how steep it may be, over the map: of perspective depths, which are small, over the depth.
const float kTiltStep = 4.0;
const float kLeastTiltArea = 1e-12;
const float kSteepestFar = 1000.0;
const float kSteepestFlat = 4.0;
// From 31 frames on, 1 / √31 = 0.1796, each has a hard shadow from a point of the light of its own.
const float kSoftShare = 0.18;
#endif

/// Where map `layer` has a point, and at what depth.
vec3 shadow_point(int layer, vec3 position) {
  vec4 clip = shadows[layer].from_world * vec4(position, 1.0);
  return vec3(clip.xy / clip.w * 0.5 + 0.5, clip.z / clip.w);
}

/// What a surface must be nearer to the light than another to be in its way, as depth.
float shadow_slack(int layer, float depth) {
  float texel = kSlack * shadows[layer].texel;
  return shadows[layer].is_perspective == 1 ? texel * depth : texel / (shadows[layer].far - shadows[layer].near);
}

#ifdef HAS_SOFT_SHADOWS
/// Distance from the light of a depth of map `layer`.
float shadow_distance(int layer, float depth) {
  if (shadows[layer].is_perspective == 1) return shadows[layer].near / max(depth, kLeastDepth);
  return mix(shadows[layer].far, shadows[layer].near, depth);
}

/// Width of the penumbra over that of the map: what stands at the mean distance of what stands in the way, of a light
/// of this radius (of a directional one: tangent of its angular radius). 0 where nothing does. `map` is which of the
/// maps of the light's `layer` says what stands there. Fernando 2005, "Percentage-Closer Soft Shadows".
float shadow_penumbra(int layer, int map, vec3 at, vec2 tilt, float receiver, float radius, float turn) {
  bool is_perspective = shadows[layer].is_perspective == 1;
  float size = float(textureSize(shadow_depths, 0).x);
  float width = shadows[layer].texel * size;  // metres, of a perspective one at distance 1
  float search = is_perspective ? radius / (receiver * width) : radius * (receiver - shadows[layer].near) / width;
  search = clamp(search, kLeastSearch / size, kWidestFilter);
  float slack = kSoftSlack * shadow_slack(layer, at.z);
  float sum = 0.0, count = 0.0;
  for (int i = 0; i < SHADE_TIMES(kSearchTaps); ++i) {
    vec2 offset = disc_point(i, kSearchTaps, turn) * search;
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
  return is_perspective ? radius * spread / (max(blocker, kNearestBlocker * receiver) * receiver * width)
                        : radius * spread / width;
}

float shadow_softly(int layer, vec3 at, vec2 tilt, float radius) {
  float turn = 2.0 * kShadePi * interleaved_noise(gl_FragCoord.xy, noise_turn);
  float size = float(textureSize(shadow_depths, 0).x);
  float penumbra = shadow_penumbra(layer, layer, at, tilt, shadow_distance(layer, at.z), radius, turn);
  penumbra = clamp(penumbra, 1.0 / size, kWidestFilter);
  float slack = kSoftSlack * shadow_slack(layer, at.z);
  float sum = 0.0;
  for (int i = 0; i < SHADE_TIMES(kFilterTaps); ++i) {
    vec2 offset = disc_point(i, kFilterTaps, turn) * penumbra;
    sum += texture(shadow_maps, vec4(at.xy + offset, float(layer), at.z + dot(tilt, offset) + slack));
  }
  return sum / float(kFilterTaps);
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
  for (int i = 0; i < SHADE_TIMES(9); ++i) {
    sum += wx[i % 3] * wy[i / 3] * veil_at(layer, texel + ivec2(i % 3 - 1, i / 3 - 1), z);
  }
  return sum;
}

#ifdef HAS_SOFT_SHADOWS
/// The same from a light with an extent.
float veil_softly(int layer, vec3 at, vec2 tilt, float radius) {
  float turn = 2.0 * kShadePi * interleaved_noise(gl_FragCoord.xy, noise_turn);
  ivec3 size = textureSize(veils, 0);
  float penumbra = shadow_penumbra(layer, size.z + layer, at, tilt, shadow_distance(layer, at.z), radius, turn);
  penumbra = clamp(penumbra, 1.0 / float(size.x), kWidestFilter);
  float slack = kSoftSlack * shadow_slack(layer, at.z);
  float sum = 0.0;
  for (int i = 0; i < SHADE_TIMES(kFilterTaps); ++i) {
    vec2 offset = disc_point(i, kFilterTaps, turn) * penumbra;
    sum += veil_at(layer, ivec2(floor((at.xy + offset) * vec2(size.xy))), at.z + dot(tilt, offset) + slack);
  }
  return sum / float(kFilterTaps);
}
#endif
#endif

#ifdef HAS_SOFT_SHADOWS
/// How the depth of the plane of a surface changes over the map: a filter as wide as a light must not find the surface
/// in its own way. In a perspective map, too, a plane's depth is linear.
vec2 shadow_tilt(int layer, vec3 at, vec3 position, vec3 normal, float step) {
  vec3 x = shade_tangent(normal);
  vec3 a = shadow_point(layer, position + x * step) - at,
       b = shadow_point(layer, position + cross(normal, x) * step) - at;
  float area = a.x * b.y - a.y * b.x;
  if (abs(area) < kLeastTiltArea) return vec2(0.0);
  vec2 most = vec2(shadows[layer].is_perspective == 1 ? kSteepestFar * at.z : kSteepestFlat);
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
  vec3 moved = position + normal * (texel * (kLift + kLiftOfSlope * slope));
  clip = shadows[layer].from_world * vec4(moved, 1.0);
  vec3 at = vec3(clip.xy / clip.w * 0.5 + 0.5, clip.z / clip.w);
  if (clip.w <= 0.0 || any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return 1.0;
#ifdef HAS_SOFT_SHADOWS
  // Of a picture of many frames each has a hard shadow from a point of its own.
  radius *= shadow_share;
  if (radius > 0.0 && shadow_share > kSoftShare) {
    vec2 tilt = shadow_tilt(layer, at, moved, normal, kTiltStep * texel);
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
