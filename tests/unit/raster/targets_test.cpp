#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "raster/render.h"
#include "unit/gl/gl_fixture.h"
#include "unit/path/scenes.h"

// The pictures that are drawn into: how large, how fine, which way up, what they hold.

namespace candela {
namespace {

using namespace test;

class unit_raster_targets : public NeedsGl {};  // NOLINT(readability-identifier-naming): as its suite

/// Red above, green below, on a square of two metres that fills the picture from `at`.
Scene flag(vec3 at = vec3(0.0f)) {
  SceneBuilder b;
  b.add(quad(at + vec3(-1, 0, 0), {2, 0, 0}, {0, 1, 0}), unlit({1, 0, 0}));
  b.add(quad(at + vec3(-1, -1, 0), {2, 0, 0}, {0, 1, 0}), unlit({0, 1, 0}));
  return b.build();
}

View before(vec3 at, float half) {
  View view = look_at(at + vec3(0, 0, 4), at, 1.0f);
  view.projection = OrthographicCamera{.xmag = half, .ymag = half};
  return view;
}

raster::Settings sized(int width, int height) {
  raster::Settings s;
  s.width = width, s.height = height;
  return s;
}

TEST_F(unit_raster_targets, the_first_row_is_at_the_top) {
  const Film film = raster::render(flag(), dark_environment(), before(vec3(0.0f), 1.0f), sized(4, 6));
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 4; ++x)
      EXPECT_EQ(film.beauty.rgb(x, y), y < 3 ? vec3(1, 0, 0) : vec3(0, 1, 0)) << x << ' ' << y;
  }
}

TEST_F(unit_raster_targets, more_than_the_driver_draws_is_refused_and_says_how_much_it_does) {
  try {
    raster::render(flag(), dark_environment(), before(vec3(0.0f), 1.0f), sized(65536, 1));
    GTEST_SKIP() << "this driver draws as much";
  } catch (const Error& error) {
    EXPECT_EQ(error.where(), "--size");
    EXPECT_NE(error.message().find("pixels a side"), std::string::npos) << error.message();
  }
}

TEST_F(unit_raster_targets, more_samples_than_the_driver_has_are_those_it_has) {
  // Pixels that the edge of the square covers in part.
  const auto partial = [](int msaa) {
    raster::Settings settings = sized(9, 9);
    settings.msaa = msaa;
    settings.background = Background::transparent;
    const Film film = raster::render(flag(), dark_environment(), before({0.1f, 0.07f, 0}, 1.3f), settings);
    int count = 0;
    for (std::size_t i = 3; i < film.beauty.pixels.size(); i += 4) {
      count += film.beauty.pixels[i] > 0.0f && film.beauty.pixels[i] < 1.0f ? 1 : 0;
    }
    return count;
  };
  EXPECT_EQ(partial(1), 0);
  EXPECT_GT(partial(1 << 20), 0);
}

TEST_F(unit_raster_targets, layers_say_where_nothing_is_and_positions_are_the_worlds) {
  const vec3 at(1000.0f, -200.0f, 30.0f);
  raster::Settings settings = sized(8, 8);
  settings.layers = {Layer::depth, Layer::distance, Layer::position, Layer::normal};
  const Film film = raster::render(flag(at), dark_environment(), before(at, 2.0f), settings);
  const Image& depth = film.layers.at(Layer::depth);
  EXPECT_EQ(depth.channels, 1);
  EXPECT_TRUE(std::isinf(depth.pixels[depth.index(0, 0)])) << "beside the square";
  EXPECT_NEAR(depth.pixels[depth.index(4, 4)], 4.0f, 1e-3f);
  EXPECT_NEAR(film.layers.at(Layer::distance).pixels[depth.index(4, 4)], 4.0f, 1e-3f) << "rays are parallel";
  const Image& position = film.layers.at(Layer::position);
  // The middle of the pixel to the right of and below the picture's.
  EXPECT_LT(glm::distance(position.rgb(4, 4), at + vec3(0.25f, -0.25f, 0)), 2e-3f);
  EXPECT_EQ(position.rgb(0, 0), vec3(0.0f));
  EXPECT_LT(glm::distance(film.layers.at(Layer::normal).rgb(4, 4), vec3(0, 0, 1)), 1e-3f);
}

}  // namespace
}  // namespace candela
