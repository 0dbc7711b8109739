#include "raster/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "ibl/source.h"
#include "raster/body.h"
#include "scene/surface_params.h"
#include "shade/surface_params.glsl.h"
#include "shade/tables.glsl.h"

namespace candela::raster {

namespace {

// A sun is a disc; a mirror that reflects it as a point would show nothing. α of at least half its radius convolves the
// lobe with it: 0.00465 / 2.
constexpr float kLeastSunRoughness = 0.0482f;

void filter(GLenum target, GLint min, GLint mag) {
  glTexParameteri(target, GL_TEXTURE_MIN_FILTER, min);
  glTexParameteri(target, GL_TEXTURE_MAG_FILTER, mag);
}

void wrap(GLenum target, GLint s, GLint t) {
  glTexParameteri(target, GL_TEXTURE_WRAP_S, s);
  glTexParameteri(target, GL_TEXTURE_WRAP_T, t);
}

/// Where what is seen through glass stands, beside the layers of scattered light.
constexpr GLenum kThroughAttachment = GL_COLOR_ATTACHMENT3;

/// Draws into the picture and what is seen through glass.
void use_through_attachment() {
  constexpr std::array<GLenum, 4> kBuffers = {GL_COLOR_ATTACHMENT0, GL_NONE, GL_NONE, kThroughAttachment};
  glDrawBuffers(static_cast<GLsizei>(kBuffers.size()), kBuffers.data());
}

/// Draws into the first `count` pictures of the framebuffer that is bound.
void use_color_attachments(GLsizei count) {
  constexpr std::array<GLenum, 3> kAll = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2};
  glDrawBuffers(count, kAll.data());
}

void check_framebuffer(const char* what) {
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE) {
    throw Error("the driver cannot draw into " + std::string(what) + " (status " + std::to_string(status) + ")");
  }
}

/// Whether all light is shown.
bool is_whole(Quantity quantity) { return quantity == Quantity::light || quantity == Quantity::luminance; }

void upload_triangles(const std::vector<uvec3>& triangles, GpuTriangles& gpu) {
  gpu.index_count = static_cast<GLsizei>(3 * triangles.size());
  glBindVertexArray(0);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, gpu.indices);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(triangles.size() * sizeof(uvec3)), triangles.data(),
               GL_STATIC_DRAW);
}

/// Mean luminance of what arrives from far away, suns aside.
float mean_luminance(const Environment& environment) {
  float mean = luminance(environment.constant);
  if (environment.map != nullptr) {
    const Image& map = *environment.map;
    double sum = 0.0, weight = 0.0;
    const int step = std::max(map.height / 64, 1);
    for (int y = step / 2; y < map.height; y += step) {
      const double w = std::sin(static_cast<double>(kPi) * (y + 0.5) / map.height);
      for (int x = step / 2; x < map.width; x += step) {
        sum += w * static_cast<double>(luminance(map.rgb(x, y)));
        weight += w;
      }
    }
    mean += static_cast<float>(sum / weight);
  }
  return mean * environment.intensity;
}

gl::Texture upload_panorama(const Image* map) {
  gl::Texture texture;
  glBindTexture(GL_TEXTURE_2D, texture);
  if (map == nullptr) {
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA16F, 1, 1, 0, GL_RGBA, GL_FLOAT, nullptr);
  } else {
    constexpr float kMostHalf = 65504.0f;
    std::vector<float> rgba(static_cast<std::size_t>(map->width) * static_cast<std::size_t>(map->height) * 4, 1.0f);
    for (int y = 0; y < map->height; ++y) {
      for (int x = 0; x < map->width; ++x) {
        const vec3 v = glm::min(map->rgb(x, y), vec3(kMostHalf));
        float* p = rgba.data() + 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(map->width) +
                                      static_cast<std::size_t>(x));
        p[0] = v.x, p[1] = v.y, p[2] = v.z;
      }
    }
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA16F, map->width, map->height, 0, GL_RGBA, GL_FLOAT, rgba.data());
  }
  filter(GL_TEXTURE_2D, GL_LINEAR, GL_LINEAR);
  wrap(GL_TEXTURE_2D, GL_REPEAT, GL_CLAMP_TO_EDGE);
  gl::check("uploading the environment");
  return texture;
}

}  // namespace

Renderer::Renderer(const Scene& scene, const Environment& environment, const Settings& settings,
                   Diagnostics& diagnostics)
    : scene_(&scene),
      environment_(environment),
      settings_(settings),
      diagnostics_(diagnostics),
      programs_(settings.shading, settings.shader_folder, settings.most_textures),
      gpu_(scene, settings.shading, diagnostics),
      expects_light_(is_lit_from_far(environment)) {
  if (!gl::has_extension("GL_EXT_color_buffer_float") && !gl::has_extension("GL_EXT_color_buffer_half_float")) {
    throw Error("the driver cannot draw into floating-point pictures (GL_EXT_color_buffer_float)");
  }
  const Image* seen = environment.backdrop != nullptr ? environment.backdrop.get() : environment.map.get();
  panorama_ = upload_panorama(settings.background == Background::environment ? seen : nullptr);
  profiles_ = upload_profiles(scene);
  sky_ = mean_luminance(environment);
  find_area_lights(diagnostics);
  upload_table();
  glSamplerParameteri(depth_sampler_, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glSamplerParameteri(depth_sampler_, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glSamplerParameteri(depth_sampler_, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glSamplerParameteri(depth_sampler_, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  make_targets();
  make_occlusion_targets();
}

void Renderer::set_light(const BakedLight& light) {
  has_light_ = !light.specular.empty();
  if (!has_light_) return;
  light_levels_ = static_cast<int>(light.specular.levels.size());
  specular_ = upload_cube(light.specular);
  diffuse_ = upload_cube(cube_of_one_level(light.irradiance));
  has_sheen_light_ = !light.sheen.empty();
  if (has_sheen_light_) sheen_ = upload_cube(light.sheen);
}

void Renderer::set_probes(const std::vector<Probe>& probes) {
  probes_.clear();
  for (const Probe& probe : probes) {
    GpuProbe& gpu = probes_.emplace_back();
    gpu.position = probe.position;
    gpu.box = probe.box;
    gpu.levels = static_cast<int>(probe.light.specular.levels.size());
    gpu.specular = upload_cube(probe.light.specular);
    gpu.diffuse = upload_cube(cube_of_one_level(probe.light.irradiance));
    if (!probe.light.sheen.empty()) gpu.sheen = upload_cube(probe.light.sheen);
  }
}

/// The light of the probe that is nearest to a draw.
void Renderer::bind_probe(std::size_t draw, const gl::Program& program) {
  const vec3 center = gpu_.draws()[draw].center + gpu_.origin();
  const auto nearest = std::min_element(probes_.begin(), probes_.end(), [&](const GpuProbe& a, const GpuProbe& b) {
    return glm::distance(a.position, center) < glm::distance(b.position, center);
  });
  const auto set = [&](const char* name, vec3 place) {
    place -= gpu_.origin();
    glUniform3fv(program.uniform(name), 1, &place.x);
  };
  set("probe_position", nearest->position);
  set("probe_low", nearest->box.lower);
  set("probe_high", nearest->box.upper);
  glUniform1f(program.uniform("probe_levels"), static_cast<float>(nearest->levels));
  program.bind("specular_light", GL_TEXTURE_CUBE_MAP, nearest->specular);
  program.bind("diffuse_light", GL_TEXTURE_CUBE_MAP, nearest->diffuse);
  program.bind("sheen_light", GL_TEXTURE_CUBE_MAP, nearest->sheen);
}

void Renderer::set_scene(const Scene& scene) {
  scene_ = &scene;
  gpu_.set_scene(scene, told_);
  find_area_lights(told_);
  // What begins to scatter or to transmit draws into pictures that nothing needed before.
  if (wants_scattering() > has_scattering_ || wants_opaque_picture() > has_opaque_picture_) make_targets();
}

bool Renderer::lacks_sheen_light() const { return has_light_ && !has_sheen_light_ && gpu_.has_lobe(shade::kLobeSheen); }

bool Renderer::wants_scattering() const { return gpu_.has_scattering() && !is_of_surface(settings_.quantity); }
bool Renderer::wants_opaque_picture() const { return gpu_.has_lobe(shade::kLobeTransmission); }

void Renderer::find_area_lights(Diagnostics& diagnostics) {
  areas_ = find_areas(*scene_, gpu_, sky_, diagnostics);
  own_areas_.assign(gpu_.draws().size(), 0);
  beside_lamps_.clear();
  for (std::size_t i = 0; i < areas_.size(); ++i) {
    std::map<std::size_t, std::vector<bool>> is_lamp;  // triangles of each draw
    for (const LampSurface& surface : areas_[i].surfaces) {
      own_areas_[surface.draw] |= 1 << i;
      std::vector<bool>& lamp = is_lamp[surface.draw];
      lamp.resize(gpu_.triangles(*scene_, surface.draw).size());
      for (const std::uint32_t t : surface.triangles) lamp[t] = true;
    }
    for (const auto& [draw, lamp] : is_lamp) {
      const std::vector<uvec3>& triangles = gpu_.triangles(*scene_, draw);
      std::vector<uvec3> rest;
      for (std::size_t t = 0; t < lamp.size(); ++t) {
        if (!lamp[t]) rest.push_back(triangles[t]);
      }
      if (!rest.empty()) upload_triangles(rest, beside_lamps_[{static_cast<int>(i), draw}]);
    }
  }
}

/// As everything that is drawn is placed.
View Renderer::relative(View view) const {
  view.world_from_camera = gpu_.relative(view.world_from_camera);
  return view;
}

void Renderer::warm_up(const View& view) {
  // A driver compiles for the kind of texture that it finds.
  if (!has_light_) {
    Cubemap black;
    black.levels = {make_cube_faces(2), make_cube_faces(1)};
    specular_ = upload_cube(black);
    sheen_ = upload_cube(black);
    diffuse_ = upload_cube(cube_of_one_level(make_cube_faces(2)));
  }
  glEnable(GL_SCISSOR_TEST);
  glScissor(0, 0, 1, 1);
  draw(view);
  glDisable(GL_SCISSOR_TEST);
  std::array<float, 4> pixel{};
  glBindFramebuffer(GL_FRAMEBUFFER, resolved_framebuffer_);
  glReadPixels(0, 0, 1, 1, GL_RGBA, GL_FLOAT, pixel.data());
}

void Renderer::upload_table() {
  constexpr int kWidth = 256;  // as shade_table() reads it
  const int height = (shade::kTableCount + kWidth - 1) / kWidth;
  std::vector<float> texels(shade::kTableEntries, shade::kTableEntries + shade::kTableCount);
  texels.resize(static_cast<std::size_t>(kWidth) * static_cast<std::size_t>(height));
  glBindTexture(GL_TEXTURE_2D, table_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R32F, kWidth, height, 0, GL_RED, GL_FLOAT, texels.data());
  filter(GL_TEXTURE_2D, GL_NEAREST, GL_NEAREST);

  // As table_ggx_column() reads it.
  const auto cosines = static_cast<std::size_t>(shade::kTableMu);
  std::vector<vec2> ggx;
  constexpr int kRows = shade::kTableCurves * shade::kTableRoughness;
  for (std::size_t row = 0; row < static_cast<std::size_t>(kRows); ++row) {
    const auto entry = [](int table, std::size_t i) {
      const float* at = shade::kTableEntries + table + 2 * i;
      return vec2(at[1], 1.0f - at[0] - at[1]);
    };
    for (std::size_t i = 0; i < cosines; ++i) ggx.push_back(entry(shade::kTableGgx, row * cosines + i));
    ggx.push_back(entry(shade::kTableGgxMean, row));
    const float* walk = shade::kTableEntries + shade::kTableWalk + 2 * (row % shade::kTableRoughness);
    ggx.emplace_back(walk[0], walk[1]);
    ggx.emplace_back(shade::kTableEntries[shade::kTableWalkRise + static_cast<int>(row)], 0.0f);
  }
  glBindTexture(GL_TEXTURE_2D, ggx_table_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RG16F, shade::kTableMu + 3, kRows, 0, GL_RG, GL_FLOAT, ggx.data());
  filter(GL_TEXTURE_2D, GL_LINEAR, GL_LINEAR);
  wrap(GL_TEXTURE_2D, GL_CLAMP_TO_EDGE, GL_CLAMP_TO_EDGE);
  gl::check("uploading the tables");
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
  const bool is_length = settings_.quantity == Quantity::position || settings_.quantity == Quantity::depth;
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

bool Renderer::has_extended_lights() const {
  return lights_.area_count > 0 ||
         (settings_.has_soft_shadows && (lights_.has_suns || (settings_.light_radius > 0.0f && lights_.count > 0)));
}

void Renderer::begin(const View& view, LightPoint point) {
  gpu_.set_origin(*scene_, vec3(view.world_from_camera[3]));
  const View placed = relative(view);
  range_ =
      seen_range(*scene_, gpu_, placed, static_cast<float>(settings_.width) / static_cast<float>(settings_.height));
  const FrameCamera camera = frame_camera(placed, settings_.width, settings_.height, range_);
  // What there is to say about lights is said the first time.
  Diagnostics& diagnostics = is_begun_ ? told_ : diagnostics_;
  is_begun_ = true;
  is_moved_light_ = point != LightPoint(0.5f);
  // Of a view with a near plane the middle of what it shows of it.
  const vec3 eye = transform_point(view.world_from_camera, vec3(0.0f, 0.0f, -view.near_plane));
  body_ = camera.is_perspective ? body_around(*scene_, eye) : -1;
  const float radius = settings_.has_soft_shadows ? settings_.light_radius : 0.0f;
  lights_ = collect_lights(*scene_, environment_, gpu_, camera, settings_.has_soft_shadows ? point : LightPoint(0.5f),
                           radius, shadow_views(areas_), diagnostics);
  if (!settings_.has_soft_shadows) {
    for (LightEntry& light : lights_.block.lights) light.sun_radius = 0.0f;
  }
  add_areas(areas_, gpu_, point, lights_, diagnostics);
  glBindBuffer(GL_UNIFORM_BUFFER, lights_block_);
  glBufferData(GL_UNIFORM_BUFFER, sizeof lights_.block, &lights_.block, GL_DYNAMIC_DRAW);
  draw_shadows();
}

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

void Renderer::bind_frame(const FrameCamera& camera) {
  FrameBlock block;
  block.clip_from_world = camera.clip_from_world;
  block.eye = camera.eye;
  block.is_perspective = camera.is_perspective ? 1.0f : 0.0f;
  block.back = camera.back;
  block.light_levels = static_cast<float>(light_levels_);
  block.least_roughness = lights_.has_suns ? kLeastSunRoughness : 0.0f;
  block.sample_area = settings_.specular_antialiasing ? 1.0f / static_cast<float>(settings_.frames) : 0.0f;
  block.picture_height = static_cast<float>(settings_.height);
  block.picture_levels = static_cast<float>(picture_levels_);
  block.light_radius = settings_.has_soft_shadows ? settings_.light_radius : 0.0f;
  block.noise_turn = static_cast<float>(frame_) * 0.618034f;
  // Of many frames each stands for a part of the light.
  block.shadow_share = is_moved_light_ ? 1.0f / std::sqrt(static_cast<float>(settings_.frames)) : 1.0f;
  block.light_count = lights_.count;
  block.shown_parts = parts_of(settings_.quantity);
  block.shown_light = settings_.quantity == Quantity::one_light ? settings_.shown_light : -1;
  block.area_count = lights_.area_count;
  glBindBuffer(GL_UNIFORM_BUFFER, frame_block_);
  glBufferData(GL_UNIFORM_BUFFER, sizeof block, &block, GL_DYNAMIC_DRAW);
  glBindBufferBase(GL_UNIFORM_BUFFER, frame_binding, frame_block_);
  glBindBufferBase(GL_UNIFORM_BUFFER, lights_binding, lights_block_);
}

void Renderer::bind_light(const gl::Program& program) const {
  program.bind("shade_table_texels", GL_TEXTURE_2D, table_);
  program.bind("shade_ggx_texels", GL_TEXTURE_2D, ggx_table_);
  program.bind("specular_light", GL_TEXTURE_CUBE_MAP, specular_);
  program.bind("diffuse_light", GL_TEXTURE_CUBE_MAP, diffuse_);
  program.bind("sheen_light", GL_TEXTURE_CUBE_MAP, sheen_);
  program.bind("shadow_maps", GL_TEXTURE_2D_ARRAY, shadows_);
  program.bind("shadow_depths", GL_TEXTURE_2D_ARRAY, shadows_, depth_sampler_);
  program.bind("light_profiles", GL_TEXTURE_2D_ARRAY, profiles_);
  program.bind("opaque_picture", GL_TEXTURE_2D, opaque_picture_);
  program.bind("screen_visibility", GL_TEXTURE_2D, visibility_[1]);
  program.bind("veils", GL_TEXTURE_2D_ARRAY, veils_);
  program.bind("depth_layers", GL_TEXTURE_2D_ARRAY, depth_layers_);
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
  const float cosine = std::cos(environment_.rotation), sine = std::sin(environment_.rotation);
  const auto in_environment = [&](vec3 d) { return vec3(cosine * d.x - sine * d.z, d.y, sine * d.x + cosine * d.z); };
  // Rays through a plane before the eye spread evenly over it; those of an orthographic camera are all the same.
  const auto ray_through = [&](float x, float y) {
    if (!camera.is_perspective) return in_environment(-camera.back);
    return in_environment(transform_vector(camera.world_from_camera, camera.at_depth({x, y}, 1.0f)));
  };
  const vec3 ray = ray_through(0, 0), ray_x = ray_through(1, 0) - ray, ray_y = ray_through(0, 1) - ray;
  constexpr std::size_t kMostSuns = 4;
  std::vector<vec4> directions;
  std::vector<vec3> radiances;
  if (!environment_.suns.empty()) {
    Environment suns = environment_;
    suns.map = nullptr;
    for (const SunDisc& sun : ibl::make_source(suns).suns) {
      if (directions.size() == kMostSuns) break;
      directions.emplace_back(in_environment(sun.direction), std::cos(sun.angular_radius));
      radiances.push_back(glm::min(sun.radiance, vec3(60000.0f)));
    }
  }
  const auto sun_count = static_cast<GLsizei>(directions.size());
  const bool has_map = environment_.map != nullptr || environment_.backdrop != nullptr;

  const gl::Program& program = programs_.background(has_map, sun_count);
  glUseProgram(program.id());
  glUniform3fv(program.uniform("ray"), 1, &ray.x);
  glUniform3fv(program.uniform("ray_x"), 1, &ray_x.x);
  glUniform3fv(program.uniform("ray_y"), 1, &ray_y.x);
  const vec3 constant = environment_.constant * environment_.intensity;
  glUniform3fv(program.uniform("constant_light"), 1, &constant.x);
  if (has_map) {
    program.bind("panorama", GL_TEXTURE_2D, panorama_);
    glUniform1f(program.uniform("intensity"), environment_.intensity);
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

void Renderer::tell_left_out(const GpuMaterial& material, std::uint32_t slots) {
  if (!told_materials_.insert(material.block).second) return;
  std::string names;
  for (std::size_t i = 0; i < kTextureSlots; ++i) {
    if ((slots >> i & 1u) != 0) names.append(names.empty() ? "" : ", ").append(kTextureRows[i].name);
  }
  diagnostics_.warn("more textures than the driver reads at once; left out: " + names, material.name);
}

void Renderer::draw_some(std::size_t first, std::size_t count, const PassKey& pass) {
  const Draw& d = gpu_.draws()[first];
  const GpuMaterial& material = gpu_.material_of(d);
  const SurfaceProgram& surface = programs_.mesh(material.key, pass);
  if (surface.left_out != 0) tell_left_out(material, surface.left_out);
  const gl::Program& program = *surface.program;
  glUseProgram(program.id());
  bind_light(program);
  if (pass.has_probes) bind_probe(first, program);
  if (pass.has_areas) glUniform1i(program.uniform("own_areas"), own_areas_[first]);
  if (pass.blend_part == BlendPart::rest) {
    glUniform4i(program.uniform("depth_slice"), slice_.x, slice_.y, material.is_transmissive() ? -1 : slice_.z,
                slice_.w);
  }
  if (pass.is_in_body) {
    const Material& body = scene_->materials[static_cast<std::size_t>(body_)];
    const vec3 extinction = volume_extinction(body);
    glUniform3fv(program.uniform("body_extinction"), 1, &extinction.x);
    const float index = std::max(body.ior, 1.0f);
    glUniform1f(program.uniform("body_share"), 1.0f / (index * index));
  }
  if (pass.quantity == Quantity::object_id) glUniform1f(program.uniform("object_id"), static_cast<float>(d.number + 1));
  gpu_.bind_material(material, program);
  gpu_.draw(first, count);
}

/// In a body the eye sees its boundary from behind; glTF: doubleSided does not matter to it.
bool Renderer::has_both_sides(const GpuMaterial& material) const {
  return material.is_double_sided || (body_ >= 0 && material.key.has_body);
}

/// Depth alone; masks and blended surfaces are cut out or left out.
void Renderer::draw_depth(const std::vector<std::size_t>& order, const FrameCamera& camera, bool has_cut_out) {
  for (const std::size_t i : order) {
    const Draw& d = gpu_.draws()[i];
    const GpuMaterial& material = gpu_.material_of(d);
    const bool is_cut_out = material.key.alpha_mode != AlphaMode::opaque;
    if ((is_cut_out && !has_cut_out) || is_outside(camera.clip_from_world, d.bounds)) continue;
    const gl::Program& program = programs_.depth(material.key);
    glUseProgram(program.id());
    glUniformMatrix4fv(program.uniform("clip_from_world"), 1, GL_FALSE, &camera.clip_from_world[0][0]);
    if (is_cut_out) gpu_.bind_material(material, program);
    if (has_both_sides(material)) {
      glDisable(GL_CULL_FACE);
    } else {
      glEnable(GL_CULL_FACE);
      glCullFace(GL_BACK);
    }
    gpu_.draw(i);
  }
}

void Renderer::draw_surfaces(const std::vector<std::size_t>& order, const PassKey& pass, const FrameCamera& camera) {
  std::vector<bool> is_wanted(gpu_.draws().size(), false);
  for (const std::size_t i : order) is_wanted[i] = !is_outside(camera.clip_from_world, gpu_.draws()[i].bounds);
  for (const std::size_t i : order) {
    if (!is_wanted[i]) continue;
    const GpuMaterial& material = gpu_.material_of(gpu_.draws()[i]);
    const bool is_blended = pass.blend_part == BlendPart::rest;
    // What may be drawn in any order goes together with its neighbours.
    const bool is_sorted = (is_blended && is_slice_deep_) || material.is_transmissive() ||
                           pass.quantity == Quantity::object_id || (pass.has_areas && own_areas_[i] != 0) ||
                           pass.has_probes;
    std::size_t first = i, end = i + 1;
    while (!is_sorted && first > 0 && is_wanted[first - 1] && gpu_.are_alike(first - 1, i)) --first;
    while (!is_sorted && end < is_wanted.size() && is_wanted[end] && gpu_.are_alike(end, i)) ++end;
    for (std::size_t k = first; k < end; ++k) is_wanted[k] = false;
    const std::size_t count = end - first;
    if (!has_both_sides(material)) {
      glEnable(GL_CULL_FACE);
      glCullFace(GL_BACK);
      draw_some(first, count, pass);
    } else if (is_blended && is_slice_deep_) {
      // Far sides before near ones.
      glEnable(GL_CULL_FACE);
      for (const GLenum side : {GLenum{GL_FRONT}, GLenum{GL_BACK}}) {
        glCullFace(side);
        draw_some(first, count, pass);
      }
    } else {
      glDisable(GL_CULL_FACE);
      draw_some(first, count, pass);
    }
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

void Renderer::draw(const View& view, vec2 jitter, vec2 aperture, int frame) {
  frame_ = frame;
  const FrameCamera camera = frame_camera(relative(view), settings_.width, settings_.height, range_, jitter, aperture);
  bind_frame(camera);

  // ----- what is drawn when
  std::vector<std::size_t> opaque, transmissive, blended;
  for (std::size_t i = 0; i < gpu_.draws().size(); ++i) {
    const GpuMaterial& material = gpu_.material_of(gpu_.draws()[i]);
    if (material.is_blended()) blended.push_back(i);
    if (material.is_blended() && !material.has_opaque_part) continue;
    (material.is_transmissive() ? transmissive : opaque).push_back(i);
  }
  const auto depth = [&](std::size_t i) { return glm::dot(camera.eye - gpu_.draws()[i].center, camera.back); };
  const auto near_first = [&](std::size_t a, std::size_t b) { return depth(a) < depth(b); };
  const auto far_first = [&](std::size_t a, std::size_t b) { return depth(a) > depth(b); };
  std::stable_sort(opaque.begin(), opaque.end(), near_first);
  std::stable_sort(transmissive.begin(), transmissive.end(), far_first);
  std::stable_sort(blended.begin(), blended.end(), far_first);

  glViewport(0, 0, settings_.width, settings_.height);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  const bool has_far_light = expects_light_ || !probes_.empty();
  const bool has_occlusion = settings_.occlusion_radius > 0.0f && has_far_light;
  if (has_occlusion) draw_occlusion(opaque, camera);
  find_depth_layers(transmissive, blended, camera);
  glBindFramebuffer(GL_FRAMEBUFFER, target_.framebuffer);
  glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
  glClearDepthf(1.0f);
  const bool has_background = settings_.background == Background::environment && is_whole(settings_.quantity);
  // A background covers whatever was there.
  glClear(has_background ? GL_DEPTH_BUFFER_BIT : GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);

  PassKey pass;
  pass.has_lights = lights_.count + lights_.area_count > 0;
  pass.has_veils = has_veils_;
  pass.is_in_body = body_ >= 0;
  pass.blend_part = BlendPart::opaque;
  if (is_of_surface(settings_.quantity)) {
    draw_quantity(settings_.quantity, camera);
    resolve(resolved_framebuffer_);
    gl::check("drawing");
    return;
  }
  pass.has_far_light = has_far_light;
  pass.has_areas = lights_.area_count > 0;
  pass.has_probes = !probes_.empty();
  // A large light's hard shadow would be a lie.
  pass.has_soft_shadows = lights_.shadow_count > 0 && (settings_.has_soft_shadows || pass.has_areas);
  pass.has_sheen_light = gpu_.has_lobe(shade::kLobeSheen);
  pass.has_scattering = has_scattering_;
  if (has_scattering_) {
    use_color_attachments(3);
    const std::array<float, 4> black{};
    for (GLint i = 1; i < 3; ++i) glClearBufferfv(GL_COLOR, i, black.data());
  }
  pass.has_coverage = settings_.msaa > 1;
  pass.has_occlusion = has_occlusion;
  // Only what is seen is shaded afterwards. Masks, which would be cut out twice, wait.
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  draw_depth(opaque, camera, false);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  if (pass.has_coverage) glEnable(GL_SAMPLE_ALPHA_TO_COVERAGE);
  draw_surfaces(opaque, pass, camera);
  glDisable(GL_SAMPLE_ALPHA_TO_COVERAGE);
  pass.has_coverage = false;
  pass.has_occlusion = false;
  pass.has_scattering = false;
  if (has_scattering_) draw_scattering(camera);
  if (has_background) draw_background(camera);

  if (!transmissive.empty() || !blended.empty()) {
    pass.has_opaque_picture = gpu_.has_lobe(shade::kLobeTransmission);
    // What is blended and lies behind glass stands in the picture that the glass shows.
    const bool is_split = has_glass_before_blended_;
    if (is_split) draw_blended(blended, pass, camera, GlassSide::not_before);
    if (pass.has_opaque_picture) {
      resolve(picture_framebuffer_);
      glBindFramebuffer(GL_FRAMEBUFFER, target_.framebuffer);
      glBindTexture(GL_TEXTURE_2D, opaque_picture_);
      glGenerateMipmap(GL_TEXTURE_2D);
    }
    if (has_through_) {
      pass.has_through = true;
      use_through_attachment();
      const std::array<float, 4> nothing{};
      glClearBufferfv(GL_COLOR, 3, nothing.data());
    }
    draw_surfaces(transmissive, pass, camera);
    draw_blended(blended, pass, camera, is_split ? GlassSide::before : GlassSide::any);
  }
  resolve(resolved_framebuffer_);
  if (has_through_) resolve_through();
  gl::check("drawing");
}

namespace {

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

}  // namespace

void Renderer::draw_quantity(Quantity quantity, const FrameCamera& camera) {
  std::vector<std::size_t> all(gpu_.draws().size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  PassKey pass;
  pass.has_lights = lights_.count + lights_.area_count > 0;
  pass.quantity = quantity;
  if (quantity == Quantity::overdraw) {
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
  }
  draw_surfaces(all, pass, camera);
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
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

void Renderer::present(ivec2 size, float exposure, ToneCurve tone_curve) {
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
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

void Renderer::resize(int width, int height) {
  settings_.width = width;
  settings_.height = height;
  make_targets();
  make_occlusion_targets();
}

Image Renderer::read_layer(const View& view, Layer layer) {
  const FrameCamera camera = frame_camera(relative(view), settings_.width, settings_.height, range_);
  bind_frame(camera);
  Target target;
  glBindRenderbuffer(GL_RENDERBUFFER, target.color);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA32F, settings_.width, settings_.height);
  glBindRenderbuffer(GL_RENDERBUFFER, target.depth);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, settings_.width, settings_.height);
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target.color);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, target.depth);
  check_framebuffer("floats");
  glViewport(0, 0, settings_.width, settings_.height);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  const float nothing = layer == Layer::depth ? kInfinity : layer == Layer::albedo ? 1.0f : 0.0f;
  const std::array<float, 4> clear = {nothing, nothing, nothing, 0.0f};
  glClearBufferfv(GL_COLOR, 0, clear.data());
  glClearDepthf(1.0f);
  glClear(GL_DEPTH_BUFFER_BIT);
  draw_quantity(quantity_of(layer), camera);
  const Image rgba = read_pixels(settings_.width, settings_.height);
  const int channels = layer == Layer::depth || layer == Layer::object_id ? 1 : 3;
  Image image(settings_.width, settings_.height, channels);
  for (std::size_t i = 0; i < rgba.pixels.size() / 4; ++i) {
    for (int c = 0; c < channels; ++c) {
      // A position is the world's again.
      const bool is_place = layer == Layer::position && rgba.pixels[4 * i + 3] > 0.0f;
      image.pixels[i * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c)] =
          rgba.pixels[4 * i + static_cast<std::size_t>(c)] + (is_place ? gpu_.origin()[c] : 0.0f);
    }
  }
  return image;
}

}  // namespace candela::raster
