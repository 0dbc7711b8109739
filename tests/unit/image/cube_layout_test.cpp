#include "image/cube_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "unit/image/labelled_cube.h"

namespace candela {
namespace {

std::vector<CubeAxes> all_axes() {
  std::vector<CubeAxes> all;
  std::array<int, 3> axis{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs)
      all.push_back({axis, {(signs & 1) != 0 ? -1 : 1, (signs & 2) != 0 ? -1 : 1, (signs & 4) != 0 ? -1 : 1}});
  } while (std::next_permutation(axis.begin(), axis.end()));
  return all;
}

TEST(unit_image_cube_layout, axes_say_themselves_and_are_their_own_inverse) {
  EXPECT_EQ(axes_text(CubeAxes()), "+x+y+z");
  EXPECT_EQ(axes_text(kPictureAxes), "-x+y+z");
  int pictures = 0;
  for (const CubeAxes& axes : all_axes()) {
    EXPECT_EQ(parse_axes(axes_text(axes)), axes);
    const vec3 d(0.25f, -0.5f, 0.75f);
    EXPECT_EQ(axes.world_from_lookup(axes.lookup_from_world(d)), d);
    EXPECT_EQ(axes.lookup_from_world(axes.world_from_lookup(d)), d);
    pictures += axes.is_picture();
  }
  EXPECT_EQ(pictures, 24);  // of 48
  EXPECT_TRUE(kPictureAxes.is_picture());
  for (const char* text : {"", "+x+y", "+x+y+z ", "xyzxyz", "+x+x+z", "+x+y+w", "*x+y+z"})
    EXPECT_FALSE(parse_axes(text)) << text;
}

TEST(unit_image_cube_layout, an_engine_that_looks_up_by_its_axes_finds_the_direction_of_the_world) {
  const CubeFaces world = test::labelled_faces(4);
  for (const CubeAxes& axes : all_axes()) {
    const CubeFaces file = file_from_world(world, axes);
    for (int face = 0; face < 6; ++face) {
      for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 4; ++x) {
          const vec3 d = test::texel_direction(face, x, y, 4);
          const vec3 c = shade::cube_coordinates(axes.lookup_from_world(d));
          const auto texel = [](float s) { return static_cast<int>(std::floor((s + 1.0f) * 2.0f)); };
          ASSERT_EQ(file[static_cast<std::size_t>(c.x)].rgb(texel(c.y), texel(c.z)), d + 2.0f) << axes_text(axes);
        }
      }
    }
    EXPECT_TRUE(test::faces_are_equal(world_from_file(file, axes), world));
    // The twin: other axes do not undo it.
    if (axes != kPictureAxes) {
      EXPECT_FALSE(test::faces_are_equal(world_from_file(file, kPictureAxes), world));
    }
  }
}

TEST(unit_image_cube_layout, layouts_come_back) {
  const CubeFaces faces = test::labelled_faces(5);
  for (int i = 0; i < 4; ++i) {
    const auto layout = static_cast<CubeLayout>(i);
    const Image picture = layout_from_faces(faces, layout);
    EXPECT_EQ(detect_layout(picture.width, picture.height), layout);
    EXPECT_EQ(parse_layout(layout_name(layout)), layout);
    EXPECT_TRUE(test::faces_are_equal(faces_from_layout(picture, layout), faces));
  }
  EXPECT_FALSE(detect_layout(200, 100));
  EXPECT_FALSE(detect_layout(100, 100));
  EXPECT_FALSE(detect_layout(401, 300));
  EXPECT_FALSE(detect_layout(0, 0));
  EXPECT_THROW(parse_layout("cross"), Error);
}

/// Steps of the label between neighbours in a cross, where both belong to the cube.
double largest_step(const Image& cross) {
  double largest = 0.0;
  for (int y = 0; y < cross.height; ++y) {
    for (int x = 0; x < cross.width; ++x) {
      for (const ivec2 step : {ivec2(1, 0), ivec2(0, 1)}) {
        const ivec2 next = ivec2(x, y) + step;
        if (next.x >= cross.width || next.y >= cross.height) continue;
        const vec3 a = cross.rgb(x, y), b = cross.rgb(next.x, next.y);
        if (a == vec3(0.0f) || b == vec3(0.0f)) continue;
        largest = std::max(largest, static_cast<double>(glm::length(b - a)));
      }
    }
  }
  return largest;
}

TEST(unit_image_cube_layout, a_cross_is_continuous_where_its_faces_meet) {
  const CubeFaces faces = test::labelled_faces(16);
  const double inside = 2.0 / 16.0;
  for (const CubeLayout layout : {CubeLayout::cross_4x3, CubeLayout::cross_3x4})
    EXPECT_LT(largest_step(layout_from_faces(faces, layout)), 1.1 * inside);
  // The twin: two faces exchanged.
  CubeFaces wrong = faces;
  std::swap(wrong[4], wrong[5]);
  EXPECT_GT(largest_step(layout_from_faces(wrong, CubeLayout::cross_3x4)), 1.0);
  // As a picture from inside: +z in the middle, and what is right of it, +x of the left-handed lookup, is -x of the
  // world.
  const Image cross = layout_from_faces(file_from_world(faces, kPictureAxes), CubeLayout::cross_4x3);
  EXPECT_LT(cross.rgb(2 * 16 + 8, 16 + 8).x, 1.2f);
  EXPECT_GT(cross.rgb(16 + 8, 16 + 8).z, 2.8f);
}

TEST(unit_image_cube_layout, solid_angles_of_a_cube_are_the_sphere) {
  for (const int size : {1, 2, 7, 64}) {
    double sum = 0.0;
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) sum += 6.0 * cube_texel_solid_angle(size, x, y);
    EXPECT_NEAR(sum, 4.0 * 3.14159265358979, 1e-12);
  }
  // Far from the middle of a face a texel covers 3^(3/2) times less.
  EXPECT_NEAR(cube_texel_solid_angle(256, 128, 128) / cube_texel_solid_angle(256, 0, 0), std::pow(3.0, 1.5), 0.05);
}

}  // namespace
}  // namespace candela
