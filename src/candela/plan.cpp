#include "candela/plan.h"

#include <algorithm>
#include <cmath>

#include "base/stopwatch.h"

namespace candela {

namespace {

constexpr double kLook_s = 3.0;  // that is traced
constexpr int kFramesOfLook = 2;

/// The first picture with few samples.
Shot shot_of_look(Shot shot) {
  if (shot.has_many_pictures()) shot.pictures = PictureRange();
  shot.part.reset();
  shot.traced.noise.reset();
  shot.traced.time_limit_s = std::min(shot.traced.time_limit_s.value_or(kLook_s), kLook_s);
  shot.drawn.frames = std::min(shot.drawn.frames, kFramesOfLook);
  return shot;
}

double time_of(const Shot& shot, const TakenPicture& look) {
  if (shot.engine == Engine::raster) return look.drawn.frame_s / look.drawn.frames * shot.drawn.frames;
  if (shot.traced.time_limit_s) return *shot.traced.time_limit_s + look.denoise_s;
  const double samples = std::max(look.traced.mean_samples_per_pixel, 1e-3);
  // Of a moving picture every moment is built.
  const double build_s = shot.shutter_s > 0.0 ? look.traced.build_s : 0.0;
  return look.traced.render_s / samples * shot.traced.samples + build_s + look.denoise_s;
}

}  // namespace

WorkTimes measure_work(Shot shot, const Job& job, Diagnostics* diagnostics) {
  const Stopwatch watch;
  WorkTimes times;
  Take take(shot_of_look(shot), diagnostics);
  double made_s = 0.0;
  const TakeResult result = take.render(
      [&](const TakenPicture& look) {
        times.picture_s = time_of(shot, look);
        made_s = shot.engine == Engine::raster ? look.drawn.frame_s : look.traced.render_s + look.denoise_s;
      },
      job);
  if (result.interrupted && job.is_stopped()) throw Interrupted("before the work was known");
  times.start_s = std::max(watch.seconds() - made_s, 0.0);
  return times;
}

int most_parts(const Shot& shot) {
  const bool is_divisible =
      shot.engine == Engine::path && !shot.traced.noise && !shot.traced.time_limit_s && shot.shutter_s == 0.0;
  return is_divisible ? (shot.traced.samples + path::kSamplesOfBlock - 1) / path::kSamplesOfBlock : 1;
}

std::vector<WorkPiece> divide_work(std::size_t pictures, int most_parts, const WorkTimes& times, double piece_s) {
  const double work_s = std::max(piece_s - times.start_s, times.start_s);
  std::vector<WorkPiece> pieces;
  if (times.picture_s > work_s && most_parts > 1) {
    const double wanted = std::ceil(times.picture_s / work_s);
    const int parts = static_cast<int>(std::min(wanted, static_cast<double>(most_parts)));
    for (std::size_t picture = 1; picture <= pictures; ++picture) {
      for (int part = 1; part <= parts; ++part) pieces.push_back({{picture, picture}, PartRange{part, parts}});
    }
    return pieces;
  }
  const double fitting = std::floor(work_s / std::max(times.picture_s, 1e-9));
  const auto together = static_cast<std::size_t>(std::clamp(fitting, 1.0, static_cast<double>(pictures)));
  const std::size_t count = (pictures + together - 1) / together;
  for (std::size_t i = 0; i < count; ++i) pieces.push_back({{pictures * i / count + 1, pictures * (i + 1) / count}});
  return pieces;
}

}  // namespace candela
