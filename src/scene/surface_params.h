#pragma once

#include <algorithm>

#include "scene/material_table.h"
#include "shade/model.glsl.h"
#include "shade/surface_params.glsl.h"

namespace candela {

/// The factors of a material as the surface takes them, its lobes among them; textures come on top.
shade::SurfaceParams surface_params(const Material& material, const shade::ShadingModel& model);

/// What a texel of a slot makes of the parameters that it is a factor of.
template <std::size_t kSlot>
void apply_texel(vec4 texel, const Material& material, shade::SurfaceParams& params) {
  for_each_property([&](auto i) {
    constexpr const MaterialProperty& kRow = kMaterialProperties[i];
    if constexpr (kRow.param && kRow.texture.slot == kTextureRows[kSlot].slot) {
      if constexpr (kRow.param.is_color()) {
        params.*kRow.param.color *= vec3(texel);
      } else if constexpr (kRow.texture.low != nullptr) {
        params.*kRow.param.number = glm::mix(material.*kRow.texture.low, material.*kRow.member.number,
                                             texel[static_cast<int>(kRow.texture.texel)]);
      } else {
        params.*kRow.param.number *= texel[static_cast<int>(kRow.texture.texel)];
      }
    }
  });
}

/// Whether a slot's texels are factors of parameters that lobes beyond the base read.
constexpr bool is_layer_texture(std::size_t slot) {
  return std::any_of(kMaterialProperties.begin(), kMaterialProperties.end(), [slot](const MaterialProperty& row) {
    return row.param && row.lobe.bit != 0 && row.texture.slot == kTextureRows[slot].slot;
  });
}

/// σ_t of KHR_materials_volume, 1/m: -ln(attenuation colour) / attenuation distance; 0 where it does not absorb.
vec3 volume_extinction(const Material& material);

}  // namespace candela
