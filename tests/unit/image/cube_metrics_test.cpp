#include "image/cube_metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "unit/image/labelled_cube.h"

namespace candela {
namespace {

Cubemap flat_cube(int size, float value) {
  Cubemap cube;
  cube.levels = {make_cube_faces(size), make_cube_faces(size / 2)};
  for (CubeFaces& level : cube.levels)
    for (Image& face : level) std::fill(face.pixels.begin(), face.pixels.end(), value);
  return cube;
}

TEST(unit_image_cube_metrics, mean_light_is_over_the_sphere_and_not_over_texels) {
  CubeFaces faces = make_cube_faces(64);
  for (int face = 0; face < 6; ++face) {
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const vec3 d = glm::normalize(test::texel_direction(face, x, y, 64));
        faces[static_cast<std::size_t>(face)].set_rgb(x, y, vec3(d.x * d.x * d.x * d.x));
      }
    }
  }
  EXPECT_NEAR(measure_light(faces).mean, 0.2, 2e-4);  // ∫ x⁴ over the sphere / 4π
  double texels = 0.0;
  for (const Image& face : faces)
    for (const float v : face.pixels) texels += static_cast<double>(v) / (6.0 * 64 * 64 * 3);
  EXPECT_GT(std::abs(texels - 0.2), 5e-3);  // the twin without solid angles
}

TEST(unit_image_cube_metrics, equal_cubes_do_not_differ_and_a_factor_is_found) {
  const Cubemap a = flat_cube(8, 2.0f);
  for (const CubeLevelDifference& d : diff_cubemaps(a, a)) {
    EXPECT_EQ(d.max_relative, 0.0);
    EXPECT_EQ(d.rms_relative, 0.0);
  }
  const auto result = diff_cubemaps(flat_cube(8, 1.5f), a);
  ASSERT_EQ(result.size(), 2u);
  for (const CubeLevelDifference& d : result) {
    EXPECT_DOUBLE_EQ(d.max_relative, 0.25);
    EXPECT_DOUBLE_EQ(d.rms_relative, 0.25);
    EXPECT_DOUBLE_EQ(d.mean_relative, -0.25);
    EXPECT_DOUBLE_EQ(d.max_absolute, 0.5);
  }
  EXPECT_EQ(result[1].size, 4);
}

TEST(unit_image_cube_metrics, a_texel_counts_by_its_solid_angle_and_is_named) {
  const Cubemap a = flat_cube(8, 1.0f);
  const auto rms = [&](int x, int y) {
    Cubemap b = a;
    b.levels[0][3].set_rgb(x, y, vec3(2.0f));
    const CubeLevelDifference d = diff_cubemaps(b, a)[0];
    EXPECT_EQ(ivec3(d.face, d.x, d.y), ivec3(3, x, y));
    EXPECT_DOUBLE_EQ(d.max_relative, 0.5);
    return d.rms_relative;
  };
  EXPECT_GT(rms(4, 4), 1.5 * rms(0, 0));
}

TEST(unit_image_cube_metrics, noise_in_the_dark_is_no_disaster_and_nan_is_counted) {
  Cubemap a = flat_cube(8, 1.0f);
  Cubemap b = a;
  a.levels[0][0].set_rgb(0, 0, vec3(0.0f));
  b.levels[0][0].set_rgb(0, 0, vec3(1e-5f));
  EXPECT_LT(diff_cubemaps(b, a)[0].max_relative, 0.011);
  b.levels[0][0].set_rgb(1, 0, vec3(std::nanf("")));
  EXPECT_EQ(diff_cubemaps(b, a)[0].non_finite, 1u);
  EXPECT_EQ(measure_light(b.levels[0]).non_finite, 1u);
  EXPECT_LT(diff_cubemaps(b, a)[0].max_relative, 0.011);
}

TEST(unit_image_cube_metrics, cubes_of_other_sizes_are_refused) {
  EXPECT_THROW(diff_cubemaps(flat_cube(8, 1.0f), flat_cube(4, 1.0f)), Error);
  EXPECT_THROW(diff_cubemaps(Cubemap(), Cubemap()), Error);
  Cubemap one = flat_cube(8, 1.0f);
  one.levels.pop_back();
  EXPECT_THROW(diff_cubemaps(one, flat_cube(8, 1.0f)), Error);
}

}  // namespace
}  // namespace candela
