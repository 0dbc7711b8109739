#include "io/triangles.h"

#include <algorithm>

#include "io/gltf_accessor.h"

namespace candela::io {

namespace {

/// Adds the triangles of one list, strip or fan.
void assemble_run(std::span<const std::uint32_t> indices, std::uint64_t mode, std::vector<uvec3>& triangles) {
  const std::size_t n = indices.size();
  const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
    const uvec3 t(indices[a], indices[b], indices[c]);
    if (t.x != t.y && t.y != t.z && t.z != t.x) triangles.push_back(t);
  };
  if (mode == 4) {
    for (std::size_t i = 0; i + 2 < n; i += 3) add(i, i + 1, i + 2);
  } else if (mode == 5) {
    for (std::size_t i = 0; i + 2 < n; ++i) add(i, i + 1 + i % 2, i + 2 - i % 2);  // glTF 2.0 §3.7.2.1, strips
  } else {
    for (std::size_t i = 0; i + 2 < n; ++i) add(i + 1, i + 2, 0);  // and fans
  }
}

}  // namespace

std::vector<uvec3> assemble(std::span<const std::uint32_t> indices, std::uint64_t mode) {
  std::vector<uvec3> triangles;
  triangles.reserve(mode == 4 ? indices.size() / 3 : indices.size());
  while (true) {
    const auto end = std::find(indices.begin(), indices.end(), kPrimitiveRestart);
    assemble_run({indices.begin(), end}, mode, triangles);
    if (end == indices.end()) return triangles;
    indices = {end + 1, indices.end()};
  }
}

std::vector<std::uint32_t> compact(std::vector<uvec3>& triangles, std::size_t vertex_count) {
  std::vector<std::uint32_t> used;
  // A table over all vertices is fastest, unless a small primitive refers into a huge shared array.
  if (vertex_count <= 64 * triangles.size()) {
    std::vector<std::uint32_t> slot(vertex_count, 0);
    for (const uvec3& t : triangles) slot[t.x] = slot[t.y] = slot[t.z] = 1;
    for (std::size_t i = 0; i < vertex_count; ++i) {
      if (slot[i] == 0) continue;
      slot[i] = static_cast<std::uint32_t>(used.size());
      used.push_back(static_cast<std::uint32_t>(i));
    }
    for (uvec3& t : triangles) t = uvec3(slot[t.x], slot[t.y], slot[t.z]);
    return used;
  }
  for (const uvec3& t : triangles) used.insert(used.end(), {t.x, t.y, t.z});
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  const auto slot = [&](std::uint32_t v) {
    return static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), v) - used.begin());
  };
  for (uvec3& t : triangles) t = uvec3(slot(t.x), slot(t.y), slot(t.z));
  return used;
}

}  // namespace candela::io
