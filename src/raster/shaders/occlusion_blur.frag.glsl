// Mean of 4 × 4 neighbours on the same surface: the noise of the planes repeats over about as much.

uniform highp sampler2D visibility_map;
uniform highp sampler2D depth_map;
uniform mat4 clip_from_camera;
uniform float is_perspective;

layout(location = 0) out vec4 o_visibility;

const float kDepthsApart = 40.0;  // texels whose distance differs by a fortieth are of another surface
const float kLeastDepth = 1e-6;
const float kLeastWeight = 1e-6;

void main() {
  ivec2 size = textureSize(depth_map, 0);
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float depth = texelFetch(depth_map, pixel, 0).x;
  // Beside what is visible, how far along the view: who reads it has another resolution.
  float z = depth * 2.0 - 1.0;
  float along = is_perspective > 0.5 ? clip_from_camera[3].z / (z + clip_from_camera[2].z)
                                     : -(z - clip_from_camera[3].z) / clip_from_camera[2].z;
  if (depth >= 1.0) {
    o_visibility = vec4(1.0, along, 0.0, 1.0);
    return;
  }
  float sum = 0.0, weight = 0.0;
  for (int y = -2; y < 2; ++y) {
    for (int x = -2; x < 2; ++x) {
      ivec2 at = clamp(pixel + ivec2(x, y), ivec2(0), size - 1);
      // Depths near 1 differ little: over what is left to 1 they tell metres.
      float w =
          max(1.0 - kDepthsApart * abs(texelFetch(depth_map, at, 0).x - depth) / max(1.0 - depth, kLeastDepth), 0.0);
      sum += w * texelFetch(visibility_map, at, 0).x;
      weight += w;
    }
  }
  o_visibility = vec4(sum / max(weight, kLeastWeight), along, 0.0, 1.0);
}
