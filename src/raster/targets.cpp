// What of Renderer is about the pictures that it draws into: how they are made, resolved, read and shown.

#include "raster/targets.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "raster/renderer.h"
#include "scene/surface_layers.h"

namespace candela::raster {

Image read_pixels(int width, int height) {
  Image image(width, height, 4);
  std::vector<float> row(static_cast<std::size_t>(width) * 4);
  std::vector<float> all(image.pixels.size());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_FLOAT, all.data());
  gl::check("reading the picture");
  const std::size_t stride = row.size();
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
    std::copy_n(all.data() + (static_cast<std::size_t>(height) - 1 - y) * stride, stride,
                image.pixels.data() + y * stride);
  }
  return image;
}

DisplayImage read_bytes(int width, int height) {
  DisplayImage image{width, height, {}};
  const std::size_t stride = static_cast<std::size_t>(width) * 4;
  std::vector<std::uint8_t> all(stride * static_cast<std::size_t>(height));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, all.data());
  gl::check("reading the picture");
  image.rgba.resize(all.size());
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
    std::copy_n(all.data() + (static_cast<std::size_t>(height) - 1 - y) * stride, stride,
                image.rgba.data() + y * stride);
  }
  return image;
}

void Renderer::make_targets() {
  const int w = settings_.width, h = settings_.height;
  GLint most = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &most);
  if (std::max(w, h) > most)
    throw Error("the driver draws no more than " + std::to_string(most) + " pixels a side", "--size");
  GLint most_samples = 1;
  glGetInternalformativ(GL_RENDERBUFFER, GL_RGBA16F, GL_SAMPLES, 1, &most_samples);
  const int samples = std::min(settings_.msaa, most_samples) <= 1 ? 0 : std::min(settings_.msaa, most_samples);

  // Half floats end at 65504, which lengths may exceed.
  const bool is_length = settings_.quantity == Quantity::position || settings_.quantity == Quantity::depth ||
                         settings_.quantity == Quantity::distance;
  const GLenum format = is_length && gl::has_extension("GL_EXT_color_buffer_float") ? GL_RGBA32F : GL_RGBA16F;
  glBindRenderbuffer(GL_RENDERBUFFER, target_.color);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, w, h);
  glBindRenderbuffer(GL_RENDERBUFFER, target_.depth);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_DEPTH_COMPONENT32F, w, h);
  glBindFramebuffer(GL_FRAMEBUFFER, target_.framebuffer);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target_.color);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, target_.depth);
  // At another moment what a scene has now may be gone, and come back.
  has_scattering_ |= wants_scattering();
  has_opaque_picture_ |= wants_opaque_picture();
  if (has_scattering_) {
    for (std::size_t i = 0; i < scattered_.size(); ++i) {
      glBindRenderbuffer(GL_RENDERBUFFER, scattered_samples_[i]);
      glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_RGBA16F, w, h);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT1 + static_cast<GLenum>(i), GL_RENDERBUFFER,
                                scattered_samples_[i]);
    }
  }
  has_through_ = settings_.background == Background::transparent && !settings_.environment_in_glass &&
                 has_opaque_picture_ && is_whole(settings_.quantity);
  if (has_through_) {
    glBindRenderbuffer(GL_RENDERBUFFER, through_samples_);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_RGBA16F, w, h);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, kThroughAttachment, GL_RENDERBUFFER, through_samples_);
  }
  check_framebuffer("half floats");
  settings_.msaa = std::max(samples, 1);

  const auto make_picture = [&](const gl::Texture& texture, const gl::Framebuffer& framebuffer, GLint min,
                                GLenum kind = GL_RGBA16F) {
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(kind), w, h, 0, GL_RGBA, GL_FLOAT, nullptr);
    filter(GL_TEXTURE_2D, min, kind == GL_RGBA32F ? GL_NEAREST : GL_LINEAR);
    wrap(GL_TEXTURE_2D, GL_CLAMP_TO_EDGE, GL_CLAMP_TO_EDGE);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    check_framebuffer("half floats");
  };
  make_picture(resolved_, resolved_framebuffer_, format == GL_RGBA32F ? GL_NEAREST : GL_LINEAR, format);
  for (std::size_t i = 0; has_scattering_ && i < scattered_.size(); ++i) {
    make_picture(scattered_[i], scattered_framebuffer_[i], GL_NEAREST);
  }
  if (has_through_) make_picture(through_, through_framebuffer_, GL_NEAREST);
  if (has_opaque_picture_) {
    make_picture(opaque_picture_, picture_framebuffer_, GL_LINEAR_MIPMAP_LINEAR);
    picture_levels_ = 1 + static_cast<int>(std::log2(static_cast<float>(std::max(w, h))));
  }
  gl::check("making the picture");
}

void Renderer::make_occlusion_targets() {
  // Half of the picture's: what is open changes slowly.
  const int w = (settings_.width + 1) / 2, h = (settings_.height + 1) / 2;
  const auto make = [&](const gl::Texture& texture, const gl::Framebuffer& framebuffer, GLint format, GLenum layout,
                        GLenum type, GLenum attachment) {
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexImage2D(GL_TEXTURE_2D, 0, format, w, h, 0, layout, type, nullptr);
    filter(GL_TEXTURE_2D, GL_NEAREST, GL_NEAREST);
    wrap(GL_TEXTURE_2D, GL_CLAMP_TO_EDGE, GL_CLAMP_TO_EDGE);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture, 0);
  };
  make(depth_map_, depth_framebuffer_, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, GL_DEPTH_ATTACHMENT);
  const GLenum none = GL_NONE;
  glDrawBuffers(1, &none);
  check_framebuffer("a map of depth");
  make(culled_map_, culled_framebuffer_, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, GL_DEPTH_ATTACHMENT);
  glDrawBuffers(1, &none);
  check_framebuffer("a map of depth");
  for (std::size_t i = 0; i < visibility_.size(); ++i) {
    make(visibility_[i], visibility_framebuffer_[i], GL_RG16F, GL_RG, GL_FLOAT, GL_COLOR_ATTACHMENT0);
    check_framebuffer("half floats");
  }
}

void Renderer::resolve(GLuint framebuffer) {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, target_.framebuffer);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
  glBlitFramebuffer(0, 0, settings_.width, settings_.height, 0, 0, settings_.width, settings_.height,
                    GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void Renderer::resolve_through() {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, target_.framebuffer);
  glReadBuffer(kThroughAttachment);
  resolve(through_framebuffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, target_.framebuffer);
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  use_color_attachments(1);
}

Image Renderer::read() {
  glBindFramebuffer(GL_FRAMEBUFFER, resolved_framebuffer_);
  return read_pixels(settings_.width, settings_.height);
}

Image Renderer::read_through() {
  if (!has_through_) return {};
  glBindFramebuffer(GL_FRAMEBUFFER, through_framebuffer_);
  return read_pixels(settings_.width, settings_.height);
}

void Renderer::present(ivec2 size, float exposure, ToneCurve tone_curve) { draw_shown(0, size, exposure, tone_curve); }

DisplayImage Renderer::read_shown(float exposure, ToneCurve tone_curve) {
  const gl::Framebuffer framebuffer;
  const gl::Renderbuffer color;
  glBindRenderbuffer(GL_RENDERBUFFER, color);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, settings_.width, settings_.height);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color);
  check_framebuffer("a picture of bytes");
  draw_shown(framebuffer, {settings_.width, settings_.height}, exposure, tone_curve);
  return read_bytes(settings_.width, settings_.height);
}

void Renderer::draw_shown(GLuint framebuffer, ivec2 size, float exposure, ToneCurve tone_curve) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, size.x, size.y);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  const gl::Program& program = programs_.fullscreen("present.frag.glsl");
  glUseProgram(program.id());
  program.bind("picture", GL_TEXTURE_2D, resolved_);
  glUniform1f(program.uniform("exposure"), exposure);
  glUniform1i(program.uniform("tone_curve"), static_cast<GLint>(tone_curve));
  glBindVertexArray(nothing_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  gl::check("showing the picture");
}

void Renderer::change(const Settings& settings) {
  const Settings before = std::exchange(settings_, settings);
  settings_.msaa = before.msaa;
  settings_.background = before.background, settings_.environment_in_glass = before.environment_in_glass;
  if (settings.width == before.width && settings.height == before.height) return;
  make_targets();
  make_occlusion_targets();
}

/// For numbers, without samples.
Renderer::Target Renderer::make_float_target() const {
  Target target;
  glBindRenderbuffer(GL_RENDERBUFFER, target.color);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA32F, settings_.width, settings_.height);
  glBindRenderbuffer(GL_RENDERBUFFER, target.depth);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, settings_.width, settings_.height);
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target.color);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, target.depth);
  check_framebuffer("floats");
  return target;
}

/// Of the target that is bound, all channels but alpha; then it is ready to be drawn into.
void Renderer::clear_floats(float value) const {
  glViewport(0, 0, settings_.width, settings_.height);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  const std::array<float, 4> clear = {value, value, value, 0.0f};
  glClearBufferfv(GL_COLOR, 0, clear.data());
  glClearDepthf(1.0f);
  glClear(GL_DEPTH_BUFFER_BIT);
}

Image Renderer::read_layer(const View& view, Layer layer) {
  const FrameCamera camera = frame_camera(relative(view), settings_.width, settings_.height, range_);
  bind_frame(camera);
  const Target target = make_float_target();
  clear_floats(layer_info(layer).nothing);
  draw_quantity(quantity_of(layer), camera);
  const Image rgba = read_pixels(settings_.width, settings_.height);
  Image image(settings_.width, settings_.height, layer_channels(layer));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) image.set_rgb(x, y, rgba.rgb(x, y));
  }
  return image;
}

void Renderer::draw_map(const std::vector<std::size_t>& draws, const FrameCamera& camera) {
  PassKey pass;
  pass.quantity = Quantity::object_id;
  pass.is_map = true;
  clear_floats(0.0f);
  draw_surfaces(draws, pass, camera);
}

SurfaceMap Renderer::read_surfaces(const View& view, vec2 jitter, vec2 aperture) {
  const FrameCamera camera = frame_camera(relative(view), settings_.width, settings_.height, range_, jitter, aperture);
  bind_frame(camera);
  const Target target = make_float_target();
  draw_map(all_draws(), camera);
  const Image rgba = read_pixels(settings_.width, settings_.height);
  gl::check("drawing numbers");
  SurfaceMap map(settings_.width, settings_.height);
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const auto found = rgba.at(x, y);
      if (found[0] <= 0.0f) continue;
      const Draw& draw = gpu_.draws()[static_cast<std::size_t>(found[0]) - 1];
      SurfaceSample& s = map.at(x, y);
      s.node = draw.node;
      s.primitive = static_cast<int>(draw.part);
      s.triangle = static_cast<std::uint32_t>(found[1]);
      s.barycentric = {found[2], found[3]};
      s.position = position_at(*scene_, s.node, s.primitive, s.triangle, s.barycentric);
      s.uv = uv_at(*scene_, s.node, s.primitive, s.triangle, s.barycentric);
    }
  }
  return map;
}

std::vector<InstanceMask> Renderer::read_masks(const View& view) {
  const FrameCamera camera = frame_camera(relative(view), settings_.width, settings_.height, range_);
  bind_frame(camera);
  const Target target = make_float_target();
  std::map<int, std::vector<std::size_t>> draws_of;
  for (std::size_t i = 0; i < gpu_.draws().size(); ++i) {
    const Draw& draw = gpu_.draws()[i];
    if (!is_outside(camera.clip_from_world, draw.bounds)) draws_of[draw.node].push_back(i);
  }
  MaskBuilder masks;
  for (const auto& [node, draws] : draws_of) {
    draw_map(draws, camera);
    const Image rgba = read_pixels(settings_.width, settings_.height);
    for (int y = 0; y < rgba.height; ++y) {
      for (int x = 0; x < rgba.width; ++x) {
        if (rgba.at(x, y)[0] > 0.0f) masks.add(node, {x, y});
      }
    }
  }
  gl::check("drawing masks");
  return masks.build();
}

}  // namespace candela::raster
