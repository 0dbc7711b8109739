#include "io/tangents.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace candela::io {

namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF;

bool not_zero(float x) { return std::fabs(x) > std::numeric_limits<float>::min(); }

vec3 normalized_or_zero(vec3 v) {
  const float length = glm::length(v);
  return not_zero(length) && std::isfinite(length) ? v / length : vec3(0);
}

vec3 projected(vec3 v, vec3 normal) { return normalized_or_zero(v - normal * glm::dot(normal, v)); }

/// Vertices equal in position, normal and uv become one: the result maps each vertex to the first of its kind.
std::vector<std::uint32_t> weld(std::span<const vec3> positions, std::span<const vec3> normals,
                                std::span<const vec2> uvs) {
  using Key = std::array<std::uint32_t, 8>;
  const auto key_of = [&](std::size_t i) {
    const vec3 p = positions[i], n = normals[i];
    const vec2 t = uvs[i];
    // Adding 0 turns -0 into +0, which compare equal as numbers.
    const std::array<float, 8> floats{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f, n.x + 0.0f,
                                      n.y + 0.0f, n.z + 0.0f, t.x + 0.0f, t.y + 0.0f};
    return std::bit_cast<Key>(floats);
  };
  const std::size_t capacity = std::bit_ceil(positions.size() * 2 + 1);
  std::vector<std::uint32_t> table(capacity, kNone);
  std::vector<std::uint32_t> result(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Key key = key_of(i);
    std::uint64_t hash = 0x9E3779B97F4A7C15;
    for (const std::uint32_t word : key) hash = (std::rotl(hash, 5) ^ word) * 0x9E3779B97F4A7C15;
    std::size_t slot = (hash ^ hash >> 32) & (capacity - 1);
    while (table[slot] != kNone && key_of(table[slot]) != key) slot = (slot + 1) & (capacity - 1);
    if (table[slot] == kNone) table[slot] = static_cast<std::uint32_t>(i);
    result[i] = table[slot];
  }
  return result;
}

struct Face {
  std::array<std::uint32_t, 3> vertices;                         ///< welded
  std::array<std::uint32_t, 3> neighbours{kNone, kNone, kNone};  ///< across the edge from corner i to i + 1
  std::array<std::uint32_t, 3> groups{kNone, kNone, kNone};
  vec3 tangent{0};
  bool preserves_orientation = false;  ///< the uv map does not mirror
  bool joins_any_group = true;         ///< no uv area: has no tangent of its own
};

/// The derivative of position by u, as a direction (Mikkelsen 2008, eq. 18).
void set_uv_frame(Face& face, const std::array<vec3, 3>& p, const std::array<vec2, 3>& t) {
  const vec2 t1 = t[1] - t[0], t2 = t[2] - t[0];
  const vec3 d1 = p[1] - p[0], d2 = p[2] - p[0];
  const float area = t1.x * t2.y - t1.y * t2.x;
  const vec3 by_u = t2.y * d1 - t1.y * d2;
  const vec3 by_v = t1.x * d2 - t2.x * d1;
  face.preserves_orientation = area > 0;
  if (!not_zero(area)) return;
  face.tangent = normalized_or_zero(by_u) * (area > 0 ? 1.0f : -1.0f);
  const float magnitude = std::fabs(area);
  face.joins_any_group = !(not_zero(glm::length(by_u) / magnitude) && not_zero(glm::length(by_v) / magnitude));
}

/// Triangles are neighbours when they walk a shared edge in opposite directions; of several the first in order.
void link_neighbours(std::vector<Face>& faces) {
  struct Edge {
    std::uint64_t key;  ///< both vertices, the smaller one first
    std::uint32_t corner;
    bool forward;
  };
  std::vector<Edge> edges;
  edges.reserve(faces.size() * 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = faces[f].vertices[i], b = faces[f].vertices[(i + 1) % 3];
      edges.push_back(
          {std::uint64_t{std::min(a, b)} << 32 | std::max(a, b), static_cast<std::uint32_t>(f * 3 + i), a < b});
    }
  }
  std::sort(edges.begin(), edges.end(),
            [](const Edge& x, const Edge& y) { return x.key != y.key ? x.key < y.key : x.corner < y.corner; });
  // Within one edge, the n-th triangle of one direction meets the n-th of the other.
  for (std::size_t begin = 0; begin < edges.size();) {
    std::size_t end = begin;
    while (end < edges.size() && edges[end].key == edges[begin].key) ++end;
    std::size_t forward = begin, backward = begin;
    for (;;) {
      while (forward < end && !edges[forward].forward) ++forward;
      while (backward < end && edges[backward].forward) ++backward;
      if (forward == end || backward == end) break;
      const std::uint32_t a = edges[forward++].corner, b = edges[backward++].corner;
      faces[a / 3].neighbours[a % 3] = b / 3;
      faces[b / 3].neighbours[b % 3] = a / 3;
    }
    begin = end;
  }
}

struct Group {
  std::uint32_t vertex;
  bool preserves_orientation;
};

std::size_t corner_at(const Face& face, std::uint32_t vertex) {
  return face.vertices[0] == vertex ? 0 : face.vertices[1] == vertex ? 1 : face.vertices[2] == vertex ? 2 : 3;
}

/// The reference's four rules: a group is what can be reached around one vertex across edges between triangles whose uv
/// maps have the same orientation; triangles without uv area join whoever comes first.
std::vector<Group> make_groups(std::vector<Face>& faces) {
  std::vector<Group> groups;
  std::vector<std::uint32_t> stack;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (faces[f].joins_any_group || faces[f].groups[i] != kNone) continue;
      const auto id = static_cast<std::uint32_t>(groups.size());
      const Group group{faces[f].vertices[i], faces[f].preserves_orientation};
      groups.push_back(group);
      stack.assign(1, static_cast<std::uint32_t>(f));
      while (!stack.empty()) {
        Face& face = faces[stack.back()];
        stack.pop_back();
        const std::size_t corner = corner_at(face, group.vertex);
        if (corner == 3 || face.groups[corner] != kNone) continue;
        const bool free = face.groups[0] == kNone && face.groups[1] == kNone && face.groups[2] == kNone;
        if (face.joins_any_group && free) face.preserves_orientation = group.preserves_orientation;
        if (face.preserves_orientation != group.preserves_orientation) continue;
        face.groups[corner] = id;
        const std::uint32_t left = face.neighbours[corner], right = face.neighbours[(corner + 2) % 3];
        if (right != kNone) stack.push_back(right);
        if (left != kNone) stack.push_back(left);
      }
    }
  }
  return groups;
}

}  // namespace

vec3 any_perpendicular(vec3 normal) {
  const vec3 axis = std::fabs(normal.x) < 0.5f ? vec3(1, 0, 0) : vec3(0, 1, 0);
  return glm::normalize(axis - normal * glm::dot(normal, axis));
}

TangentFrames make_tangents(std::span<const vec3> positions, std::span<const vec3> normals, std::span<const vec2> uvs,
                            std::span<const uvec3> triangles) {
  const std::vector<std::uint32_t> welded = weld(positions, normals, uvs);
  std::vector<Face> faces(triangles.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const uvec3 t = triangles[f];
    faces[f].vertices = {welded[t.x], welded[t.y], welded[t.z]};
    set_uv_frame(faces[f], {positions[t.x], positions[t.y], positions[t.z]}, {uvs[t.x], uvs[t.y], uvs[t.z]});
  }
  link_neighbours(faces);
  const std::vector<Group> groups = make_groups(faces);

  // Each group's tangent: its triangles' tangents in the vertex's plane, weighted by the angle there.
  std::vector<vec3> sums(groups.size(), vec3(0));
  for (const Face& face : faces) {
    if (face.joins_any_group) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      if (face.groups[i] == kNone) continue;
      const vec3 n = normals[face.vertices[i]];
      const vec3 p = positions[face.vertices[i]];
      const vec3 before = projected(positions[face.vertices[(i + 2) % 3]] - p, n);
      const vec3 after = projected(positions[face.vertices[(i + 1) % 3]] - p, n);
      const float angle = std::acos(glm::clamp(glm::dot(before, after), -1.0f, 1.0f));
      sums[face.groups[i]] += angle * projected(face.tangent, n);
    }
  }

  TangentFrames result;
  result.corners.resize(faces.size() * 3);
  result.groups.resize(faces.size() * 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t id = faces[f].groups[i];
      const vec3 n = normals[faces[f].vertices[i]];
      vec3 tangent = id == kNone ? vec3(0) : normalized_or_zero(sums[id]);
      if (tangent == vec3(0)) tangent = any_perpendicular(n);
      // glTF's image goes up where v goes down, hence the sign opposite to the reference's.
      const bool preserves = id != kNone && groups[id].preserves_orientation;
      result.corners[f * 3 + i] = vec4(tangent, preserves ? -1.0f : 1.0f);
      result.groups[f * 3 + i] = id;
    }
  }
  return result;
}

}  // namespace candela::io
