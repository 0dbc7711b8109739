#include "raster/areas.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <unordered_map>

#include "math/position_hash.h"
#include "raster/glow.h"

namespace candela::raster {

namespace {

constexpr float kFlat = 0.98f;           // of the area that a panel shows to its front
constexpr std::size_t kMostEdges = 256;  // that a rectangle is tried along
constexpr float kFaintest = 0.02f;       // of the sky's light, what a painted lamp must add to it
constexpr std::size_t kMostToMerge = 256;

/// A part of a draw, relative to a base near by.
struct Panel {
  std::vector<std::array<vec3, 3>> triangles;
  vec3 facing{0.0f};  ///< sum of area vectors
  float area = 0.0f;
  vec3 center{0.0f};  ///< of the area
};

Panel make_panel(const Primitive& primitive, const mat4& world_from_node, const std::vector<std::uint32_t>& part,
                 const glm::dvec3& base) {
  Panel panel;
  const glm::dmat4 world(world_from_node);
  const auto placed = [&](std::uint32_t i) {
    return vec3(glm::dvec3(world * glm::dvec4(primitive.positions[i], 1.0)) - base);
  };
  const bool is_mirrored = glm::determinant(mat3(world_from_node)) < 0.0f;
  for (const std::uint32_t i : part) {
    const uvec3& t = primitive.triangles[i];
    const vec3 a = placed(t.x), b = placed(t.y), c = placed(t.z);
    panel.triangles.push_back({a, b, c});
    const vec3 twice = glm::cross(b - a, c - a) * (is_mirrored ? -1.0f : 1.0f);
    const float area = 0.5f * glm::length(twice);
    panel.facing += 0.5f * twice;
    panel.area += area;
    panel.center += (a + b + c) * (area / 3.0f);
  }
  if (panel.area > 0.0f) panel.center /= panel.area;
  return panel;
}

/// The smallest rectangle in the panel's plane along one of its edges, scaled to an area.
std::array<vec3, 4> rectangle(const Panel& panel, float area) {
  const vec3 normal = glm::normalize(panel.facing);
  float least = kInfinity;
  std::array<vec3, 4> best{};
  std::size_t tried = 0;
  for (const std::array<vec3, 3>& t : panel.triangles) {
    for (std::size_t i = 0; i < 3 && tried < kMostEdges; ++i, ++tried) {
      vec3 x = t[(i + 1) % 3] - t[i];
      x -= normal * glm::dot(x, normal);
      if (glm::dot(x, x) <= 0.0f) continue;
      x = glm::normalize(x);
      const vec3 y = glm::cross(normal, x);
      vec2 low(kInfinity), high(-kInfinity);
      for (const std::array<vec3, 3>& other : panel.triangles) {
        for (const vec3& p : other) {
          const vec2 q(glm::dot(p - panel.center, x), glm::dot(p - panel.center, y));
          low = glm::min(low, q), high = glm::max(high, q);
        }
      }
      const vec2 size = high - low;
      if (!(size.x * size.y < least)) continue;
      least = size.x * size.y;
      const vec3 middle = panel.center + x * (0.5f * (low.x + high.x)) + y * (0.5f * (low.y + high.y));
      const float scale = std::sqrt(area / std::max(least, 1e-30f));
      const vec3 ex = x * (0.5f * size.x * scale), ey = y * (0.5f * size.y * scale);
      best = {middle - ex - ey, middle + ex - ey, middle + ex + ey, middle - ex + ey};
    }
  }
  return best;
}

std::array<vec3, 4> corners_of(const AreaEntry& e) { return {e.corner_0, e.corner_1, e.corner_2, e.corner_3}; }

void set_corners(AreaEntry& e, const std::array<vec3, 4>& c) {
  e.corner_0 = c[0], e.corner_1 = c[1], e.corner_2 = c[2], e.corner_3 = c[3];
}

/// The square of a body of which `seen` shows from each side.
void set_body(AreaEntry& entry, vec3 center, float seen) {
  entry.is_body = 1;
  entry.corner_0 = center;
  entry.half_side = 0.5f * std::sqrt(seen);
}

/// Power and size, by the corners and the colour.
void finish(AreaLight& light) {
  AreaEntry& e = light.entry;
  const float sides = e.is_body != 0 ? 4.0f : e.has_two_sides != 0 ? 2.0f : 1.0f;
  e.radius = std::sqrt(light.seen_area / kPi);
  light.power = sides * luminance(e.color) * light.seen_area;
}

AreaLight make_light(const Panel& panel, const GlowingPart& part, bool is_double_sided) {
  AreaLight light;
  AreaEntry& e = light.entry;
  e.color = part.emission;
  const float area = panel.area * part.share;
  if (glm::length(panel.facing) > kFlat * panel.area) {
    std::array<vec3, 4> corners = rectangle(panel, area);
    if (panel.triangles.size() == 1 && part.share == 1.0f) {
      const std::array<vec3, 3>& t = panel.triangles[0];
      corners = {t[0], t[1], t[2], t[0]};
    }
    if (glm::dot(glm::cross(corners[1] - corners[0], corners[2] - corners[0]), panel.facing) < 0.0f) {
      std::swap(corners[1], corners[3]);
    }
    set_corners(e, corners);
    e.has_two_sides = is_double_sided ? 1 : 0;
    light.seen_area = area;
  } else {
    set_body(e, panel.center, 0.25f * area);
    light.seen_area = 0.25f * area;
  }
  for (const std::array<vec3, 3>& t : panel.triangles) {
    for (const vec3& p : t) e.extent = std::max(e.extent, glm::distance(p, e.middle()));
  }
  finish(light);
  return light;
}

std::vector<AreaLight> glowing_draws(const Scene& scene, const GpuScene& gpu, float sky) {
  std::vector<AreaLight> all;
  std::vector<GlowingPart> parts;
  int parts_of = -1;
  for (std::size_t i = 0; i < gpu.draws().size(); ++i) {
    const Draw& draw = gpu.draws()[i];
    const Node& node = scene.nodes[static_cast<std::size_t>(draw.node)];
    const Primitive& primitive = scene.meshes[static_cast<std::size_t>(node.mesh)].primitives[draw.part];
    const Material& material = scene.materials[static_cast<std::size_t>(primitive.material)];
    // Draws of one primitive stand beside each other.
    if (draw.primitive != parts_of) parts = glowing_parts(scene, primitive, material);
    parts_of = draw.primitive;
    const float half_size = 0.5f * glm::length(draw.bounds.size());
    const glm::dvec3 base = glm::dvec3(gpu.origin()) + glm::dvec3(draw.center);
    std::vector<AreaLight> lamps;
    float power = 0.0f;
    bool is_all = false;
    for (const GlowingPart& part : parts) {
      const Panel panel = make_panel(primitive, node.world_from_node, part.triangles, base);
      if (!(panel.area > 0.0f)) continue;
      AreaLight light = make_light(panel, part, material.double_sided);
      if (!(light.power > 0.0f)) continue;
      light.base = base;
      light.surfaces = {{i, part.triangles}};
      power += light.power;
      is_all |= light.entry.is_body == 0 && part.triangles.size() == primitive.triangles.size();
      lamps.push_back(std::move(light));
    }
    // Flux over a sphere as large as the draw.
    const bool is_painted = material.emissive_texture && !is_all;
    if (is_painted && power < kFaintest * kPi * sky * 4.0f * half_size * half_size) continue;
    std::move(lamps.begin(), lamps.end(), std::back_inserter(all));
  }
  return all;
}

vec3 front_of(const AreaEntry& e) {
  return glm::normalize(glm::cross(e.corner_1 - e.corner_0, e.corner_2 - e.corner_0));
}

glm::dvec3 place_of(const AreaLight& light) { return light.base + glm::dvec3(light.entry.middle()); }

/// Whether `b` is at the place of `a` and as large, so that of both one is seen.
bool are_at_one_place(const AreaLight& a, const AreaLight& b) {
  constexpr float kAlike = 1e-4f;  // relative
  const auto differ = [](float x, float y) { return std::abs(x - y) > kAlike * std::max(x, y); };
  if (a.entry.is_body != b.entry.is_body || a.entry.has_two_sides != b.entry.has_two_sides) return false;
  if (differ(a.seen_area, b.seen_area) || differ(a.entry.extent, b.entry.extent)) return false;
  if (a.entry.is_body != 0) return true;
  const float facing = glm::dot(front_of(a.entry), front_of(b.entry));
  return (a.entry.has_two_sides != 0 ? std::abs(facing) : facing) > 1.0f - kAlike;
}

/// Removes lamps that a later opaque one at the same place hides.
void remove_hidden(const Scene& scene, const GpuScene& gpu, std::vector<AreaLight>& all) {
  const auto is_opaque = [&](const AreaLight& light) {
    const Draw& draw = gpu.draws()[light.surfaces[0].draw];
    const Node& node = scene.nodes[static_cast<std::size_t>(draw.node)];
    const Primitive& primitive = scene.meshes[static_cast<std::size_t>(node.mesh)].primitives[draw.part];
    return scene.materials[static_cast<std::size_t>(primitive.material)].alpha_mode == AlphaMode::opaque;
  };
  std::unordered_map<vec3, std::vector<const AreaLight*>, PositionHash> later;
  std::vector<bool> is_hidden(all.size(), false);
  for (std::size_t i = all.size(); i-- > 0;) {
    std::vector<const AreaLight*>& here = later[vec3(place_of(all[i])) + 0.0f];
    is_hidden[i] =
        std::any_of(here.begin(), here.end(), [&](const AreaLight* other) { return are_at_one_place(all[i], *other); });
    if (!is_hidden[i] && is_opaque(all[i])) here.push_back(&all[i]);
  }
  std::vector<AreaLight> seen;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!is_hidden[i]) seen.push_back(std::move(all[i]));
  }
  all = std::move(seen);
}

/// One lamp of two, where the light of both is centred: of two panels that face the same way a panel, else a body.
AreaLight joined(AreaLight a, AreaLight b) {
  if (a.power < b.power) std::swap(a, b);
  const auto share = static_cast<double>(a.power / (a.power + b.power));
  const glm::dvec3 at = share * place_of(a) + (1.0 - share) * place_of(b);
  AreaLight light = a;
  AreaEntry& e = light.entry;
  e.extent = std::max(a.entry.extent + static_cast<float>(glm::length(place_of(a) - at)),
                      b.entry.extent + static_cast<float>(glm::length(place_of(b) - at)));
  const bool is_panel = a.entry.is_body == 0 && b.entry.is_body == 0 &&
                        a.entry.has_two_sides == b.entry.has_two_sides &&
                        glm::dot(front_of(a.entry), front_of(b.entry)) > 0.9f;
  const auto whole = [](const AreaLight& l) {
    return l.seen_area * (l.entry.is_body != 0 ? 4.0f : l.entry.has_two_sides != 0 ? 2.0f : 1.0f);
  };
  const float area = whole(a) + whole(b);
  e.color = (a.entry.color * whole(a) + b.entry.color * whole(b)) / area;
  light.seen_area = is_panel ? a.seen_area + b.seen_area : 0.25f * area;
  light.base = at;
  if (is_panel) {
    const vec3 middle = a.entry.middle();
    std::array<vec3, 4> corners = corners_of(a.entry);
    for (vec3& c : corners) c = (c - middle) * std::sqrt(light.seen_area / a.seen_area);
    set_corners(e, corners);
  } else {
    set_body(e, vec3(0.0f), light.seen_area);
  }
  light.surfaces.insert(light.surfaces.end(), b.surfaces.begin(), b.surfaces.end());
  finish(light);
  return light;
}

/// Joins pairs until few are left: those first that move the least power the least way.
void join_nearest(std::vector<AreaLight>& all, std::size_t most) {
  while (all.size() > most) {
    std::size_t best_a = 0, best_b = 1;
    double least = static_cast<double>(kInfinity);
    for (std::size_t a = 0; a < all.size(); ++a) {
      for (std::size_t b = a + 1; b < all.size(); ++b) {
        const glm::dvec3 way = place_of(all[a]) - place_of(all[b]);
        const double cost = static_cast<double>(std::min(all[a].power, all[b].power)) * glm::dot(way, way);
        if (cost < least) least = cost, best_a = a, best_b = b;
      }
    }
    all[best_a] = joined(std::move(all[best_a]), std::move(all[best_b]));
    all.erase(all.begin() + static_cast<std::ptrdiff_t>(best_b));
  }
}

}  // namespace

std::vector<AreaLight> find_areas(const Scene& scene, const GpuScene& gpu, float sky, Diagnostics& diagnostics) {
  std::vector<AreaLight> all = glowing_draws(scene, gpu, sky);
  remove_hidden(scene, gpu, all);
  const auto by_power = [](const AreaLight& a, const AreaLight& b) { return a.power > b.power; };
  std::stable_sort(all.begin(), all.end(), by_power);
  if (all.size() > kMostAreas) {
    diagnostics.warn(std::to_string(all.size()) + " glowing surfaces light the scene as " + std::to_string(kMostAreas) +
                         ", those near each other as one; the path tracer has no such limit",
                     scene.name);
    // Of very many the weakest join a strong one near by, each in one step.
    while (all.size() > kMostToMerge) {
      AreaLight weakest = std::move(all.back());
      all.pop_back();
      const auto nearest =
          std::min_element(all.begin(), all.begin() + kMostAreas, [&](const AreaLight& a, const AreaLight& b) {
            return glm::distance(place_of(a), place_of(weakest)) < glm::distance(place_of(b), place_of(weakest));
          });
      *nearest = joined(std::move(*nearest), std::move(weakest));
    }
    join_nearest(all, kMostAreas);
    std::stable_sort(all.begin(), all.end(), by_power);
  }
  return all;
}

int shadow_views(const std::vector<AreaLight>& areas) {
  int views = 0;
  for (const AreaLight& a : areas) views += shadow_views(a.entry);
  return views;
}

void add_areas(const std::vector<AreaLight>& areas, const GpuScene& gpu, LightPoint point, SceneLights& lights,
               Diagnostics& diagnostics) {
  bool is_short = false;
  for (const AreaLight& area : areas) {
    AreaEntry& entry = lights.block.areas[static_cast<std::size_t>(lights.area_count)];
    entry = area.entry;
    const vec3 base(area.base - glm::dvec3(gpu.origin()));
    std::array<vec3, 4> c = corners_of(entry);
    for (vec3& corner : c) corner += base;
    set_corners(entry, c);
    const vec3 from = entry.is_body != 0
                          ? c[0] + entry.radius * point_of_ball(point)
                          : glm::mix(glm::mix(c[0], c[1], point.x), glm::mix(c[3], c[2], point.x), point.y);
    is_short |= !add_area_shadows(lights, entry, from, gpu.bounds());
    for (int s = entry.first_shadow; s >= 0 && s < entry.first_shadow + entry.shadow_count; ++s) {
      lights.shadow_owner[static_cast<std::size_t>(s)] = lights.area_count;
    }
    ++lights.area_count;
  }
  if (is_short) diagnostics.warn("so many glowing surfaces that the weakest cast no shadow", "");
}

}  // namespace candela::raster
