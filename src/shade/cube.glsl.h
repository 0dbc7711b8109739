#ifndef CANDELA_SHADE_CUBE_GLSL_H
#define CANDELA_SHADE_CUBE_GLSL_H

#include "shade/shim.glsl.h"

// Addresses on a cube map: faces +x -x +y -y +z -z; (s, t) in [-1, 1]², s to the right and t downwards as the rows of a
// face are stored. Khronos Group, "OpenGL 4.6 core profile", table 8.19 (there (s, t) are in [0, 1]).

SHADE_BEGIN

/// Towards the point (s, t) of a face; not normalised, the largest component is 1.
SHADE_FN vec3 cube_direction(int face, float s, float t) {
  if (face == 0) return vec3(1.0f, -t, -s);
  if (face == 1) return vec3(-1.0f, -t, s);
  if (face == 2) return vec3(s, 1.0f, t);
  if (face == 3) return vec3(s, -1.0f, -t);
  if (face == 4) return vec3(s, -t, 1.0f);
  return vec3(-s, -t, -1.0f);
}

/// The face that direction `d` meets, and where: (face, s, t).
SHADE_FN vec3 cube_coordinates(vec3 d) {
  vec3 a = abs(d);
  if (a.x >= a.y && a.x >= a.z) {
    return d.x > 0.0f ? vec3(0.0f, -d.z / a.x, -d.y / a.x) : vec3(1.0f, d.z / a.x, -d.y / a.x);
  }
  if (a.y >= a.z) {
    return d.y > 0.0f ? vec3(2.0f, d.x / a.y, d.z / a.y) : vec3(3.0f, d.x / a.y, -d.z / a.y);
  }
  return d.z > 0.0f ? vec3(4.0f, d.x / a.z, -d.y / a.z) : vec3(5.0f, -d.x / a.z, -d.y / a.z);
}

/// Solid angle (sr) per unit of (s, t) area at (s, t): dω = ds dt / (1 + s² + t²)^(3/2).
SHADE_FN float cube_solid_angle_density(float s, float t) {
  float r2 = 1.0f + s * s + t * t;
  return 1.0f / (r2 * sqrt(r2));
}

SHADE_END

#endif
