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

#ifdef HAS_PANORAMA
// As fine as a panorama of 16384 texels asks for, and fewer operations than a driver's own. Abramowitz & Stegun 1964,
// "Handbook of Mathematical Functions", 4.4.46 and 4.4.47.
float arccosine(float x) {
  float a = abs(x);
  float p = 0.0308918810 + a * (-0.0170881256 + a * (0.0066700901 - a * 0.0012624911));
  p = 1.5707963050 + a * (-0.2145988016 + a * (0.0889789874 + a * (-0.0501743046 + a * p)));
  float angle = sqrt(max(1.0 - a, 0.0)) * p;
  return x < 0.0 ? kShadePi - angle : angle;
}

float arctangent(float y, float x) {
  float ax = abs(x), ay = abs(y);
  float t = min(ax, ay) / max(max(ax, ay), 1e-30), t2 = t * t;
  float angle = t * (0.9998660 + t2 * (-0.3302995 + t2 * (0.1801410 + t2 * (-0.0851330 + t2 * 0.0208351))));
  angle = ay > ax ? 0.5 * kShadePi - angle : angle;
  angle = x < 0.0 ? kShadePi - angle : angle;
  return y < 0.0 ? -angle : angle;
}
#endif

void main() {
  vec3 d = normalize(ray + ray_x * v_ndc.x + ray_y * v_ndc.y);
  vec3 color = constant_light;
#ifdef HAS_PANORAMA
  vec2 uv = vec2(0.5 + arctangent(d.z, d.x) / (2.0 * kShadePi), arccosine(d.y) / kShadePi);
  color += textureLod(panorama, uv, 0.0).rgb * intensity;
#endif
#ifdef kSuns
  for (int i = 0; i < kSuns; ++i) {
    if (dot(d, sun_directions[i].xyz) >= sun_directions[i].w) color += sun_radiances[i];
  }
#endif
  o_color = vec4(color, 1.0);
}
