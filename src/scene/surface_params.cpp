#include "scene/surface_params.h"

#include "scene/material_table.h"

namespace candela {

shade::SurfaceParams surface_params(const Material& m, const shade::ShadingModel& model) {
  shade::SurfaceParams p = shade::surface_params_default();
  p.lobes = lobes_of(m);
  if (m.scatters_as_sheet()) p.lobes |= shade::kLobeDiffuseTransmission;
  if (!shade::shading_model_is_default(model)) p.lobes |= shade::kLobeModel;
  p.model = model;
  p.is_thin = !m.has_volume();
  p.eta = m.ior;
  for (const MaterialProperty& row : kMaterialProperties) {
    if (!row.param) continue;
    for (int i = 0; i < row.member.size(); ++i) row.param.at(p, i) = row.member.at(m, i);
  }
  return p;
}

vec3 volume_extinction(const Material& m) {
  if (!(m.attenuation_distance < kInfinity)) return vec3(0.0f);
  const vec3 depth = glm::max(-glm::log(glm::max(m.attenuation_color, vec3(1e-30f))), vec3(0.0f));
  return glm::min(depth / glm::max(m.attenuation_distance, 1e-9f), vec3(1e9f));
}

}  // namespace candela
