#include "frame.glsl"
#include "more_uvs.vert.glsl"

layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec4 a_tangent;
layout(location = 3) in vec4 a_uv;
layout(location = 4) in vec4 a_color;
layout(location = 5) in vec4 a_world_0;  // rows of world_from_object
layout(location = 6) in vec4 a_world_1;
layout(location = 7) in vec4 a_world_2;
layout(location = 8) in vec4 a_node_color;

invariant gl_Position;  // so that depths drawn before are met again

out vec3 v_position;
out vec3 v_normal;
out vec4 v_uv;
#ifdef HAS_TANGENT
out vec4 v_tangent;
#endif
#ifdef HAS_COLOR
out vec4 v_color;
#endif
#ifdef HAS_SCALE
flat out float v_scale;  // of lengths, from object to world
#endif
#ifdef SURFACE_MAP
uniform int first_draw;
flat out ivec2 v_place;  // which draw, and which of its triangles
out vec2 v_corner;       // weights of the second and the third
#endif

void main() {
  vec4 p = vec4(a_position, 1.0);
  vec3 x = a_world_0.xyz, y = a_world_1.xyz, z = a_world_2.xyz;
  v_position = vec3(dot(a_world_0, p), dot(a_world_1, p), dot(a_world_2, p));
  // The cofactors are the inverse transpose up to scale, and exist for flattening transforms too.
  vec3 n = vec3(dot(cross(y, z), a_normal), dot(cross(z, x), a_normal), dot(cross(x, y), a_normal));
  float side = dot(x, cross(y, z)) < 0.0 ? -1.0 : 1.0;
  float n2 = dot(n, n);
  v_normal = n * (n2 > 0.0 ? side * inversesqrt(n2) : 0.0);
  v_uv = a_uv;
  pass_more_uvs();
#ifdef HAS_TANGENT
  v_tangent = vec4(dot(x, a_tangent.xyz), dot(y, a_tangent.xyz), dot(z, a_tangent.xyz), a_tangent.w * side);
#endif
#ifdef HAS_COLOR
  v_color = a_color * a_node_color;
#endif
#ifdef HAS_SCALE
  v_scale = pow(abs(dot(x, cross(y, z))), 1.0 / 3.0);
#endif
#ifdef SURFACE_MAP
  // Every triangle has vertices of its own.
  int corner = gl_VertexID % 3;
  v_place = ivec2(first_draw + gl_InstanceID, gl_VertexID / 3);
  v_corner = vec2(corner == 1, corner == 2);
#endif
  gl_Position = clip_from_world * vec4(v_position, 1.0);
}
