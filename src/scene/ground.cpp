#include "scene/ground.h"

#include <algorithm>
#include <cmath>

namespace candela {

Material ground_material(const Ground& ground) {
  Material material;
  material.name = "ground";
  material.base_color = ground.color;
  material.metallic = 0.0f;
  material.specular = 0.0f;
  return material;
}

Primitive ground_primitive(const Ground& ground, const Box3& subject) {
  constexpr std::uint32_t kSectors = 32;
  constexpr float kFirst = 0.25f, kLast = 1000.0f;  // radii, in those of the subject
  constexpr float kGrowth = 1.5f;
  const Box3 bounds = subject.empty() ? Box3{vec3(-1.0f), vec3(1.0f)} : subject;
  const vec3 center = bounds.center();
  const float size = std::max(0.5f * glm::length(bounds.size()), 1e-6f);

  Primitive plane;
  plane.positions.emplace_back(center.x, ground.height, center.z);
  for (float radius = kFirst; radius < kLast * kGrowth; radius *= kGrowth) {
    const auto first = static_cast<std::uint32_t>(plane.positions.size());
    for (std::uint32_t i = 0; i < kSectors; ++i) {
      const float angle = 2.0f * kPi * static_cast<float>(i) / static_cast<float>(kSectors);
      const vec2 at = vec2(center.x, center.z) + size * radius * vec2(std::cos(angle), std::sin(angle));
      plane.positions.emplace_back(at.x, ground.height, at.y);
      const std::uint32_t here = first + i, next = first + (i + 1) % kSectors;
      if (first == 1) {
        plane.triangles.emplace_back(0, next, here);
        continue;
      }
      plane.triangles.emplace_back(here - kSectors, next - kSectors, next);
      plane.triangles.emplace_back(here - kSectors, next, here);
    }
  }
  plane.normals.assign(plane.positions.size(), vec3(0, 1, 0));
  return plane;
}

}  // namespace candela
