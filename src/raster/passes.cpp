// What of Renderer is about single passes: shadow maps, occlusion, scattered light, the background. Its order of them
// is Renderer::draw.

#include <algorithm>
#include <cmath>

#include "raster/renderer.h"
#include "raster/targets.h"
#include "scene/environment.h"

namespace candela::raster {

void Renderer::draw_shadows() {
  glBindTexture(GL_TEXTURE_2D_ARRAY, shadows_);
  const GLsizei layers = std::max(lights_.shadow_count, 1), size = lights_.shadow_count > 0 ? lights_.shadow_size : 1;
  has_veils_ = lights_.shadow_count > 0 && std::any_of(gpu_.draws().begin(), gpu_.draws().end(),
                                                       [&](const Draw& d) { return casts_veil(gpu_.material_of(d)); });
  // Behind the maps of what is opaque, those of the first and of the second blended surface.
  glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_DEPTH_COMPONENT32F, size, size, has_veils_ ? 3 * layers : layers, 0,
               GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
  filter(GL_TEXTURE_2D_ARRAY, GL_LINEAR, GL_LINEAR);
  wrap(GL_TEXTURE_2D_ARRAY, GL_CLAMP_TO_EDGE, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_COMPARE_FUNC, GL_GEQUAL);
  gl::check("making shadow maps");
  if (lights_.shadow_count == 0) return;

  glBindFramebuffer(GL_FRAMEBUFFER, shadow_framebuffer_);
  glViewport(0, 0, size, size);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GEQUAL);  // 1 is near
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  for (int layer = 0; layer < lights_.shadow_count; ++layer) {
    glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, shadows_, 0, layer);
    const GLenum none = GL_NONE;
    glDrawBuffers(1, &none);
    glClearDepthf(0.0f);
    glClear(GL_DEPTH_BUFFER_BIT);
    draw_casters(layer);
  }
  if (has_veils_) draw_veils();
  glDepthFunc(GL_LEQUAL);
  gl::check("drawing shadows");
}

void Renderer::use_shadow_program(const gl::Program& program, const ShadowEntry& shadow) {
  glUseProgram(program.id());
  glUniformMatrix4fv(program.uniform("clip_from_world"), 1, GL_FALSE, &shadow.from_world[0][0]);
  // Nothing is too near for parallel rays.
  glUniform1f(program.uniform("near"), shadow.is_perspective != 0 ? shadow.near : 0.5f);
}

void Renderer::draw_casters(int layer) {
  const ShadowEntry& shadow = lights_.block.shadows[static_cast<std::size_t>(layer)];
  const int owner = lights_.shadow_owner[static_cast<std::size_t>(layer)];
  const auto is_lamp = [&](std::size_t i) { return owner >= 0 && (own_areas_[i] >> owner & 1) != 0; };
  const auto casts = [&](std::size_t i) {
    if (is_lamp(i) && beside_lamps_.find({owner, i}) == beside_lamps_.end()) return false;
    const GpuMaterial& material = gpu_.material_of(gpu_.draws()[i]);
    // What lets light through casts no hard shadow.
    if ((material.is_blended() && !material.has_opaque_part) || material.is_transmissive()) return false;
    return !is_beside(shadow.from_world, gpu_.draws()[i].bounds);
  };
  for (std::size_t i = 0, end = 0; i < gpu_.draws().size(); i = end) {
    end = i + 1;
    if (!casts(i)) continue;
    while (!is_lamp(i) && end < gpu_.draws().size() && gpu_.are_alike(i, end) && casts(end) && !is_lamp(end)) ++end;
    const GpuMaterial& material = gpu_.material_of(gpu_.draws()[i]);
    const gl::Program& program = programs_.depth(material.key, DepthPass::solid, true);
    use_shadow_program(program, shadow);
    if (material.key.alpha_mode != AlphaMode::opaque) gpu_.bind_material(material, program);
    if (is_lamp(i)) {
      gpu_.draw(i, beside_lamps_.at({owner, i}));
    } else {
      gpu_.draw(i, end - i);
    }
  }
}

/// Depth of what the eye does not see because it looks at its back: light meets both sides. Returns whether there is
/// any.
bool Renderer::draw_culled(const std::vector<std::size_t>& opaque, const FrameCamera& camera) {
  std::vector<std::size_t> single_sided;
  std::copy_if(opaque.begin(), opaque.end(), std::back_inserter(single_sided), [&](std::size_t i) {
    const Draw& d = gpu_.draws()[i];
    return !has_both_sides(gpu_.material_of(d)) && !is_outside(camera.clip_from_world, d.bounds);
  });
  const int w = (settings_.width + 1) / 2, h = (settings_.height + 1) / 2;
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, culled_framebuffer_);
  glBlitFramebuffer(0, 0, w, h, 0, 0, w, h, GL_DEPTH_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, culled_framebuffer_);
  glDepthFunc(GL_LESS);
  const bool is_any = draw_layer(single_sided, camera.clip_from_world, DepthPass::solid, GL_FRONT);
  glDepthFunc(GL_LEQUAL);
  return is_any;
}

void Renderer::draw_occlusion(const std::vector<std::size_t>& opaque, const FrameCamera& camera) {
  // ----- depth
  glViewport(0, 0, (settings_.width + 1) / 2, (settings_.height + 1) / 2);
  glBindFramebuffer(GL_FRAMEBUFFER, depth_framebuffer_);
  glClearDepthf(1.0f);
  glClear(GL_DEPTH_BUFFER_BIT);
  draw_depth(opaque, camera, true);
  const bool has_culled = draw_culled(opaque, camera);

  // ----- horizons, then their mean
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glBindVertexArray(nothing_);
  glBindFramebuffer(GL_FRAMEBUFFER, visibility_framebuffer_[0]);
  const gl::Program& horizons = programs_.occlusion(has_culled);
  glUseProgram(horizons.id());
  horizons.bind("culled_map", GL_TEXTURE_2D, culled_map_);
  horizons.bind("depth_map", GL_TEXTURE_2D, depth_map_);
  glUniformMatrix4fv(horizons.uniform("clip_from_camera"), 1, GL_FALSE, &camera.clip_from_camera[0][0]);
  const float pixels = 0.25f * static_cast<float>(settings_.height) * camera.clip_from_camera[1][1];
  glUniform4f(horizons.uniform("reach"), settings_.occlusion_radius * glm::length(gpu_.bounds().size()), pixels,
              static_cast<float>(frame_) * 0.618034f, camera.is_perspective ? 1.0f : 0.0f);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindFramebuffer(GL_FRAMEBUFFER, visibility_framebuffer_[1]);
  const gl::Program& blur = programs_.fullscreen("occlusion_blur.frag.glsl");
  glUseProgram(blur.id());
  blur.bind("depth_map", GL_TEXTURE_2D, depth_map_);
  blur.bind("visibility_map", GL_TEXTURE_2D, visibility_[0]);
  glUniformMatrix4fv(blur.uniform("clip_from_camera"), 1, GL_FALSE, &camera.clip_from_camera[0][0]);
  glUniform1f(blur.uniform("is_perspective"), camera.is_perspective ? 1.0f : 0.0f);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glEnable(GL_DEPTH_TEST);
  glViewport(0, 0, settings_.width, settings_.height);
}

/// Spreads what the opaque pass left in the layers of scattered light, onto the picture.
void Renderer::draw_scattering(const FrameCamera& camera) {
  for (std::size_t i = 0; i < scattered_.size(); ++i) {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, target_.framebuffer);
    glReadBuffer(GL_COLOR_ATTACHMENT1 + static_cast<GLenum>(i));
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, scattered_framebuffer_[i]);
    glBlitFramebuffer(0, 0, settings_.width, settings_.height, 0, 0, settings_.width, settings_.height,
                      GL_COLOR_BUFFER_BIT, GL_NEAREST);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, target_.framebuffer);
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  use_color_attachments(1);
  const gl::Program& program = programs_.fullscreen("scattering.frag.glsl");
  glUseProgram(program.id());
  program.bind("scattered_light", GL_TEXTURE_2D, scattered_[0]);
  program.bind("scattering_width", GL_TEXTURE_2D, scattered_[1]);
  glUniform4f(program.uniform("scale"), 0.5f * static_cast<float>(settings_.height) * camera.clip_from_camera[1][1],
              camera.is_perspective ? 1.0f : 0.0f, static_cast<float>(frame_) * 0.618034f, 0.0f);
  glBindVertexArray(nothing_);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
}

void Renderer::draw_background(const FrameCamera& camera) {
  // Turned back by the rotation about +y.
  const float cosine = std::cos(environment_->rotation), sine = std::sin(environment_->rotation);
  const auto in_environment = [&](vec3 d) { return vec3(cosine * d.x - sine * d.z, d.y, sine * d.x + cosine * d.z); };
  // Rays through a plane before the eye spread evenly over it; those of an orthographic camera are all the same.
  const auto ray_through = [&](float x, float y) {
    if (!camera.is_perspective) return in_environment(-camera.back);
    return in_environment(transform_vector(camera.world_from_camera, camera.at_depth({x, y}, 1.0f)));
  };
  const vec3 ray = ray_through(0, 0), ray_x = ray_through(1, 0) - ray, ray_y = ray_through(0, 1) - ray;
  constexpr std::size_t kMostSuns = 4;
  constexpr float kMostRadiance = 60000.0f;  // of the 65504 of a half float, which the sky behind it needs too
  std::vector<vec4> directions;
  std::vector<vec3> radiances;
  for (const SunDisc& sun : world_suns(*environment_)) {
    if (directions.size() == kMostSuns) break;
    directions.emplace_back(in_environment(sun.direction), std::cos(sun.angular_radius));
    radiances.push_back(glm::min(sun.radiance, vec3(kMostRadiance)));
  }
  const auto sun_count = static_cast<GLsizei>(directions.size());
  const bool has_map = environment_->map != nullptr || environment_->backdrop != nullptr;

  const gl::Program& program = programs_.background(has_map, sun_count);
  glUseProgram(program.id());
  glUniform3fv(program.uniform("ray"), 1, &ray.x);
  glUniform3fv(program.uniform("ray_x"), 1, &ray_x.x);
  glUniform3fv(program.uniform("ray_y"), 1, &ray_y.x);
  const vec3 constant = environment_->constant * environment_->intensity;
  glUniform3fv(program.uniform("constant_light"), 1, &constant.x);
  if (has_map) {
    program.bind("panorama", GL_TEXTURE_2D, panorama_);
    glUniform1f(program.uniform("intensity"), environment_->intensity);
  }
  if (sun_count > 0) {
    glUniform4fv(program.uniform("sun_directions"), sun_count, &directions[0].x);
    glUniform3fv(program.uniform("sun_radiances"), sun_count, &radiances[0].x);
  }
  glBindVertexArray(nothing_);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glDepthMask(GL_FALSE);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDepthMask(GL_TRUE);
}

/// A ground hides what is below it from an eye above. Depth alone: what it shows is put behind the frame.
void Renderer::draw_ground_depth(const FrameCamera& camera) {
  if (!scene_->ground || !is_whole(settings_.quantity)) return;
  const float height = scene_->ground->height - gpu_.origin().y;
  const bool is_above = camera.is_perspective ? camera.eye.y > height : camera.back.y > 0.0f;
  if (!is_above || !(gpu_.bounds().lower.y < height)) return;
  const mat4 world_from_clip(glm::inverse(glm::dmat4(camera.clip_from_world)));
  const gl::Program& program = programs_.fullscreen("ground_depth.frag.glsl");
  glUseProgram(program.id());
  const auto set = [&](const char* name, int column) {
    glUniform4fv(program.uniform(name), 1, &world_from_clip[column][0]);
  };
  set("across", 0), set("upward", 1), set("along", 2), set("middle", 3);
  glUniform1f(program.uniform("height"), height);
  glBindVertexArray(nothing_);
  glDisable(GL_CULL_FACE);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

}  // namespace candela::raster
