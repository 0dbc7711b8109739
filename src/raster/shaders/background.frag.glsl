#include "shade/shim.glsl.h"

// All directions are in the environment's frame, turned by its rotation.

in vec2 v_ndc;

uniform vec3 ray;    // through the middle of the picture
uniform vec3 ray_x;  // what its right edge adds to it
uniform vec3 ray_y;  // and its upper one
uniform vec3 constant_light;
#ifdef HAS_PANORAMA
uniform highp sampler2D panorama;
uniform float intensity;
#endif
#ifdef kSuns
uniform vec4 sun_directions[kSuns];  // w: cosine of the angular radius
uniform vec3 sun_radiances[kSuns];
#endif

layout(location = 0) out vec4 o_color;

const float kMostHalf = 65504.0;  // of half floats: beyond it a picture would have infinities

#ifdef HAS_PANORAMA
/// Within 1e-5, a texel's eighth of a panorama of 16384, in fewer operations than a driver's own. Abramowitz & Stegun
/// 1964, "Handbook of Mathematical Functions", 4.4.47.
float arctangent(float y, float x) {
  const float kLeast = 1e-30;  // none is divided by
  float ax = abs(x), ay = abs(y);
  float t = min(ax, ay) / max(max(ax, ay), kLeast), t2 = t * t;
  float angle = t * (0.9998660 + t2 * (-0.3302995 + t2 * (0.1801410 + t2 * (-0.0851330 + t2 * 0.0208351))));
  angle = ay > ax ? 0.5 * kShadePi - angle : angle;
  angle = x < 0.0 ? kShadePi - angle : angle;
  return y < 0.0 ? -angle : angle;
}
#endif

void main() {
  vec3 d = ray + ray_x * v_ndc.x + ray_y * v_ndc.y;
  vec3 color = constant_light;
#ifdef HAS_PANORAMA
  vec2 uv = 0.5 + vec2(0.5, -1.0) / kShadePi * vec2(arctangent(d.z, d.x), arctangent(d.y, length(d.xz)));
  color += textureLod(panorama, uv, 0.0).rgb * intensity;
#endif
#ifdef kSuns
  vec3 toward = normalize(d);
  for (int i = 0; i < kSuns; ++i) {
    if (dot(toward, sun_directions[i].xyz) >= sun_directions[i].w) color += sun_radiances[i];
  }
#endif
  o_color = vec4(min(color, vec3(kMostHalf)), 1.0);
}
