#pragma once

#include <string>
#include <vector>

#include "gl/gl.h"

namespace candela::parity {

/// What src/shade fetches from a table in C++ and from a texture in GLSL: the uniform, and the texels behind it.
struct Table {
  std::string uniform;
  GLenum target = GL_TEXTURE_3D;  ///< or GL_TEXTURE_2D_ARRAY; GL_TEXTURE_2D is one of depth 1
  int width = 0;
  int height = 0;
  int depth = 1;
  int channels = 1;           ///< 1 … 4 floats per texel
  std::vector<float> texels;  ///< x fastest, then y, then z
  GLint filter = GL_NEAREST;  ///< GL_LINEAR needs OES_texture_float_linear
};

/// Every table that the shared text may read. A header that declares a sampler gets its row here; the harness refuses
/// a program that reads a sampler without one.
const std::vector<Table>& tables();

/// The table as a texture, clamped at its edges.
gl::Texture upload(const Table& table);

}  // namespace candela::parity
