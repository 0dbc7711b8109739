// What of Renderer is about surfaces that something shows through: the order in which they are drawn, how they dim the
// light of lamps, and the body that the eye may be in.

#include <algorithm>

#include "base/browser.h"
#include "raster/renderer.h"
#include "raster/targets.h"

namespace candela::raster {

namespace {

constexpr int kGlassLayer = 0, kBodyLayer = 1, kFirstSlice = 2;  // of depth_layers_
constexpr int kMostSlices = 8;

void make_depth_texture(const gl::Texture& texture, GLsizei width, GLsizei height) {
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, width, height, 0, GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
  nearest_texels(GL_TEXTURE_2D);
}

void draw_no_color() {
  const GLenum none = GL_NONE;
  glDrawBuffers(1, &none);
}

}  // namespace

bool Renderer::casts_veil(const GpuMaterial& material) const {
  return material.is_blended() && !material.is_transmissive();
}

/// Depth of the blended surfaces of `order`, and what passes them. Returns whether there was any.
bool Renderer::draw_layer(std::vector<std::size_t> order, const mat4& clip_from_world, DepthPass pass, GLenum culled,
                          GLuint last_layer, const ShadowEntry* shadow) {
  using Query = gl::Name<glGenQueries, glDeleteQueries>;
  const Query query;
  glBeginQuery(GL_ANY_SAMPLES_PASSED, query);
  std::sort(order.begin(), order.end());
  for (std::size_t k = 0, end = 0; k < order.size(); k = end) {
    // Neighbours that are alike go together.
    end = k + 1;
    const std::size_t i = order[k];
    while (end < order.size() && order[end] == i + (end - k) && gpu_.are_alike(i, order[end])) ++end;
    const GpuMaterial& material = gpu_.material_of(gpu_.draws()[i]);
    const gl::Program& program = programs_.depth(material.key, pass, shadow != nullptr);
    if (shadow != nullptr) {
      use_shadow_program(program, *shadow);
    } else {
      glUseProgram(program.id());
      glUniformMatrix4fv(program.uniform("clip_from_world"), 1, GL_FALSE, &clip_from_world[0][0]);
    }
    gpu_.bind_material(material, program);
    if (last_layer != 0) program.bind("last_layer", GL_TEXTURE_2D, last_layer);
    if (culled != GL_NONE && !has_both_sides(material)) {
      glEnable(GL_CULL_FACE);
      glCullFace(culled);
    } else {
      glDisable(GL_CULL_FACE);
    }
    gpu_.draw(i, end - k);
  }
  glEndQuery(GL_ANY_SAMPLES_PASSED);
  // WebGL answers only when no code runs any more; a layer of nothing changes nothing.
  if (kIsBrowser) return true;
  GLuint is_any = 0;
  glGetQueryObjectuiv(query, GL_QUERY_RESULT, &is_any);
  return is_any != 0;
}

/// For each shadow map: the depth of the first blended surface and of the second, what share of light passes the first
/// and what passes all. A receiver behind two is dimmed by both, one between them by the first, one before them by
/// none.
void Renderer::draw_veils() {
  const GLsizei layers = lights_.shadow_count, size = lights_.shadow_size;
  glBindTexture(GL_TEXTURE_2D_ARRAY, veils_);
  glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_RG8, size, size, layers, 0, GL_RG, GL_UNSIGNED_BYTE, nullptr);
  nearest_texels(GL_TEXTURE_2D_ARRAY);
  make_depth_texture(veil_depth_, size, size);
  for (int layer = 0; layer < layers; ++layer) {
    const ShadowEntry& shadow = lights_.block.shadows[static_cast<std::size_t>(layer)];
    const mat4& clip_from_world = shadow.from_world;
    const int owner = lights_.shadow_owner[static_cast<std::size_t>(layer)];
    std::vector<std::size_t> casters;
    for (std::size_t i = 0; i < gpu_.draws().size(); ++i) {
      const Draw& d = gpu_.draws()[i];
      if (!casts_veil(gpu_.material_of(d)) || is_beside(clip_from_world, d.bounds)) continue;
      if (owner < 0 || (own_areas_[i] >> owner & 1) == 0) casters.push_back(i);
    }

    // ----- the first
    glBindFramebuffer(GL_FRAMEBUFFER, veil_framebuffer_);
    glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, veils_, 0, layer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, veil_depth_, 0);
    const GLenum color = GL_COLOR_ATTACHMENT0;
    glDrawBuffers(1, &color);
    glClearColor(1.0f, 1.0f, 1.0f, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    const bool is_any = draw_layer(casters, clip_from_world, DepthPass::first_layer, GL_NONE, 0, &shadow);
    glBindFramebuffer(GL_FRAMEBUFFER, copy_framebuffer_);
    glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, shadows_, 0, layers + layer);
    draw_no_color();
    glBindFramebuffer(GL_READ_FRAMEBUFFER, veil_framebuffer_);
    glBlitFramebuffer(0, 0, size, size, 0, 0, size, size, GL_DEPTH_BUFFER_BIT, GL_NEAREST);

    // ----- the second
    glBindFramebuffer(GL_FRAMEBUFFER, copy_framebuffer_);
    glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, shadows_, 0, 2 * layers + layer);
    glClear(GL_DEPTH_BUFFER_BIT);
    if (is_any) draw_layer(casters, clip_from_world, DepthPass::next_layer, GL_NONE, veil_depth_, &shadow);

    // ----- what passes the first, which may be several at one place, and all of them
    glBindFramebuffer(GL_FRAMEBUFFER, veil_framebuffer_);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, 0, 0);  // it is read
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ZERO, GL_SRC_COLOR);
    glColorMask(GL_TRUE, GL_FALSE, GL_FALSE, GL_FALSE);
    if (is_any) draw_layer(casters, clip_from_world, DepthPass::first_veil, GL_NONE, veil_depth_, &shadow);
    glColorMask(GL_FALSE, GL_TRUE, GL_FALSE, GL_FALSE);
    if (is_any) draw_layer(casters, clip_from_world, DepthPass::passing_veil, GL_NONE, 0, &shadow);
    glDisable(GL_BLEND);
    glEnable(GL_DEPTH_TEST);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  }
  gl::check("drawing what dims lamps");
}

void Renderer::make_depth_layers() {
  const glm::ivec3 size(settings_.width, settings_.height, kFirstSlice + kMostSlices);
  if (layers_size_ == size) return;
  layers_size_ = size;
  glBindTexture(GL_TEXTURE_2D_ARRAY, depth_layers_);
  glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_DEPTH_COMPONENT32F, size.x, size.y, size.z, 0, GL_DEPTH_COMPONENT, GL_FLOAT,
               nullptr);
  nearest_texels(GL_TEXTURE_2D_ARRAY);
  for (const gl::Texture& texture : last_layers_) make_depth_texture(texture, size.x, size.y);
  gl::check("making layers of depth");
}

void Renderer::attach_depth_layer(int layer) {
  glBindFramebuffer(GL_FRAMEBUFFER, copy_framebuffer_);
  glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, depth_layers_, 0, layer);
  draw_no_color();
}

/// Depths of a picture that its draws have to know: of glass that has blended surfaces about it, of the boundary of the
/// body that the eye is in, of the blended surfaces.
void Renderer::find_depth_layers(const std::vector<std::size_t>& transmissive, const std::vector<std::size_t>& blended,
                                 const FrameCamera& camera) {
  slice_count_ = 0;
  has_glass_before_blended_ = false;
  if (is_of_surface(settings_.quantity) || (blended.empty() && !body_)) return;
  make_depth_layers();
  glClearDepthf(1.0f);
  std::vector<std::size_t> blended_glass;
  std::copy_if(blended.begin(), blended.end(), std::back_inserter(blended_glass),
               [&](std::size_t i) { return gpu_.material_of(gpu_.draws()[i]).is_transmissive(); });
  has_glass_before_blended_ = blended_glass.size() < blended.size() && !(transmissive.empty() && blended_glass.empty());
  if (has_glass_before_blended_) {
    attach_depth_layer(kGlassLayer);
    glClear(GL_DEPTH_BUFFER_BIT);
    draw_depth(transmissive, camera, true);
    draw_layer(blended_glass, camera.clip_from_world, DepthPass::first_layer, GL_BACK);
  }
  if (body_) {
    std::vector<std::size_t> boundary;
    for (std::size_t i = 0; i < gpu_.draws().size(); ++i) {
      if (gpu_.material_of(gpu_.draws()[i]).key.has_body) boundary.push_back(i);
    }
    attach_depth_layer(kBodyLayer);
    glClear(GL_DEPTH_BUFFER_BIT);
    draw_depth(boundary, camera, true);
  }
  if (!blended.empty()) slice_count_ = find_slices(blended, camera);
}

/// The depths of what is blended from near to far, one layer each: Everitt 2001, "Interactive Order-Independent
/// Transparency". Returns how many there are.
int Renderer::find_slices(const std::vector<std::size_t>& blended, const FrameCamera& camera) {
  const int w = settings_.width, h = settings_.height;
  std::vector<std::size_t> seen;
  for (const std::size_t i : blended) {
    if (!is_outside(camera.clip_from_world, gpu_.draws()[i].bounds)) seen.push_back(i);
  }
  if (seen.empty()) return 0;
  for (int k = 0; k < kMostSlices; ++k) {
    const gl::Texture &here = last_layers_[static_cast<std::size_t>(k % 2)],
                      &last = last_layers_[static_cast<std::size_t>((k + 1) % 2)];
    glBindFramebuffer(GL_FRAMEBUFFER, layer_framebuffer_);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, here, 0);
    draw_no_color();
    glClear(GL_DEPTH_BUFFER_BIT);
    const bool is_any = k == 0 ? draw_layer(seen, camera.clip_from_world, DepthPass::first_layer, GL_BACK)
                               : draw_layer(seen, camera.clip_from_world, DepthPass::next_layer, GL_BACK, last);
    if (!is_any) return std::max(k, 1);  // a pixel whose middle nothing covers may have covered samples
    attach_depth_layer(kFirstSlice + k);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, layer_framebuffer_);
    glBlitFramebuffer(0, 0, w, h, 0, 0, w, h, GL_DEPTH_BUFFER_BIT, GL_NEAREST);
  }
  return kMostSlices;
}

/// What is blended, a slice of depth after the other from far to near. Each slice lies between two layers, so that
/// every fragment is drawn once, also that of a pixel of which it covers no more than an edge; farther than the last
/// layer that there is room for, draws are sorted by their middles.
void Renderer::draw_blended(const std::vector<std::size_t>& blended, PassKey pass, const FrameCamera& camera,
                            GlassSide side) {
  if (slice_count_ == 0) return;
  pass.blend_part = BlendPart::rest;
  // Glass reads the picture, which has to be there.
  std::vector<std::size_t> order;
  std::copy_if(blended.begin(), blended.end(), std::back_inserter(order), [&](std::size_t i) {
    return side != GlassSide::not_before || !gpu_.material_of(gpu_.draws()[i]).is_transmissive();
  });
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  for (int k = slice_count_ - 1; k >= 0; --k) {
    is_slice_deep_ = k + 1 == kMostSlices;
    slice_ = {k == 0 ? -1 : kFirstSlice + k - 1, k + 1 == slice_count_ ? -1 : kFirstSlice + k,
              side == GlassSide::any ? -1 : kGlassLayer, side == GlassSide::before ? 1 : 0};
    draw_surfaces(order, pass, camera);
  }
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
}

}  // namespace candela::raster
