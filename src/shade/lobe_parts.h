#pragma once

#include "shade/surface.glsl.h"

namespace candela::shade {

/// What each lobe has in the value of a surface.
struct LobeParts {
  vec3 specular{0.0f};  ///< facets, and light that bounces between them
  vec3 diffuse{0.0f};
  vec3 sheen{0.0f};
  vec3 coat{0.0f};
  vec3 below{0.0f};    ///< diffuse light from the other side
  vec3 through{0.0f};  ///< what facets let through
};

/// surface_eval().value by its lobes: f·|cos θi|, without delta lobes. They add up to it. A value is linear in the
/// colour of a lobe, which is what tells them apart.
inline LobeParts surface_parts(const Surface& s, vec3 wo, vec3 wi) {
  LobeParts parts;
  const vec3 all = surface_eval(s, wo, wi).value;
  const bool is_below = wi.z < 0.0f;
  Surface rest = s;
  (is_below ? rest.diffuse_below : rest.diffuse) = vec3(0.0f);
  const vec3 facets = surface_eval(rest, wo, wi).value;
  (is_below ? parts.below : parts.diffuse) = all - facets;
  if (is_below) {
    parts.through = facets;
    return parts;
  }
  if ((s.lobes & kLobesOfFibres) != 0 && s.sheen_weight > 0.0f) {
    rest.sheen = vec3(0.0f);
    parts.sheen = facets - surface_eval(rest, wo, wi).value;
  }
  if ((s.lobes & kLobeClearcoat) != 0 && s.coat > 0.0f) {
    parts.coat = coat_eval(s, wo, wi).value * sheen_over_coat_both(s, wi);
  }
  parts.specular = facets - parts.sheen - parts.coat;
  return parts;
}

}  // namespace candela::shade
