#include "scene/brightness.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "scene/environment.h"
#include "shade/color.glsl.h"

namespace candela {

namespace {

/// A point of a surface, its unit normal, and what glows there.
struct Place {
  dvec3 position, normal;
  bool is_double_sided = false;
  double radiance = 0.0;
};

/// What is lit from: a lamp, or a surface that glows, seen as a ball of its area.
struct Source {
  dvec3 position;
  double intensity = 0.0;  ///< cd
  double nearest2 = 0.0;   ///< square of the radius within which nothing is
};

double luminous(vec3 v) { return static_cast<double>(shade::color_luminance(v)); }

/// The corners of a triangle in the world.
struct Corners {
  dvec3 a, b, c;
  dvec3 area_vector() const { return 0.5 * glm::cross(b - a, c - a); }
};
Corners corners_of(const Primitive& p, const uvec3& t, const mat4& world) {
  return {dvec3(transform_point(world, p.positions[t.x])), dvec3(transform_point(world, p.positions[t.y])),
          dvec3(transform_point(world, p.positions[t.z]))};
}

vec3 texel(const TextureImage& image, int x, int y) {
  const std::size_t at =
      4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
  vec3 result;
  for (int i = 0; i < 3; ++i) {
    const std::size_t channel = at + static_cast<std::size_t>(i);
    if (image.bits == 16) {
      std::uint16_t word = 0;
      std::memcpy(&word, image.pixels.data() + 2 * channel, sizeof word);
      result[i] = static_cast<float>(word) / 65535.0f;
    } else {
      result[i] = static_cast<float>(image.pixels[channel]) / 255.0f;
    }
  }
  return result;
}

/// Radiance of what glows, at the middle of a triangle.
double glow_of(const Scene& scene, const Primitive& p, const uvec3& t) {
  const Material& m = scene.materials[static_cast<std::size_t>(p.material)];
  if (m.unlit || max_component(m.emission) <= 0.0f) return 0.0;
  const TextureSlot& slot = m.emissive_texture;
  const auto& uvs = p.uvs[static_cast<std::size_t>(slot.uv_set)];
  if (!slot || uvs.empty()) return luminous(m.emission);
  const TextureImage& image =
      *scene.images[static_cast<std::size_t>(scene.textures[static_cast<std::size_t>(slot.texture)].image)];
  if (image.pixels.empty()) return luminous(m.emission);
  const vec2 uv = slot.apply((uvs[t.x] + uvs[t.y] + uvs[t.z]) / 3.0f);
  const auto texel_at = [](float x, int size) {
    return std::min(static_cast<int>((x - std::floor(x)) * static_cast<float>(size)), size - 1);
  };
  const vec3 code = texel(image, texel_at(uv.x, image.width), texel_at(uv.y, image.height));
  return luminous(m.emission * shade::srgb_decode(code));
}

/// Punctual lights but directional ones, and every primitive that glows.
std::vector<Source> find_sources(const Scene& scene) {
  std::vector<Source> sources;
  for (const Node& node : scene.nodes) {
    if (node.mesh < 0) continue;
    for (const Primitive& p : scene.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
      if (max_component(scene.materials[static_cast<std::size_t>(p.material)].emission) <= 0.0f) continue;
      Source source;
      double area = 0.0, power = 0.0;
      for (const uvec3& t : p.triangles) {
        const Corners c = corners_of(p, t, node.world_from_node);
        const double size = glm::length(c.area_vector()), radiance = glow_of(scene, p, t);
        area += size;
        power += size * radiance;
        source.position += size * radiance * (c.a + c.b + c.c) / 3.0;
      }
      if (power <= 0.0) continue;
      source.position /= power;
      source.intensity = power / 4.0;  // Cauchy 1850: a convex body shows a quarter of its surface on average
      source.nearest2 = area / (4.0 * static_cast<double>(kPi));
      sources.push_back(source);
    }
  }
  return sources;
}

/// Illuminance by one punctual light, facing it.
struct Arriving {
  dvec3 direction;  ///< to the light
  double illuminance = 0.0;
};
Arriving arrive(const Scene& scene, const Node& node, const dvec3& position) {
  const Light& light = scene.lights[static_cast<std::size_t>(node.light)];
  const double strength = static_cast<double>(light.intensity) * luminous(light.color);
  const mat3 linear(node.world_from_node);
  const vec3 back = glm::length(linear[2]) > 0.0f ? glm::normalize(linear[2]) : vec3(0, 0, 1);
  if (light.type == LightType::directional) return {dvec3(back), strength};
  const dvec3 offset = dvec3(vec3(node.world_from_node[3])) - position;
  constexpr double kNearest2 = 1e-4;  // a centimetre: a point has no size, and nothing real is nearer
  const double d2 = std::max(glm::dot(offset, offset), kNearest2);
  const dvec3 to_light = offset / std::sqrt(d2);
  if (d2 > static_cast<double>(light.range) * static_cast<double>(light.range)) return {to_light, 0.0};
  double intensity = strength;
  if (light.type == LightType::spot) {
    const auto away = static_cast<float>(glm::dot(to_light, dvec3(back)));
    if (away < std::cos(light.outer_cone)) intensity = 0.0;
  } else if (light.ies >= 0) {
    const mat3 turned(linear[0] / glm::length(linear[0]), linear[1] / glm::length(linear[1]), back);
    const vec3 local = glm::transpose(turned) * -vec3(to_light);
    const IesProfile& profile = scene.ies_profiles[static_cast<std::size_t>(light.ies)];
    intensity *= is_finite(local) ? static_cast<double>(ies_intensity(profile, local)) : 0.0;
  }
  return {to_light, intensity / d2};
}

/// Points that stand for equal areas, but that no primitive has more of them than all others together: a ground,
/// however large, is no more of what is looked at than what stands on it.
std::vector<Place> spread_places(const Scene& scene) {
  constexpr std::size_t kCount = 1024;
  struct Part {
    std::size_t node;
    const Primitive* primitive;
    double own;  ///< area
    double end;  ///< area up to here
    double scale = 1.0;
  };
  std::vector<Part> parts;
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    const Node& node = scene.nodes[n];
    if (node.mesh < 0) continue;
    for (const Primitive& p : scene.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
      double own = 0.0;
      for (const uvec3& t : p.triangles) own += glm::length(corners_of(p, t, node.world_from_node).area_vector());
      parts.push_back({n, &p, own, 0.0});
    }
  }
  const auto glows = [&](const Part& part) {
    return max_component(scene.materials[static_cast<std::size_t>(part.primitive->material)].emission) > 0.0f;
  };
  double area = 0.0, dark = 0.0;
  for (const Part& part : parts) {
    area += part.own;
    if (!glows(part)) dark += part.own;
  }
  for (Part& part : parts) {
    const double others = dark - part.own;
    if (!glows(part) && part.own > others && others > 1e-9 * area) part.scale = others / part.own;
  }
  area = 0.0;
  for (Part& part : parts) part.end = area += part.scale * part.own;
  std::vector<Place> places;
  if (!(area > 0.0)) return places;
  std::size_t next = 0;
  double done = 0.0;
  const auto wanted = [&] { return (static_cast<double>(next) + 0.5) / kCount * area; };
  for (const Part& part : parts) {
    if (next >= kCount || part.end <= wanted()) {
      done = part.end;
      continue;
    }
    const Node& node = scene.nodes[part.node];
    const Material& material = scene.materials[static_cast<std::size_t>(part.primitive->material)];
    for (const uvec3& t : part.primitive->triangles) {
      const Corners c = corners_of(*part.primitive, t, node.world_from_node);
      const double size = glm::length(c.area_vector());
      done += part.scale * size;
      for (; next < kCount && wanted() < done; ++next) {
        // The R2 lattice (Roberts 2018), folded into the triangle.
        double u = 0.5 + 0.7548776662466927 * static_cast<double>(next);
        double v = 0.5 + 0.5698402909980532 * static_cast<double>(next);
        u -= std::floor(u), v -= std::floor(v);
        if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
        places.push_back({c.a + u * (c.b - c.a) + v * (c.c - c.a), c.area_vector() / size, material.double_sided,
                          glow_of(scene, *part.primitive, t)});
      }
    }
    done = part.end;
  }
  return places;
}

/// On a surface that faces anywhere.
double mean_illuminance(const Environment& environment) {
  double flux = 0.0;
  if (environment.map) {
    const Image& map = *environment.map;
    for (int y = 0; y < map.height; ++y) {
      double row = 0.0;
      for (int x = 0; x < map.width; ++x) row += luminous(map.rgb(x, y));
      flux += row * static_cast<double>(map_solid_angle(y, map.width, map.height));
    }
  }
  flux += 4.0 * static_cast<double>(kPi) * luminous(environment.constant);
  for (const SunDisc& sun : environment.suns) {
    const double half = std::sin(0.5 * static_cast<double>(sun.angular_radius));
    flux += 4.0 * static_cast<double>(kPi) * half * half * luminous(sun.radiance);
  }
  return 0.25 * flux * static_cast<double>(environment.intensity);
}

double facing(const Place& place, const dvec3& direction) {
  const double cosine = glm::dot(place.normal, direction);
  return place.is_double_sided ? std::fabs(cosine) : std::max(cosine, 0.0);
}

}  // namespace

bool outshines(const Scene& scene, const Environment& environment) {
  constexpr double kShare = 0.1;
  constexpr double kTimes = 2.0;
  const std::vector<Source> sources = find_sources(scene);
  std::vector<const Node*> lamps;
  for (const Node& node : scene.nodes) {
    if (node.light >= 0) lamps.push_back(&node);
  }
  if (sources.empty() && lamps.empty()) return false;
  const double threshold = kTimes * mean_illuminance(environment);
  const std::vector<Place> places = spread_places(scene);
  const auto is_bright = [&](const Place& place) {
    // A surface shows what it emits as a white one shows π times that illuminance.
    double sum = place.radiance * static_cast<double>(kPi);
    for (const Node* node : lamps) {
      if (sum > threshold) return true;
      const Arriving light = arrive(scene, *node, place.position);
      sum += light.illuminance * facing(place, light.direction);
    }
    for (const Source& source : sources) {
      if (sum > threshold) return true;
      const dvec3 offset = source.position - place.position;
      const double d2 = glm::dot(offset, offset);
      if (d2 <= source.nearest2) continue;  // its own surface
      sum += source.intensity / d2 * facing(place, offset / std::sqrt(d2));
    }
    return sum > threshold;
  };
  const auto bright = static_cast<double>(std::count_if(places.begin(), places.end(), is_bright));
  return bright > kShare * static_cast<double>(places.size());
}

}  // namespace candela
