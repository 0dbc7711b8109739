#include "more_uvs.vert.glsl"

layout(location = 0) in vec3 a_position;
layout(location = 3) in vec4 a_uv;
layout(location = 4) in vec4 a_color;
layout(location = 5) in vec4 a_world_0;
layout(location = 6) in vec4 a_world_1;
layout(location = 7) in vec4 a_world_2;
layout(location = 8) in vec4 a_node_color;

uniform mat4 clip_from_world;
#ifdef IS_SHADOW
uniform float near;

out float v_depth;  // times w
#endif

invariant gl_Position;

out vec4 v_uv;
out float v_alpha;

void main() {
  vec4 p = vec4(a_position, 1.0);
  v_uv = a_uv;
  pass_more_uvs();
  v_alpha = a_color.a * a_node_color.a;
  gl_Position = clip_from_world * vec4(dot(a_world_0, p), dot(a_world_1, p), dot(a_world_2, p), 1.0);
#ifdef IS_SHADOW
  // Cut off at the near plane only.
  v_depth = gl_Position.z;
  gl_Position.z = gl_Position.w - 2.0 * near;
#endif
}
