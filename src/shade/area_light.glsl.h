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

/// The share of a clamped cosine about z that falls on the quadrilateral a b c d, seen from the origin, of either
/// winding; a triangle repeats a corner. In [0, 1].
SHADE_FN float area_share(vec3 a, vec3 b, vec3 c, vec3 d) {
  vec3 down = vec3(0.0f);
  vec3 up = vec3(0.0f);
  float sum = 0.0f;
  // Each edge as far as it is above z = 0, and then along the horizon, from where the polygon sinks to where it rises.
  for (int i = 0; i < SHADE_TIMES(5); ++i) {
    vec3 from = i == 0 ? a : i == 1 ? b : i == 2 ? c : i == 3 ? d : down;
    vec3 to = i == 0 ? b : i == 1 ? c : i == 2 ? d : i == 3 ? a : up;
    bool is_closed = i == 4;
    if (is_closed ? dot(down, down) <= 0.0f || dot(up, up) <= 0.0f : from.z <= 0.0f && to.z <= 0.0f) continue;
    if (!is_closed && (from.z <= 0.0f || to.z <= 0.0f)) {
      vec3 crossing = from + (to - from) * (from.z / (from.z - to.z));
      if (from.z > 0.0f) {
        to = down = crossing;
      } else {
        from = up = crossing;
      }
    }
    sum += area_edge(from, to);
  }
  return min(abs(sum) * (0.5f / kShadePi), 1.0f);
}

SHADE_END

#endif
