#include "raster/lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "ibl/source.h"
#include "math/box.h"
#include "scene/environment.h"
#include "scene/view.h"
#include "shade/lights.glsl.h"
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

LightType type_of(const Entry& e) { return static_cast<LightType>(e.light.kind); }

float peak(const IesProfile& profile) { return *std::max_element(profile.candela.begin(), profile.candela.end()); }

Entry punctual(const Scene& scene, const Node& node, const GpuScene& gpu) {
  const Light& light = scene.lights[static_cast<std::size_t>(node.light)];
  const mat4 world = gpu.relative(node.world_from_node);
  const auto unit = [](vec3 v, vec3 otherwise) {
    const float length = glm::length(v);
    return length > 0.0f ? v / length : otherwise;
  };
  const vec3 along = transform_vector(world, {1, 0, 0});
  const bool has_profile = light.type == LightType::point && light.ies >= 0;
  vec3 color = light.color * light.intensity;
  // Profiles are stored over their largest value, so that half floats hold them.
  if (has_profile) color *= peak(scene.ies_profiles[static_cast<std::size_t>(light.ies)]);
  Entry e;
  static_assert(static_cast<int>(LightType::point) == shade::kPointLight &&
                static_cast<int>(LightType::spot) == shade::kSpotLight &&
                static_cast<int>(LightType::directional) == shade::kDirectionalLight);
  e.light.position = vec3(world[3]);
  e.light.kind = static_cast<int>(light.type);
  e.light.direction = unit(transform_vector(world, {0, 0, -1}), {0, 0, -1});
  e.light.range = light.range;
  e.light.color = color;
  e.light.falloff = static_cast<int>(light.falloff);
  e.light.cos_inner = std::cos(light.inner_cone), e.light.cos_outer = std::cos(light.outer_cone);
  e.light.polynomial = light.polynomial;
  e.light.profile = has_profile ? light.ies : -1;
  e.light.across = unit(along - e.light.direction * glm::dot(along, e.light.direction), {1, 0, 0});
  e.light.handedness = glm::determinant(mat3(world)) < 0.0f ? -1.0f : 1.0f;
  e.half_angle = light.outer_cone;
  const vec3 to_middle = gpu.bounds().empty() ? vec3(1, 0, 0) : gpu.bounds().center() - e.light.position;
  e.strength = luminance(color);
  if (light.type != LightType::directional) e.strength /= std::max(glm::dot(to_middle, to_middle), 1e-12f);
  return e;
}

Entry sun_light(const SunDisc& sun) {
  Entry e;
  e.light.kind = static_cast<int>(LightType::directional);
  e.light.direction = -sun.direction;
  e.light.color = sun.radiance * static_cast<float>(ibl::disc_solid_angle(sun));
  e.light.sun_radius = std::tan(sun.angular_radius);
  e.strength = luminance(e.light.color);
  e.half_angle = sun.angular_radius;
  e.is_sun = true;
  return e;
}

mat4 light_from_world(vec3 position, vec3 direction) {
  mat4 m = glm::transpose(look_at(vec3(0.0f), direction, 1.0f).world_from_camera);
  m[3] = m * vec4(-position, 1.0f);
  return m;
}

/// Of the distance to what is farthest away, where a shadow map begins: depth is as fine at any distance from there.
constexpr float kNearest = 1e-8f;

/// A view along a cone from a point, whose half angle has this tangent. What is nearer than `least` casts no shadow.
void add_cone(SceneLights& lights, vec3 position, vec3 direction, float tangent, const Box3& bounds, float least) {
  float far = 0.0f;
  for (const vec3& c : corners(bounds)) far = std::max(far, glm::length(c - position));
  ShadowEntry& shadow = lights.block.shadows[static_cast<std::size_t>(lights.shadow_count++)];
  shadow.near = std::max({kNearest * far, least, std::numeric_limits<float>::min()});
  shadow.far = far;
  shadow.texel = 2.0f * tangent / static_cast<float>(lights.shadow_size);
  shadow.is_perspective = 1;
  mat4 projection(0.0f);
  projection[0][0] = projection[1][1] = 1.0f / tangent;
  projection[2][3] = -1.0f;
  projection[3][2] = shadow.near;
  shadow.from_world = projection * light_from_world(position, direction);
}

/// A view along parallel rays into a box (light space); what casts into it may stand before it.
void add_box(SceneLights& lights, const mat4& from_world, Box3 box) {
  const vec3 margin = vec3(0.02f * std::max(box.size().x, box.size().y) + std::numeric_limits<float>::min());
  box.lower -= margin, box.upper += margin;
  const vec3 size = box.size(), center = box.center();
  ShadowEntry& shadow = lights.block.shadows[static_cast<std::size_t>(lights.shadow_count++)];
  shadow.near = -box.upper.z, shadow.far = -box.lower.z;
  shadow.texel = std::max(size.x, size.y) / static_cast<float>(lights.shadow_size);
  mat4 projection(1.0f);
  projection[0][0] = 2.0f / size.x, projection[1][1] = 2.0f / size.y, projection[2][2] = 1.0f / size.z;
  projection[3] = {-center.x * projection[0][0], -center.y * projection[1][1], -box.lower.z / size.z, 1.0f};
  shadow.from_world = projection * from_world;
}

/// Cascades: slices of what the camera sees of the scene, each in a box along the light; the last holds everything.
void add_cascades(SceneLights& lights, vec3 direction, const Box3& bounds, const FrameCamera& camera, int count) {
  const mat4 from_world = light_from_world(vec3(0.0f), direction);
  Box3 all;
  for (const vec3& c : corners(bounds)) all.extend(transform_point(from_world, c));
  const float far = camera.range.far, near = std::max(camera.range.near, 1e-5f * far);
  for (int slice = 0; slice + 1 < count; ++slice) {
    const float end = near * std::pow(far / near, static_cast<float>(slice + 1) / static_cast<float>(count));
    Box3 seen;
    for (int i = 0; i < 8; ++i) {
      const vec2 ndc((i & 1) != 0 ? 1.05f : -1.05f, (i & 2) != 0 ? 1.05f : -1.05f);
      const vec3 corner = camera.at_depth(ndc, (i & 4) != 0 ? end : near);
      seen.extend(transform_point(from_world, transform_point(camera.world_from_camera, corner)));
    }
    const Box3 box{glm::max(all.lower, seen.lower), glm::min(all.upper, seen.upper)};
    const bool is_empty = !(box.lower.x < box.upper.x && box.lower.y < box.upper.y && box.lower.z <= box.upper.z);
    add_box(lights, from_world, is_empty ? all : box);
  }
  add_box(lights, from_world, all);
}

/// In the order in which the shader chooses a face: the axis that points from the light to the surface.
void add_six(SceneLights& lights, vec3 position, const Box3& bounds, float least = 0.0f) {
  for (const vec3& axis :
       {vec3(1, 0, 0), vec3(-1, 0, 0), vec3(0, 1, 0), vec3(0, -1, 0), vec3(0, 0, 1), vec3(0, 0, -1)}) {
    // A little more than a right angle, for filters at the edges.
    add_cone(lights, position, axis, 1.02f, bounds, least);
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

SceneLights collect_lights(const Scene& scene, const Environment& environment, const GpuScene& gpu,
                           const FrameCamera& camera, LightPoint point, float radius, int more_views,
                           Diagnostics& diagnostics) {
  const Box3& bounds = gpu.bounds();
  std::vector<Entry> entries;
  for (const Node& node : scene.nodes) {
    if (node.light >= 0) entries.push_back(punctual(scene, node, gpu));
  }
  for (const SunDisc& sun : world_suns(environment)) entries.push_back(sun_light(sun));
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
  constexpr int kMostTexels = 48 << 20;
  int wanted = 0;
  for (const Entry& e : entries) wanted += views_of(e);
  lights.shadow_size = wanted > 0 && wanted <= 8 ? 2048 : 1024;
  wanted = std::min(wanted + more_views, kMostShadows);
  while (wanted * lights.shadow_size * lights.shadow_size > kMostTexels) lights.shadow_size /= 2;
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
      const vec3 position = e.light.position + (is_directional ? vec3(0.0f) : radius * point_of_ball(point));
      const vec3 direction =
          is_directional && e.is_sun ? point_of_disc(e.light.direction, e.half_angle, point) : e.light.direction;
      e.light.first_shadow = lights.shadow_count;
      e.light.shadow_count = views;
      switch (type_of(e)) {
        case LightType::point:
          add_six(lights, position, bounds);
          break;
        case LightType::spot:
          add_cone(lights, position, direction, std::tan(0.5f * std::min(2.0f * e.half_angle, kWidestSpot)) * 1.01f,
                   bounds, 0.0f);
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

int shadow_views(const AreaEntry& area) { return area.is_body != 0 ? 6 : area.has_two_sides != 0 ? 2 : 1; }

bool add_area_shadows(SceneLights& lights, AreaEntry& area, vec3 from, const Box3& bounds) {
  constexpr float kWide = 4.5f;  // tangent of half of 155 degrees
  const int views = shadow_views(area);
  if (bounds.empty()) return true;
  if (lights.shadow_count + views > kMostShadows) return false;
  area.first_shadow = lights.shadow_count;
  area.shadow_count = views;
  // What touches a lamp is part of it.
  const float least = 1e-3f * area.radius;
  if (area.is_body != 0) {
    add_six(lights, from, bounds, least);
  } else {
    const vec3 normal = glm::normalize(glm::cross(area.corner_1 - area.corner_0, area.corner_2 - area.corner_0));
    add_cone(lights, from, normal, kWide, bounds, least);
    if (views == 2) add_cone(lights, from, -normal, kWide, bounds, least);
  }
  return true;
}

void remove_shadows(SceneLights& lights) {
  lights.shadow_count = 0;
  lights.shadow_owner.fill(-1);
  for (LightEntry& light : lights.block.lights) light.first_shadow = -1, light.shadow_count = 0;
  for (AreaEntry& area : lights.block.areas) area.first_shadow = -1, area.shadow_count = 0;
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
