#include "raster/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "raster/cube_texture.h"
#include "raster/targets.h"
#include "scene/surface_params.h"
#include "shade/surface_params.glsl.h"
#include "shade/tables.glsl.h"

namespace candela::raster {

namespace {

// A sun is a disc; a mirror that reflects it as a point would show nothing. α of at least half its radius convolves the
// lobe with it: 0.00465 / 2.
constexpr float kLeastSunRoughness = 0.0482f;

void upload_triangles(const std::vector<uvec3>& triangles, GpuTriangles& gpu) {
  gpu.index_count = static_cast<GLsizei>(3 * triangles.size());
  glBindVertexArray(0);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, gpu.indices);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(triangles.size() * sizeof(uvec3)), triangles.data(),
               GL_STATIC_DRAW);
}

int texture_anisotropy(const Settings& settings) {
  constexpr int kUsual = 8;
  if (settings.texture_anisotropy > 0) return settings.texture_anisotropy;
  return gl::is_software() ? 1 : kUsual;
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

Renderer::Renderer(const Scene& scene, const Environment& environment, const shade::ShadingModel& shading,
                   const Settings& settings, Diagnostics& diagnostics)
    : scene_(&scene),
      environment_(&environment),
      settings_(settings),
      diagnostics_(diagnostics),
      programs_(shading, settings.shader_folder, settings.most_textures),
      gpu_(scene, shading, diagnostics),
      expects_light_(is_lit_from_far(environment)) {
  if (!gl::has_extension("GL_EXT_color_buffer_float") && !gl::has_extension("GL_EXT_color_buffer_half_float")) {
    throw Error("the driver cannot draw into floating-point pictures (GL_EXT_color_buffer_float)");
  }
  profiles_ = upload_profiles(scene);
  set_environment(environment);
  find_area_lights(diagnostics);
  upload_table();
  glSamplerParameteri(depth_sampler_, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glSamplerParameteri(depth_sampler_, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glSamplerParameteri(depth_sampler_, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glSamplerParameteri(depth_sampler_, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  make_targets();
  make_occlusion_targets();
}

void Renderer::set_environment(const Environment& environment) {
  environment_ = &environment;
  expects_light_ = is_lit_from_far(environment);
  const Image* seen = environment.backdrop != nullptr ? environment.backdrop.get() : environment.map.get();
  panorama_ = upload_panorama(settings_.background == Background::environment ? seen : nullptr);
  sky_ = mean_luminance(environment);
}

void Renderer::turn_light(float radians, float factor) { light_turn_ = {std::cos(radians), std::sin(radians), factor}; }

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

bool Renderer::lacks_sheen_light() const {
  return has_light_ && !has_sheen_light_ && gpu_.has_lobe(shade::kLobesOfFibres);
}

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

bool Renderer::has_extended_lights() const {
  return lights_.area_count > 0 ||
         (settings_.has_soft_shadows && (lights_.has_suns || (settings_.light_radius > 0.0f && lights_.count > 0)));
}

void Renderer::begin(const View& view, LightPoint point) {
  gpu_.set_texture_anisotropy(texture_anisotropy(settings_));
  gpu_.set_origin(*scene_, vec3(view.world_from_camera[3]));
  View placed = relative(view);
  near_plane_ = view.near_plane;
  placed.near_plane = rays_start_ = start_of_rays(view);
  range_ =
      seen_range(*scene_, gpu_, placed, static_cast<float>(settings_.width) / static_cast<float>(settings_.height));
  const FrameCamera camera = frame_camera(placed, settings_.width, settings_.height, range_);
  // What there is to say about lights is said the first time.
  Diagnostics& diagnostics = is_begun_ ? told_ : diagnostics_;
  is_begun_ = true;
  is_moved_light_ = point != LightPoint(0.5f);
  body_ = body_around(*scene_, transform_point(view.world_from_camera, vec3(0.0f, 0.0f, -rays_start_)));
  const float radius = settings_.has_soft_shadows ? settings_.light_radius : 0.0f;
  lights_ = collect_lights(*scene_, *environment_, gpu_, camera, settings_.has_soft_shadows ? point : LightPoint(0.5f),
                           radius, shadow_views(areas_), diagnostics);
  if (!settings_.has_soft_shadows) {
    for (LightEntry& light : lights_.block.lights) light.sun_radius = 0.0f;
  }
  add_areas(areas_, gpu_, point, lights_, diagnostics);
  if (!settings_.has_shadows) remove_shadows(lights_);
  glBindBuffer(GL_UNIFORM_BUFFER, lights_block_);
  glBufferData(GL_UNIFORM_BUFFER, sizeof lights_.block, &lights_.block, GL_DYNAMIC_DRAW);
  draw_shadows();
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
  block.light_turn = light_turn_;
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
    const Material& body = scene_->materials[static_cast<std::size_t>(body_->material)];
    const vec3 extinction = volume_extinction(body);
    glUniform3fv(program.uniform("body_extinction"), 1, &extinction.x);
    const float index = std::max(body.ior, 1.0f);
    glUniform1f(program.uniform("body_share"), 1.0f / (index * index));
    // Rays start a hair away from a face that they start on.
    const vec3 margin = 1e-4f * body_->bounds.size();
    const vec3 low = body_->bounds.lower - gpu_.origin() - margin, high = body_->bounds.upper - gpu_.origin() + margin;
    glUniform3fv(program.uniform("body_low"), 1, &low.x);
    glUniform3fv(program.uniform("body_high"), 1, &high.x);
    glUniform1f(program.uniform("near_plane"), near_plane_);
    glUniform1f(program.uniform("rays_start"), rays_start_);
  }
  gpu_.bind_material(material, program);
  if (pass.is_map) {
    glUniform1i(program.uniform("first_draw"), static_cast<GLint>(first));
    gpu_.draw_corners(*scene_, first, count);
    return;
  }
  if (pass.quantity == Quantity::object_id) glUniform1f(program.uniform("object_id"), static_cast<float>(d.number + 1));
  gpu_.draw(first, count);
}

/// In a body the eye sees its boundary from behind; glTF: doubleSided does not matter to it.
bool Renderer::has_both_sides(const GpuMaterial& material) const {
  return material.is_double_sided || (body_ && material.key.has_body);
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

void Renderer::draw_in_bands(std::size_t first, std::size_t count, const PassKey& pass) {
  if (bands_ < 2) {
    draw_some(first, count, pass);
    return;
  }
  glEnable(GL_SCISSOR_TEST);
  for (int band = 0; band < bands_; ++band) {
    const int low = settings_.height * band / bands_, high = settings_.height * (band + 1) / bands_;
    glScissor(0, low, settings_.width, high - low);
    draw_some(first, count, pass);
    glFinish();
    StopScope::check();
  }
  glDisable(GL_SCISSOR_TEST);
}

void Renderer::reset_state() {
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_SAMPLE_ALPHA_TO_COVERAGE);
  glDisable(GL_BLEND);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
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
                           (pass.quantity == Quantity::object_id && !pass.is_map) ||
                           (pass.has_areas && own_areas_[i] != 0) || pass.has_probes;
    std::size_t first = i, end = i + 1;
    while (!is_sorted && first > 0 && is_wanted[first - 1] && gpu_.are_alike(first - 1, i)) --first;
    while (!is_sorted && end < is_wanted.size() && is_wanted[end] && gpu_.are_alike(end, i)) ++end;
    for (std::size_t k = first; k < end; ++k) is_wanted[k] = false;
    const std::size_t count = end - first;
    if (!has_both_sides(material)) {
      glEnable(GL_CULL_FACE);
      glCullFace(GL_BACK);
      draw_in_bands(first, count, pass);
    } else if (is_blended && is_slice_deep_) {
      // Far sides before near ones.
      glEnable(GL_CULL_FACE);
      for (const GLenum side : {GLenum{GL_FRONT}, GLenum{GL_BACK}}) {
        glCullFace(side);
        draw_in_bands(first, count, pass);
      }
    } else {
      glDisable(GL_CULL_FACE);
      draw_in_bands(first, count, pass);
    }
  }
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
  draw_ground_depth(camera);

  PassKey pass;
  pass.has_lights = lights_.count > 0;
  pass.has_veils = has_veils_;
  pass.is_in_body = body_.has_value();
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
  pass.has_sheen_light = gpu_.has_lobe(shade::kLobesOfFibres);
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

std::vector<std::size_t> Renderer::all_draws() const {
  std::vector<std::size_t> all(gpu_.draws().size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const auto rank = [&](std::size_t i) {
    const GpuMaterial& material = gpu_.material_of(gpu_.draws()[i]);
    return material.is_blended() ? 2 : material.is_transmissive() ? 1 : 0;
  };
  std::stable_sort(all.begin(), all.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
  return all;
}

void Renderer::draw_quantity(Quantity quantity, const FrameCamera& camera) {
  PassKey pass;
  pass.has_lights = lights_.count > 0;
  pass.quantity = quantity;
  if (quantity == Quantity::overdraw) {
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
  }
  draw_surfaces(all_draws(), pass, camera);
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
}

}  // namespace candela::raster
