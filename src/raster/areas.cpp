#include "raster/areas.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "raster/opacity.h"
#include "shade/color.glsl.h"

namespace candela::raster {

namespace {

constexpr float kFlat = 0.98f;           // of the area that a panel shows to its front
constexpr std::size_t kMostEdges = 256;  // that a rectangle is tried along

struct Panel {
  std::vector<vec3> positions;  ///< world
  const std::vector<uvec3>* triangles = nullptr;
  vec3 facing{0.0f};  ///< sum of area vectors
  float area = 0.0f;
  vec3 center{0.0f};  ///< of the area
};

Panel make_panel(const Primitive& primitive, const mat4& world_from_node) {
  Panel panel;
  panel.triangles = &primitive.triangles;
  for (const vec3& p : primitive.positions) panel.positions.push_back(transform_point(world_from_node, p));
  const bool is_mirrored = glm::determinant(mat3(world_from_node)) < 0.0f;
  for (const uvec3& t : primitive.triangles) {
    const vec3 a = panel.positions[t.x], b = panel.positions[t.y], c = panel.positions[t.z];
    const vec3 twice = glm::cross(b - a, c - a) * (is_mirrored ? -1.0f : 1.0f);
    panel.facing += 0.5f * twice;
    const float area = 0.5f * glm::length(twice);
    panel.area += area;
    panel.center += (a + b + c) * (area / 3.0f);
  }
  if (panel.area > 0.0f) panel.center /= panel.area;
  return panel;
}

/// The smallest rectangle in the panel's plane along one of its edges, scaled to the panel's own area.
std::array<vec3, 4> rectangle(const Panel& panel) {
  const vec3 normal = glm::normalize(panel.facing);
  float least = kInfinity;
  std::array<vec3, 4> best{};
  std::size_t tried = 0;
  for (const uvec3& t : *panel.triangles) {
    for (int i = 0; i < 3 && tried < kMostEdges; ++i, ++tried) {
      vec3 x = panel.positions[t[(i + 1) % 3]] - panel.positions[t[i]];
      x -= normal * glm::dot(x, normal);
      if (glm::dot(x, x) <= 0.0f) continue;
      x = glm::normalize(x);
      const vec3 y = glm::cross(normal, x);
      vec2 low(kInfinity), high(-kInfinity);
      for (const vec3& p : panel.positions) {
        const vec2 q(glm::dot(p - panel.center, x), glm::dot(p - panel.center, y));
        low = glm::min(low, q), high = glm::max(high, q);
      }
      const vec2 size = high - low;
      if (!(size.x * size.y < least)) continue;
      least = size.x * size.y;
      const vec3 middle = panel.center + x * (0.5f * (low.x + high.x)) + y * (0.5f * (low.y + high.y));
      const float scale = std::sqrt(panel.area / std::max(least, 1e-30f));
      const vec3 ex = x * (0.5f * size.x * scale), ey = y * (0.5f * size.y * scale);
      best = {middle - ex - ey, middle + ex - ey, middle + ex + ey, middle - ex + ey};
    }
  }
  return best;
}

/// Mean of the emissive texture over the surface, by a few points of each triangle.
vec3 mean_texel(const Scene& scene, const Primitive& primitive, const TextureSlot& slot) {
  const Texture& texture = scene.textures[static_cast<std::size_t>(slot.texture)];
  const TextureImage& image = *scene.images[static_cast<std::size_t>(texture.image)];
  const auto& uvs = primitive.uvs[static_cast<std::size_t>(slot.uv_set)];
  if (image.pixels.empty() || uvs.empty()) return vec3(1.0f);
  const std::size_t bytes = image.bits == 16 ? 2 : 1;
  const auto channel = [&](std::size_t texel, std::size_t c) {
    const std::size_t at = (texel * 4 + c) * bytes;
    const float v = bytes == 1 ? static_cast<float>(image.pixels[at]) / 255.0f
                               : static_cast<float>(image.pixels[at] | image.pixels[at + 1] << 8) / 65535.0f;
    return shade::srgb_decode_channel(v);
  };
  constexpr int kSide = 12;
  vec3 sum(0.0f);
  float weight = 0.0f;
  for (const uvec3& t : primitive.triangles) {
    const vec3 a = primitive.positions[t.x];
    const float area = glm::length(glm::cross(primitive.positions[t.y] - a, primitive.positions[t.z] - a));
    for (int i = 0; i < kSide; ++i) {
      for (int j = 0; i + j < kSide; ++j) {
        const vec2 b = (vec2(i, j) + 1.0f / 3.0f) / static_cast<float>(kSide);
        const vec2 uv = glm::fract(slot.apply(uvs[t.x] * (1.0f - b.x - b.y) + uvs[t.y] * b.x + uvs[t.z] * b.y));
        const auto x = static_cast<std::size_t>(
            std::min(static_cast<int>(uv.x * static_cast<float>(image.width)), image.width - 1));
        const auto y = static_cast<std::size_t>(
            std::min(static_cast<int>(uv.y * static_cast<float>(image.height)), image.height - 1));
        const std::size_t texel = y * static_cast<std::size_t>(image.width) + x;
        sum += area * vec3(channel(texel, 0), channel(texel, 1), channel(texel, 2));
        weight += area;
      }
    }
  }
  return weight > 0.0f ? sum / weight : vec3(1.0f);
}

/// Nothing where the draw does not glow or cannot be said in so few words.
std::vector<AreaLight> glowing_draws(const Scene& scene, const GpuScene& gpu) {
  std::vector<AreaLight> all;
  for (std::size_t i = 0; i < gpu.draws().size(); ++i) {
    const Draw& draw = gpu.draws()[i];
    const Node& node = scene.nodes[static_cast<std::size_t>(draw.node)];
    const Primitive& primitive = scene.meshes[static_cast<std::size_t>(node.mesh)].primitives[draw.part];
    const Material& material = scene.materials[static_cast<std::size_t>(primitive.material)];
    if (max_component(material.emission) <= 0.0f || material.unlit) continue;
    const Panel panel = make_panel(primitive, node.world_from_node);
    const bool is_flat = glm::length(panel.facing) > kFlat * panel.area;
    // Lamps painted on a body are small beside it, and nobody knows where.
    if (panel.area <= 0.0f || (material.emissive_texture && !is_flat)) continue;
    AreaLight c;
    c.draw = i;
    vec3 color = material.emission;
    if (material.emissive_texture) color *= mean_texel(scene, primitive, material.emissive_texture);
    color *= mean_opacity(scene, primitive, material);
    c.entry.color = vec4(color, 0.0f);
    if (is_flat) {
      std::array<vec3, 4> corners = rectangle(panel);
      if (primitive.triangles.size() == 1) {
        const uvec3& t = primitive.triangles[0];
        corners = {panel.positions[t.x], panel.positions[t.y], panel.positions[t.z], panel.positions[t.x]};
      }
      if (glm::dot(glm::cross(corners[1] - corners[0], corners[2] - corners[0]), panel.facing) < 0.0f) {
        std::swap(corners[1], corners[3]);
      }
      for (std::size_t k = 0; k < 4; ++k) c.entry.corners[k] = vec4(corners[k], 0.0f);
    } else {
      c.entry.corners[0] = vec4(panel.center, 0.0f);
      c.entry.corners[1] = vec4(0.5f * std::sqrt(0.25f * panel.area));
    }
    const float seen = is_flat ? panel.area : 0.25f * panel.area;
    c.entry.corners[0].w = std::sqrt(seen / kPi);
    c.entry.shape = {is_flat ? 0.0f : 1.0f, material.double_sided ? 1.0f : 0.0f, -1.0f, 0.0f};
    c.power = luminance(color) * seen;
    if (c.power > 0.0f) all.push_back(c);
  }
  return all;
}

}  // namespace

std::vector<AreaLight> find_areas(const Scene& scene, const GpuScene& gpu, Diagnostics& diagnostics) {
  std::vector<AreaLight> all = glowing_draws(scene, gpu);
  std::stable_sort(all.begin(), all.end(), [](const AreaLight& a, const AreaLight& b) { return a.power > b.power; });
  if (all.size() > kMostAreas) {
    diagnostics.warn("of " + std::to_string(all.size()) + " glowing surfaces the strongest " +
                         std::to_string(kMostAreas) + " light others; the path tracer has no such limit",
                     scene.name);
    all.resize(kMostAreas);
  }
  return all;
}

void add_areas(const std::vector<AreaLight>& areas, const Box3& bounds, LightPoint point, SceneLights& lights) {
  for (const AreaLight& area : areas) {
    AreaEntry entry = area.entry;
    const auto& k = entry.corners;
    if (entry.shape.x > 0.5f) {
      add_point_shadows(lights, vec3(k[0]) + k[0].w * point_of_ball(point), bounds, entry.shape);
    } else {
      const vec3 low = glm::mix(vec3(k[0]), vec3(k[1]), point.x), high = glm::mix(vec3(k[3]), vec3(k[2]), point.x);
      const vec3 center = glm::mix(low, high, point.y);
      const vec3 normal = glm::normalize(glm::cross(vec3(k[1] - k[0]), vec3(k[2] - k[0])));
      add_panel_shadows(lights, center, normal, entry.shape.y > 0.5f, bounds, entry.shape);
    }
    const auto first = static_cast<int>(entry.shape.z), count = static_cast<int>(entry.shape.w);
    for (int s = first; s >= 0 && s < first + count; ++s) {
      lights.shadow_owner[static_cast<std::size_t>(s)] = lights.area_count;
    }
    lights.block.areas[static_cast<std::size_t>(lights.area_count++)] = entry;
  }
}

}  // namespace candela::raster
