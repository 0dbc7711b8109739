#ifndef CANDELA_SHADE_WORKFLOW_GLSL_H
#define CANDELA_SHADE_WORKFLOW_GLSL_H

#include "shade/shim.glsl.h"

// Metallic-roughness and specular-glossiness (KHR_materials_pbrSpecularGlossiness) say the same two things in different
// words: F0, and the albedo of the diffuse layer as it appears under the boundary. That pair is
//
//   metallic-roughness    F0 = mix(0.04, base, m)    c = base (1 - m) (1 - 0.04)
//   specular-glossiness   F0 = specular              c = diffuse (1 - max specular)
//
// so that either vocabulary stays within [0, 1]. Linear colours; roughness = 1 - glossiness.

SHADE_BEGIN

/// F0 of the dielectric part of metallic-roughness: an index of 1.5.
SHADE_CONST float kWorkflowF0 = 0.04f;

struct SpecularGlossiness {
  vec3 diffuse;
  vec3 specular;
  float glossiness;
};

struct MetallicRoughness {
  vec3 base_color;
  float metallic;
  float roughness;
};

SHADE_FN vec3 workflow_f0(MetallicRoughness m) { return mix(vec3(kWorkflowF0), m.base_color, m.metallic); }

SHADE_FN vec3 workflow_diffuse(MetallicRoughness m) {
  return m.base_color * ((1.0f - m.metallic) * (1.0f - kWorkflowF0));
}

SHADE_FN vec3 workflow_diffuse_below(SpecularGlossiness s) { return s.diffuse * (1.0f - shade_max3(s.specular)); }

/// The albedo of the diffuse layer itself, seen through a boundary of 4 %, for what `specular` leaves of it.
SHADE_FN vec3 workflow_base_color(vec3 diffuse, vec3 specular) {
  float left = 1.0f - shade_max3(specular);
  return min(diffuse * (left / (1.0f - kWorkflowF0)), vec3(1.0f));
}

/// Roughness where a texture multiplies glossiness.
SHADE_FN float workflow_roughness(float roughness, float glossiness) { return 1.0f - (1.0f - roughness) * glossiness; }

/// Exact. A perfect mirror (F0 = 1) has diffuse 0, which nothing can see.
SHADE_FN SpecularGlossiness specular_glossiness_from_metallic(MetallicRoughness m) {
  SpecularGlossiness s;
  s.specular = workflow_f0(m);
  float left = 1.0f - shade_max3(s.specular);
  s.diffuse = left > 1e-6f ? min(workflow_diffuse(m) * (1.0f / left), vec3(1.0f)) : vec3(0.0f);
  s.glossiness = 1.0f - m.roughness;
  return s;
}

/// Largest difference, over both colours and all channels, between what the two describe.
SHADE_FN float workflow_difference(SpecularGlossiness s, MetallicRoughness m) {
  vec3 f0 = abs(s.specular - workflow_f0(m));
  vec3 diffuse = abs(workflow_diffuse_below(s) - workflow_diffuse(m));
  return max(shade_max3(f0), shade_max3(diffuse));
}

/// The base colour for a given `metallic`. Diffuse and F0 each name one; metals are told by F0, the others by diffuse.
SHADE_FN MetallicRoughness metallic_from_known_metallic(SpecularGlossiness s, float metallic) {
  MetallicRoughness m;
  vec3 of_diffuse = workflow_diffuse_below(s) * (1.0f / (max(1.0f - metallic, 1e-6f) * (1.0f - kWorkflowF0)));
  vec3 of_f0 = (s.specular - vec3(kWorkflowF0 * (1.0f - metallic))) * (1.0f / max(metallic, 1e-6f));
  of_diffuse = clamp(of_diffuse, vec3(0.0f), vec3(1.0f));
  of_f0 = clamp(of_f0, vec3(0.0f), vec3(1.0f));
  m.base_color = mix(of_diffuse, of_f0, metallic * metallic);
  m.metallic = metallic;
  m.roughness = 1.0f - s.glossiness;
  return m;
}

/// Inverse of specular_glossiness_from_metallic, exact for everything that comes from there. F0 below 0.04 without a
/// dark diffuse colour, and coloured F0 over a diffuse colour of another hue, have no metallic-roughness; then the
/// nearest of the candidates, and workflow_residual says what is lost.
///
/// Eliminating the base colour of one channel from the pair above leaves 0.04 m² + (d + F0 - 0.08) m + 0.04 - F0 = 0
/// with d = c / 0.96. It is solved in the channel with the strongest F0; of two roots in [0, 1] the other channels
/// decide.
SHADE_FN MetallicRoughness metallic_from_specular_glossiness(SpecularGlossiness s) {
  vec3 below = workflow_diffuse_below(s) * (1.0f / (1.0f - kWorkflowF0));
  float f0 = s.specular.x;
  float d = below.x;
  if (s.specular.y > f0) {
    f0 = s.specular.y;
    d = below.y;
  }
  if (s.specular.z > f0) {
    f0 = s.specular.z;
    d = below.z;
  }

  // ----- both roots, without the cancellation of the textbook formula
  float b = d + f0 - 2.0f * kWorkflowF0;
  float c = kWorkflowF0 - f0;
  float q = -0.5f * (b + (b < 0.0f ? -1.0f : 1.0f) * sqrt(max(b * b - 4.0f * kWorkflowF0 * c, 0.0f)));
  float first = shade_saturate(abs(q) > 1e-12f ? c / q : 0.0f);
  float second = shade_saturate(q / kWorkflowF0);

  // ----- the better of them, or a pure dielectric
  MetallicRoughness best = metallic_from_known_metallic(s, 0.0f);
  MetallicRoughness other = metallic_from_known_metallic(s, first);
  if (workflow_difference(s, other) < workflow_difference(s, best)) best = other;
  other = metallic_from_known_metallic(s, second);
  if (workflow_difference(s, other) < workflow_difference(s, best)) best = other;
  return best;
}

/// What metallic_from_specular_glossiness cannot say of `s`: the largest absolute error of diffuse and F0, all
/// channels.
SHADE_FN float workflow_residual(SpecularGlossiness s) {
  return workflow_difference(s, metallic_from_specular_glossiness(s));
}

SHADE_END

#endif
