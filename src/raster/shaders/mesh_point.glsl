// Where a surface is and how it faces, as path/surface_point.cpp has it.

struct Point {
  vec3 wo;             // world
  vec3 geometric;      // unit, on the viewer's side
  vec3 vertex_normal;  // of the vertices
  vec3 normal;         // mapped
  vec3 coat_normal;
  vec3 front_tangent;  // of the front; 0: there is none
  vec3 front_bitangent;
  float widened;  // what of the squared alpha stands for normals that turn within the pixel
};

// Of squared lengths: what is shorter has no direction that floats could tell.
const float kLeastNormal2 = 1e-12;
const float kLeastTangent2 = 1e-16;

#ifdef HAS_height
#include "mesh_relief.glsl"
#endif

/// Along the eye's ray.
float distance_to_eye() {
  return is_perspective > 0.5 ? distance(eye, v_position) : dot(eye - v_position, back);
}

Point make_point(bool is_back) {
  Point p;
  p.wo = is_perspective > 0.5 ? normalize(eye - v_position) : back;
  vec3 ng = cross(dFdx(v_position), dFdy(v_position));
  float ng2 = dot(ng, ng);
  ng = ng2 > 0.0 ? ng * inversesqrt(ng2) : p.wo;
  if (dot(ng, p.wo) < 0.0) ng = -ng;
  p.geometric = ng;
  float n2 = dot(v_normal, v_normal);
  vec3 ns = n2 > kLeastNormal2 ? v_normal * inversesqrt(n2) : ng;
  if (dot(ns, ng) < 0.0) ns = -ns;
  p.vertex_normal = ns;
#if defined(HAS_height) && !defined(HAS_normal)
  ns = relief_normal(ns);
#endif
  p.coat_normal = ns;
  p.widened = 0.0;
  p.front_tangent = vec3(0.0);
  p.front_bitangent = vec3(0.0);
#ifdef HAS_TANGENT
  float side = is_back ? -1.0 : 1.0;
  vec3 nf = ns * side;
  vec3 t = v_tangent.xyz - nf * dot(nf, v_tangent.xyz);
  float t2 = dot(t, t);
  t = t2 > kLeastTangent2 ? t * inversesqrt(t2) : shade_tangent(nf);
  bool flip = v_tangent.w < 0.0;
  mat3 front = mat3(t, cross(nf, t), nf);
#ifdef HAS_clearcoat_normal
  p.coat_normal = normal_mapped(clearcoat_normal_texel().xyz, material.clearcoat_normal_scale, front, flip, ns, side);
#endif
#ifdef HAS_normal
  ns = normal_mapped(normal_texel().xyz, material.normal_scale, front, flip, ns, side);
#endif
  p.front_tangent = front[0];
  p.front_bitangent = flip ? -front[1] : front[1];
#endif
  p.normal = normal_kept_outside(ns, ng, p.wo);
  return p;
}
