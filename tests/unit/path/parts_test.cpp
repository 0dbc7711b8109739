#include <gtest/gtest.h>

#include "base/error.h"
#include "path/accumulator.h"
#include "unit/path/scenes.h"

// Pictures in parts: what is added up, and what is gone on with, is what one run would have made.

namespace candela {
namespace {

using namespace test;

/// A lamp, a ball, a sheet of glass before nothing, and much that is brighter than it.
Scene mixed() {
  SceneBuilder b;
  b.add(sphere({-0.5f, 0, 0}, 0.6f, 3, false), plastic({0.2f, 0.4f, 0.9f}, 0.3f));
  b.add(sphere({0.9f, 0.5f, 0}, 0.2f, 2, true), lamp(vec3(3e4f, 1e-3f, 2.0f)));
  Material glass = plastic({0.9f, 0.6f, 0.3f}, 0.1f);
  glass.transmission = 1.0f;
  b.add(quad({0, -1, 0.5f}, {1, 0, 0}, {0, 1, 0}), glass);
  return b.build();
}

path::Settings of_part(int first, int end) {
  path::Settings s = settings(24, end, 6);
  s.first_sample = first;
  s.background = Background::transparent;
  s.layers = {Layer::albedo, Layer::normal, Layer::base_color};
  s.mattes = {MatteKind::object};
  return s;
}

TEST(unit_path_parts, sums_of_parts_are_those_of_the_whole_to_the_last_bit) {
  const path::Tracer tracer(mixed(), constant_environment(vec3(0.7f, 0.8f, 0.9f)));
  const View view = look_at({0, 0, 4}, vec3(0.0f), 0.6f);
  const auto traced = [&](int first, int end) {
    const path::Settings s = of_part(first, end);
    path::Picture picture(tracer, view, s);
    picture.trace(end);
    std::vector<std::byte> bytes;
    picture.sums().write(bytes);
    return std::pair(std::move(bytes), picture.has_through());
  };
  const auto [whole, has_through] = traced(0, 72);
  EXPECT_TRUE(has_through);
  path::Accumulator sum(of_part(0, 72), has_through);
  for (const auto& [first, end] : {std::pair(48, 72), {0, 16}, {16, 48}}) {
    const auto [bytes, also] = traced(first, end);
    std::span<const std::byte> rest(bytes);
    path::Accumulator part(of_part(0, 72), has_through);
    part.read(rest);
    EXPECT_TRUE(rest.empty());
    sum.add(part);
  }
  Film merged, expected;
  sum.resolve(merged, false);
  path::Accumulator all(of_part(0, 72), has_through);
  std::span<const std::byte> rest(whole);
  all.read(rest);
  all.resolve(expected, false);
  EXPECT_EQ(merged.beauty.pixels, expected.beauty.pixels);
  for (const auto& [layer, image] : expected.layers) EXPECT_EQ(merged.layers.at(layer).pixels, image.pixels);
  EXPECT_EQ(merged.through.pixels, expected.through.pixels);
}

TEST(unit_path_parts, a_picture_goes_on_from_its_state) {
  const path::Tracer tracer(mixed(), constant_environment(vec3(0.7f)));
  const View view = look_at({0, 0, 4}, vec3(0.0f), 0.6f);
  path::Settings s = of_part(0, 64);
  s.has_features = true;
  path::Picture whole(tracer, view, s);
  whole.trace(64);
  for (const int so_far : {1, 16, 40}) {
    path::Picture begun(tracer, view, s);
    begun.trace(so_far);
    path::Picture resumed(tracer, view, s);
    resumed.set_state(begun.state());
    resumed.trace(64);
    EXPECT_TRUE(films_are_identical(resumed.film(), whole.film())) << so_far;
    EXPECT_EQ(resumed.statistics().samples, whole.statistics().samples);
  }
  std::vector<std::byte> state = whole.state();
  state.pop_back();
  path::Picture other(tracer, view, s);
  EXPECT_THROW(other.set_state(state), Error);
  state.push_back({});
  state.push_back({});
  EXPECT_THROW(other.set_state(state), Error);
}

TEST(unit_path_parts, a_part_begins_with_a_block_and_has_no_noise_target) {
  const path::Tracer tracer(mixed(), constant_environment(vec3(0.7f)));
  const View view = look_at({0, 0, 4}, vec3(0.0f), 0.6f);
  EXPECT_THROW(path::Picture(tracer, view, of_part(8, 32)), Error);
  EXPECT_THROW(path::Picture(tracer, view, of_part(32, 32)), Error);
  path::Settings s = of_part(16, 32);
  s.noise = 0.1f;
  EXPECT_THROW(path::Picture(tracer, view, s), Error);
}

}  // namespace
}  // namespace candela
