// Points that differ from pixel to pixel, so that a few neighbours together have many.
#include "shade/shim.glsl.h"

/// Interleaved gradient noise in [0, 1), `turn` later in it. Jiménez 2014, "Next Generation Post Processing in Call of
/// Duty: Advanced Warfare", with its constants.
float interleaved_noise(vec2 pixel, float turn) {
  return fract(52.9829189 * fract(dot(floor(pixel), vec2(0.06711056, 0.00583715))) + turn);
}

const float kGoldenAngle = 2.39996323;  // π (3 - √5): points that follow one another by it are spread evenly

/// Point i of `count` spread over the unit disc. Vogel 1979, "A Better Way to Construct the Sunflower Head".
vec2 disc_point(int i, int count, float turn) {
  float r = sqrt((float(i) + 0.5) / float(count)), phi = kGoldenAngle * float(i) + turn;
  return vec2(cos(phi), sin(phi)) * r;
}
