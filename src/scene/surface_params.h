#pragma once

#include "scene/scene.h"
#include "shade/model.glsl.h"
#include "shade/surface_params.glsl.h"

namespace candela {

/// The factors of a material as the surface takes them, its lobes among them; textures come on top.
shade::SurfaceParams surface_params(const Material& material, const shade::ShadingModel& model);

/// σ_t of KHR_materials_volume, 1/m: -ln(attenuation colour) / attenuation distance; 0 where it does not absorb.
vec3 volume_extinction(const Material& material);

}  // namespace candela
