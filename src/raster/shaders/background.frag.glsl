#include "shade/shim.glsl.h"

in vec2 v_ndc;

uniform highp sampler2D panorama;
uniform vec3 ray;  // in the environment's frame, through the middle of the picture
uniform vec3 ray_x;  // added towards its right edge
uniform vec3 ray_y;  // and its upper one
uniform vec2 panorama_scale;  // intensity, 1 where there is a map
uniform vec3 constant_light;
uniform int sun_count;
uniform vec4 sun_directions[4];  // in the environment's frame; w: cosine of the angular radius
uniform vec3 sun_radiances[4];

layout(location = 0) out vec4 o_color;

// As fine as a texel of 16384 asks for, in a third of the time that a driver's own functions take. Abramowitz & Stegun
// 1964, "Handbook of Mathematical Functions", 4.4.46 and 4.4.47.
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

void main() {
  vec3 d = normalize(ray + ray_x * v_ndc.x + ray_y * v_ndc.y);
  vec3 color = constant_light;
  if (panorama_scale.y > 0.5) {
    vec2 uv = vec2(0.5 + arctangent(d.z, d.x) / (2.0 * kShadePi), arccosine(d.y) / kShadePi);
    color += textureLod(panorama, uv, 0.0).rgb * panorama_scale.x;
  }
  for (int i = 0; i < sun_count; ++i) {
    if (dot(d, sun_directions[i].xyz) >= sun_directions[i].w) color += sun_radiances[i];
  }
  o_color = vec4(color, 1.0);
}
