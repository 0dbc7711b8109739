#include "image/cube_panorama.h"

#include <ImfEnvmap.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "shade/cube.glsl.h"

// OpenEXR's own functions say where its pixels look.
namespace candela {
namespace {

using Imath::Box2i;
using Imath::V2f;
using Imath::V2i;

vec3 color_of(vec3 d) { return vec3(0.5f) + 0.5f * glm::normalize(d); }
vec3 to_vec3(const Imath::V3f& v) { return {v.x, v.y, v.z}; }

Image openexr_cube(int size) {
  const Box2i window(V2i(0, 0), V2i(size - 1, 6 * size - 1));
  Image image(size, 6 * size, 3);
  for (int face = 0; face < 6; ++face) {
    for (int j = 0; j < size; ++j) {
      for (int i = 0; i < size; ++i) {
        const auto f = static_cast<Imf::CubeMapFace>(face);
        const V2f in_face(static_cast<float>(i), static_cast<float>(j));
        const V2f at = Imf::CubeMap::pixelPosition(f, window, in_face);
        image.set_rgb(static_cast<int>(at.x), static_cast<int>(at.y),
                      color_of(to_vec3(Imf::CubeMap::direction(f, window, in_face))));
      }
    }
  }
  return image;
}

TEST(unit_image_cube_panorama, openexrs_cube_shows_each_direction_where_it_is) {
  for (const int size : {2, 7, 32}) {
    const CubeFaces faces = cube_from_openexr(openexr_cube(size));
    for (int face = 0; face < 6; ++face) {
      for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
          const float s = (2.0f * static_cast<float>(x) + 1.0f) / static_cast<float>(size) - 1.0f;
          const float t = (2.0f * static_cast<float>(y) + 1.0f) / static_cast<float>(size) - 1.0f;
          const vec3 expected = color_of(shade::cube_direction(face, s, t));
          const vec3 found = faces[static_cast<std::size_t>(face)].rgb(x, y);
          // A straight line across a pixel instead of the sphere.
          ASSERT_LT(glm::distance(found, expected), 0.6f / static_cast<float>(size * size))
              << face << ' ' << x << ' ' << y;
        }
      }
    }
  }
}

TEST(unit_image_cube_panorama, openexrs_panorama_shows_each_direction_where_it_is) {
  for (const int height : {4, 31, 64}) {
    const Box2i window(V2i(0, 0), V2i(2 * height - 1, height - 1));
    Image image(2 * height, height, 3);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < image.width; ++x)
        image.set_rgb(
            x, y,
            color_of(to_vec3(Imf::LatLongMap::direction(window, V2f(static_cast<float>(x), static_cast<float>(y))))));
    const Image map = panorama_from_openexr(image);
    ASSERT_EQ(map.width, image.width);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < map.width; ++x) {
        const float azimuth = ((static_cast<float>(x) + 0.5f) / static_cast<float>(map.width) - 0.5f) * 2.0f * kPi;
        const float polar = (static_cast<float>(y) + 0.5f) / static_cast<float>(height) * kPi;
        const vec3 d(std::sin(polar) * std::cos(azimuth), std::cos(polar), std::sin(polar) * std::sin(azimuth));
        ASSERT_LT(glm::distance(map.rgb(x, y), color_of(d)), 2.0f / static_cast<float>(height * height))
            << x << ' ' << y;
      }
    }
  }
}

TEST(unit_image_cube_panorama, a_constant_stays_and_a_bright_pixel_keeps_its_sum) {
  Image cube(8, 48, 3), latlong(16, 8, 3);
  std::fill(cube.pixels.begin(), cube.pixels.end(), 2.0f);
  std::fill(latlong.pixels.begin(), latlong.pixels.end(), 2.0f);
  for (const Image& face : cube_from_openexr(cube))
    for (const float v : face.pixels) ASSERT_NEAR(v, 2.0f, 1e-5f);
  for (const float v : panorama_from_openexr(latlong).pixels) ASSERT_NEAR(v, 2.0f, 1e-5f);

  for (const int x : {0, 3, 4, 11, 15}) {
    Image sun(16, 8, 3);
    sun.set_rgb(x, 4, vec3(100.0f));
    double sum = 0.0;
    for (const float v : panorama_from_openexr(sun).pixels) sum += static_cast<double>(v) / 3.0;
    // Pixels lie 1/15 of the whole apart, and rows 1/7; a sixteenth and an eighth is what ours cover. At the cut a
    // pixel is half of what it is elsewhere, and the other half is at the other end.
    EXPECT_NEAR(sum, 100.0 * (16.0 / 15.0) * (8.0 / 7.0) * (x == 0 || x == 15 ? 0.5 : 1.0), 0.01) << x;
  }
}

TEST(unit_image_cube_panorama, a_pixel_alone_is_everywhere) {
  Image one(1, 6, 3);
  for (int face = 0; face < 6; ++face) one.set_rgb(0, face, vec3(static_cast<float>(face)));
  const CubeFaces faces = cube_from_openexr(one);
  for (int face = 0; face < 6; ++face)
    EXPECT_EQ(faces[static_cast<std::size_t>(face)].rgb(0, 0), vec3(static_cast<float>(face)));
}

}  // namespace
}  // namespace candela
