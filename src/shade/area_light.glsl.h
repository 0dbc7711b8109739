#ifndef CANDELA_SHADE_AREA_LIGHT_GLSL_H
#define CANDELA_SHADE_AREA_LIGHT_GLSL_H

#include "shade/tables.glsl.h"

// Light from a polygon that shines the same everywhere, in closed form: a linear map turns the lobe into a clamped
// cosine, whose integral over a polygon is a sum over its edges. Heitz, Dupuy, Hill & Neubelt 2016, "Real-Time
// Polygonal-Light Shading with Linearly Transformed Cosines". The maps are fitted by shade/make_tables.cpp.

SHADE_BEGIN

/// The map from directions in the frame whose z is the normal and whose x the viewer leans towards, to where the lobe
/// of GGX with this roughness is a clamped cosine. Lobes narrower than the second entry of the table are as wide.
SHADE_FN mat3 area_lobe(float mu, float roughness) {
  vec4 m = table_cosine(mu, max(roughness, 1.0f / float(kTableCosines - 1)));
  return mat3(vec3(m.x, 0.0f, m.y), vec3(0.0f, 1.0f, 0.0f), vec3(m.z, 0.0f, m.w));
}

/// What an edge from `a` to `b` adds to the irradiance on z = 0 at the origin: the angle between them times the z of
/// the normal of the plane through both. Lambert 1760, in the form of Baum, Rushmeier & Winget 1989, "Improving
/// Radiosity Solutions through the Use of Analytically Determined Form-Factors".
SHADE_FN float area_edge(vec3 a, vec3 b) {
  vec3 u = a / max(length(a), 1e-20f);
  vec3 v = b / max(length(b), 1e-20f);
  vec3 n = cross(u, v);
  float sine = length(n);
  return sine < 1e-7f ? 0.0f : n.z / sine * atan(sine, dot(u, v));
}

/// An edge as far as it is above z = 0; where it crosses, the crossing becomes `down` or `up`.
SHADE_FN float area_edge_above(vec3 a, vec3 b, SHADE_INOUT(vec3) down, SHADE_INOUT(vec3) up) {
  if (a.z <= 0.0f && b.z <= 0.0f) return 0.0f;
  if (a.z > 0.0f && b.z > 0.0f) return area_edge(a, b);
  vec3 crossing = a + (b - a) * (a.z / (a.z - b.z));
  if (a.z > 0.0f) {
    down = crossing;
    return area_edge(a, crossing);
  }
  up = crossing;
  return area_edge(crossing, b);
}

/// The share of a clamped cosine about z that falls on the quadrilateral a b c d, seen from the origin, of either
/// winding; a triangle repeats a corner. In [0, 1].
SHADE_FN float area_share(vec3 a, vec3 b, vec3 c, vec3 d) {
  vec3 down = vec3(0.0f);
  vec3 up = vec3(0.0f);
  float sum = area_edge_above(a, b, down, up) + area_edge_above(b, c, down, up) + area_edge_above(c, d, down, up) +
              area_edge_above(d, a, down, up);
  // Along the horizon, from where the polygon sinks to where it rises.
  if (dot(down, down) > 0.0f && dot(up, up) > 0.0f) sum += area_edge(down, up);
  return min(abs(sum) * (0.5f / kShadePi), 1.0f);
}

SHADE_END

#endif
