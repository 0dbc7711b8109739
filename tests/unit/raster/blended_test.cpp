#include <gtest/gtest.h>

#include <vector>

#include "raster/render.h"
#include "unit/gl/gl_fixture.h"
#include "unit/path/scenes.h"

// How surfaces that something shows through are sliced by depth; what they look like is
// tests/laws/raster_blended.cpp's.

namespace candela {
namespace {

using namespace test;

class unit_raster_blended : public NeedsGl {};  // NOLINT(readability-identifier-naming): as its suite

constexpr float kOpacity = 0.25f;

/// Sheets before one another at these depths, each of a colour of its own; the first is the farthest.
Scene sheets(const std::vector<int>& order, int count) {
  SceneBuilder b;
  for (const int i : order) {
    Material m = unlit({static_cast<float>(i) / static_cast<float>(count), i % 2 == 0 ? 1.0f : 0.0f, 0.5f});
    m.alpha_mode = AlphaMode::blend;
    m.opacity = kOpacity;
    b.add(quad({-4, -4, static_cast<float>(i)}, {8, 0, 0}, {0, 8, 0}), m);
  }
  return b.build();
}

vec3 middle_of(const Scene& scene, int count) {
  raster::Settings settings;
  settings.width = settings.height = 8;
  const View view = look_at({0, 0, static_cast<float>(count) + 3.0f}, vec3(0.0f), 0.4f);
  const Film film = raster::render(scene, dark_environment(), view, settings);
  return film.beauty.rgb(4, 4);
}

vec3 expected(int count) {
  vec3 color(0.0f);
  for (int i = 0; i < count; ++i) {
    const vec3 own(static_cast<float>(i) / static_cast<float>(count), i % 2 == 0 ? 1.0f : 0.0f, 0.5f);
    color = glm::mix(color, own, kOpacity);
  }
  return color;
}

TEST_F(unit_raster_blended, sheets_cover_one_another_whatever_their_order_in_the_scene) {
  for (const std::vector<int>& order : {std::vector{0, 1, 2, 3}, std::vector{3, 2, 1, 0}, std::vector{2, 0, 3, 1}}) {
    EXPECT_LT(glm::distance(middle_of(sheets(order, 4), 4), expected(4)), 2e-3f);
  }
}

TEST_F(unit_raster_blended, those_beyond_the_last_slice_are_sorted_too) {
  // More than there are slices of depth, in an order that is none.
  const std::vector<int> order = {0, 5, 10, 3, 8, 1, 6, 11, 4, 9, 2, 7};
  EXPECT_LT(glm::distance(middle_of(sheets(order, 12), 12), expected(12)), 4e-3f);
}

}  // namespace
}  // namespace candela
