#pragma once

#include "path/texture.h"
#include "scene/scene.h"

namespace candela::path {

/// The primitive with the relief of its material's height texture as geometry: every triangle divided as finely as the
/// texture has texels along its longest side, as far as two million triangles go, and moved along the normals of the
/// vertices. Without a normal map the normals follow the relief; with one, the map tells of it already.
Primitive displaced(const Primitive& primitive, const Material& material, const TextureReader& height);

}  // namespace candela::path
