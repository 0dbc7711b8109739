#include "check/edges.h"

#include <gmock/gmock.h>

#include <array>

namespace candela::check {
namespace {

struct Triangles {
  std::vector<vec3> positions;
  std::vector<uvec3> triangles;

  EdgeReport inspect() const { return inspect_edges(positions, triangles, default_weld_distance(positions)); }
};

/// A cube whose faces have corners of their own, as files with flat normals have them.
void add_cube(Triangles& mesh, vec3 center, float half, bool inward = false) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0f, 1.0f}) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      constexpr std::array<vec2, 4> kCorners = {vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, 1)};
      for (const vec2 c : kCorners) {
        vec3 p;
        p[axis] = sign;
        p[(axis + 1) % 3] = c.x;
        p[(axis + 2) % 3] = c.y;
        mesh.positions.push_back(center + half * p);
      }
      const bool outward = (sign > 0.0f) != inward;
      mesh.triangles.push_back(outward ? uvec3(0, 1, 2) + first : uvec3(2, 1, 0) + first);
      mesh.triangles.push_back(outward ? uvec3(0, 2, 3) + first : uvec3(3, 2, 0) + first);
    }
  }
}

TEST(unit_check_edges, corners_at_the_same_place_are_one) {
  Triangles cube;
  add_cube(cube, vec3(0), 1);
  const EdgeReport report = cube.inspect();
  EXPECT_TRUE(report.is_closed());
  EXPECT_EQ(report.edges, 18);  // 12 of the cube, 6 diagonals
  ASSERT_EQ(report.parts.size(), 1);
  EXPECT_NEAR(report.parts[0].volume, 8, 1e-6);
  // And apart without welding.
  EXPECT_EQ(inspect_edges(cube.positions, cube.triangles, 0.0f).boundary, 0) << "equal numbers are equal";
  for (std::size_t i = 0; i < cube.positions.size(); i += 4) cube.positions[i].x += 1e-3f;
  EXPECT_FALSE(cube.inspect().is_closed());
}

TEST(unit_check_edges, rounding_of_exporters_is_forgiven) {
  Triangles cube;
  add_cube(cube, vec3(1000, 0, 0), 1);
  for (std::size_t i = 0; i < cube.positions.size(); ++i) cube.positions[i].y += i % 2 == 0 ? 4e-6f : -4e-6f;
  EXPECT_TRUE(cube.inspect().is_closed());
}

TEST(unit_check_edges, what_is_missing_and_turned_is_counted) {
  Triangles open;
  add_cube(open, vec3(0), 1);
  open.triangles.resize(10);
  EXPECT_EQ(open.inspect().boundary, 4);
  EXPECT_EQ(open.inspect().inconsistent, 0);

  Triangles turned;
  add_cube(turned, vec3(0), 1);
  std::swap(turned.triangles[0].y, turned.triangles[0].z);
  EXPECT_EQ(turned.inspect().inconsistent, 3);
  EXPECT_EQ(turned.inspect().boundary, 0);

  Triangles fin;
  add_cube(fin, vec3(0), 1);
  fin.positions.emplace_back(5, 5, 5);
  fin.triangles.emplace_back(fin.triangles[0].x, fin.triangles[0].y,
                             static_cast<std::uint32_t>(fin.positions.size() - 1));
  EXPECT_EQ(fin.inspect().non_manifold, 1);
  EXPECT_EQ(fin.inspect().boundary, 2);
}

TEST(unit_check_edges, volume_tells_inside_from_outside) {
  Triangles outward, inward, hollow, far;
  add_cube(outward, vec3(0), 1);
  EXPECT_EQ(outward.inspect().inside_out(), 0);
  add_cube(inward, vec3(0), 1, true);
  EXPECT_EQ(inward.inspect().inside_out(), 1);
  inward.triangles.resize(10);
  EXPECT_EQ(inward.inspect().inside_out(), 0) << "what is open has no inside";
  // The wall of a hollow looks into it.
  add_cube(hollow, vec3(0), 1);
  add_cube(hollow, vec3(0), 0.5f, true);
  EXPECT_EQ(hollow.inspect().inside_out(), 0);
  EXPECT_EQ(hollow.inspect().parts.size(), 2);
  add_cube(hollow, vec3(3, 0, 0), 0.5f, true);
  EXPECT_EQ(hollow.inspect().inside_out(), 1);
  add_cube(far, vec3(1e5f, -1e5f, 1e5f), 1);
  EXPECT_EQ(far.inspect().inside_out(), 0);
}

TEST(unit_check_edges, nothing_is_nothing) {
  const EdgeReport report = inspect_edges({}, {}, 0.0f);
  EXPECT_EQ(report.edges, 0);
  EXPECT_TRUE(report.parts.empty());
  EXPECT_EQ(default_weld_distance({}), 0.0f);
  // Triangles that welding makes flat are none.
  Triangles speck{{vec3(0), vec3(1e-9f, 0, 0), vec3(0, 1, 0), vec3(1, 0, 0)}, {uvec3(0, 1, 2), uvec3(0, 3, 2)}};
  EXPECT_EQ(speck.inspect().edges, 3);
}

}  // namespace
}  // namespace candela::check
