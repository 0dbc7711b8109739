#pragma once

#include "image/image.h"

namespace candela {

/// What the texels of a texture stand for, and so what the mean of several is.
enum class TexelKind {
  color,  ///< sRGB: the mean of the light; alpha by itself
  data,   ///< the mean of the codes
  normal  ///< the mean direction, of length one
};

/// The size of a texture after so many halvings, each rounded down, at least 1.
ivec2 size_of_level(ivec2 size, int level);

/// The texture with the size of that level. Each texel is the mean of the area that it stands for, of all that it
/// covers and in parts where sizes are odd, so that the mean of the whole is kept (but of normals).
TextureImage reduced(const TextureImage& image, int level, TexelKind kind);

}  // namespace candela
