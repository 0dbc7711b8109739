#ifndef CANDELA_SHADE_FOOTPRINT_GLSL_H
#define CANDELA_SHADE_FOOTPRINT_GLSL_H

#include "shade/shim.glsl.h"

SHADE_BEGIN

// Which texels a lookup reads, for whoever reads them from memory without a sampler.

// How a coordinate beyond [0, 1] continues; in the order of candela::Wrap.
SHADE_CONST int kFootprintRepeat = 0;
SHADE_CONST int kFootprintClamp = 1;
SHADE_CONST int kFootprintMirror = 2;

/// Along one axis: two texels and how much of the second is in the mix.
struct FootprintAxis {
  int first;
  int second;
  float share;
};

/// Into [0, 1]; mirrored repeat is a triangle wave. In C++ infinite coordinates and NaN become 0: max(0, NaN) is 0 in
/// this order.
SHADE_FN float footprint_unit(float t, int wrap) {
  if (wrap == kFootprintRepeat) return max(0.0f, t - floor(t));
  if (wrap == kFootprintClamp) return min(max(0.0f, t), 1.0f);
  float m = max(0.0f, t - 2.0f * floor(0.5f * t));
  return m > 1.0f ? 2.0f - m : m;
}

/// A texel at most one beyond the edge.
SHADE_FN int footprint_texel(int i, int size, int wrap) {
  if (i >= 0 && i < size) return i;
  if (wrap == kFootprintRepeat) return i < 0 ? i + size : i - size;
  return i < 0 ? 0 : size - 1;
}

/// `unit` within [0, 1].
SHADE_FN FootprintAxis footprint_nearest(float unit, int size) {
  FootprintAxis axis;
  int at = int(unit * float(size));
  axis.first = at < size ? at : size - 1;
  axis.second = axis.first;
  axis.share = 0.0f;
  return axis;
}

/// Texels have their value at their middle.
SHADE_FN FootprintAxis footprint_linear(float unit, int size, int wrap) {
  FootprintAxis axis;
  float place = unit * float(size);
  float below = floor(place - 0.5f);
  axis.share = place - 0.5f - below;
  axis.first = footprint_texel(int(below), size, wrap);
  axis.second = footprint_texel(int(below) + 1, size, wrap);
  return axis;
}

// ----- panoramas, equirectangular: +y up, the middle of the picture at +x, its right at +z

/// atan(x) for x in [0, 1]; Abramowitz & Stegun 1964, eq. 4.4.49, |error| ≤ 2e-8.
SHADE_FN float panorama_atan_unit(float x) {
  float s = x * x;
  float p = 0.0028662257f;
  p = p * s - 0.0161657367f;
  p = p * s + 0.0429096138f;
  p = p * s - 0.0752896400f;
  p = p * s + 0.1065626393f;
  p = p * s - 0.1420889944f;
  p = p * s + 0.1999355085f;
  p = p * s - 0.3333314528f;
  return x + x * s * p;
}

/// Angle of (x, y) in [-π, π], as atan(y, x), which on a CPU takes several times as long: it is needed for every ray
/// that hits nothing.
SHADE_FN float panorama_angle(float y, float x) {
  float ax = abs(x);
  float ay = abs(y);
  float longer = max(ax, ay);
  if (longer == 0.0f) return 0.0f;
  float a = panorama_atan_unit(min(ax, ay) / longer);
  if (ay > ax) a = 0.5f * kShadePi - a;
  if (x < 0.0f) a = kShadePi - a;
  return y < 0.0f ? -a : a;
}

/// Of a unit direction, whose sine to the pole is `sin_theta`.
SHADE_FN vec2 panorama_uv(vec3 direction, float sin_theta) {
  return vec2(0.5f + panorama_angle(direction.z, direction.x) * (0.5f / kShadePi),
              panorama_angle(sin_theta, direction.y) * (1.0f / kShadePi));
}

/// Sine to the pole; above 0, because densities over solid angles divide by it.
SHADE_FN float panorama_sine(float v) { return max(sin(v * kShadePi), 1e-6f); }

/// The unit direction of uv, whose sine to the pole is `sin_theta`.
SHADE_FN vec3 panorama_direction(vec2 uv, float sin_theta) {
  float phi = (uv.x - 0.5f) * 2.0f * kShadePi;
  return normalize(vec3(sin_theta * cos(phi), cos(uv.y * kShadePi), sin_theta * sin(phi)));
}

SHADE_END

#endif
