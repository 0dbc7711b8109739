#include "io/vertex_frames.h"

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "io/tangents.h"

namespace candela::io {

namespace {

vec3 unit(dvec3 v) { return vec3(v / glm::length(v)); }

template <class V>
void gather(std::vector<V>& values, std::span<const std::uint32_t> sources) {
  if (values.empty()) return;
  std::vector<V> result(sources.size());
  for (std::size_t i = 0; i < sources.size(); ++i) result[i] = values[sources[i]];
  values = std::move(result);
}

/// New vertices, each a copy of the old one that `sources` names.
void gather_vertices(Primitive& primitive, std::span<const std::uint32_t> sources) {
  gather(primitive.positions, sources);
  gather(primitive.normals, sources);
  gather(primitive.tangents, sources);
  for (auto& [set, uvs] : primitive.uvs) gather(uvs, sources);
  gather(primitive.colors, sources);
}

}  // namespace

dvec3 area_vector(const Primitive& primitive, const uvec3& t) {
  const dvec3 a(primitive.positions[t.x]), b(primitive.positions[t.y]), c(primitive.positions[t.z]);
  return glm::cross(b - a, c - a);
}

void make_flat(Primitive& primitive) {
  std::vector<std::uint32_t> corners;
  corners.reserve(primitive.triangles.size() * 3);
  for (const uvec3& t : primitive.triangles) corners.insert(corners.end(), {t.x, t.y, t.z});
  gather_vertices(primitive, corners);
  primitive.normals.resize(corners.size());
  for (std::size_t f = 0; f < primitive.triangles.size(); ++f) {
    const auto first = static_cast<std::uint32_t>(f * 3);
    primitive.triangles[f] = uvec3(first, first + 1, first + 2);
    const vec3 normal = unit(area_vector(primitive, primitive.triangles[f]));
    for (std::size_t i = 0; i < 3; ++i) primitive.normals[first + i] = normal;
  }
}

void normalize_normals(Primitive& primitive) {
  std::vector<std::uint32_t> missing;
  for (std::size_t i = 0; i < primitive.normals.size(); ++i) {
    const dvec3 n(primitive.normals[i]);
    const double length = glm::length(n);
    // Double, because the squares of small floats underflow.
    if (length > 0 && std::isfinite(length)) {
      primitive.normals[i] = vec3(n / length);
    } else {
      missing.push_back(static_cast<std::uint32_t>(i));
    }
  }
  if (missing.empty()) return;
  std::vector<dvec3> sums(primitive.positions.size(), dvec3(0));
  for (const uvec3& t : primitive.triangles) {
    const dvec3 area = area_vector(primitive, t);
    for (int i = 0; i < 3; ++i) sums[t[i]] += area;
  }
  for (const std::uint32_t i : missing) {
    primitive.normals[i] = sums[i] == dvec3(0) ? vec3(0, 0, 1) : unit(sums[i]);
  }
}

void turn_tangents(Primitive& primitive) {
  // Nearer to a pole than this, the circle has no direction that a float could hold.
  constexpr float kSmallestSine = 1e-3f;
  primitive.tangents.reserve(primitive.normals.size());
  for (const vec3 n : primitive.normals) {
    const vec3 circle = glm::cross(vec3(0, 1, 0), n);
    const float sine = glm::length(circle);
    primitive.tangents.emplace_back(sine > kSmallestSine ? circle / sine : any_perpendicular(n), 1.0f);
  }
}

void generate_tangents(const TextureSlot& slot, Primitive& primitive) {
  std::vector<vec2> uvs = primitive.uvs[static_cast<std::size_t>(slot.uv_set)];
  for (vec2& uv : uvs) uv = slot.apply(uv);
  const TangentFrames frames = make_tangents(primitive.positions, primitive.normals, uvs, primitive.triangles);

  // A vertex keeps the first group that it meets; each further group gets a copy.
  struct Copy {
    std::uint32_t group;
    std::uint32_t next;
  };
  constexpr std::uint32_t kEnd = 0xFFFFFFFF;
  const std::size_t originals = primitive.positions.size();
  std::vector<std::uint32_t> sources(originals);
  for (std::size_t i = 0; i < originals; ++i) sources[i] = static_cast<std::uint32_t>(i);
  std::vector<Copy> copies(originals, Copy{kEnd, kEnd});
  std::vector<bool> met(originals, false);
  std::vector<vec4> tangents(originals, vec4(0));
  for (std::size_t f = 0; f < primitive.triangles.size(); ++f) {
    for (int i = 0; i < 3; ++i) {
      const std::size_t corner = f * 3 + static_cast<std::size_t>(i);
      std::uint32_t vertex = primitive.triangles[f][i];
      if (!met[vertex]) {
        met[vertex] = true;
        copies[vertex].group = frames.groups[corner];
      }
      while (copies[vertex].group != frames.groups[corner]) {
        if (copies[vertex].next == kEnd) {
          copies[vertex].next = static_cast<std::uint32_t>(copies.size());
          sources.push_back(sources[vertex]);
          tangents.emplace_back(0.0f);
          copies.push_back({frames.groups[corner], kEnd});
        }
        vertex = copies[vertex].next;
      }
      tangents[vertex] = frames.corners[corner];
      primitive.triangles[f][i] = vertex;
    }
  }
  if (sources.size() > originals) gather_vertices(primitive, sources);
  primitive.tangents = std::move(tangents);
  for (std::size_t i = 0; i < originals; ++i) {
    if (!met[i]) primitive.tangents[i] = vec4(any_perpendicular(primitive.normals[i]), 1);
  }
}

void normalize_tangents(Primitive& primitive) {
  for (std::size_t i = 0; i < primitive.tangents.size(); ++i) {
    vec4& tangent = primitive.tangents[i];
    const dvec3 t(tangent);
    const double length = glm::length(t);
    tangent = vec4(length > 0 && std::isfinite(length) ? vec3(t / length) : any_perpendicular(primitive.normals[i]),
                   tangent.w < 0 ? -1.0f : 1.0f);
  }
}

}  // namespace candela::io
