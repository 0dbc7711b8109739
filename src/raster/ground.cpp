#include "raster/ground.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "math/distribution.h"
#include "math/frame.h"
#include "raster/targets.h"
#include "scene/environment.h"
#include "scene/lamp.h"

namespace candela::raster {

namespace {

constexpr int kTexels = 768;     // along an edge of the picture of the ground
constexpr float kReach = 3.0f;   // half an edge, in radii of the subject
constexpr float kFade = 0.15f;   // of half an edge
constexpr int kLayers = 8;       // shadows that are added in one pass; as in ground.frag.glsl
constexpr int kFarBeams = 128;   // of a map
constexpr int kDiscBeams = 16;   // of a sun, or of a ball
constexpr float kLevel = 0.01f;  // least height of light, as a sine: lower light is level

/// Light from one direction or place.
struct Beam {
  vec4 from{0.0f};    ///< towards the light, w = 0; or a place in the world, w = 1
  vec3 weight{1.0f};  ///< of the ground's light
  int lamp = -1;      ///< whose weight differs from place to place; -1 = light from far away
};

/// Points of a square that fill it evenly, see lattice_point in render.cpp: powers of the root of x³ = x + 1.
vec2 square_point(int i) {
  return {static_cast<float>(std::fmod(0.5 + 0.7548776662466927 * i, 1.0)),
          static_cast<float>(std::fmod(0.5 + 0.5698402909980532 * i, 1.0))};
}

vec2 disc_point(int i) {
  const vec2 u = square_point(i);
  return std::sqrt(u.x) * vec2(std::cos(2.0f * kPi * u.y), std::sin(2.0f * kPi * u.y));
}

/// The upper half of the map in cells, each with what it gives to the ground.
void add_map_beams(const Environment& environment, std::vector<Beam>& beams) {
  constexpr int kWidth = 128, kHeight = 32;
  std::vector<vec3> flux(std::size_t{kWidth} * kHeight, vec3(0.0f));
  const int width = environment.map ? environment.map->width : kWidth;
  const int height = environment.map ? environment.map->height : 2 * kHeight;
  for (int y = 0; y < (height + 1) / 2; ++y) {
    const float polar = kPi * (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
    const float weight = std::max(std::cos(polar), 0.0f) * map_solid_angle(y, width, height);
    const auto row = static_cast<std::size_t>(std::min(2 * y * kHeight / height, kHeight - 1));
    for (int x = 0; x < width; ++x) {
      const vec3 radiance = environment.constant + (environment.map ? environment.map->rgb(x, y) : vec3(0.0f));
      flux[row * kWidth + static_cast<std::size_t>(x) * kWidth / static_cast<std::size_t>(width)] += radiance * weight;
    }
  }
  std::vector<float> luminances(flux.size());
  std::transform(flux.begin(), flux.end(), luminances.begin(), [](vec3 v) { return luminance(v); });
  const Distribution2D distribution(luminances, kWidth, kHeight);
  if (!(distribution.total() > 0.0)) return;
  const float c = std::cos(environment.rotation), s = std::sin(environment.rotation);
  for (int i = 0; i < kFarBeams; ++i) {
    const Distribution2D::Sample sample = distribution.sample(square_point(i));
    const auto cell = static_cast<std::size_t>(sample.cell.y) * kWidth + static_cast<std::size_t>(sample.cell.x);
    const vec3 d = map_direction(sample.uv.x * kWidth, sample.uv.y * kHeight, kWidth, 2 * kHeight);
    const float chance = luminances[cell] / static_cast<float>(distribution.total());
    beams.push_back({vec4(c * d.x + s * d.z, d.y, -s * d.x + c * d.z, 0.0f),
                     environment.intensity * flux[cell] / (chance * kFarBeams)});
  }
}

void add_sun_beams(const Environment& environment, std::vector<Beam>& beams) {
  for (const SunDisc& sun : world_suns(environment)) {
    const Frame frame = frame_from_normal(glm::normalize(sun.direction));
    const float sine = std::sin(sun.angular_radius);
    for (int i = 0; i < kDiscBeams; ++i) {
      const vec2 p = disc_point(i) * sine;
      const vec3 direction = frame.to_world({p.x, p.y, std::sqrt(std::max(1.0f - glm::dot(p, p), 0.0f))});
      const float share = kPi * sine * sine / kDiscBeams;
      beams.push_back({vec4(direction, 0.0f), sun.radiance * (share * std::max(direction.y, 0.0f))});
    }
  }
}

/// The k-th lamp: parallel light is as good as a sun's, what has a place is weighted where it arrives.
void add_lamp_beams(const PlacedLamp& lamp, int k, float radius, std::vector<Beam>& beams) {
  if (lamp.lamp.kind == shade::kDirectionalLight) {
    const vec3 direction = -lamp.lamp.direction;
    beams.push_back({vec4(direction, 0.0f), lamp.intensity * std::max(direction.y, 0.0f)});
    return;
  }
  const int count = radius > 0.0f ? kDiscBeams : 1;
  for (int i = 0; i < count; ++i) {
    // Of a ball, the disc that the ground below sees.
    const vec2 p = radius > 0.0f ? disc_point(i) * radius : vec2(0.0f);
    beams.push_back({vec4(lamp.position + vec3(p.x, 0.0f, p.y), 1.0f), vec3(1.0f / static_cast<float>(count)), k});
  }
}

/// Takes what is above the ground along the light to the ground, and `corner` … `corner + size` to the picture; depth
/// is 1 on the ground and below 1 above it. All relative to the scene's origin.
mat4 ground_from_relative(vec4 from, vec2 middle, float half, float height, float top) {
  mat4 m(0.0f);
  if (from.w == 0.0f) {
    const vec2 slope = vec2(from.x, from.z) / from.y;
    const float depth = 2.0f / std::max(1.05f * (top - height), 1e-30f);
    m[0] = {1.0f / half, 0.0f, 0.0f, 0.0f};
    m[1] = {-slope.x / half, -slope.y / half, -depth, 0.0f};
    m[2] = {0.0f, 1.0f / half, 0.0f, 0.0f};
    m[3] = {(slope.x * height - middle.x) / half, (slope.y * height - middle.y) / half, 1.0f + depth * height, 1.0f};
    return m;
  }
  // x' = L.x + (P.x - L.x) (L.y - h) / (L.y - P.y), and w = L.y - P.y.
  constexpr float kDepth = 1e-3f;
  const float above = from.y - height;
  m[0] = {above / half, 0.0f, 0.0f, 0.0f};
  m[1] = {-(from.x - middle.x) / half, -(from.z - middle.y) / half, -1.0f - kDepth, -1.0f};
  m[2] = {0.0f, above / half, 0.0f, 0.0f};
  m[3] = {((from.x - middle.x) * from.y - from.x * above) / half,
          ((from.z - middle.y) * from.y - from.z * above) / half, from.y + kDepth * height, from.y};
  return m;
}

/// What the driver draws shadows into.
class ShadowLayers {
 public:
  explicit ShadowLayers(bool has_veils) : has_veils_(has_veils) {
    glBindTexture(GL_TEXTURE_2D_ARRAY, depths_);
    glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_DEPTH_COMPONENT32F, kTexels, kTexels, kLayers, 0, GL_DEPTH_COMPONENT,
                 GL_FLOAT, nullptr);
    nearest_texels(GL_TEXTURE_2D_ARRAY);
    const int veils = has_veils ? kTexels : 1;
    glBindTexture(GL_TEXTURE_2D_ARRAY, veils_);
    glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_R8, veils, veils, kLayers, 0, GL_RED, GL_UNSIGNED_BYTE, nullptr);
    nearest_texels(GL_TEXTURE_2D_ARRAY);
    glBindTexture(GL_TEXTURE_2D, sum_);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA16F, kTexels, kTexels, 0, GL_RGBA, GL_HALF_FLOAT, nullptr);
    nearest_texels(GL_TEXTURE_2D);
    glBindFramebuffer(GL_FRAMEBUFFER, sum_framebuffer_);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, sum_, 0);
    check_framebuffer("a picture of the ground");
    gl::check("making pictures of the ground");
  }

  /// Draws into one of kLayers, cleared.
  void begin(int layer) {
    glBindFramebuffer(GL_FRAMEBUFFER, layer_framebuffer_);
    glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, depths_, 0, layer);
    if (has_veils_) glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, veils_, 0, layer);
    const GLenum target = has_veils_ ? GL_COLOR_ATTACHMENT0 : GL_NONE;
    glDrawBuffers(1, &target);
    glViewport(0, 0, kTexels, kTexels);
    glClearColor(1.0f, 1.0f, 1.0f, 1.0f);
    glClearDepthf(1.0f);
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glClear(GL_DEPTH_BUFFER_BIT | (has_veils_ ? GL_COLOR_BUFFER_BIT : 0u));
  }

  /// Adds what passes the first layers, each times its weight, to `sum`.
  void add(const std::vector<vec3>& weights, Programs& programs, std::vector<vec3>& sum) {
    glBindFramebuffer(GL_FRAMEBUFFER, sum_framebuffer_);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glBindVertexArray(nothing_);
    const gl::Program& program = programs.fullscreen("ground.frag.glsl", has_veils_ ? "#define HAS_VEILS 1\n" : "");
    glUseProgram(program.id());
    program.bind("depths", GL_TEXTURE_2D_ARRAY, depths_);
    program.bind("veils", GL_TEXTURE_2D_ARRAY, veils_);
    glUniform1i(program.uniform("count"), static_cast<GLint>(weights.size()));
    glUniform3fv(program.uniform("weights"), static_cast<GLsizei>(weights.size()), &weights[0].x);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    const Image part = read_pixels(kTexels, kTexels);
    for (int y = 0; y < kTexels; ++y) {
      // Row 0 of `part` is the last in z.
      for (int x = 0; x < kTexels; ++x) {
        sum[static_cast<std::size_t>(y) * kTexels + static_cast<std::size_t>(x)] += part.rgb(x, kTexels - 1 - y);
      }
    }
    glEnable(GL_DEPTH_TEST);
  }

 private:
  bool has_veils_;
  gl::Texture depths_, veils_, sum_;
  gl::Framebuffer layer_framebuffer_, sum_framebuffer_;
  gl::VertexArray nothing_;
};

bool is_veil(const GpuMaterial& material) { return material.is_blended() && !material.is_transmissive(); }

/// What keeps all light away into depth, then what lets some pass.
void draw_casters(const mat4& clip, const GpuScene& gpu, Programs& programs, bool has_veils) {
  const auto draw = [&](DepthPass pass, const auto& casts) {
    for (std::size_t i = 0, end = 0; i < gpu.draws().size(); i = end) {
      end = i + 1;
      if (!casts(i)) continue;
      while (end < gpu.draws().size() && gpu.are_alike(i, end) && casts(end)) ++end;
      const GpuMaterial& material = gpu.material_of(gpu.draws()[i]);
      const gl::Program& program = programs.depth(material.key, pass);
      glUseProgram(program.id());
      glUniformMatrix4fv(program.uniform("clip_from_world"), 1, GL_FALSE, &clip[0][0]);
      if (material.key.alpha_mode != AlphaMode::opaque) gpu.bind_material(material, program);
      gpu.draw(i, end - i);
    }
  };
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  draw(DepthPass::solid, [&](std::size_t i) {
    const GpuMaterial& material = gpu.material_of(gpu.draws()[i]);
    return !((material.is_blended() && !material.has_opaque_part) || material.is_transmissive());
  });
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  if (has_veils) {
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ZERO, GL_SRC_COLOR);
    draw(DepthPass::passing_veil, [&](std::size_t i) { return is_veil(gpu.material_of(gpu.draws()[i])); });
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
  }
  glDepthFunc(GL_LEQUAL);
}

std::vector<Beam> find_beams(const std::vector<PlacedLamp>& lamps, const Environment& environment, float light_radius) {
  std::vector<Beam> beams;
  add_map_beams(environment, beams);
  add_sun_beams(environment, beams);
  for (std::size_t k = 0; k < lamps.size(); ++k) add_lamp_beams(lamps[k], static_cast<int>(k), light_radius, beams);
  // Parallel beams first, then lamp by lamp.
  std::stable_sort(beams.begin(), beams.end(), [](const Beam& a, const Beam& b) { return a.lamp < b.lamp; });
  return beams;
}

}  // namespace

vec3 GroundShare::at(vec2 xz) const {
  if (share.empty()) return vec3(1.0f);
  const vec2 uv = (xz - corner) / size;
  const vec2 from_middle = glm::abs(2.0f * uv - 1.0f);
  const float edge = std::max(from_middle.x, from_middle.y);
  if (!(edge < 1.0f)) return vec3(1.0f);
  const vec2 p =
      glm::clamp(uv * vec2(share.width, share.height) - 0.5f, vec2(0.0f), vec2(share.width - 1, share.height - 1));
  const ivec2 low(p);
  const ivec2 high = glm::min(low + 1, ivec2(share.width - 1, share.height - 1));
  const vec2 t = p - vec2(low);
  const vec3 upper = glm::mix(share.rgb(low.x, low.y), share.rgb(high.x, low.y), t.x);
  const vec3 lower = glm::mix(share.rgb(low.x, high.y), share.rgb(high.x, high.y), t.x);
  return glm::mix(glm::mix(upper, lower, t.y), vec3(1.0f), std::clamp((edge - 1.0f + kFade) / kFade, 0.0f, 1.0f));
}

GroundShare draw_ground_share(const Scene& scene, const Environment& environment, float light_radius,
                              const GpuScene& gpu, Programs& programs) {
  GroundShare result;
  const Box3& box = gpu.bounds();
  result.height = scene.ground->height;
  const float height = result.height - gpu.origin().y;
  if (box.empty() || box.upper.y <= height) return result;
  const vec2 middle(box.center().x, box.center().z);
  const float half = kReach * std::max(0.5f * glm::length(box.size()), 1e-6f);
  result.size = 2.0f * half;
  result.corner = middle + vec2(gpu.origin().x, gpu.origin().z) - half;

  std::vector<PlacedLamp> lamps;
  for (const Node& node : scene.nodes) {
    if (node.light >= 0) lamps.push_back(placed_lamp(scene, node));
  }
  const std::vector<Beam> beams = find_beams(lamps, environment, light_radius);

  // ----- what passes of each beam, and what there is without the scene
  constexpr std::size_t kCount = std::size_t{kTexels} * kTexels;
  std::vector<vec3> left(kCount, vec3(0.0f)), all(kCount, vec3(0.0f));
  const bool has_veils =
      std::any_of(gpu.draws().begin(), gpu.draws().end(), [&](const Draw& d) { return is_veil(gpu.material_of(d)); });
  ShadowLayers layers(has_veils);
  const auto point_of = [&](std::size_t i) {
    const std::size_t row = i / kTexels;
    const vec2 texel(i % kTexels, row);
    const vec2 xz = result.corner + result.size * (texel + 0.5f) / static_cast<float>(kTexels);
    return vec3(xz.x, result.height, xz.y);
  };
  for (std::size_t first = 0, end = 0; first < beams.size(); first = end) {
    std::vector<vec3> weights;
    const int lamp = beams[first].lamp;
    vec3 total(0.0f);
    for (end = first; end < beams.size() && beams[end].lamp == lamp && end - first < kLayers; ++end) {
      const Beam& beam = beams[end];
      const vec4 from = beam.from - (beam.from.w != 0.0f ? vec4(gpu.origin(), 0.0f) : vec4(0.0f));
      layers.begin(static_cast<int>(end - first));
      const float rise = beam.from.w != 0.0f ? from.y - height : from.y;
      if (rise > (beam.from.w != 0.0f ? 0.0f : kLevel)) {
        draw_casters(ground_from_relative(from, middle, half, height, box.upper.y), gpu, programs, has_veils);
      }
      weights.push_back(beam.weight);
      total += beam.weight;
    }
    // Halves do not hold the sun.
    const float brightest = std::max(max_component(total), 1e-30f);
    for (vec3& weight : weights) weight /= brightest;
    std::vector<vec3> passing(kCount, vec3(0.0f));
    layers.add(weights, programs, passing);
    for (std::size_t i = 0; i < kCount; ++i) {
      vec3 scale(brightest);
      if (lamp >= 0) {
        const ArrivingLight light = arriving_light(lamps[static_cast<std::size_t>(lamp)], point_of(i));
        scale *= light.irradiance * std::max(light.direction.y, 0.0f);
      }
      left[i] += scale * passing[i];
      all[i] += scale * total / brightest;
    }
  }

  result.share = Image(kTexels, kTexels, 3);
  for (std::size_t i = 0; i < kCount; ++i) {
    for (int c = 0; c < 3; ++c) {
      result.share.pixels[3 * i + static_cast<std::size_t>(c)] = all[i][c] > 0.0f ? left[i][c] / all[i][c] : 1.0f;
    }
  }
  gl::check("drawing shadows on the ground");
  return result;
}

Environment environment_over_ground(const Environment& environment, const Ground& ground) {
  Environment result = environment;
  const vec3 from_ground = ground.color / kPi * irradiance_from_above(environment);
  const int width = environment.map ? environment.map->width : 64;
  const int height = environment.map ? environment.map->height : 32;
  auto map = std::make_shared<Image>(width, height, 3);
  const float intensity = environment.intensity > 0.0f ? environment.intensity : 1.0f;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const vec3 above = environment.constant + (environment.map ? environment.map->rgb(x, y) : vec3(0.0f));
      map->set_rgb(x, y, 2 * y < height ? above : from_ground / intensity);
    }
  }
  result.map = std::move(map);
  result.backdrop = nullptr;
  result.constant = vec3(0.0f);
  std::erase_if(result.suns, [](const SunDisc& sun) { return sun.direction.y <= -std::sin(sun.angular_radius); });
  return result;
}

View mirrored_view(const View& view, float height) {
  mat4 mirror(1.0f);
  mirror[1][1] = -1.0f;
  mirror[3][1] = 2.0f * height;
  mat4 upside_down(1.0f);
  upside_down[1][1] = -1.0f;
  View result = view;
  result.world_from_camera = mirror * view.world_from_camera * upside_down;
  return result;
}

GroundSight::Ray GroundSight::ray(int x, int y) const {
  const vec2 ndc(2.0f * (static_cast<float>(x) + 0.5f) / static_cast<float>(size_.x) - 1.0f,
                 1.0f - 2.0f * (static_cast<float>(y) + 0.5f) / static_cast<float>(size_.y));
  const mat4& world = camera_.world_from_camera;
  if (!camera_.is_perspective) {
    return {transform_point(world, camera_.at_depth(ndc, 0.0f)), -glm::normalize(vec3(world[2]))};
  }
  return {camera_.eye, glm::normalize(transform_vector(world, camera_.at_depth(ndc, 1.0f)))};
}

std::optional<vec2> GroundSight::at(int x, int y) const {
  const Ray r = ray(x, y);
  if (!(r.direction.y < 0.0f) || r.origin.y <= height_) return std::nullopt;
  const vec3 p = r.origin + r.direction * ((height_ - r.origin.y) / r.direction.y);
  return vec2(p.x, p.z);
}

}  // namespace candela::raster
