#include "scene/surface_params.h"

#include <algorithm>

namespace candela {

shade::SurfaceParams surface_params(const Material& m, const shade::ShadingModel& model) {
  shade::SurfaceParams p = shade::surface_params_default();
  p.base_color = m.base_color;
  p.metallic = m.metallic;
  p.roughness = m.roughness;
  p.ior = m.ior;
  p.specular = m.specular;
  p.specular_color = m.specular_color;
  p.model = model;
  const auto add = [&p](bool is_used, int lobe) { p.lobes |= is_used ? lobe : 0; };
  add(!shade::shading_model_is_default(model), shade::kLobeModel);
  add(m.anisotropy > 0.0f, shade::kLobeAnisotropy);
  add(m.iridescence > 0.0f, shade::kLobeIridescence);
  add(m.is_conductor(), shade::kLobeConductor);
  add(m.transmission > 0.0f, shade::kLobeTransmission);
  add(m.diffuse_transmission > 0.0f || m.scatters_as_sheet(), shade::kLobeDiffuseTransmission);
  add(max_component(m.sheen_color) > 0.0f, shade::kLobeSheen);
  add(m.clearcoat > 0.0f, shade::kLobeClearcoat);
  p.anisotropy = m.anisotropy;
  p.iridescence = m.iridescence;
  p.film_ior = m.iridescence_ior;
  p.film_nm = m.iridescence_thickness_max_nm;
  p.conductor_n = m.conductor_n;
  p.conductor_k = m.conductor_k;
  p.transmission = m.transmission;
  p.is_thin = !m.has_volume();
  p.eta = m.ior;
  p.diffuse_transmission = m.diffuse_transmission;
  p.diffuse_transmission_color = m.diffuse_transmission_color;
  p.scatter = m.scatters_as_sheet() ? m.sheet_scatter : 0.0f;
  p.scatter_color = m.multiscatter_color;
  p.scatter_forward = 0.5f * (1.0f + m.scatter_anisotropy);
  p.sheen_color = m.sheen_color;
  p.sheen_roughness = m.sheen_roughness;
  p.clearcoat = m.clearcoat;
  p.clearcoat_roughness = m.clearcoat_roughness;
  return p;
}

vec3 volume_extinction(const Material& m) {
  if (!(m.attenuation_distance < kInfinity)) return vec3(0.0f);
  const vec3 depth = glm::max(-glm::log(glm::max(m.attenuation_color, vec3(1e-30f))), vec3(0.0f));
  return glm::min(depth / glm::max(m.attenuation_distance, 1e-9f), vec3(1e9f));
}

}  // namespace candela
