#pragma once

#include <array>
#include <string>

#include "base/error.h"
#include "gl/gl.h"
#include "image/develop.h"
#include "image/image.h"
#include "raster/quantity.h"

/// What making pictures to draw into and drawing into them have in common.
namespace candela::raster {

inline void filter(GLenum target, GLint min, GLint mag) {
  glTexParameteri(target, GL_TEXTURE_MIN_FILTER, min);
  glTexParameteri(target, GL_TEXTURE_MAG_FILTER, mag);
}

inline void wrap(GLenum target, GLint s, GLint t) {
  glTexParameteri(target, GL_TEXTURE_WRAP_S, s);
  glTexParameteri(target, GL_TEXTURE_WRAP_T, t);
}

/// Of the texture that is bound: texels as they are.
inline void nearest_texels(GLenum target) {
  filter(target, GL_NEAREST, GL_NEAREST);
  wrap(target, GL_CLAMP_TO_EDGE, GL_CLAMP_TO_EDGE);
}

/// The framebuffer that is bound, 4 channels, row 0 at the top.
Image read_pixels(int width, int height);
/// The same of one that holds bytes.
DisplayImage read_bytes(int width, int height);

/// Where what is seen through glass stands, beside the layers of scattered light.
inline constexpr GLenum kThroughAttachment = GL_COLOR_ATTACHMENT3;

/// Draws into the picture and what is seen through glass.
inline void use_through_attachment() {
  constexpr std::array<GLenum, 4> kBuffers = {GL_COLOR_ATTACHMENT0, GL_NONE, GL_NONE, kThroughAttachment};
  glDrawBuffers(static_cast<GLsizei>(kBuffers.size()), kBuffers.data());
}

/// Draws into the first `count` pictures of the framebuffer that is bound.
inline void use_color_attachments(GLsizei count) {
  constexpr std::array<GLenum, 3> kAll = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2};
  glDrawBuffers(count, kAll.data());
}

inline void check_framebuffer(const char* what) {
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE) {
    throw Error("the driver cannot draw into " + std::string(what) + " (status " + std::to_string(status) + ")");
  }
}

/// Whether all light is shown.
inline bool is_whole(Quantity quantity) { return quantity == Quantity::light || quantity == Quantity::luminance; }

}  // namespace candela::raster
