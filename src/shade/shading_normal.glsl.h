#ifndef CANDELA_SHADE_SHADING_NORMAL_GLSL_H
#define CANDELA_SHADE_SHADING_NORMAL_GLSL_H

#include "shade/shim.glsl.h"

// Which way a surface faces for its lobes: normal maps, directions that textures turn, and what keeps a mapped normal
// from mirroring light out of the surface.

SHADE_BEGIN

/// Turns a shading normal just so far that the viewer is in front of it and its mirror direction is in front of the
/// facet, whose normal is `ng`.
SHADE_FN vec3 normal_kept_outside(vec3 ns, vec3 ng, vec3 wo) {
  float cos_o = dot(ns, wo);
  if (cos_o < 0.01f) ns = normalize(ns + (0.01f - cos_o) * wo);
  vec3 reflected = 2.0f * dot(ns, wo) * ns - wo;
  float limit = min(0.9f * dot(ng, wo), 0.01f);
  float above = dot(reflected, ng);
  if (above >= limit) return ns;
  return normalize(wo + normalize(reflected + (limit - above) * ng));
}

/// The normal that a texel of a map gives, on the viewer's side; `ns` where the map has none. The frame belongs to the
/// front, where tangents may run the other way round (`flip`); `side` is -1 for a viewer behind it (glTF 2.0 §3.9.6).
SHADE_FN vec3 normal_mapped(vec3 texel, float scale, mat3 front, bool flip, vec3 ns, float side) {
  vec3 local = texel * 2.0f - vec3(1.0f);
  local.x *= scale;
  local.y *= flip ? -scale : scale;
  vec3 mapped = front[0] * local.x + front[1] * local.y + front[2] * local.z;
  float mapped2 = dot(mapped, mapped);
  return mapped2 > 1e-12f ? mapped * (inversesqrt(mapped2) * side) : ns;
}

/// A direction from the tangent, turned further by what a texel says (KHR_materials_anisotropy): cosine and sine, of a
/// texel without a direction shorter.
SHADE_FN vec2 normal_turned(vec2 turn, vec2 texel) {
  vec2 d = texel * 2.0f - vec2(1.0f);
  return vec2(turn.x * d.x - turn.y * d.y, turn.y * d.x + turn.x * d.y);
}

SHADE_END

#endif
