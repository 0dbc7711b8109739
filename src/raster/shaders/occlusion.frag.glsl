#include "shade/shim.glsl.h"
#include "noise.glsl"

// Ambient occlusion from the depth of the picture: how much of the cosine-weighted hemisphere is open, by the horizons
// to both sides in a few planes through the line of sight. Jiménez, Wu, Pesce & Jarabo 2016, "Practical Real-Time
// Strategies for Accurate Indirect Occlusion", §4.

uniform highp sampler2D depth_map;
#ifdef HAS_CULLED
uniform highp sampler2D culled_map;  // the same with what turns its back to the eye
#endif
uniform mat4 clip_from_camera;
uniform vec4 reach;  // radius in metres, pixels per metre at distance 1, turn of the planes, 1 = perspective

layout(location = 0) out vec4 o_visibility;

const int kPlanes = 2;
const int kSteps = 5;
const float kFade = 1.5;            // from a third of the radius on
const float kHorizonSlack = 0.035;  // two degrees: the roundings of depth and the chords of curved surfaces
const float kWidest = 0.3;          // of the picture's height: farther steps would step over what is thin
const float kLeastRadius = 2.0;     // pixels: within fewer there is nothing to see
const float kStepTurn = 7.0;        // any numbers that spread the steps of a pixel's planes, and of its neighbours
const float kPlaneTurn = 0.37;
const float kLeastLength = 1e-9;  // m
const float kLeastShare = 1e-6;

vec3 position_in(highp sampler2D map, ivec2 pixel, ivec2 size) {
  pixel = clamp(pixel, ivec2(0), size - 1);
  float depth = texelFetch(map, pixel, 0).x * 2.0 - 1.0;
  vec2 ndc = (vec2(pixel) + 0.5) / vec2(size) * 2.0 - 1.0;
  mat4 m = clip_from_camera;
  if (reach.w < 0.5) return vec3((ndc.x - m[3].x) / m[0].x, (ndc.y - m[3].y) / m[1].y, (depth - m[3].z) / m[2].z);
  float along = m[3].z / (depth + m[2].z);
  return vec3((ndc.x + m[2].x) * along / m[0].x, (ndc.y + m[2].y) * along / m[1].y, -along);
}

vec3 position_at(ivec2 pixel, ivec2 size) { return position_in(depth_map, pixel, size); }

/// Cosine between the view and what lies at `to`, or `open` where that is too far away to matter.
float horizon_of(vec3 to, vec3 v, float open) {
  float l = length(to);
  // What is farther off than the radius occludes less and less: it would not be seen from a ray's end either.
  float near = clamp(kFade - kFade * l / reach.x, 0.0, 1.0);
  return mix(open, dot(to, v) / max(l, kLeastLength) - kHorizonSlack, near);
}

void main() {
  ivec2 size = textureSize(depth_map, 0);
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  o_visibility = vec4(1.0);
  if (texelFetch(depth_map, pixel, 0).x >= 1.0) return;
  vec3 c = position_at(pixel, size);
  vec3 v = reach.w > 0.5 ? normalize(-c) : vec3(0.0, 0.0, 1.0);

  // The facet, by the nearer neighbour on either axis.
  vec3 right = position_at(pixel + ivec2(1, 0), size) - c, left = c - position_at(pixel - ivec2(1, 0), size);
  vec3 up = position_at(pixel + ivec2(0, 1), size) - c, down = c - position_at(pixel - ivec2(0, 1), size);
  bool is_right = pixel.x == 0 || (pixel.x + 1 < size.x && abs(right.z) < abs(left.z));
  bool is_up = pixel.y == 0 || (pixel.y + 1 < size.y && abs(up.z) < abs(down.z));
  vec3 n = normalize(cross(is_right ? right : left, is_up ? up : down));
  if (dot(n, v) < 0.0) n = -n;

  float radius = reach.x * reach.y / (reach.w > 0.5 ? -c.z : 1.0);  // pixels
  radius = min(radius, kWidest * float(size.y));
  if (radius < kLeastRadius) return;

  // Neighbours see other planes.
  float noise = interleaved_noise(gl_FragCoord.xy, reach.z);
  float sum = 0.0;
  for (int i = 0; i < kPlanes; ++i) {
    float phi = (float(i) + noise) * (kShadePi / float(kPlanes));
    vec2 direction = vec2(cos(phi), sin(phi));
    vec3 d = vec3(direction, 0.0);
    vec3 axis = normalize(cross(d, v));
    vec3 in_plane = n - axis * dot(n, axis);
    float share = length(in_plane);
    vec3 tangent = d - v * dot(d, v);
    float cos_n = clamp(dot(in_plane, v) / max(share, kLeastShare), -1.0, 1.0);
    float angle_n = (dot(tangent, in_plane) < 0.0 ? -1.0 : 1.0) * acos(cos_n);
    vec2 horizon;
    for (int side = 0; side < 2; ++side) {
      float sgn = side == 0 ? -1.0 : 1.0;
      // Nothing lies below the facet.
      float open = cos(angle_n + sgn * (0.5 * kShadePi));
      float highest = open;
      for (int k = 0; k < kSteps; ++k) {
        float t = (float(k) + fract(noise * kStepTurn + kPlaneTurn * float(i))) / float(kSteps);
        vec2 offset = direction * (sgn * max(t * t * radius, float(k) + 1.0));
        ivec2 there = pixel + ivec2(round(offset));
        highest = max(highest, horizon_of(position_at(there, size) - c, v, open));
#ifdef HAS_CULLED
        highest = max(highest, horizon_of(position_in(culled_map, there, size) - c, v, open));
#endif
      }
      horizon[side] = sgn * acos(clamp(highest, -1.0, 1.0));
    }
    // ∫ of the cosine between the horizons, ibid. eq. 10.
    for (int side = 0; side < 2; ++side) {
      float h = angle_n + clamp(horizon[side] - angle_n, -0.5 * kShadePi, 0.5 * kShadePi);
      sum += share * 0.25 * (cos_n + 2.0 * h * sin(angle_n) - cos(2.0 * h - angle_n));
    }
  }
  o_visibility = vec4(clamp(sum / float(kPlanes), 0.0, 1.0));
}
