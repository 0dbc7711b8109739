// Where a surface is and how it faces, as path/surface_point.cpp has it.

struct Point {
  vec3 wo;             // world
  vec3 geometric;      // unit, on the viewer's side
  vec3 vertex_normal;  // of the vertices
  vec3 normal;         // mapped
  vec3 coat_normal;
  vec3 tangent;
};

// Below this cosine a shading normal looks away from the viewer, and a mirror direction into the facet; of what grazes
// the facet the mirror direction may graze it by nearly as much. path/surface_point.cpp has the same numbers.
const float kLeastCosine = 0.01;
const float kGrazingShare = 0.9;

// Of squared lengths: what is shorter has no direction that floats could tell.
const float kLeastNormal2 = 1e-12;
const float kLeastTangent2 = 1e-16;

/// Turns a shading normal just so far that the viewer is in front of it and its mirror direction is in front of the
/// facet.
vec3 keep_reflection_outside(vec3 ns, vec3 ng, vec3 wo) {
  float cos_o = dot(ns, wo);
  if (cos_o < kLeastCosine) ns = normalize(ns + (kLeastCosine - cos_o) * wo);
  vec3 reflected = 2.0 * dot(ns, wo) * ns - wo;
  float limit = min(kGrazingShare * dot(ng, wo), kLeastCosine);
  float above = dot(reflected, ng);
  if (above >= limit) return ns;
  return normalize(wo + normalize(reflected + (limit - above) * ng));
}

vec3 mapped(vec4 texel, float scale, mat3 front, bool flip, vec3 ns, float side) {
  vec3 l = texel.xyz * 2.0 - 1.0;
  l.x *= scale;
  l.y *= flip ? -scale : scale;
  vec3 m = front * l;
  float m2 = dot(m, m);
  return m2 > kLeastNormal2 ? m * (inversesqrt(m2) * side) : ns;
}

#ifdef HAS_height
#include "mesh_relief.glsl"
#endif

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
  p.tangent = vec3(0.0);
#ifdef HAS_TANGENT
  float side = is_back ? -1.0 : 1.0;
  vec3 nf = ns * side;
  vec3 t = v_tangent.xyz - nf * dot(nf, v_tangent.xyz);
  float t2 = dot(t, t);
  t = t2 > kLeastTangent2 ? t * inversesqrt(t2) : shade_tangent(nf);
  bool flip = v_tangent.w < 0.0;
  mat3 front = mat3(t, cross(nf, t), nf);
#ifdef HAS_clearcoat_normal
  p.coat_normal = mapped(clearcoat_normal_texel(), material.clearcoat_normal_scale, front, flip, ns, side);
#endif
#ifdef HAS_normal
  ns = mapped(normal_texel(), material.normal_scale, front, flip, ns, side);
#endif
  vec2 turn = vec2(material.anisotropy_cos, material.anisotropy_sin);
#ifdef HAS_anisotropy
  vec2 d = anisotropy_texel().xy * 2.0 - 1.0;
  turn = vec2(turn.x * d.x - turn.y * d.y, turn.y * d.x + turn.x * d.y);
#endif
  p.tangent = front[0] * turn.x + (flip ? -front[1] : front[1]) * turn.y;
#endif
  p.normal = keep_reflection_outside(ns, ng, p.wo);
  return p;
}
