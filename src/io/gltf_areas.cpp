#include "io/gltf_areas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "content/shapes.h"

namespace candela::io {

namespace {

constexpr float kDefaultNits = 1000.0f;
// Squares of sizes, and what is so bright over so large an area, have to be finite.
constexpr float kLargestSize = 1e6f;
constexpr float kBrightest = 1e12f;

float within(const JsonView& json, const char* key, float fallback, float low, float high, Warnings& warnings) {
  const float value = json.real_or(key, fallback);
  const float result = std::clamp(value, low, high);
  if (result != value) warnings.warn(fmt::format("an area light's {} {} becomes {}", key, value, result), json);
  return result;
}

/// A polygon of the disc's area, seen from -z.
Primitive disc(float diameter) {
  constexpr int kCorners = 64;
  const float turn = 2.0f * kPi / static_cast<float>(kCorners);
  const float radius = 0.5f * diameter * std::sqrt(turn / std::sin(turn));
  Primitive result;
  const auto add = [&](vec2 at) {
    result.positions.emplace_back(at, 0.0f);
    result.normals.emplace_back(0.0f, 0.0f, -1.0f);
    result.uvs[0].push_back(vec2(0.5f) + 0.5f * at / radius);
  };
  add(vec2(0.0f));
  for (int i = 0; i < kCorners; ++i) {
    const float angle = turn * static_cast<float>(i);
    add(radius * vec2(std::cos(angle), std::sin(angle)));
    const auto k = static_cast<std::uint32_t>(i);
    result.triangles.emplace_back(0, (k + 1) % kCorners + 1, k + 1);
  }
  return result;
}

}  // namespace

int add_area_light(const JsonView& json, Scene& scene, Warnings& warnings) {
  Material material;
  material.name = json.string_or("name");
  material.is_lamp = true;
  material.base_color = vec3(0.0f);
  material.metallic = material.specular = 0.0f;
  vec3 color = json.vector_or("color", vec3(1));
  if (glm::any(glm::lessThan(color, vec3(0)))) {
    warnings.warn("an area light has a negative colour; clamped to 0", json);
    color = glm::max(color, vec3(0));
  }
  const float nits = within(json, "intensity", kDefaultNits, 0.0f, kBrightest, warnings);
  material.emission = glm::min(color, vec3(kBrightest)) * nits;

  const float size = within(json, "size", 1.0f, 0.0f, kLargestSize, warnings);
  const std::string type = json.at("type").string();
  Primitive primitive;
  bool is_there = size > 0.0f;  // what has no area is left out
  if (type == "rect") {
    const auto rect = json.find("rect");
    const float aspect = rect ? within(*rect, "aspect", 1.0f, 0.0f, kLargestSize, warnings) : 1.0f;
    const float width = std::min(size * aspect, kLargestSize);
    is_there &= width > 0.0f;
    primitive = content::quad({0.5f * width, -0.5f * size, 0.0f}, {-width, 0, 0}, {0, size, 0});
  } else if (type == "disk") {
    primitive = disc(size);
  } else {
    throw json.at("type").error("must be rect or disk");
  }
  primitive.tangents.clear();
  primitive.material = static_cast<int>(scene.materials.size());
  scene.materials.push_back(std::move(material));
  Mesh& mesh = scene.meshes.emplace_back();
  mesh.name = json.string_or("name");
  if (is_there) mesh.primitives.push_back(std::move(primitive));
  return static_cast<int>(scene.meshes.size()) - 1;
}

std::optional<mat4> place_of_area_light(const mat4& world_from_node) {
  const glm::dmat3 linear(world_from_node);
  const double scale = std::max({glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2])});
  if (!(scale > 0.0)) return std::nullopt;
  // A flattened node still says where two of its axes are.
  glm::dvec3 x = linear[0] / scale, y = linear[1] / scale, z = linear[2] / scale;
  constexpr double kFlat = 1e-12;
  const double handedness = glm::determinant(linear) < 0.0 ? -1.0 : 1.0;
  if (glm::dot(z, z) < kFlat) z = handedness * glm::cross(x, y);
  if (glm::dot(x, x) < kFlat) x = handedness * glm::cross(y, z);
  if (glm::dot(z, z) < kFlat) return std::nullopt;
  z = glm::normalize(z);
  x -= z * glm::dot(x, z);
  if (glm::dot(x, x) < kFlat) return std::nullopt;
  x = glm::normalize(x);
  mat4 result(1.0f);
  result[0] = vec4(x * scale, 0.0);
  result[1] = vec4(glm::cross(z, x) * scale, 0.0);
  result[2] = vec4(z * scale, 0.0);
  result[3] = world_from_node[3];
  return result;
}

}  // namespace candela::io
