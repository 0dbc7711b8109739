#include "path/capture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "image/cube_layout.h"
#include "unit/image/labelled_cube.h"
#include "unit/path/scenes.h"

namespace candela {
namespace {

using namespace test;

/// Largest departure of any texel and channel from `value`.
double departure(const Cubemap& cube, double value) {
  double largest = 0.0;
  for (const Image& face : cube.levels[0])
    for (const float v : face.pixels) largest = std::max(largest, std::abs(static_cast<double>(v) - value));
  return largest;
}

Cubemap capture(const Scene& scene, const Environment& environment, vec3 position, int size, int samples,
                int bounces = 4) {
  path::Statistics statistics;
  Cubemap cube = path::capture_environment(path::Tracer(scene, environment), position, size,
                                           settings(1, samples, bounces), {}, &statistics);
  EXPECT_EQ(statistics.non_finite_samples, 0U);
  EXPECT_EQ(statistics.samples, 6U * static_cast<unsigned>(size * size * samples));
  return cube;
}

TEST(unit_path_capture, inside_a_furnace_it_is_the_furnace) {
  const auto beside_a_box = [](float albedo) {
    SceneBuilder b;
    b.add(box(vec3(1.0f, -1.0f, -1.0f), vec3(2.0f, 1.0f, 1.0f)), matte(vec3(albedo)));
    return b.build();
  };
  const Environment furnace = constant_environment(vec3(1.0f));
  EXPECT_LT(departure(capture(beside_a_box(1.0f), furnace, vec3(0.0f), 12, 16), 1.0), 1e-4);
  // The twin: half a percent of absorption is seen.
  EXPECT_GT(departure(capture(beside_a_box(0.995f), furnace, vec3(0.0f), 12, 16), 1.0), 1e-3);
}

/// A closed room whose walls glow in the colours of the faces +x -x +y -y +z -z.
Scene coloured_room() {
  const vec3 colors[] = {{1, 0, 0}, {0, 1, 1}, {0, 1, 0}, {1, 0, 1}, {0, 0, 1}, {1, 1, 0}};
  const vec3 x(2, 0, 0), y(0, 2, 0), z(0, 0, 2), low(-1.0f);
  const Primitive walls[] = {quad(low + x, z, y), quad(low, y, z),     quad(low + y, x, z),
                             quad(low, z, x),     quad(low + z, y, x), quad(low, x, y)};
  SceneBuilder b;
  for (std::size_t i = 0; i < 6; ++i) {
    Material m = lamp(colors[i]);
    m.double_sided = true;
    b.add(walls[i], m);
  }
  return b.build();
}

TEST(unit_path_capture, walls_are_seen_in_their_own_faces) {
  const vec3 colors[] = {{1, 0, 0}, {0, 1, 1}, {0, 1, 0}, {1, 0, 1}, {0, 0, 1}, {1, 1, 0}};
  const Cubemap cube = capture(coloured_room(), dark_environment(), vec3(0.0f), 8, 4, 0);
  for (std::size_t face = 0; face < 6; ++face) {
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 8; ++x) ASSERT_EQ(cube.levels[0][face].rgb(x, y), colors[face]) << face;
    }
  }
}

TEST(unit_path_capture, the_middle_of_a_texel_looks_in_its_direction) {
  // An environment that is its own direction: what comes back must be the label of the texel.
  const Environment labels = mapped_environment(512, 256, [](vec3 d) { return d + 2.0f; });
  const Cubemap cube = capture(SceneBuilder().build(), labels, vec3(3.0f, 1.0f, -2.0f), 8, 64);
  const auto worst = [&](const CubeFaces& faces) {
    double largest = 0.0;
    for (int face = 0; face < 6; ++face) {
      for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 8; ++x) {
          const vec3 found = faces[static_cast<std::size_t>(face)].rgb(x, y) - 2.0f;
          const vec3 expected = glm::normalize(texel_direction(face, x, y, 8));
          largest = std::max(largest, static_cast<double>(glm::length(found - expected)));
        }
      }
    }
    return largest;
  };
  EXPECT_LT(worst(cube.levels[0]), 0.05);  // a texel is 0.25 wide
  // The twin: as a camera with right-handed axes would have seen it.
  EXPECT_GT(worst(file_from_world(cube.levels[0], kPictureAxes)), 0.5);
}

TEST(unit_path_capture, lamps_are_seen_and_backdrops_are_not) {
  Environment studio = mapped_environment(16, 8, [](vec3) { return vec3(2.0f); });
  studio.backdrop = std::make_shared<Image>(16, 8, 3);
  const Cubemap cube = capture(SceneBuilder().build(), studio, vec3(0.0f), 4, 4);
  EXPECT_LT(departure(cube, 2.0), 1e-5);
}

TEST(unit_path_capture, it_does_not_depend_on_the_number_of_threads) {
  SceneBuilder b;
  b.add(sphere(vec3(2.0f, 0.0f, 0.0f), 1.0f, 2, false), plastic(vec3(0.5f), 0.3f));
  const Scene scene = b.build();
  const Environment light = mapped_environment(16, 8, [](vec3 d) { return vec3(1.0f + d.y); });
  const Cubemap many = capture(scene, light, vec3(0.0f), 20, 4);
  const ThreadLimit one(1);
  EXPECT_TRUE(faces_are_equal(capture(scene, light, vec3(0.0f), 20, 4).levels[0], many.levels[0]));
}

TEST(unit_path_capture, progress_grows_from_face_to_face_and_a_stop_leaves_nothing) {
  const path::Tracer tracer(coloured_room(), dark_environment());
  double last = 0.0;
  Job job;
  job.progress = [&](const Progress& p) {
    EXPECT_GE(p.fraction, last);
    last = p.fraction;
  };
  path::capture_environment(tracer, vec3(0.0f), 8, settings(1, 4, 1), job);
  EXPECT_EQ(last, 1.0);
  const std::atomic<bool> stop{true};
  EXPECT_THROW(path::capture_environment(tracer, vec3(0.0f), 8, settings(1, 4, 1), {.stop = &stop}), Interrupted);
  EXPECT_THROW(path::capture_environment(tracer, vec3(0.0f), 0, settings(1, 4, 1)), Error);
  EXPECT_THROW(path::capture_environment(tracer, vec3(1e20f), 8, settings(1, 4, 1)), Error);
}

}  // namespace
}  // namespace candela
