#include "shade/color.glsl.h"
#include "shade/tonemap.glsl.h"

// A linear picture on a display.

in vec2 v_ndc;

uniform highp sampler2D picture;
uniform float exposure;
uniform int tone_curve;

layout(location = 0) out vec4 o_color;

void main() {
  vec4 c = textureLod(picture, v_ndc * 0.5 + 0.5, 0.0);
  vec3 shown = tone_map(tone_curve, max(c.rgb, vec3(0.0)) * exposure);
  o_color = vec4(srgb_encode(clamp(shown, 0.0, 1.0)), 1.0);
}
