#include "raster/lights.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "ibl/source.h"
#include "scene/view.h"
#include "shade/surface_base.glsl.h"

namespace candela::raster {

namespace {

constexpr int kCascades = 4;
constexpr float kWidestSpot = 2.9f;  // radians; a shadow map sees no more

struct Entry {
  LightEntry light;
  float strength = 0.0f;  ///< illuminance at the scene's middle, lux
  float half_angle = 0.0f;
  bool is_sun = false;
};

LightType type_of(const Entry& e) { return static_cast<LightType>(static_cast<int>(e.light.position.w)); }

float peak(const IesProfile& profile) { return *std::max_element(profile.candela.begin(), profile.candela.end()); }

Entry punctual(const Scene& scene, const Node& node, const Box3& bounds) {
  const Light& light = scene.lights[static_cast<std::size_t>(node.light)];
  const mat4& world = node.world_from_node;
  const auto unit = [](vec3 v, vec3 otherwise) {
    const float length = glm::length(v);
    return length > 0.0f ? v / length : otherwise;
  };
  const vec3 direction = unit(transform_vector(world, {0, 0, -1}), {0, 0, -1});
  const vec3 along = transform_vector(world, {1, 0, 0});
  const vec3 across = unit(along - direction * glm::dot(along, direction), {1, 0, 0});
  const bool has_profile = light.type == LightType::point && light.ies >= 0;
  vec3 color = light.color * light.intensity;
  // Profiles are stored over their largest value, so that half floats hold them.
  if (has_profile) color *= peak(scene.ies_profiles[static_cast<std::size_t>(light.ies)]);
  Entry e;
  static_assert(static_cast<int>(LightType::point) == 0 && static_cast<int>(LightType::spot) == 1 &&
                static_cast<int>(LightType::directional) == 2);
  e.light.position = vec4(vec3(world[3]), static_cast<float>(light.type));
  e.light.direction = vec4(direction, light.range);
  e.light.color = vec4(color, static_cast<float>(light.falloff));
  e.light.cone = {std::cos(light.inner_cone), std::cos(light.outer_cone), -1.0f, 0.0f};
  e.light.polynomial = vec4(light.polynomial, has_profile ? static_cast<float>(light.ies) : -1.0f);
  e.light.across = vec4(across, glm::determinant(mat3(world)) < 0.0f ? -1.0f : 1.0f);
  e.half_angle = light.outer_cone;
  const vec3 to_middle = bounds.empty() ? vec3(1, 0, 0) : bounds.center() - vec3(world[3]);
  e.strength = luminance(color);
  if (light.type != LightType::directional) e.strength /= std::max(glm::dot(to_middle, to_middle), 1e-6f);
  return e;
}

Entry sun_light(const SunDisc& sun) {
  Entry e;
  const vec3 irradiance = sun.radiance * static_cast<float>(ibl::disc_solid_angle(sun));
  e.light.position.w = static_cast<float>(LightType::directional);
  e.light.direction = vec4(-sun.direction, kInfinity);
  e.light.color = vec4(irradiance, 0.0f);
  e.light.cone.z = -1.0f;
  e.light.polynomial.w = -1.0f;
  e.light.across = {1, 0, 0, 1};
  e.light.cone.x = sun.angular_radius;
  e.strength = luminance(irradiance);
  e.is_sun = true;
  return e;
}

std::array<vec3, 8> corners(const Box3& b) {
  std::array<vec3, 8> all;
  for (std::size_t i = 0; i < 8; ++i) {
    all[i] = {(i & 1) != 0 ? b.upper.x : b.lower.x, (i & 2) != 0 ? b.upper.y : b.lower.y,
              (i & 4) != 0 ? b.upper.z : b.lower.z};
  }
  return all;
}

mat4 light_from_world(vec3 position, vec3 direction) {
  return glm::inverse(look_at(position, position + direction, 1.0f).world_from_camera);
}

/// A view along a cone from a point, whose half angle has this tangent.
void add_cone(SceneLights& lights, vec3 position, vec3 direction, float tangent, const Box3& bounds) {
  const mat4 from_world = light_from_world(position, direction);
  float far = 1e-4f;
  for (const vec3& c : corners(bounds)) far = std::max(far, glm::length(c - position));
  const float near = 1e-3f * far;
  const vec2 extent(tangent * near);
  const auto i = static_cast<std::size_t>(lights.shadow_count++);
  lights.block.shadow_from_world[i] = perspective_projection(-extent, extent, near, far) * from_world;
  lights.block.shadow_texel[i] = {2.0f * tangent / static_cast<float>(lights.shadow_size), 1.0f, near, far};
}

/// Cascades: slices of what the camera sees of the scene, each in a box along the light.
void add_cascades(SceneLights& lights, vec3 direction, const Box3& bounds, const FrameCamera& camera, int count) {
  const mat4 from_world = light_from_world(bounds.center(), direction);
  Box3 all;
  for (const vec3& c : corners(bounds)) all.extend(transform_point(from_world, c));
  // Distances along the view of the scene's nearest and farthest corner.
  vec2 range(kInfinity, 0.0f);
  for (const vec3& c : corners(bounds)) {
    const float depth = glm::dot(camera.eye - c, camera.back);
    range = {std::min(range.x, depth), std::max(range.y, depth)};
  }
  range.x = std::max(range.x, 0.02f * range.y);
  const mat4 world_from_clip = glm::inverse(camera.clip_from_world);
  const auto at_depth = [&](vec2 ndc, float depth) {
    const vec4 far = world_from_clip * vec4(ndc, 1.0f, 1.0f), near = world_from_clip * vec4(ndc, -1.0f, 1.0f);
    const vec3 a = vec3(near) / near.w, b = vec3(far) / far.w;
    const float da = glm::dot(camera.eye - a, camera.back), db = glm::dot(camera.eye - b, camera.back);
    return a + (b - a) * ((depth - da) / (db - da));
  };
  for (int slice = 0; slice < count; ++slice) {
    Box3 box = all;
    if (slice + 1 < count && range.y > range.x) {
      const float near = range.x;
      const float far =
          range.x * std::pow(range.y / range.x, static_cast<float>(slice + 1) / static_cast<float>(count));
      Box3 seen;
      for (int i = 0; i < 8; ++i) {
        const vec2 ndc((i & 1) != 0 ? 1.05f : -1.05f, (i & 2) != 0 ? 1.05f : -1.05f);
        seen.extend(transform_point(from_world, at_depth(ndc, (i & 4) != 0 ? far : near)));
      }
      // What casts into the slice may lie before it along the light.
      box.lower = vec3(glm::max(vec2(all.lower), vec2(seen.lower)), all.lower.z);
      box.upper = vec3(glm::min(vec2(all.upper), vec2(seen.upper)), all.upper.z);
      if (!(box.lower.x < box.upper.x && box.lower.y < box.upper.y)) box = all;
    }
    const vec3 margin = vec3(0.02f * std::max(box.size().x, box.size().y) + 1e-6f);
    box.lower -= margin, box.upper += margin;
    const auto i = static_cast<std::size_t>(lights.shadow_count++);
    lights.block.shadow_from_world[i] =
        orthographic_projection(vec2(box.lower), vec2(box.upper), -box.upper.z, -box.lower.z) * from_world;
    lights.block.shadow_texel[i] = {std::max(box.size().x, box.size().y) / static_cast<float>(lights.shadow_size), 0.0f,
                                    -box.upper.z, -box.lower.z};
  }
}

/// In the order in which the shader chooses a face: the axis that points from the light to the surface.
void add_six(SceneLights& lights, vec3 position, const Box3& bounds) {
  for (const vec3& axis :
       {vec3(1, 0, 0), vec3(-1, 0, 0), vec3(0, 1, 0), vec3(0, -1, 0), vec3(0, 0, 1), vec3(0, 0, -1)}) {
    // A little more than a right angle, for filters at the edges.
    add_cone(lights, position, axis, 1.02f, bounds);
  }
}

/// A direction within a disc about `axis`.
vec3 point_of_disc(vec3 axis, float angular_radius, LightPoint point) {
  const float r = point == LightPoint(0.5f) ? 0.0f : std::tan(angular_radius) * std::sqrt(point.x);
  const vec3 x = shade::shade_tangent(axis);
  const float phi = 2.0f * kPi * point.y;
  return glm::normalize(axis + r * (std::cos(phi) * x + std::sin(phi) * glm::cross(axis, x)));
}

int views_of(const Entry& e) {
  switch (type_of(e)) {
    case LightType::point:
      return 6;
    case LightType::spot:
      return 1;
    case LightType::directional:
      return kCascades;
  }
  return 0;
}

}  // namespace

SceneLights collect_lights(const Scene& scene, const Environment& environment, const Box3& bounds,
                           const FrameCamera& camera, LightPoint point, float radius, Diagnostics& diagnostics) {
  std::vector<Entry> entries;
  for (const Node& node : scene.nodes) {
    if (node.light >= 0) entries.push_back(punctual(scene, node, bounds));
  }
  if (!environment.suns.empty()) {
    Environment suns = environment;
    suns.map = nullptr;
    for (const SunDisc& sun : ibl::make_source(suns).suns) entries.push_back(sun_light(sun));
  }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.strength > b.strength; });
  std::erase_if(entries, [](const Entry& e) { return e.strength <= 0.0f; });
  if (entries.size() > kMostLights) {
    diagnostics.warn("of " + std::to_string(entries.size()) + " lights the strongest " + std::to_string(kMostLights) +
                         " are drawn; the path tracer has no such limit",
                     scene.name);
    entries.resize(kMostLights);
  }

  SceneLights lights;
  lights.shadow_owner.fill(-1);
  int wanted = 0;
  for (const Entry& e : entries) wanted += views_of(e);
  lights.shadow_size = wanted == 0 ? 0 : wanted <= 8 ? 2048 : 1024;
  bool is_short = false;
  for (Entry& e : entries) {
    lights.has_suns |= e.is_sun;
    const int views = views_of(e);
    if (bounds.empty()) {
      // Nothing casts a shadow.
    } else if (lights.shadow_count + views > kMostShadows) {
      is_short = true;
    } else {
      const bool is_directional = type_of(e) == LightType::directional;
      const vec3 position = vec3(e.light.position) + (is_directional ? vec3(0.0f) : radius * point_of_ball(point));
      const vec3 direction = is_directional && e.is_sun ? point_of_disc(vec3(e.light.direction), e.light.cone.x, point)
                                                        : vec3(e.light.direction);
      e.light.cone.z = static_cast<float>(lights.shadow_count);
      e.light.cone.w = static_cast<float>(views);
      switch (type_of(e)) {
        case LightType::point:
          add_six(lights, position, bounds);
          break;
        case LightType::spot:
          add_cone(lights, position, direction, std::tan(0.5f * std::min(2.0f * e.half_angle, kWidestSpot)) * 1.01f,
                   bounds);
          break;
        case LightType::directional:
          add_cascades(lights, direction, bounds, camera, views);
          break;
      }
    }
    lights.block.lights[static_cast<std::size_t>(lights.count++)] = e.light;
  }
  if (is_short) diagnostics.warn("so many lights that the weakest cast no shadow", scene.name);
  return lights;
}

vec3 point_of_ball(LightPoint point) {
  if (point == LightPoint(0.5f)) return vec3(0.0f);
  // A density of 1 / √(1 - r²) per volume; its share within r is (asin r - r √(1 - r²)) / (π / 2).
  float low = 0.0f, high = 1.0f;
  for (int i = 0; i < 24; ++i) {
    const float r = 0.5f * (low + high);
    const float within = (std::asin(r) - r * std::sqrt(1.0f - r * r)) * (2.0f / kPi);
    (within < point.x ? low : high) = r;
  }
  const float z = 2.0f * point.y - 1.0f, phi = 2.0f * kPi * point.z, s = std::sqrt(std::max(1.0f - z * z, 0.0f));
  return low * vec3(s * std::cos(phi), s * std::sin(phi), z);
}

void add_point_shadows(SceneLights& lights, vec3 position, const Box3& bounds, vec4& shape) {
  if (bounds.empty() || lights.shadow_count + 6 > kMostShadows) return;
  if (lights.shadow_size == 0) lights.shadow_size = 1024;
  shape.z = static_cast<float>(lights.shadow_count);
  shape.w = 6.0f;
  add_six(lights, position, bounds);
}

void add_panel_shadows(SceneLights& lights, vec3 center, vec3 normal, bool has_two_sides, const Box3& bounds,
                       vec4& shape) {
  constexpr float kWide = 4.5f;  // tangent of half of 155 degrees
  const int sides = has_two_sides ? 2 : 1;
  if (bounds.empty() || lights.shadow_count + sides > kMostShadows) return;
  if (lights.shadow_size == 0) lights.shadow_size = 1024;
  shape.z = static_cast<float>(lights.shadow_count);
  shape.w = static_cast<float>(sides);
  add_cone(lights, center, normal, kWide, bounds);
  if (has_two_sides) add_cone(lights, center, -normal, kWide, bounds);
}

gl::Texture upload_profiles(const Scene& scene) {
  constexpr int kWidth = 361, kHeight = 181;  // a degree each
  const auto layers = std::max<std::size_t>(scene.ies_profiles.size(), 1);
  std::vector<float> texels(static_cast<std::size_t>(kWidth * kHeight) * layers, 0.0f);
  std::size_t at = 0;
  for (const IesProfile& profile : scene.ies_profiles) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const float vertical = radians(static_cast<float>(y)), horizontal = radians(static_cast<float>(x));
        const float r = std::sin(vertical);
        const vec3 d(r * std::cos(horizontal), r * std::sin(horizontal), -std::cos(vertical));
        texels[at++] = ies_intensity(profile, d) / std::max(peak(profile), 1e-30f);
      }
    }
  }
  gl::Texture texture;
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture);
  glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_R16F, kWidth, kHeight, static_cast<GLsizei>(layers), 0, GL_RED, GL_FLOAT,
               texels.data());
  for (const GLenum which : {GLenum{GL_TEXTURE_MIN_FILTER}, GLenum{GL_TEXTURE_MAG_FILTER}}) {
    glTexParameteri(GL_TEXTURE_2D_ARRAY, which, GL_LINEAR);
  }
  for (const GLenum which : {GLenum{GL_TEXTURE_WRAP_S}, GLenum{GL_TEXTURE_WRAP_T}}) {
    glTexParameteri(GL_TEXTURE_2D_ARRAY, which, GL_CLAMP_TO_EDGE);
  }
  return texture;
}

}  // namespace candela::raster
