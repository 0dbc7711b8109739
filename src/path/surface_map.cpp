#include "path/surface_map.h"

#include "base/parallel.h"
#include "path/displacement.h"

namespace candela::path {

Ray centre_ray(const Camera& camera, int x, int y) {
  return camera.generate(vec2(x, y) + 0.5f, vec2(0.5f)).ray;  // a polygon's numbers (½, ½) are not its middle
}

SurfaceSample surface_sample_of(const Geometry& geometry, const Hit& hit) {
  SurfaceSample sample;
  const Placement& placement = geometry.placement(hit.placement);
  const TrianglePositions p = triangle_positions(placement, hit.triangle);
  const vec3 b(1.0f - hit.u - hit.v, hit.u, hit.v);
  const UndividedPlace place = undivided({hit.triangle, {hit.u, hit.v}}, placement.mesh->divisions);
  sample.node = placement.node;
  sample.primitive = placement.primitive;
  sample.triangle = place.triangle;
  sample.barycentric = place.barycentric;
  sample.position = p.p0 * b.x + p.p1 * b.y + p.p2 * b.z + geometry.origin();
  sample.uv = placement.mesh->uv(placement.mesh->triangles[hit.triangle], b, 0);
  return sample;
}

namespace {

/// Calls `row(y)` for every row, on all cores.
template <class Row>
void for_rows(int height, Row row) {
  parallel_for(0, static_cast<std::size_t>(height), 4, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) row(y);
  });
}

}  // namespace

SurfaceMap map_surfaces(const Geometry& geometry, const Camera& camera, ivec2 size) {
  SurfaceMap map(size.x, size.y);
  for_rows(size.y, [&](int y) {
    for (int x = 0; x < size.x; ++x) {
      if (const Hit hit = geometry.first_surface(centre_ray(camera, x, y)))
        map.at(x, y) = surface_sample_of(geometry, hit);
    }
  });
  return map;
}

std::vector<InstanceMask> find_masks(const Geometry& geometry, const Camera& camera, ivec2 size) {
  std::vector<std::vector<std::pair<int, int>>> rows(static_cast<std::size_t>(size.y));  // node and column
  for_rows(size.y, [&](int y) {
    for (int x = 0; x < size.x; ++x) {
      for (const Hit& hit : geometry.all_surfaces(centre_ray(camera, x, y))) {
        rows[static_cast<std::size_t>(y)].emplace_back(geometry.placement(hit.placement).node, x);
      }
    }
  });
  MaskBuilder masks;
  for (int y = 0; y < size.y; ++y) {
    for (const auto& [node, x] : rows[static_cast<std::size_t>(y)]) masks.add(node, {x, y});
  }
  return masks.build();
}

}  // namespace candela::path
