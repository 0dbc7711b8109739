#include "frame.glsl"
#include "shade/shim.glsl.h"
#include "noise.glsl"

// Light that left a scattering body spreads to its neighbourhood in the picture, by the profile of Christensen & Burley
// 2015: (exp(-r/d) + exp(-r/3d)) / (8 π d r). Points are chosen by the widest colour's profile; what lies in front or
// behind is as far away as it is.

uniform highp sampler2D scattered_light;   // a: distance along the view, 0 where nothing scatters
uniform highp sampler2D scattering_width;  // d of each colour, metres
uniform vec4 scale;                        // pixels per metre at distance 1, 1 = perspective, turn of the points

layout(location = 0) out vec4 o_color;

const int kPoints = 32;
// Of the points, what the narrow exponential gets: its share of the profile's integral over the plane. What 0 … 1 of
// each is multiplied by to be drawn from ends short of 1, where a radius is infinite.
const float kNarrowShare = 0.25;
const float kNarrowScale = 3.999;
const float kWideScale = 1.3332;
const float kWithinPixel = 0.2;     // pixels: light that spreads over less has nowhere to go
const float kLeastWidth = 1e-7;     // m
const float kLeastDensity = 1e-12;  // 1/m
const float kLeastWeight = 1e-6;    // of all points: with less a colour stays as it is

/// Times 2 π r: the density of a radius.
vec3 profile(float r, vec3 d) { return (exp(-r / d) + exp(-r / (3.0 * d))) / (4.0 * d); }

void main() {
  ivec2 size = textureSize(scattered_light, 0);
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 middle = texelFetch(scattered_light, pixel, 0);
  o_color = vec4(0.0);
  if (middle.a <= 0.0) return;
  vec3 d = max(texelFetch(scattering_width, pixel, 0).rgb, vec3(kLeastWidth));
  float widest = shade_max3(d);
  float pixels = scale.x / (scale.y > 0.5 ? middle.a : 1.0);
  if (widest * pixels < kWithinPixel) {
    o_color = vec4(middle.rgb, 0.0);
    return;
  }
  float turn = interleaved_noise(gl_FragCoord.xy, scale.z);
  vec3 sum = vec3(0.0), weight = vec3(0.0);
  for (int i = 0; i < kPoints; ++i) {
    float u = (float(i) + turn) / float(kPoints);
    float r = u < kNarrowShare ? -widest * log(1.0 - u * kNarrowScale)
                               : -3.0 * widest * log(1.0 - (u - kNarrowShare) * kWideScale);
    float phi = kGoldenAngle * float(i) + 2.0 * kShadePi * turn;
    ivec2 at = clamp(pixel + ivec2(round(vec2(cos(phi), sin(phi)) * (r * pixels))), ivec2(0), size - 1);
    vec4 there = texelFetch(scattered_light, at, 0);
    if (there.a <= 0.0) continue;
    float step = there.a - middle.a;
    float away = sqrt(r * r + step * step);
    vec3 w = profile(away, d) / max(profile(r, vec3(widest)).x, kLeastDensity);
    sum += w * there.rgb;
    weight += w;
  }
  o_color = vec4(mix(middle.rgb, sum / max(weight, vec3(kLeastWeight)), step(kLeastWeight, weight)), 0.0);
}
