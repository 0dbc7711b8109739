#include "frame.glsl"
#include "shade/shim.glsl.h"

in vec2 v_ndc;

uniform highp sampler2D panorama;
uniform mat4 world_from_clip;
uniform vec4 panorama_turn;  // cos and sin of the environment's rotation, its intensity, 1 where there is a map
uniform vec3 constant_light;
uniform int sun_count;
uniform vec4 sun_directions[4];  // w: cosine of the angular radius
uniform vec3 sun_radiances[4];

layout(location = 0) out vec4 o_color;

void main() {
  vec4 far = world_from_clip * vec4(v_ndc, 1.0, 1.0);
  vec3 d = eye.w > 0.5 ? normalize(far.xyz / far.w - eye.xyz) : -back.xyz;
  vec3 color = constant_light;
  if (panorama_turn.w > 0.5) {
    // Turned back by the rotation about +y.
    vec3 m = vec3(panorama_turn.x * d.x - panorama_turn.y * d.z, d.y, panorama_turn.y * d.x + panorama_turn.x * d.z);
    vec2 uv = vec2(0.5 + atan(m.z, m.x) / (2.0 * kShadePi), acos(clamp(m.y, -1.0, 1.0)) / kShadePi);
    color += textureLod(panorama, uv, 0.0).rgb * panorama_turn.z;
  }
  for (int i = 0; i < sun_count; ++i) {
    if (dot(d, sun_directions[i].xyz) >= sun_directions[i].w) color += sun_radiances[i];
  }
  o_color = vec4(color, 1.0);
}
