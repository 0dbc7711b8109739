#include <gtest/gtest.h>

#include <atomic>

#include "candela/candela.h"
#include "unit/path/scenes.h"
#include "unit/raster/gl_fixture.h"

namespace candela {
namespace {

using namespace test;

class unit_raster_stop : public NeedsGl {};  // NOLINT(readability-identifier-naming): as its suite

Scene ball() {
  SceneBuilder b;
  b.add(sphere(vec3(0.0f), 1.0f, 3, false), matte(vec3(0.5f)));
  return b.build();
}

double mean(const Film& film) {
  double sum = 0.0;
  for (const float v : film.beauty.pixels) sum += static_cast<double>(v);
  return sum / static_cast<double>(film.beauty.pixels.size());
}

TEST_F(unit_raster_stop, a_picture_that_is_stopped_is_the_mean_of_the_frames_it_has) {
  const Scene scene = ball();
  const Environment environment = make_environment("furnace");
  const View view = look_at({0, 0, 4}, vec3(0.0f), 0.8f);
  raster::Settings s;
  s.width = 24, s.height = 16, s.frames = 8;
  Diagnostics diagnostics;
  const Film whole = raster::render(scene, environment, view, s, diagnostics);

  s.frames = 100000;
  std::atomic<bool> stop = false;
  int told = 0;
  double last = 0.0;
  raster::Statistics statistics;
  const Film part = raster::render(scene, environment, view, s, diagnostics, &statistics,
                                   {[&](const raster::Progress& p) {
                                      EXPECT_GE(p.fraction, last);
                                      last = p.fraction;
                                      if (++told == 3) stop = true;
                                    },
                                    &stop});
  EXPECT_TRUE(statistics.interrupted);
  EXPECT_GE(statistics.frames, 3);
  EXPECT_LT(statistics.frames, 100000);
  EXPECT_NEAR(mean(part), mean(whole), 0.01 * mean(whole));
}

TEST_F(unit_raster_stop, no_other_picture_is_begun_and_the_first_frame_is_always_drawn) {
  const Scene scene = ball();
  const std::vector<View> views(3, look_at({0, 0, 4}, vec3(0.0f), 0.8f));
  Diagnostics diagnostics;
  std::atomic<bool> stop = true;
  std::size_t taken = 0;
  raster::Settings small;
  small.width = small.height = 8;
  small.frames = 4;
  raster::Statistics statistics;
  raster::Session session;
  session.draw(scene, make_environment("furnace"), views, small, diagnostics,
               [&](std::size_t, const Film& film) {
                 EXPECT_GT(mean(film), 0.1);
                 ++taken;
               },
               &statistics, {}, {{}, &stop});
  EXPECT_EQ(taken, 1u);
  EXPECT_EQ(statistics.frames, 1);
  EXPECT_TRUE(statistics.interrupted);
}

TEST_F(unit_raster_stop, what_is_whole_when_it_is_stopped_is_not_interrupted) {
  Diagnostics diagnostics;
  std::atomic<bool> stop = true;
  raster::Statistics statistics;
  raster::Settings small;
  small.width = small.height = 8;
  raster::render(ball(), make_environment("furnace"), look_at({0, 0, 4}, vec3(0.0f), 0.8f), small, diagnostics,
                 &statistics, {{}, &stop});
  EXPECT_FALSE(statistics.interrupted);
}

}  // namespace
}  // namespace candela
