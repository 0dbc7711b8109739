#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shade/model.glsl.h"

namespace candela {

/// A shading model by name: a preset (candela, gltf, ue4, learnopengl, thesis, blinn-phong), terms (d=beckmann,
/// g=smith-separable, f=exact, diffuse=eon, blend=half-vector, multiscatter=off, layers=literal), or both, separated by
/// commas; terms without a preset change `candela`. Throws Error that lists what there is.
shade::ShadingModel parse_shading_model(std::string_view text);

/// The names of presets, and of every term's choices as "d=ggx|beckmann|…".
std::vector<std::string> shading_model_names();

}  // namespace candela
