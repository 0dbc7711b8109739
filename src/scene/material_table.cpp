#include "scene/material_table.h"

namespace candela {

namespace {

/// Special readings: a body's colour takes the strength of its scattering in, a sheet keeps it apart.
bool scatters(const Material& m) {
  return m.multiscatter_color != vec3(0.0f) && (m.has_volume() || m.sheet_scatter > 0.0f);
}

/// Of a part of a surface that is all there, nobody reads the opacity.
bool is_read(const Material& m, const MaterialProperty& row) {
  if (row.member == NumberOrColor(&Material::opacity)) return m.alpha_mode != AlphaMode::opaque;
  return row.lobe.bit == 0 || (lobes_of(m) & row.lobe.bit) != 0;
}

}  // namespace

int lobes_of(const Material& m) {
  int lobes = 0;
  for (const MaterialProperty& row : kMaterialProperties) {
    if (!row.lobe.is_switch) continue;
    for (int i = 0; i < row.member.size(); ++i) {
      if (row.member.at(m, i) > 0.0f) lobes |= row.lobe.bit;
    }
  }
  return lobes;
}

bool has_effect(const Material& m, std::size_t slot) {
  const auto member = kTextureRows[slot].slot;
  if (member == &Material::scatter_strength_texture || member == &Material::multiscatter_color_texture) {
    return scatters(m);
  }
  bool is_factor = false;
  for (const MaterialProperty& row : kMaterialProperties) {
    if (row.texture.slot != member) continue;
    is_factor = true;
    const bool is_zero = row.member.is_zero(m) && (row.texture.low == nullptr || m.*row.texture.low == 0.0f);
    if (!is_zero && is_read(m, row)) return true;
  }
  return !is_factor;  // what no number multiplies shows
}

const TextureSlot* tangent_slot(const Material& m) {
  for (const TextureSlot* slot : {&m.normal_texture, &m.clearcoat_normal_texture}) {
    if (*slot) return slot;
  }
  for (const DirectionRow& row : kDirectionRows) {
    if (m.*row.texture) return &(m.*row.texture);
  }
  const int lobes = lobes_of(m);
  for (const DirectionRow& row : kDirectionRows) {
    if ((lobes & row.lobe) != 0) return &(m.*row.texture);
  }
  return nullptr;
}

std::vector<std::string_view> material_lobes(const Material& m) {
  if (m.unlit) return {"unlit"};
  const bool transmits = m.transmission > 0.0f || m.diffuse_transmission > 0.0f;
  const bool volume = transmits && m.has_volume();
  std::vector<std::string_view> names{m.specular_glossiness ? "specular-glossiness" : "metallic-roughness"};
  const int lobes = lobes_of(m) & ~(m.metallic > 0.0f ? 0 : shade::kLobeConductor);
  for (const LobeRow& lobe : kLobes) {
    if ((lobes & lobe.bit) != 0) names.push_back(lobe.words);
  }
  if (volume) names.emplace_back("volume");
  if ((volume && m.multiscatter_color != vec3(0.0f)) || m.scatters_as_sheet()) names.emplace_back("scattering");
  if (volume && m.transmission > 0.0f && m.dispersion > 0.0f) names.emplace_back("dispersion");
  return names;
}

}  // namespace candela
