#include "io/tangents.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace candela::io {
namespace {

struct Grid {
  std::vector<vec3> positions, normals;
  std::vector<vec2> uvs;
  std::vector<uvec3> triangles;
};

/// n × n quads in the plane z = 0 with vertices shared; `uv` maps x, y in [0, 1] to uv.
template <class Uv>
Grid plane(std::uint32_t n, const Uv& uv) {
  Grid g;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) {
      const vec2 p(static_cast<float>(x) / static_cast<float>(n), static_cast<float>(y) / static_cast<float>(n));
      g.positions.emplace_back(p, 0);
      g.normals.emplace_back(0, 0, 1);
      g.uvs.push_back(uv(p));
    }
  }
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t i = y * (n + 1) + x;
      g.triangles.emplace_back(i, i + 1, i + n + 1);
      g.triangles.emplace_back(i + 1, i + n + 2, i + n + 1);
    }
  }
  return g;
}

void expect_near(vec4 a, vec4 b) {
  EXPECT_LT(glm::length(a - b), 1e-6f) << a.x << ' ' << a.y << ' ' << a.z << ' ' << a.w << " is not " << b.x << ' '
                                       << b.y << ' ' << b.z << ' ' << b.w;
}

TangentFrames make(const Grid& g) { return make_tangents(g.positions, g.normals, g.uvs, g.triangles); }

TEST(unit_io_tangents, a_plane_has_the_direction_of_u_and_the_image_upright) {
  // glTF: v points down in the image, so that an upright picture has v = 1 - y and its up is +y = cross(n, t) · w.
  for (const vec4 t : make(plane(3, [](vec2 p) { return vec2(p.x, 1 - p.y); })).corners)
    expect_near(t, vec4(1, 0, 0, 1));
  for (const vec4 t : make(plane(3, [](vec2 p) { return vec2(-p.x, 1 - p.y); })).corners)
    expect_near(t, vec4(-1, 0, 0, -1));
  for (const vec4 t : make(plane(3, [](vec2 p) { return vec2(p.y, p.x); })).corners) expect_near(t, vec4(0, 1, 0, 1));
}

TEST(unit_io_tangents, mirrored_halves_do_not_share_a_group) {
  const Grid g = plane(4, [](vec2 p) { return vec2(std::fabs(p.x - 0.5f), 1 - p.y); });
  const TangentFrames frames = make(g);
  for (std::size_t f = 0; f < g.triangles.size(); ++f) {
    const vec3 centre =
        (g.positions[g.triangles[f].x] + g.positions[g.triangles[f].y] + g.positions[g.triangles[f].z]) / 3.0f;
    for (std::size_t i = 0; i < 3; ++i) {
      expect_near(frames.corners[f * 3 + i], centre.x < 0.5f ? vec4(-1, 0, 0, -1) : vec4(1, 0, 0, 1));
    }
  }
}

TEST(unit_io_tangents, order_of_triangles_and_corners_does_not_matter) {
  Grid g = plane(6, [](vec2 p) { return vec2(p.x + 0.3f * p.y * p.y, 1 - p.y + 0.2f * std::sin(5 * p.x)); });
  const TangentFrames before = make(g);
  std::mt19937 random(7);
  std::vector<std::size_t> order(g.triangles.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), random);
  Grid shuffled = g;
  for (std::size_t f = 0; f < order.size(); ++f) {
    const uvec3 t = g.triangles[order[f]];
    shuffled.triangles[f] = uvec3(t.y, t.z, t.x);
  }
  const TangentFrames after = make(shuffled);
  for (std::size_t f = 0; f < order.size(); ++f) {
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_LT(glm::length(before.corners[order[f] * 3 + (i + 1) % 3] - after.corners[f * 3 + i]), 1e-5f);
    }
  }
}

TEST(unit_io_tangents, splitting_vertices_does_not_matter) {
  const Grid g = plane(5, [](vec2 p) { return vec2(p.x * p.x, 1 - p.y * p.x); });
  Grid split;
  for (const uvec3& t : g.triangles) {
    const auto base = static_cast<std::uint32_t>(split.positions.size());
    for (int i = 0; i < 3; ++i) {
      split.positions.push_back(g.positions[t[i]]);
      split.normals.push_back(g.normals[t[i]]);
      split.uvs.push_back(g.uvs[t[i]]);
    }
    split.triangles.emplace_back(base, base + 1, base + 2);
  }
  const TangentFrames shared = make(g), apart = make(split);
  for (std::size_t c = 0; c < shared.corners.size(); ++c) expect_near(shared.corners[c], apart.corners[c]);
}

TEST(unit_io_tangents, corners_weigh_by_their_angle) {
  // Around the origin: 90° of a triangle whose u runs along +x, and 45° of one whose u runs along +x-y.
  Grid g;
  g.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 1, 0}};
  g.normals.assign(4, vec3(0, 0, 1));
  g.triangles = {{0, 1, 2}, {0, 2, 3}};
  g.uvs = {{0, 0}, {1, 0}, {0, 1}, {-1, 0}};
  const TangentFrames frames = make(g);
  const vec3 expected = glm::normalize(2.0f * vec3(1, 0, 0) + glm::normalize(vec3(1, -1, 0)));
  EXPECT_LT(glm::length(vec3(frames.corners[0]) - expected), 1e-6f);
  EXPECT_EQ(frames.corners[0], frames.corners[3]);
  EXPECT_EQ(frames.corners[0].w, -1);
  EXPECT_LT(glm::length(vec3(frames.corners[1]) - vec3(1, 0, 0)), 1e-6f);
}

TEST(unit_io_tangents, triangles_without_uv_area_join_their_neighbours) {
  Grid g = plane(3, [](vec2 p) { return vec2(p.x, 1 - p.y); });
  // An extra triangle in the plane whose three uvs are one point.
  const auto base = static_cast<std::uint32_t>(g.positions.size());
  g.positions.emplace_back(0.5f, -1, 0);
  g.normals.emplace_back(0, 0, 1);
  g.uvs.emplace_back(0, 1);
  g.uvs[0] = g.uvs[1] = vec2(0, 1);
  g.triangles.emplace_back(1, 0, base);
  const TangentFrames frames = make(g);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(glm::length(vec3(frames.corners[(g.triangles.size() - 1) * 3 + i])), 1, 1e-6);
  }
  // Its corner at the lone vertex has a frame from the normal.
  const vec4 lone = frames.corners.back();
  EXPECT_NEAR(lone.z, 0, 1e-6);
  EXPECT_NEAR(glm::length(vec3(lone)), 1, 1e-6);
}

TEST(unit_io_tangents, frames_are_unit_and_perpendicular_whatever_comes_in) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> u(-1, 1);
  Grid g;
  for (int i = 0; i < 200; ++i) {
    g.positions.emplace_back(u(random), u(random), u(random));
    g.normals.push_back(glm::normalize(vec3(u(random), u(random), u(random))));
    // A few equal uvs, a few huge.
    g.uvs.emplace_back(i % 7 == 0 ? 0 : u(random), i % 7 == 0 ? 0 : u(random) * (i % 11 == 0 ? 1e30f : 1.0f));
  }
  std::uniform_int_distribution<std::uint32_t> index(0, 199);
  for (int i = 0; i < 1000; ++i) g.triangles.emplace_back(index(random), index(random), index(random));
  const TangentFrames frames = make(g);
  for (std::size_t c = 0; c < frames.corners.size(); ++c) {
    const vec4 t = frames.corners[c];
    const vec3 n = g.normals[g.triangles[c / 3][static_cast<int>(c % 3)]];
    EXPECT_NEAR(glm::length(vec3(t)), 1, 1e-4);
    EXPECT_NEAR(glm::dot(vec3(t), n), 0, 1e-3);
    EXPECT_EQ(std::fabs(t.w), 1);
  }
}

TEST(unit_io_tangents, a_fan_of_many_triangles_around_one_vertex_is_fast) {
  Grid g;
  constexpr std::uint32_t n = 200000;
  g.positions.emplace_back(0, 0, 0);
  g.uvs.emplace_back(0.5f, 0.5f);
  for (std::uint32_t i = 0; i <= n; ++i) {
    const float a = 2 * kPi * static_cast<float>(i) / n;
    g.positions.emplace_back(std::cos(a), std::sin(a), 0);
    g.uvs.emplace_back(0.5f + 0.5f * std::cos(a), 0.5f - 0.5f * std::sin(a));
    if (i > 0) g.triangles.emplace_back(0, i, i + 1);
  }
  g.normals.assign(g.positions.size(), vec3(0, 0, 1));
  const TangentFrames frames = make(g);
  EXPECT_GT(frames.corners[0].x, 0.999f);
  EXPECT_EQ(frames.corners[0].w, 1);
}

}  // namespace
}  // namespace candela::io
