// What several shadows on the ground let pass of the light of each.

const int kLayers = 8;

uniform highp sampler2DArray depths;
#ifdef HAS_VEILS
uniform highp sampler2DArray veils;
#endif
uniform int count;
uniform vec3 weights[kLayers];

layout(location = 0) out vec4 o_sum;

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < count; ++i) {
    if (texelFetch(depths, ivec3(texel, i), 0).x < 1.0) continue;
    float passing = 1.0;
#ifdef HAS_VEILS
    passing = texelFetch(veils, ivec3(texel, i), 0).x;
#endif
    sum += weights[i] * passing;
  }
  o_sum = vec4(sum, 1.0);
}
