#include <gtest/gtest.h>

#include <cmath>

#include "path/geometry.h"
#include "unit/path/scenes.h"

// Sixteen rays together find what each finds alone, whatever stands in the lanes that hold none.

namespace candela {
namespace {

using namespace test;
using path::Geometry;
using path::Hit;
using path::Ray;
using path::RayPacket;

/// From in front of the scene, spread over it and beyond.
Ray ray_of_lane(int lane) {
  const int column = lane % 4 - 2, row = lane / 4 - 2;
  Ray ray;
  ray.origin = {0.1f, 0.2f, 4.0f};
  ray.direction = glm::normalize(vec3(0.12f * static_cast<float>(column), 0.1f * static_cast<float>(row), -1.0f));
  return ray;
}

bool is_same(const Hit& a, const Hit& b) {
  return a.placement == b.placement && a.triangle == b.triangle && (!a || std::abs(a.t - b.t) < 1e-4f);
}

Scene bodies() {
  SceneBuilder b;
  b.add(sphere(vec3(0.0f), 0.8f, 2, false), matte(vec3(0.5f)));
  const int mesh = b.add_mesh(box(vec3(-0.3f), vec3(0.3f)), b.add_material(matte(vec3(0.5f))));
  b.add_node(mesh, translation({-1, 0.4f, 0}));
  b.add_node(mesh, translation({0.9f, -0.5f, 0.2f}));
  return b.build();
}

TEST(unit_path_packet, lanes_without_a_ray_may_hold_anything) {
  const Scene scene = bodies();
  const Geometry geometry(scene);
  int hits = 0;
  for (const float poison : {std::nanf(""), kInfinity, -kInfinity, 1e38f, -1e-42f}) {
    for (const unsigned mask : {0xffffU, 0x7777U, 0x0137U, 0x0001U, 0x8000U, 0xa5a5U}) {
      RayPacket packet;
      for (int i = 0; i < RayPacket::kSize; ++i) {
        packet.active[i] = (mask >> i & 1U) != 0;
        packet.seeds[i] = 7;
        packet.rays[i] = packet.active[i] ? ray_of_lane(i) : Ray{vec3(poison), vec3(poison), poison, poison};
      }
      Hit together[RayPacket::kSize];
      geometry.intersect(packet, together);
      for (int i = 0; i < RayPacket::kSize; ++i) {
        const Hit alone = packet.active[i] ? geometry.intersect(ray_of_lane(i), 7) : Hit{};
        EXPECT_TRUE(is_same(together[i], alone)) << poison << ' ' << mask << ' ' << i;
        hits += alone ? 1 : 0;
      }
    }
  }
  EXPECT_GT(hits, 50);
}

TEST(unit_path_packet, pictures_of_any_size_are_whole) {
  // Sides that are no multiple of a packet's leave lanes empty.
  for (const ivec2 size : {ivec2(1, 1), ivec2(5, 3), ivec2(3, 5), ivec2(17, 18)}) {
    path::Settings s = settings(size.x, 2, 2);
    s.height = size.y;
    const Film film = shoot(bodies(), constant_environment(vec3(1.0f)), look_at({0, 0, 4}, vec3(0.0f), 0.5f), s);
    ASSERT_EQ(ivec2(film.width(), film.height()), size);
    EXPECT_TRUE(is_finite_and_not_negative(film.beauty));
    for (int i = 0; i < size.x * size.y; ++i) EXPECT_EQ(film.beauty.at(i % size.x, i / size.x)[3], 1.0f);
  }
}

}  // namespace
}  // namespace candela
