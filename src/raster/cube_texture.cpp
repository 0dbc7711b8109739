#include "raster/cube_texture.h"

#include <cstdint>
#include <vector>

#include "image/texel.h"

namespace candela::raster {

gl::Texture upload_cube(const Cubemap& cube) {
  gl::Texture texture;
  glBindTexture(GL_TEXTURE_CUBE_MAP, texture);
  // Rounded as in the files of a cache, so that a picture does not depend on whether there was one.
  std::vector<std::uint16_t> rgba;
  for (std::size_t level = 0; level < cube.levels.size(); ++level) {
    const int size = cube.size(level);
    rgba.assign(static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * 4, half_from_float(1.0f));
    for (std::size_t face = 0; face < 6; ++face) {
      const Image& image = cube.levels[level][face];
      const auto channels = static_cast<std::size_t>(image.channels);
      for (std::size_t i = 0; i < rgba.size() / 4; ++i) {
        for (std::size_t c = 0; c < 3; ++c) rgba[4 * i + c] = half_from_float(image.pixels[channels * i + c]);
      }
      glTexImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + static_cast<GLenum>(face), static_cast<GLint>(level), GL_RGBA16F,
                   size, size, 0, GL_RGBA, GL_HALF_FLOAT, rgba.data());
    }
  }
  glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAX_LEVEL, static_cast<GLint>(cube.levels.size()) - 1);
  glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MIN_FILTER,
                  cube.levels.size() > 1 ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR);
  gl::check("uploading the environment");
  return texture;
}

}  // namespace candela::raster
