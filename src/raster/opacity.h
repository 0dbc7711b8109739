#pragma once

#include "scene/scene.h"

/// How much of a surface is there. Exporters write BLEND and MASK on surfaces that nothing shows through: those are
/// drawn as any opaque one.
namespace candela::raster {

/// From here on a surface counts as whole: what 8 bits round to 1.
inline constexpr float kOpaqueAlpha = 254.5f / 255.0f;

/// Numbers that an alpha lies between.
struct AlphaRange {
  float least = 1.0f, most = 1.0f;

  AlphaRange operator*(const AlphaRange& other) const { return {least * other.least, most * other.most}; }
};

/// Of a texture, wherever it is looked up.
AlphaRange alpha_of_image(const TextureImage& image);
/// Of the vertices' colours.
AlphaRange alpha_of_vertices(const Primitive& primitive);

/// As what a surface has to be drawn whose alpha lies in `range`: opaque where nothing of it can be missing.
AlphaMode drawn_mode(const Material& material, const AlphaRange& range);

}  // namespace candela::raster
