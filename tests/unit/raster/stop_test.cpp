#include <gtest/gtest.h>

#include <atomic>

#include "candela/candela.h"
#include "unit/gl/gl_fixture.h"
#include "unit/path/scenes.h"

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
  const Film whole = raster::render(scene, environment, view, s);

  s.frames = 100000;
  std::atomic<bool> stop = false;
  int told = 0;
  double last = 0.0;
  Job job{.stop = &stop};
  job.progress = [&](const Progress& p) {
    EXPECT_GE(p.fraction, last);
    last = p.fraction;
    if (++told == 3) stop = true;
  };
  raster::Statistics statistics;
  const Film part = raster::render(scene, environment, view, s, job, &statistics);
  EXPECT_TRUE(statistics.interrupted);
  EXPECT_GE(statistics.frames, 3);
  EXPECT_LT(statistics.frames, 100000);
  EXPECT_NEAR(mean(part), mean(whole), 0.01 * mean(whole));
}

raster::Settings small(int frames) {
  raster::Settings settings;
  settings.width = settings.height = 8;
  settings.frames = frames;
  return settings;
}

TEST_F(unit_raster_stop, the_first_frame_is_always_drawn) {
  const std::atomic<bool> stop = true;
  raster::Statistics statistics;
  const Film film = raster::render(ball(), make_environment("furnace"), look_at({0, 0, 4}, vec3(0.0f), 0.8f), small(4),
                                   {.stop = &stop}, &statistics);
  EXPECT_GT(mean(film), 0.1);
  EXPECT_EQ(statistics.frames, 1);
  EXPECT_TRUE(statistics.interrupted);
}

TEST_F(unit_raster_stop, what_is_whole_when_it_is_stopped_is_not_interrupted) {
  const std::atomic<bool> stop = true;
  raster::Statistics statistics;
  raster::render(ball(), make_environment("furnace"), look_at({0, 0, 4}, vec3(0.0f), 0.8f), small(1), {.stop = &stop},
                 &statistics);
  EXPECT_FALSE(statistics.interrupted);
}

}  // namespace
}  // namespace candela
